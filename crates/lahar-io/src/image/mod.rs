//! Pictures of snapshots, drawn by the processor: for runs without a display, and for films.
//!
//! ```text
//! Snapshot ─► DrawableParticles ─┬► flat (2D: one filled shape) ─┬► Picture ─► PNG
//!             Scenery ───────────┴► perspective (3D: lit balls) ─┘        └─► Film ─► GIF, MP4
//! ```
//! [`Renderer::new`] decides once on everything that must not change between the frames of a film: view, colors, scales.

mod camera;
mod drawable;
mod film;
mod flat;
mod mp4;
mod palette;
mod perspective;
mod picture;
mod renderer;
mod scenery;
mod side_by_side;
#[cfg(test)]
mod tests;

use lahar::Field;

pub use camera::Camera;
pub use film::Film;
pub use mp4::{Mp4, Mp4Maker};
pub use palette::{
    BACKGROUND, COLLIDER, Color, PRESSURE_RAMP, REST_RAMP, SPEED_RAMP, along, body_color,
    model_colors,
};
pub use picture::Picture;
pub use renderer::{Coloring, Renderer, Style};
pub use scenery::Scenery;
pub use side_by_side::side_by_side;

/// The fields that pictures are drawn from. A snapshot may lack some of them.
pub const FIELDS: &[Field] = &[
    Field::Position,
    Field::Velocity,
    Field::Pressure,
    Field::Volume0,
    Field::Mass,
    Field::Jacobian,
    Field::Material,
    Field::Body,
];
