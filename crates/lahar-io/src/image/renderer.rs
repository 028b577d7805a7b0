//! Draws snapshots: chooses the view once, so that nothing jumps between the frames of a film.

use lahar::Snapshot;
use lahar::boundary::Placed;

use super::camera::Camera;
use super::drawable::DrawableParticles;
use super::picture::Picture;
use super::scenery::Scenery;
use super::{flat, palette, perspective};

/// The quantity that colors show. Numbers are shown on fixed scales, in the same colors as in the window:
/// [`SPEED_RAMP`](super::SPEED_RAMP), [`PRESSURE_RAMP`](super::PRESSURE_RAMP), [`REST_RAMP`](super::REST_RAMP).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Coloring {
    /// The material, or the body's own color; brighter where the material is fast.
    #[default]
    Material,
    /// The body that a particle belongs to.
    Body,
    /// Speed \[m/s\], from 0 to the given one.
    Speed(f64),
    /// Pressure \[Pa\], from the first number to the second.
    Pressure(f64, f64),
    /// Density \[kg/m³; kg/m² in 2D\], from the first number to the second.
    Density(f64, f64),
    /// The Jacobian J, from the first number to the second.
    Jacobian(f64, f64),
}

/// Size, quality and colors of pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Largest width \[pixels\]; scenes that are higher than wide use less.
    pub width: u32,
    /// Largest height \[pixels\].
    pub height: u32,
    /// Samples per pixel and axis.
    pub samples: u32,
    /// The quantity that colors show.
    pub coloring: Coloring,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            samples: 3,
            coloring: Coloring::Material,
        }
    }
}

/// Draws the snapshots of one scene, all with the same view and colors.
#[derive(Clone, Debug)]
pub struct Renderer {
    scenery: Scenery,
    style: Style,
    view: View,
}

/// Most samples of a picture; each takes 16 bytes.
const MOST_SAMPLES: u64 = 1 << 28;

/// Returns the samples per pixel and axis: large pictures have fewer.
pub(super) fn affordable(style: &Style) -> u32 {
    let pixels = u64::from(style.width) * u64::from(style.height);
    let most = (MOST_SAMPLES / pixels.max(1)).isqrt() as u32;
    style.samples.clamp(1, 8).min(most.max(1))
}

#[derive(Clone, Debug)]
enum View {
    Flat(flat::FlatPainter),
    Perspective(Box<perspective::PerspectivePainter>),
}

impl Renderer {
    /// Chooses the view of `scenery`.
    pub fn new(scenery: Scenery, style: Style) -> Self {
        let style = Style {
            width: style.width.max(16),
            height: style.height.max(16),
            samples: affordable(&style),
            ..style
        };
        let view = if scenery.dimension == 2 {
            View::Flat(flat::FlatPainter::new(&scenery, &style))
        } else {
            View::Perspective(Box::new(perspective::PerspectivePainter::new(
                &scenery, &style,
            )))
        };
        Self {
            scenery,
            style,
            view,
        }
    }

    /// Sets the camera in 3D; does nothing in 2D.
    #[must_use]
    pub fn with_camera(mut self, camera: Camera) -> Self {
        if let View::Perspective(space) = &mut self.view {
            space.camera = camera;
        }
        self
    }

    /// Shows `height` \[m\] of a 2D scene around `center` \[m\] in place of all of it; does nothing in 3D.
    #[must_use]
    pub fn with_frame(mut self, center: [f64; 3], height: f64) -> Self {
        if let View::Flat(plane) = &mut self.view {
            plane.frame(&self.style, [center[0], center[1]], height);
        }
        self
    }

    /// Returns width and height of the pictures \[pixels\].
    pub fn size(&self) -> [u32; 2] {
        match &self.view {
            View::Flat(plane) => plane.size(),
            View::Perspective(space) => space.size(),
        }
    }

    /// Draws one snapshot.
    pub fn render(&self, snapshot: &Snapshot) -> Picture {
        let particles = DrawableParticles::from(snapshot, &self.scenery, self.style.coloring);
        let solids: Vec<Solid> = self
            .scenery
            .colliders
            .iter()
            .map(|(collider, color)| Solid {
                placed: collider.at(snapshot.time),
                color: palette::linear(*color),
            })
            .collect();
        match &self.view {
            View::Flat(plane) => plane.render(&particles, &solids),
            View::Perspective(space) => space.render(&particles, &solids),
        }
    }
}

/// A collider at one moment, ready to be drawn.
pub(super) struct Solid {
    pub(super) placed: Placed<3>,
    /// Color in linear light.
    pub(super) color: [f32; 3],
}
