//! The state of the window, and its decisions. It needs no window itself: actions, mouse and snapshots come in; orders
//! to the solver and pictures go out. Tests drive it as a person would.

use std::collections::HashMap;
use std::sync::Arc;

use eframe::egui::{self, Color32};
use lahar::{Command, Pointer};
use lahar_scene::scene::{ColorBy, Comparison, Controls, Setting};

use crate::camera::{Camera, V3, add, dot, length, scale, sub};
use crate::color::{self, Range};
use crate::compare::ComparisonDraft;
use crate::controls::{Action, Direction};
use crate::palette;
use crate::pointer::{PointerMode, PointerTool};
use crate::renderer::{Line, Picture, Sprites, View};
use crate::scenery::{Scenery, sprites, usual_radius};
use crate::scenes::{Changes, SceneCard, SceneInfo};
use crate::solver::{Condition, Order, Readouts, SceneRequest, Side, SolverState};

/// Work that only the window itself can do.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Send an order to the solver.
    Order(Order),
    /// Save the window as a picture.
    Screenshot,
    /// Draw small pictures of the scenes, into [`AppState::thumbnails`].
    Thumbnails,
    /// Close the window.
    Close,
}

/// A message over the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// The text of the message.
    pub text: String,
    /// When it disappears \[s of egui's clock\].
    pub until: f64,
}

/// The search in the list of scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneSearch {
    /// The words typed.
    pub text: String,
    /// The place of the scene that Enter opens, among those found.
    pub chosen: usize,
}

/// Everything that the window knows, and what it will do next.
pub struct AppState {
    /// The scenes to choose from.
    pub scenes: Vec<SceneCard>,
    /// The scene that [`Action::DefaultScene`] opens.
    pub default_scene: String,
    /// The open scene, by name or path.
    pub scene: String,
    /// The scene's settings as the panel shows them. [`AppState::apply_settings`] puts them into effect.
    pub settings: Vec<Setting>,
    /// True while the simulation is paused.
    pub paused: bool,
    /// The largest speed, in simulated seconds per second.
    pub speed: f64,
    /// The present gravity \[m/s²\].
    pub gravity: V3,
    /// The quantity that particles are colored by.
    pub color_by: ColorBy,
    /// Colors of the scene's swatches, by index.
    pub palette: Vec<Color32>,
    /// The background color.
    pub background: Color32,
    /// The range of the legend.
    pub range: Range,
    /// Radius of a particle as drawn, in parts of its spacing or of the scene's own radius.
    pub radius: f32,
    /// The mouse pointer as a tool that stirs the particles.
    pub pointer_tool: PointerTool,
    /// The pointer's place \[m\] and mode while a mouse button is pressed in the scene.
    pub pressed: Option<(V3, PointerMode)>,
    /// True while the list of scenes is open.
    pub show_scenes: bool,
    /// The number of retries that the person at the window was told of.
    seen_retries: u64,
    /// The search in the list of scenes.
    pub search: SceneSearch,
    /// Small pictures of the scenes, by name. They arrive one by one.
    pub thumbnails: HashMap<String, egui::TextureHandle>,
    /// True while the key hints are shown.
    pub show_hints: bool,
    /// True while the side panel is shown.
    pub show_panel: bool,
    /// The camera; `None` before the first scene is built.
    pub camera: Option<Camera>,
    /// The message over the scene.
    pub notice: Option<Notice>,
    /// Width over height of the area that a side is drawn in.
    pub aspect: f64,
    /// The comparison that the panel is putting together.
    pub draft: ComparisonDraft,
    /// True once the person has turned, moved or zoomed the view. Until then it follows the window's size.
    pub view_is_own: bool,
    pub(crate) scenery: Scenery,
    /// The lines of the scenery and the colliders, per side; empty without colliders.
    lines: Vec<Arc<Vec<Line>>>,
    /// The particles to draw, per side.
    pub(crate) sprites: Vec<Arc<Sprites>>,
    /// The gravity key that is down, in scenes where gravity acts only meanwhile.
    pub(crate) gravity_key: Option<Direction>,

    changes: Changes,
    comparison: Option<Comparison>,
    solver: SolverState,
    effects: Vec<Effect>,
    /// True if sprites and lines do not show the newest state.
    sprites_are_outdated: bool,
    /// True if the view is to be fitted to the next scene that opens.
    fit_when_opened: bool,
    asked_for_thumbnails: bool,
}

/// The speeds that the keys + and − step through, in simulated seconds per second.
pub(crate) const SPEEDS: [f64; 16] = [
    0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 8.0,
];
/// The gravity that keys turn in a scene without gravity \[m/s²\].
const EARTH_GRAVITY: f64 = 9.81;
/// Frames of a recording that the arrow keys up and down skip.
const FAR: isize = 10;
/// The distance that a key turns or moves the view by, in parts of the window's height.
const STEP: f64 = 0.05;
/// The factor that a key enlarges by.
const ZOOM: f64 = 1.15;

impl AppState {
    /// Orders a scene, `wanted` or the default one.
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
            background: palette::BACKGROUND,
            range: Range::default(),
            radius: 1.0,
            pointer_tool: PointerTool::of(Controls::default(), EARTH_GRAVITY, 1.0, 0.01),
            pressed: None,
            show_scenes: false,
            seen_retries: 0,
            search: SceneSearch::default(),
            thumbnails: HashMap::new(),
            // Hints would cover one of the sides.
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
            gravity_key: None,
            changes: wanted.changes,
            comparison: wanted.comparison,
            solver: SolverState::default(),
            effects: vec![],
            sprites_are_outdated: false,
            fit_when_opened: true,
            asked_for_thumbnails: false,
        };
        state.reopen();
        state
    }

    /// Takes the work that the window must do.
    pub fn take_effects(&mut self) -> Vec<Effect> {
        core::mem::take(&mut self.effects)
    }

    /// The newest state of the solver.
    pub fn solver(&self) -> &SolverState {
        &self.solver
    }

    /// The open scene; `None` before the first one is built.
    pub fn info(&self) -> Option<&SceneInfo> {
        self.solver.info.as_deref()
    }

    /// The simulations side by side: one as a rule, none before the first scene is built.
    pub fn sides(&self) -> &[Side] {
        &self.solver.sides
    }

    /// The numbers of the first side.
    pub fn readouts(&self) -> Readouts {
        (self.solver.sides.first()).map_or_else(Readouts::default, |side| side.readouts)
    }

    /// The number of frames of the recording that is replayed; `None` for a simulation.
    pub fn recorded_frames(&self) -> Option<usize> {
        self.info().and_then(|info| info.frames)
    }

    /// The comparison that runs.
    pub fn comparison(&self) -> Option<&Comparison> {
        self.comparison.as_ref()
    }

    /// The reason why the solver stopped, if it did.
    pub fn failure(&self) -> Option<&str> {
        match &self.solver.condition {
            Condition::Failed(why) => Some(why),
            _ => None,
        }
    }

    /// Carries out the action of a key or a button.
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
                self.search = SceneSearch {
                    text: String::new(),
                    chosen: here.unwrap_or(0),
                };
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
            Action::Pause if self.solver.condition == Condition::Ended => {
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
            Action::Colors => self.set_color_by(color::next(self.color_by)),
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

    /// Opens a scene by name or path, without changes or comparison.
    pub fn open(&mut self, name: String) {
        self.scene = name;
        self.show_scenes = false;
        self.fit_when_opened = true;
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

    /// Runs the scene with several values of a key side by side, or alone again if `None`.
    pub fn compare(&mut self, comparison: Option<Comparison>) {
        self.comparison = comparison;
        self.show_hints &= self.comparison.is_none();
        self.fit_when_opened = true;
        self.reopen();
    }

    /// Runs the comparison that the panel has put together.
    pub fn compare_draft(&mut self) {
        if let Some(comparison) = self.draft.comparison() {
            self.compare(Some(comparison));
        }
    }

    /// Reopens the scene with the settings of the panel.
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

    /// Reopens the scene with the settings of its file.
    pub fn forget_settings(&mut self) {
        self.changes.clear();
        self.reopen();
    }

    /// True if the scene runs with settings other than its file's.
    pub fn has_changes(&self) -> bool {
        !self.changes.is_empty()
    }

    /// Pauses the simulation, or lets it run.
    pub fn set_paused(&mut self, paused: bool) {
        if self.paused != paused {
            self.paused = paused;
            self.order(Order::Pause(paused));
        }
    }

    /// Sets the largest speed, in simulated seconds per second.
    pub fn set_speed(&mut self, speed: f64) {
        self.speed = speed.clamp(SPEEDS[0], SPEEDS[SPEEDS.len() - 1]);
        self.order(Order::Speed(self.speed));
    }

    /// Replaces gravity \[m/s²\].
    pub fn set_gravity(&mut self, gravity: V3) {
        let gravity = gravity.map(|c| c + 0.0); // turns -0 into 0
        self.gravity = gravity;
        self.order(Order::Command(Command::Gravity(gravity)));
    }

    /// Colors particles by another quantity.
    pub fn set_color_by(&mut self, by: ColorBy) {
        self.color_by = by;
        self.sprites_are_outdated = true;
        self.order(Order::Fields(color::fields(by)));
    }

    /// Draws particles anew, after a change of the palette.
    pub fn palette_changed(&mut self) {
        self.sprites_are_outdated = true;
    }

    /// The size of the gravity that keys turn \[m/s²\].
    pub fn scene_gravity(&self) -> f64 {
        let info = self.info();
        let own = info.map_or(0.0, |info| length(info.gravity));
        let keys = info.and_then(|info| info.controls.gravity);
        keys.unwrap_or(if own > 0.0 { own } else { EARTH_GRAVITY })
    }

    /// True if the scene has gravity only while a gravity key is down.
    pub fn gravity_needs_key(&self) -> bool {
        self.info().is_some_and(|info| info.controls.hold)
    }

    /// Sets the gravity key that is down, where [`AppState::gravity_needs_key`].
    pub fn set_gravity_key(&mut self, key: Option<Direction>) {
        if self.gravity_key != key {
            self.gravity_key = key;
            let gravity = key.map_or([0.0; 3], |direction| {
                scale(self.axis(direction), self.scene_gravity())
            });
            self.set_gravity(gravity);
        }
    }

    /// Goes to a frame of the recording and pauses there.
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

    /// The axis of the scene, with its sign, that is nearest to a direction of the window.
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

    /// Takes over the newest state of the solver.
    pub fn receive(&mut self, state: SolverState) {
        let opened = state.opened != self.solver.opened;
        let scene_before = self.info().map(|info| info.card.name.clone());
        self.solver = state;
        if opened && let Some(info) = self.solver.info.clone() {
            self.gravity = info.gravity;
            self.gravity_key = None;
            self.settings.clone_from(&info.settings);
            self.draft.offer(&info.settings, self.comparison.as_ref());
            self.range.forget();
            let snapshot = self.sides().first().map(|side| Arc::clone(&side.snapshot));
            self.scenery = Scenery::new(&info, snapshot.as_deref());
            if scene_before.as_ref() != Some(&info.card.name) {
                self.adopt_look(&info, scene_before.is_none());
            }
            if core::mem::take(&mut self.fit_when_opened) {
                self.fit();
            }
        }
        self.sprites_are_outdated = true;
    }

    /// Adopts the colors, the pointer tool and the speed of another scene.
    fn adopt_look(&mut self, info: &SceneInfo, first: bool) {
        let by = info.camera.color_by;
        // The person's choice stays, unless the scene asks for a quantity.
        if self.color_by != by && (first || by != ColorBy::Material) {
            self.set_color_by(by);
        }
        self.palette = palette::palette(&info.swatches);
        self.background = palette::background(info);
        self.radius = usual_radius(info);
        self.pointer_tool = PointerTool::of(
            info.controls,
            self.scene_gravity(),
            self.scenery.smallest_side(info.dimension),
            info.dx,
        );
        if self.speed != info.controls.speed {
            self.set_speed(info.controls.speed);
        }
    }

    /// Shows the view that the scene asks for, or else the whole scene.
    fn fit(&mut self) {
        let Some(info) = self.info() else { return };
        let camera = Camera::fit(
            info.dimension,
            self.scenery.extent,
            info.gravity,
            info.camera,
            self.aspect,
        );
        self.camera = Some(camera);
        self.view_is_own = false;
    }

    /// Sets width over height of the area that a side is drawn in.
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

    /// The picture of a side, of this width and height in pixels.
    pub fn picture(&mut self, side: usize, pixels: [f32; 2]) -> Option<Picture> {
        if self.sprites_are_outdated {
            self.sprites_are_outdated = false;
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

    /// Makes the lines of each side at its own time, if there are colliders.
    fn make_lines(&mut self) {
        let Some(info) = (self.solver.info.as_ref()).filter(|f| !f.colliders.is_empty()) else {
            self.lines.clear();
            return;
        };
        self.lines = (self.solver.sides.iter())
            .map(|side| self.scenery.lines_at(info, side.snapshot.time))
            .collect();
    }

    fn make_sprites(&mut self) {
        self.make_lines();
        let Some(info) = &self.solver.info else {
            return;
        };
        let by = self.color_by;
        let snapshots = || self.solver.sides.iter().map(|side| &*side.snapshot);
        // All sides share one legend.
        self.range
            .follow(by, snapshots().filter_map(|s| color::values(by, s)));
        let colors = (by, self.palette.as_slice(), &self.range);
        self.sprites = snapshots()
            .map(|snapshot| Arc::new(sprites(snapshot, info, &self.scenery, colors)))
            .collect();
    }

    /// Shows a message for a few seconds, from `now` on \[s of egui's clock\].
    pub fn notify(&mut self, text: String, now: f64) {
        const SECONDS: f64 = 6.0;
        let until = now + SECONDS;
        self.notice = Some(Notice { text, until });
    }

    /// Shows a message if a frame was retried since this was last called.
    pub(crate) fn notify_of_retries(&mut self, now: f64) {
        let retries = (self.solver.sides.iter())
            .map(|side| side.readouts.retries)
            .sum();
        let before = core::mem::replace(&mut self.seen_retries, retries);
        let latest = self.solver.sides.iter().find_map(|side| side.retry.clone());
        if let Some(why) = latest.filter(|_| retries > before) {
            self.notify(why, now);
        }
    }

    /// Lets the pointer act on the particles, in `mode`. It is at `at` and moves with `velocity` \[1/s\], both in
    /// −1..1 of the area that `side` is drawn in.
    pub fn press_pointer(
        &mut self,
        side: usize,
        at: [f64; 2],
        mode: PointerMode,
        velocity: [f64; 2],
    ) {
        let Some(camera) = &self.camera else { return };
        let through = match self.pressed {
            Some((position, _)) => position,
            None => self.nearest_particle(side, at).unwrap_or(camera.target),
        };
        let position = camera.unproject(at, self.aspect, through);
        let ahead = [at[0] + velocity[0], at[1] + velocity[1]];
        let velocity = sub(camera.unproject(ahead, self.aspect, through), position);
        self.pressed = Some((position, mode));
        let pointer = Pointer {
            position,
            radius: self.pointer_tool.reach,
            softening: self.pointer_tool.softening,
            action: self.pointer_tool.action(mode, velocity),
        };
        self.order(Order::Command(Command::Pointer(Some(pointer))));
    }

    /// Ends the pointer's action.
    pub fn release_pointer(&mut self) {
        if self.pressed.take().is_some() {
            self.order(Order::Command(Command::Pointer(None)));
        }
    }

    /// In 3D, the position of the particle under `at` that is nearest to the eye \[m\].
    fn nearest_particle(&self, side: usize, at: [f64; 2]) -> Option<V3> {
        /// The largest distance from `at`, in parts of half the height.
        const TOLERANCE: f64 = 0.04;
        let camera = (self.camera.as_ref()).filter(|camera| camera.dimension == 3)?;
        let back = camera.axes()[2];
        let near = |&[x, y, z, _]: &[f32; 4]| {
            let point = add([x, y, z].map(f64::from), self.scenery.origin);
            let [x, y] = camera.project(point, self.aspect)?;
            let off = f64::hypot((x - at[0]) * self.aspect, y - at[1]);
            (off < TOLERANCE).then(|| (dot(back, point), point))
        };
        let found = self.sprites.get(side)?.places.iter().filter_map(near);
        found
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, point)| point)
    }

    pub(crate) fn order(&mut self, order: Order) {
        self.effects.push(Effect::Order(order));
    }
}
