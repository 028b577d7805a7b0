//! What the window knows and decides, without a window: actions, pointer and snapshots in; orders to
//! the solver and a picture out. Tests drive it as a hand would.

use std::collections::HashMap;
use std::sync::Arc;

use eframe::egui::{self, Color32};
use lahar::{Command, Field, Pointer, PointerAction, Snapshot};

use crate::camera::{Camera, V3, add, against, corners, length, scale, sub};
use crate::colour::{self, ColourBy, Range};
use crate::controls::{Action, Direction};
use crate::renderer::{Line, Picture, Sprite, View};
use crate::scenes::{Changes, SceneCard, Setting};
use crate::solver::{Condition, Facts, Order, Readouts, Shown};

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

/// The hand in the scene, in reach and strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Reach, in parts of the scene's smallest extent.
    pub reach: f64,
    /// Acceleration, in parts of the scene's gravity.
    pub strength: f64,
}

impl Default for Hand {
    fn default() -> Self {
        // mpm128 pulls with 100 where gravity is 30.
        Self {
            reach: 0.25,
            strength: 100.0 / 30.0,
        }
    }
}

/// What a pressed button means in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// Towards the hand.
    Attract,
    /// Away from it.
    Repel,
    /// Along with it.
    Drag,
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
    /// What particles are coloured by.
    pub colour_by: ColourBy,
    /// Colours of the scene's swatches, by index.
    pub palette: Vec<Color32>,
    /// Low and high end of the legend.
    pub range: Range,
    /// Radius of a particle, in parts of its spacing.
    pub radius: f32,
    /// The hand.
    pub hand: Hand,
    /// Where the hand is \[m\] and what it does, while a button holds it.
    pub held: Option<(V3, Grip)>,
    /// Whether the list of scenes is open.
    pub show_scenes: bool,
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
    /// Width over height of where the scene is drawn.
    pub aspect: f64,

    changes: Changes,
    shown: Shown,
    effects: Vec<Effect>,
    sprites: Arc<Vec<Sprite>>,
    lines: Arc<Vec<Line>>,
    origin: V3,
    extent: (V3, V3),
    recolour: bool,
    refit: bool,
    asked_for_thumbnails: bool,
}

/// Radius in parts of the spacing: discs that leave no holes between jittered particles.
const RADIUS_2D: f32 = 0.95;
/// Balls need less: those behind fill the gaps.
const RADIUS_3D: f32 = 0.65;
/// Speeds that + and − step through.
const SPEEDS: [f64; 13] = [
    0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 8.0,
];
/// Gravity of a scene that has none, when keys ask for some \[m/s²\].
const EARTH: f64 = 9.81;

impl AppState {
    /// Opens `scene` (by name or path), or the default one.
    pub fn new(scenes: Vec<SceneCard>, default_scene: &str, scene: Option<&str>) -> Self {
        let mut state = Self {
            scenes,
            default_scene: default_scene.to_owned(),
            scene: String::new(),
            settings: vec![],
            paused: false,
            speed: 1.0,
            gravity: [0.0; 3],
            colour_by: ColourBy::default(),
            palette: vec![],
            range: Range::default(),
            radius: RADIUS_2D,
            hand: Hand::default(),
            held: None,
            show_scenes: false,
            thumbnails: HashMap::new(),
            show_hints: true,
            show_panel: true,
            camera: None,
            notice: None,
            aspect: 1.5,
            changes: vec![],
            shown: Shown::default(),
            effects: vec![],
            sprites: Arc::default(),
            lines: Arc::default(),
            origin: [0.0; 3],
            extent: ([0.0; 3], [1.0; 3]),
            recolour: false,
            refit: true,
            asked_for_thumbnails: false,
        };
        state.open(scene.unwrap_or(default_scene).to_owned());
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
    pub fn facts(&self) -> Option<&Facts> {
        self.shown.facts.as_deref()
    }

    /// Numbers for the panel.
    pub fn readouts(&self) -> &Readouts {
        &self.shown.readouts
    }

    /// Why the solver stopped, if it did.
    pub fn failure(&self) -> Option<&str> {
        match &self.shown.condition {
            Condition::Failed(why) => Some(why),
            _ => None,
        }
    }

    /// Whether new pictures are to be expected without anybody doing anything.
    pub fn is_moving(&self) -> bool {
        matches!(
            self.shown.condition,
            Condition::Running | Condition::Opening
        )
    }

    /// Does what a key or a button asks for.
    pub fn act(&mut self, action: Action) {
        match action {
            Action::Restart => self.order(Order::Restart),
            Action::DefaultScene => self.open(self.default_scene.clone()),
            Action::Scene(index) => {
                if let Some(card) = self.scenes.get(index) {
                    self.open(card.name.clone());
                }
            }
            Action::SceneList => {
                self.show_scenes = !self.show_scenes;
                if !core::mem::replace(&mut self.asked_for_thumbnails, true) {
                    self.effects.push(Effect::Thumbnails);
                }
            }
            Action::Gravity(direction) => {
                let pull = self.scene_gravity();
                let axis = self.axis(direction);
                self.set_gravity(scale(axis, pull));
            }
            Action::Pause => self.set_paused(!self.paused),
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
            Action::Colours => self.set_colour_by(self.colour_by.next()),
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

    /// Opens a scene by name or path.
    pub fn open(&mut self, name: String) {
        self.scene.clone_from(&name);
        self.show_scenes = false;
        self.refit = true;
        self.changes.clear();
        self.order(Order::Open(name, vec![]));
    }

    /// Opens the scene anew with the settings of the panel.
    pub fn apply_settings(&mut self) {
        let before = self.facts().map_or(&[][..], |facts| &facts.settings);
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
        self.order(Order::Open(self.scene.clone(), self.changes.clone()));
    }

    /// Opens the scene as its file has it.
    pub fn forget_settings(&mut self) {
        self.changes.clear();
        self.order(Order::Open(self.scene.clone(), vec![]));
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
        self.order(Order::Tell(Command::Gravity(gravity)));
    }

    /// What particles are coloured by.
    pub fn set_colour_by(&mut self, by: ColourBy) {
        self.colour_by = by;
        self.recolour = true;
        self.order(Order::Fields(by.fields()));
    }

    /// Colours of the materials were changed.
    pub fn repaint(&mut self) {
        self.recolour = true;
    }

    /// The magnitude of gravity that keys turn \[m/s²\].
    pub fn scene_gravity(&self) -> f64 {
        let own = self.facts().map_or(0.0, |facts| length(facts.gravity));
        if own > 0.0 { own } else { EARTH }
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

    /// The hand at `at` (−1..1 of the drawing) doing `grip`, moving with `velocity` \[1/s, of −1..1\].
    pub fn hold(&mut self, at: [f64; 2], grip: Grip, velocity: [f64; 2]) {
        let Some(camera) = &self.camera else { return };
        let through = match self.held {
            Some((position, _)) => position,
            None => self.nearest(at).unwrap_or(camera.target),
        };
        let position = camera.unproject(at, self.aspect, through);
        let pull = self.hand.strength * self.scene_gravity();
        let action = match grip {
            Grip::Attract => PointerAction::Attract(pull),
            Grip::Repel => PointerAction::Attract(-pull),
            Grip::Drag => {
                let ahead = [at[0] + velocity[0], at[1] + velocity[1]];
                let there = camera.unproject(ahead, self.aspect, through);
                PointerAction::Drag(sub(there, position))
            }
        };
        self.held = Some((position, grip));
        let pointer = Pointer {
            position,
            radius: self.hand_radius(),
            action,
        };
        self.order(Order::Tell(Command::Pointer(Some(pointer))));
    }

    /// The hand is lifted.
    pub fn release(&mut self) {
        if self.held.take().is_some() {
            self.order(Order::Tell(Command::Pointer(None)));
        }
    }

    /// How far the hand reaches \[m\].
    pub fn hand_radius(&self) -> f64 {
        let (min, max) = self.extent;
        let dimension = self.facts().map_or(2, |facts| facts.dimension);
        let size = sub(max, min);
        let smallest = size[..dimension]
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        self.hand.reach * smallest
    }

    /// The particle nearest to the eye under `at`, in 3D.
    fn nearest(&self, at: [f64; 2]) -> Option<V3> {
        const CLOSE: f64 = 0.04;
        let camera = self
            .camera
            .as_ref()
            .filter(|camera| camera.dimension == 3)?;
        let back = camera.axes()[2];
        let near = |sprite: &Sprite| {
            let point = add(sprite.position.map(f64::from), self.origin);
            let [x, y] = camera.project(point, self.aspect)?;
            let off = f64::hypot((x - at[0]) * self.aspect, y - at[1]);
            (off < CLOSE).then(|| (crate::camera::dot(back, point), point))
        };
        let found = self.sprites.iter().filter_map(near);
        found
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, point)| point)
    }

    /// Takes in what the solver shows.
    pub fn receive(&mut self, shown: Shown) {
        let opened = shown.opened != self.shown.opened;
        let scene_before = self.facts().map(|facts| facts.card.name.clone());
        self.shown = shown;
        if opened && let Some(facts) = self.shown.facts.clone() {
            self.gravity = facts.gravity;
            self.settings.clone_from(&facts.settings);
            self.range.forget();
            let another = scene_before.as_ref() != Some(&facts.card.name);
            if another {
                if self.colour_by != facts.angle.colour_by && scene_before.is_none() {
                    self.set_colour_by(facts.angle.colour_by);
                }
                self.palette = colour::palette(&facts.swatches);
                self.radius = if facts.dimension == 2 {
                    RADIUS_2D
                } else {
                    RADIUS_3D
                };
            }
            self.extent = extent(&facts, self.shown.snapshot.as_deref());
            self.origin = scale(add(self.extent.0, self.extent.1), 0.5);
            self.lines = Arc::new(outline(&facts, self.extent, self.origin));
            if core::mem::take(&mut self.refit) {
                self.fit();
            }
        }
        self.recolour = true;
    }

    /// The whole scene in view.
    fn fit(&mut self) {
        let Some(facts) = self.facts() else { return };
        self.camera = Some(Camera::fit(
            facts.dimension,
            self.extent,
            facts.gravity,
            facts.angle.direction,
            self.aspect,
        ));
    }

    /// What is to be drawn on `pixels`.
    pub fn picture(&mut self, pixels: [f32; 2]) -> Option<Picture> {
        if self.recolour {
            self.recolour = false;
            self.make_sprites();
        }
        let camera = self.camera.as_ref()?;
        Some(Picture {
            sprites: Arc::clone(&self.sprites),
            lines: Arc::clone(&self.lines),
            view: View {
                view: camera.view(self.origin),
                projection: camera.projection(self.aspect),
                pixels,
                radius: self.radius,
                unused: 0.0,
            },
            solid: camera.dimension == 3,
            background: self.background(),
        })
    }

    /// The colour behind everything.
    pub fn background(&self) -> Color32 {
        let own = self.facts().and_then(|facts| facts.angle.background);
        own.map_or(colour::BACKGROUND, |[r, g, b]| Color32::from_rgb(r, g, b))
    }

    fn make_sprites(&mut self) {
        let (Some(facts), Some(snapshot)) = (&self.shown.facts, &self.shown.snapshot) else {
            return;
        };
        let colours = colour::colours(
            self.colour_by,
            snapshot,
            facts,
            &self.palette,
            &mut self.range,
        );
        let positions = snapshot.get(Field::Position).map(lahar::Data::to_f64);
        let volumes = snapshot.get(Field::Volume0).map(lahar::Data::to_f32);
        let (Some(positions), Some(volumes)) = (positions, volumes) else {
            return;
        };
        let d = snapshot.dimension;
        let spacing = |volume: f32| if d == 2 { volume.sqrt() } else { volume.cbrt() };
        self.sprites = Arc::new(
            (positions.chunks_exact(d).zip(&volumes).zip(colours))
                .map(|((x, &volume), colour)| Sprite {
                    position: core::array::from_fn(|i| {
                        if i < d {
                            (x[i] - self.origin[i]) as f32
                        } else {
                            0.0
                        }
                    }),
                    spacing: spacing(volume),
                    colour,
                })
                .collect(),
        );
    }

    /// Says something for a few seconds; `now` by egui's clock.
    pub fn say(&mut self, what: String, now: f64) {
        const SECONDS: f64 = 6.0;
        self.notice = Some((what, now + SECONDS));
    }

    fn order(&mut self, order: Order) {
        self.effects.push(Effect::Order(order));
    }
}

/// The domain, or the box of the particles.
fn extent(facts: &Facts, snapshot: Option<&Snapshot>) -> (V3, V3) {
    if let Some((min, max)) = facts.domain {
        return (min, max);
    }
    let d = facts.dimension;
    let mut min = [f64::INFINITY; 3];
    let mut max = [f64::NEG_INFINITY; 3];
    let positions = snapshot
        .and_then(|s| s.get(Field::Position))
        .map(lahar::Data::to_f64)
        .unwrap_or_default();
    for x in positions.chunks_exact(d) {
        for i in 0..d {
            min[i] = min[i].min(x[i]);
            max[i] = max[i].max(x[i]);
        }
    }
    for i in 0..3 {
        if i >= d {
            (min[i], max[i]) = (0.0, 0.0);
        } else if min[i] > max[i] {
            (min[i], max[i]) = (0.0, 1.0);
        } else {
            // Room to move in.
            let room = (0.5 * (max[i] - min[i])).max(4.0 * facts.dx);
            (min[i], max[i]) = (min[i] - room, max[i] + room);
        }
    }
    (min, max)
}

/// The domain's edges; in 3D, a grid on its floor too.
fn outline(facts: &Facts, (min, max): (V3, V3), origin: V3) -> Vec<Line> {
    let mut lines = vec![];
    let mut line = |a: V3, b: V3, half_width: f32, opacity: u8| {
        let local = |p: V3| sub(p, origin).map(|c| c as f32);
        lines.push(Line {
            start: local(a),
            half_width,
            end: local(b),
            colour: [0xa9, 0xc7, 0xd6, opacity],
        });
    };
    if facts.domain.is_some() {
        let corners = corners(min, max);
        for i in 0..8_usize {
            for axis in 0..facts.dimension {
                let j = i | 1 << axis;
                if j != i && (facts.dimension == 3 || j < 4) {
                    line(corners[i], corners[j], 0.7, 150);
                }
            }
        }
    }
    if facts.dimension == 3 {
        let up = against(facts.gravity);
        let vertical = (0..3).find(|&i| up[i] != 0.0).unwrap_or(1);
        let floor = if up[vertical] > 0.0 {
            min[vertical]
        } else {
            max[vertical]
        };
        let (a, b) = ((vertical + 1) % 3, (vertical + 2) % 3);
        let step = round_step((max[a] - min[a]).max(max[b] - min[b]) / 12.0);
        for (along, across) in [(a, b), (b, a)] {
            let mut k = (min[across] / step).ceil();
            while k * step <= max[across] {
                let mut start = [floor; 3];
                start[across] = k * step;
                let mut end = start;
                (start[along], end[along]) = (min[along], max[along]);
                line(start, end, 0.4, 60);
                k += 1.0;
            }
        }
    }
    lines
}

/// 1, 2 or 5 times a power of ten, at least `least`.
pub fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|&step| step >= least * (1.0 - 1e-9))
        .unwrap_or(power)
}

/// Where a point of the window is in a rectangle, in −1..1, y up.
pub fn within(rect: egui::Rect, at: egui::Pos2) -> [f64; 2] {
    let d = at - rect.center();
    [
        f64::from(2.0 * d.x / rect.width()),
        f64::from(-2.0 * d.y / rect.height()),
    ]
}
