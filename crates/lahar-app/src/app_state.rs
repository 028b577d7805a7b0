//! What the window knows and decides, without a window: actions, pointer and snapshots in; orders to
//! the solver and a picture out. Tests drive it as a hand would.

use std::collections::HashMap;
use std::sync::Arc;

use eframe::egui::{self, Color32};
use lahar::Command;
use lahar_scene::scene::{Comparison, Controls};

use crate::camera::{Camera, V3, length, scale};
use crate::color::{self, ColorBy, Range};
use crate::compare::ComparisonDraft;
use crate::controls::{Action, Direction};
use crate::pointer::{PointerMode, PointerTool};
use crate::renderer::{Line, Picture, Sprites, View};
use crate::scenery::{Scenery, sprites, usual_radius};
use crate::scenes::{Changes, SceneCard, SceneInfo, Setting};
use crate::solver::{Condition, Order, Readouts, SceneRequest, Shown, Side};

/// What the window must do for the state.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Send to the solver.
    Order(Order),
    /// Save the window as a picture.
    Screenshot,
    /// Draw small pictures of the scenes, into [`AppState::thumbnails`].
    Thumbnails,
    /// Close the window.
    Close,
}

/// All of it.
pub struct AppState {
    /// The scenes to choose from.
    pub scenes: Vec<SceneCard>,
    /// What [`Action::DefaultScene`] opens.
    pub default_scene: String,
    /// The open scene, by name or path.
    pub scene: String,
    /// The scene's settings as the panel has them; they hold from [`AppState::apply_settings`] on.
    pub settings: Vec<Setting>,
    /// Whether the clock stands.
    pub paused: bool,
    /// Simulated seconds per second, at most.
    pub speed: f64,
    /// Gravity now \[m/s²\].
    pub gravity: V3,
    /// What particles are colored by.
    pub color_by: ColorBy,
    /// Colors of the scene's swatches, by index.
    pub palette: Vec<Color32>,
    /// The color behind everything.
    pub background: Color32,
    /// Low and high end of the legend.
    pub range: Range,
    /// Radius of a particle, in parts of its spacing, or of the scene's own radius.
    pub radius: f32,
    /// The hand.
    pub hand: PointerTool,
    /// Where the hand is \[m\] and what it does, while a button holds it.
    pub held: Option<(V3, PointerMode)>,
    /// Whether the list of scenes is open.
    pub show_scenes: bool,
    /// Frames tried again that have been told of.
    pub(crate) told_retries: u64,
    /// What was typed to find a scene, and which of those found Enter opens.
    pub search: (String, usize),
    /// Small pictures of the scenes, by name; they come one by one.
    pub thumbnails: HashMap<String, egui::TextureHandle>,
    /// Whether the hints are in sight.
    pub show_hints: bool,
    /// Whether the side panel is in sight.
    pub show_panel: bool,
    /// The camera; `None` before the first particles.
    pub camera: Option<Camera>,
    /// A word on what happened, and when it is to go \[s of egui's clock\].
    pub notice: Option<(String, f64)>,
    /// Width over height of where a side is drawn.
    pub aspect: f64,
    /// What would be compared.
    pub draft: ComparisonDraft,
    /// Whether the view was turned, moved or zoomed; if not, it follows the window's size.
    pub view_is_own: bool,
    pub(crate) scenery: Scenery,
    /// The scenery's lines and the colliders' of each side; none without colliders.
    lines: Vec<Arc<Vec<Line>>>,
    /// Particles to draw, by side.
    pub(crate) sprites: Vec<Arc<Sprites>>,
    /// The direction that gravity has while its key is held, in scenes that want it so.
    pub(crate) held_gravity: Option<Direction>,

    changes: Changes,
    comparison: Option<Comparison>,
    shown: Shown,
    effects: Vec<Effect>,
    recolor: bool,
    refit: bool,
    asked_for_thumbnails: bool,
}

/// Speeds that + and − step through.
pub(crate) const SPEEDS: [f64; 16] = [
    0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 8.0,
];
/// Gravity of a scene that has none, when keys ask for some \[m/s²\].
const EARTH: f64 = 9.81;
/// Frames of a recording that the arrows up and down pass over.
const FAR: isize = 10;
/// What a key turns or moves the view by, in parts of the window's height.
const STEP: f64 = 0.05;
/// What a key enlarges by.
const ZOOM: f64 = 1.15;

impl AppState {
    /// Opens a scene, `wanted` or the default one.
    pub fn new(scenes: Vec<SceneCard>, default_scene: &str, wanted: Option<SceneRequest>) -> Self {
        let wanted = wanted.unwrap_or_else(|| SceneRequest {
            scene: default_scene.to_owned(),
            ..SceneRequest::default()
        });
        let mut state = Self {
            scenes,
            default_scene: default_scene.to_owned(),
            scene: wanted.scene,
            settings: vec![],
            paused: false,
            speed: 1.0,
            gravity: [0.0; 3],
            color_by: ColorBy::default(),
            palette: vec![],
            background: color::BACKGROUND,
            range: Range::default(),
            radius: 1.0,
            hand: PointerTool::of(Controls::default(), EARTH, 1.0, 0.01),
            held: None,
            show_scenes: false,
            told_retries: 0,
            search: (String::new(), 0),
            thumbnails: HashMap::new(),
            // They would lie over one of the sides.
            show_hints: wanted.comparison.is_none(),
            show_panel: true,
            camera: None,
            notice: None,
            aspect: 1.5,
            draft: ComparisonDraft::default(),
            view_is_own: false,
            scenery: Scenery::default(),
            lines: vec![],
            sprites: vec![],
            held_gravity: None,
            changes: wanted.changes,
            comparison: wanted.comparison,
            shown: Shown::default(),
            effects: vec![],
            recolor: false,
            refit: true,
            asked_for_thumbnails: false,
        };
        state.reopen();
        state
    }

    /// What the window must do, since last asked.
    pub fn take_effects(&mut self) -> Vec<Effect> {
        core::mem::take(&mut self.effects)
    }

    /// What the solver showed last.
    pub fn shown(&self) -> &Shown {
        &self.shown
    }

    /// What stays the same while the scene runs.
    pub fn info(&self) -> Option<&SceneInfo> {
        self.shown.info.as_deref()
    }

    /// What runs side by side: one as a rule; none before the first scene is built.
    pub fn sides(&self) -> &[Side] {
        &self.shown.sides
    }

    /// Numbers of the first side.
    pub fn readouts(&self) -> Readouts {
        (self.shown.sides.first()).map_or_else(Readouts::default, |side| side.readouts)
    }

    /// Frames of the recording that is replayed; `None`: the scene is simulated.
    pub fn recorded_frames(&self) -> Option<usize> {
        self.info().and_then(|info| info.frames)
    }

    /// What is compared.
    pub fn comparison(&self) -> Option<&Comparison> {
        self.comparison.as_ref()
    }

    /// Why the solver stopped, if it did.
    pub fn failure(&self) -> Option<&str> {
        match &self.shown.condition {
            Condition::Failed(why) => Some(why),
            _ => None,
        }
    }

    /// Does what a key or a button asks for.
    pub fn act(&mut self, action: Action) {
        match action {
            Action::Restart => self.restart(),
            Action::DefaultScene => self.open(self.default_scene.clone()),
            Action::Scene(index) => {
                if let Some(card) = self.scenes.get(index) {
                    self.open(card.name.clone());
                }
            }
            Action::SceneList => {
                self.show_scenes = !self.show_scenes;
                let here = self.scenes.iter().position(|card| card.name == self.scene);
                self.search = (String::new(), here.unwrap_or(0));
                if !core::mem::replace(&mut self.asked_for_thumbnails, true) {
                    self.effects.push(Effect::Thumbnails);
                }
            }
            Action::Gravity(direction) if self.recorded_frames().is_some() => {
                self.seek_by(match direction {
                    Direction::Left => -1,
                    Direction::Right => 1,
                    Direction::Up => FAR,
                    Direction::Down => -FAR,
                });
            }
            Action::Gravity(direction) => {
                let pull = self.scene_gravity();
                let axis = self.axis(direction);
                self.set_gravity(scale(axis, pull));
            }
            Action::Pause if self.shown.condition == Condition::Ended => {
                self.set_paused(false);
                self.restart();
            }
            Action::Pause => self.set_paused(!self.paused),
            Action::Back => self.seek_by(-1),
            Action::Compare => match self.comparison {
                Some(_) => self.compare(None),
                None => self.compare_draft(),
            },
            Action::Turn(direction) => self.turn(direction),
            Action::Move(direction) => self.pan(direction),
            Action::Nearer => self.zoom(ZOOM),
            Action::Farther => self.zoom(1.0 / ZOOM),
            Action::Substep => {
                self.set_paused(true);
                self.order(Order::Substep);
            }
            Action::Faster => {
                let next = SPEEDS.into_iter().find(|&s| s > self.speed * 1.001);
                self.set_speed(next.unwrap_or(SPEEDS[SPEEDS.len() - 1]));
            }
            Action::Slower => {
                let next = SPEEDS.into_iter().rev().find(|&s| s < self.speed * 0.999);
                self.set_speed(next.unwrap_or(SPEEDS[0]));
            }
            Action::Colors => self.set_color_by(self.color_by.next()),
            Action::Fit => self.fit(),
            Action::Screenshot => self.effects.push(Effect::Screenshot),
            Action::Hints => self.show_hints = !self.show_hints,
            Action::Panel => self.show_panel = !self.show_panel,
            Action::Leave => {
                if self.show_scenes {
                    self.show_scenes = false;
                } else {
                    self.effects.push(Effect::Close);
                }
            }
        }
    }

    /// Opens a scene by name or path, alone and as it is.
    pub fn open(&mut self, name: String) {
        self.scene = name;
        self.show_scenes = false;
        self.refit = true;
        self.changes.clear();
        self.comparison = None;
        self.reopen();
    }

    fn reopen(&mut self) {
        self.order(Order::Open(SceneRequest {
            scene: self.scene.clone(),
            changes: self.changes.clone(),
            comparison: self.comparison.clone(),
        }));
    }

    fn restart(&mut self) {
        self.order(Order::Restart);
    }

    /// Runs the scene with several values of a key side by side, or alone again.
    pub fn compare(&mut self, comparison: Option<Comparison>) {
        self.comparison = comparison;
        self.show_hints &= self.comparison.is_none();
        self.refit = true;
        self.reopen();
    }

    /// Compares what the panel has.
    pub fn compare_draft(&mut self) {
        if let Some(comparison) = self.draft.comparison() {
            self.compare(Some(comparison));
        }
    }

    /// Opens the scene anew with the settings of the panel.
    pub fn apply_settings(&mut self) {
        let before = self.info().map_or(&[][..], |info| &info.settings);
        let changed = self.settings.iter().filter(|new| {
            let old = before.iter().find(|old| old.key == new.key);
            old.is_some_and(|old| old.value != new.value)
        });
        let changed: Changes = changed
            .map(|new| (new.key.clone(), new.value.to_toml()))
            .collect();
        // A later change of a key replaces the earlier one.
        self.changes
            .retain(|(key, _)| !changed.iter().any(|(new, _)| new == key));
        self.changes.extend(changed);
        self.reopen();
    }

    /// Opens the scene as its file has it.
    pub fn forget_settings(&mut self) {
        self.changes.clear();
        self.reopen();
    }

    /// Whether the scene runs with changes.
    pub fn has_changes(&self) -> bool {
        !self.changes.is_empty()
    }

    /// Stops the clock, or lets it run.
    pub fn set_paused(&mut self, paused: bool) {
        if self.paused != paused {
            self.paused = paused;
            self.order(Order::Pause(paused));
        }
    }

    /// Simulated seconds per second, at most.
    pub fn set_speed(&mut self, speed: f64) {
        self.speed = speed.clamp(SPEEDS[0], SPEEDS[SPEEDS.len() - 1]);
        self.order(Order::Speed(self.speed));
    }

    /// Replaces gravity \[m/s²\].
    pub fn set_gravity(&mut self, gravity: V3) {
        let gravity = gravity.map(|c| c + 0.0); // no -0
        self.gravity = gravity;
        self.order(Order::Command(Command::Gravity(gravity)));
    }

    /// What particles are colored by.
    pub fn set_color_by(&mut self, by: ColorBy) {
        self.color_by = by;
        self.recolor = true;
        self.order(Order::Fields(by.fields()));
    }

    /// Colors of the materials were changed.
    pub fn repaint(&mut self) {
        self.recolor = true;
    }

    /// The magnitude of gravity that keys turn \[m/s²\].
    pub fn scene_gravity(&self) -> f64 {
        let info = self.info();
        let own = info.map_or(0.0, |info| length(info.gravity));
        let keys = info.and_then(|info| info.controls.gravity);
        keys.unwrap_or(if own > 0.0 { own } else { EARTH })
    }

    /// Whether gravity acts while a key is held, and none after.
    pub fn holds_gravity(&self) -> bool {
        self.info().is_some_and(|info| info.controls.hold)
    }

    /// The direction whose key is held, where [`AppState::holds_gravity`].
    pub fn hold_gravity(&mut self, held: Option<Direction>) {
        if self.held_gravity != held {
            self.held_gravity = held;
            let gravity = held.map_or([0.0; 3], |direction| {
                scale(self.axis(direction), self.scene_gravity())
            });
            self.set_gravity(gravity);
        }
    }

    /// To a frame of the recording, which then stands.
    pub fn seek(&mut self, frame: usize) {
        self.set_paused(true);
        self.order(Order::Seek(frame));
    }

    fn seek_by(&mut self, frames: isize) {
        if let Some(count) = self.recorded_frames() {
            let frame = self.readouts().frame.saturating_add_signed(frames);
            self.seek(frame.min(count.saturating_sub(1)));
        }
    }

    /// A direction of the window as an axis of the scene.
    fn axis(&self, direction: Direction) -> V3 {
        let (right, up) = self
            .camera
            .as_ref()
            .map_or(([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), |camera| {
                (camera.rightward_axis(), camera.up)
            });
        match direction {
            Direction::Left => scale(right, -1.0),
            Direction::Right => right,
            Direction::Up => up,
            Direction::Down => scale(up, -1.0),
        }
    }

    /// Takes in what the solver shows.
    pub fn receive(&mut self, shown: Shown) {
        let opened = shown.opened != self.shown.opened;
        let scene_before = self.info().map(|info| info.card.name.clone());
        self.shown = shown;
        if opened && let Some(info) = self.shown.info.clone() {
            self.gravity = info.gravity;
            self.held_gravity = None;
            self.settings.clone_from(&info.settings);
            self.draft.offer(&info.settings, self.comparison.as_ref());
            self.range.forget();
            let snapshot = self.sides().first().map(|side| Arc::clone(&side.snapshot));
            self.scenery = Scenery::new(&info, snapshot.as_deref());
            if scene_before.as_ref() != Some(&info.card.name) {
                self.look_anew(&info, scene_before.is_none());
            }
            if core::mem::take(&mut self.refit) {
                self.fit();
            }
        }
        self.recolor = true;
    }

    /// Another scene: its own colors, its own hand.
    fn look_anew(&mut self, info: &SceneInfo, first: bool) {
        let by = info.angle.color_by;
        // What was chosen stays, unless the scene asks for something.
        if self.color_by != by && (first || by != ColorBy::Material) {
            self.set_color_by(by);
        }
        self.palette = color::palette(&info.swatches);
        self.background = color::background(info);
        self.radius = usual_radius(info);
        self.hand = PointerTool::of(
            info.controls,
            self.scene_gravity(),
            self.scenery.smallest(info.dimension),
            info.dx,
        );
        if self.speed != info.controls.speed {
            self.set_speed(info.controls.speed);
        }
    }

    /// The view that the scene asks for, or the whole of it.
    fn fit(&mut self) {
        let Some(info) = self.info() else { return };
        let camera = Camera::fit(
            info.dimension,
            self.scenery.extent,
            info.gravity,
            info.angle,
            self.aspect,
        );
        self.camera = Some(camera);
        self.view_is_own = false;
    }

    /// The room for a side has this width over height.
    pub fn set_aspect(&mut self, aspect: f64) {
        if (self.aspect - aspect).abs() > 1e-6 {
            self.aspect = aspect;
            if !self.view_is_own {
                self.fit();
            }
        }
    }

    fn turn(&mut self, direction: Direction) {
        let [x, y] = direction.step();
        match &mut self.camera {
            Some(camera) if camera.dimension == 3 => {
                camera.orbit(STEP * x, STEP * y);
                self.view_is_own = true;
            }
            _ => self.pan(direction),
        }
    }

    fn pan(&mut self, direction: Direction) {
        let [x, y] = direction.step();
        if let Some(camera) = &mut self.camera {
            camera.pan(-STEP * x, -STEP * y);
            self.view_is_own = true;
        }
    }

    fn zoom(&mut self, factor: f64) {
        let aspect = self.aspect;
        if let Some(camera) = &mut self.camera {
            camera.zoom(factor, [0.0; 2], aspect);
            self.view_is_own = true;
        }
    }

    /// What is to be drawn of a side, on so many pixels.
    pub fn picture(&mut self, side: usize, pixels: [f32; 2]) -> Option<Picture> {
        if self.recolor {
            self.recolor = false;
            self.make_sprites();
        }
        let camera = self.camera.as_ref()?;
        Some(Picture {
            slot: side,
            sprites: Arc::clone(self.sprites.get(side)?),
            lines: Arc::clone(self.lines.get(side).unwrap_or(&self.scenery.lines)),
            view: View::new(
                camera,
                self.scenery.origin,
                self.aspect,
                pixels,
                self.radius,
            ),
            solid: camera.dimension == 3,
            background: self.background,
        })
    }

    /// The lines of each side's moment, if there are colliders.
    fn make_lines(&mut self) {
        let Some(info) = (self.shown.info.as_ref()).filter(|f| !f.colliders.is_empty()) else {
            self.lines.clear();
            return;
        };
        self.lines = (self.shown.sides.iter())
            .map(|side| self.scenery.lines_at(info, side.snapshot.time))
            .collect();
    }

    fn make_sprites(&mut self) {
        self.make_lines();
        let Some(info) = &self.shown.info else {
            return;
        };
        let by = self.color_by;
        let snapshots = || self.shown.sides.iter().map(|side| &*side.snapshot);
        // One legend for all sides.
        self.range
            .follow(by, snapshots().filter_map(|s| by.values(s)));
        let colors = (by, self.palette.as_slice(), &self.range);
        self.sprites = snapshots()
            .map(|snapshot| Arc::new(sprites(snapshot, info, &self.scenery, colors)))
            .collect();
    }

    /// Says something for a few seconds; `now` by egui's clock.
    pub fn say(&mut self, what: String, now: f64) {
        const SECONDS: f64 = 6.0;
        self.notice = Some((what, now + SECONDS));
    }

    /// Says it when a frame had to be tried again.
    pub(crate) fn tell_retries(&mut self, now: f64) {
        let tried = |side: &Side| side.readouts.retries;
        let retries = self.shown.sides.iter().map(tried).sum();
        let before = core::mem::replace(&mut self.told_retries, retries);
        let latest = self.shown.sides.iter().find_map(|side| side.retry.clone());
        if let Some(why) = latest.filter(|_| retries > before) {
            self.say(why, now);
        }
    }

    pub(crate) fn order(&mut self, order: Order) {
        self.effects.push(Effect::Order(order));
    }
}
