//! The mouse pointer as a tool that stirs the particles.

use eframe::egui;
use lahar::PointerAction;
use lahar_scene::scene::Controls;

/// How far the pointer reaches, and how strongly it acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointerTool {
    /// Distance within which it acts \[m\]; infinite: everywhere.
    pub reach: f64,
    /// Acceleration toward the pointer or away from it \[m/s²\].
    pub pull: f64,
    /// Distance within which the acceleration goes to zero \[m\].
    pub softening: f64,
    /// If given, the pointer pushes particles, by (distance/reach) to this power. Otherwise it attracts nodes.
    pub push: Option<f64>,
}

/// Reach in parts of the scene's smallest side, where the scene does not give one.
const REACH: f64 = 0.25;
/// Pull in parts of gravity, where the scene does not give one. Taichi's mpm128 pulls with 100 where gravity is 30.
const PULL: f64 = 100.0 / 30.0;

impl PointerTool {
    /// The tool that a scene asks for. What the scene leaves open follows from its size of gravity \[m/s²\], its
    /// smallest side \[m\] and the distance `dx` between its nodes \[m\].
    pub(crate) fn of(controls: Controls, gravity: f64, smallest_side: f64, dx: f64) -> Self {
        Self {
            reach: controls.reach.unwrap_or(REACH * smallest_side),
            pull: controls.pull.unwrap_or(PULL * gravity),
            softening: controls.softening.unwrap_or(dx),
            push: controls.push,
        }
    }

    /// The modes of the left button and of the right one.
    pub fn button_modes(&self) -> [PointerMode; 2] {
        if self.push.is_some() {
            [PointerMode::Repel, PointerMode::Attract]
        } else {
            [PointerMode::Attract, PointerMode::Repel]
        }
    }

    /// The action of a mode on the particles. `velocity` is the pointer's own \[m/s\], which `Drag` passes on.
    pub(crate) fn action(&self, mode: PointerMode, velocity: [f64; 3]) -> PointerAction {
        match mode {
            PointerMode::Attract => self.pull_action(self.pull),
            PointerMode::Repel => self.pull_action(-self.pull),
            PointerMode::Drag => PointerAction::Drag(velocity),
        }
    }

    /// Accelerates by `pull` toward the pointer \[m/s²\]; if negative, away from it.
    fn pull_action(&self, pull: f64) -> PointerAction {
        match self.push {
            Some(power) => PointerAction::Push {
                acceleration: -pull,
                power,
            },
            None => PointerAction::Attract(pull),
        }
    }
}

/// The action of a pressed mouse button in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointerMode {
    /// Accelerates the material toward the pointer.
    Attract,
    /// Accelerates the material away from the pointer.
    Repel,
    /// Gives the material the pointer's velocity.
    Drag,
}

/// The place of a window point in a rectangle: −1..1 in x and y, with y up.
pub fn within(rect: egui::Rect, at: egui::Pos2) -> [f64; 2] {
    let d = at - rect.center();
    [
        f64::from(2.0 * d.x / rect.width()),
        f64::from(-2.0 * d.y / rect.height()),
    ]
}
