//! The hand in the scene: where the pointer grips, and what the simulation is told of it.

use eframe::egui;
use lahar::{Command, Pointer, PointerAction};
use lahar_scene::scene::Controls;

use crate::app_state::AppState;
use crate::camera::{V3, add, dot, sub};
use crate::solver::Order;

/// The hand's reach and strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointerTool {
    /// How far it reaches \[m\]; infinite: everywhere.
    pub reach: f64,
    /// Acceleration toward it or away from it \[m/s²\].
    pub pull: f64,
    /// Within which that goes to zero \[m\].
    pub softening: f64,
    /// It pushes particles, by (distance/reach) to this power.
    pub push: Option<f64>,
}

/// Reach, in parts of the scene's smallest extent, where the scene does not say.
const REACH: f64 = 0.25;
/// Pull, in parts of gravity, where the scene does not say: mpm128 pulls with 100 where gravity is 30.
const PULL: f64 = 100.0 / 30.0;

impl PointerTool {
    /// As the scene wants it, where `gravity` \[m/s²\] is usual, the smallest extent is `smallest` \[m\] and
    /// nodes are `dx` \[m\] apart.
    pub(crate) fn of(controls: Controls, gravity: f64, smallest: f64, dx: f64) -> Self {
        Self {
            reach: controls.reach.unwrap_or(REACH * smallest),
            pull: controls.pull.unwrap_or(PULL * gravity),
            softening: controls.softening.unwrap_or(dx),
            push: controls.push,
        }
    }

    /// What the left button does, and the right.
    pub fn buttons(&self) -> [PointerMode; 2] {
        if self.push.is_some() {
            [PointerMode::Repel, PointerMode::Attract]
        } else {
            [PointerMode::Attract, PointerMode::Repel]
        }
    }

    /// With `pull` toward it \[m/s²\], negative: away from it.
    fn action(&self, pull: f64) -> PointerAction {
        match self.push {
            Some(power) => PointerAction::Push {
                acceleration: -pull,
                power,
            },
            None => PointerAction::Attract(pull),
        }
    }
}

/// What a pressed button means in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointerMode {
    /// Toward the hand.
    Attract,
    /// Away from it.
    Repel,
    /// Along with it.
    Drag,
}

impl AppState {
    /// The hand at `at` (−1..1 of the drawing of `side`) doing `grip`, moving with `velocity` \[1/s, of −1..1\].
    pub fn hold(&mut self, side: usize, at: [f64; 2], grip: PointerMode, velocity: [f64; 2]) {
        let Some(camera) = &self.camera else { return };
        let through = match self.held {
            Some((position, _)) => position,
            None => self.nearest(side, at).unwrap_or(camera.target),
        };
        let position = camera.unproject(at, self.aspect, through);
        let pull = self.hand.pull;
        let action = match grip {
            PointerMode::Attract => self.hand.action(pull),
            PointerMode::Repel => self.hand.action(-pull),
            PointerMode::Drag => {
                let ahead = [at[0] + velocity[0], at[1] + velocity[1]];
                let there = camera.unproject(ahead, self.aspect, through);
                PointerAction::Drag(sub(there, position))
            }
        };
        self.held = Some((position, grip));
        let pointer = Pointer {
            position,
            radius: self.hand.reach,
            softening: self.hand.softening,
            action,
        };
        self.order(Order::Command(Command::Pointer(Some(pointer))));
    }

    /// The hand is lifted.
    pub fn release(&mut self) {
        if self.held.take().is_some() {
            self.order(Order::Command(Command::Pointer(None)));
        }
    }

    /// The particle nearest to the eye under `at`, in 3D.
    fn nearest(&self, side: usize, at: [f64; 2]) -> Option<V3> {
        const CLOSE: f64 = 0.04;
        let camera = (self.camera.as_ref()).filter(|camera| camera.dimension == 3)?;
        let back = camera.axes()[2];
        let near = |&[x, y, z, _]: &[f32; 4]| {
            let point = add([x, y, z].map(f64::from), self.scenery.origin);
            let [x, y] = camera.project(point, self.aspect)?;
            let off = f64::hypot((x - at[0]) * self.aspect, y - at[1]);
            (off < CLOSE).then(|| (dot(back, point), point))
        };
        let found = self.sprites.get(side)?.places.iter().filter_map(near);
        found
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, point)| point)
    }
}

/// Where a point of the window is in a rectangle, in −1..1, y up.
pub fn within(rect: egui::Rect, at: egui::Pos2) -> [f64; 2] {
    let d = at - rect.center();
    [
        f64::from(2.0 * d.x / rect.width()),
        f64::from(-2.0 * d.y / rect.height()),
    ]
}
