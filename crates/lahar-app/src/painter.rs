//! Frames of a run as pictures that look as the window's replay of it, without a window.

use std::fmt;
use std::sync::Arc;

use eframe::egui::Color32;
use lahar::Snapshot;
use lahar_io::image::{Coloring, Picture, Style};
use lahar_io::output::Recording;
use serde_json::Value;

use crate::camera::Camera;
use crate::color::{self, ColorBy, Range};
use crate::renderer::{self, Offscreen, View};
use crate::scene_library;
use crate::scenery::{Scenery, sprites, usual_radius};
use crate::scenes::SceneInfo;

/// Why a picture could not be drawn, in words: no adapter, a picture too large for it, an adapter that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PaintError(String);

impl fmt::Display for PaintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for PaintError {}

/// Draws frames of one run by the window's renderer, all by the same view and colors. Needs a graphics adapter,
/// which may be one in software, and no display.
pub struct Painter {
    offscreen: Offscreen,
    adapter: String,
    info: SceneInfo,
    scenery: Scenery,
    camera: Camera,
    aspect: f64,
    pixels: [f32; 2],
    palette: Vec<Color32>,
    by: ColorBy,
    range: Range,
}

impl Painter {
    /// Chooses the view for a run. `scene` is its scene with all defaults filled in
    /// ([`lahar_scene::scene::Scene::resolved`]), `first` a frame of it, the earlier the better. Pictures have exactly the
    /// size of `style`.
    ///
    /// # Errors
    /// There is no adapter, or it does not work.
    pub fn new(
        recording: &Recording,
        scene: &Value,
        first: &Snapshot,
        style: &Style,
    ) -> Result<Self, PaintError> {
        let info = scene_library::recorded(recording, scene);
        let (offscreen, adapter) =
            Offscreen::new([style.width, style.height], style.samples).map_err(PaintError)?;
        let scenery = Scenery::new(&info, Some(first));
        let aspect = f64::from(style.width) / f64::from(style.height);
        let (by, ends) = match style.coloring {
            Coloring::Material => (ColorBy::Material, (0.0, 1.0)),
            Coloring::Body => (ColorBy::Body, (0.0, 1.0)),
            Coloring::Speed(high) => (ColorBy::Speed, (0.0, high)),
            Coloring::Pressure(low, high) => (ColorBy::Pressure, (low, high)),
            Coloring::Density(low, high) => (ColorBy::Density, (low, high)),
            Coloring::Jacobian(low, high) => (ColorBy::Jacobian, (low, high)),
        };
        Ok(Self {
            offscreen,
            adapter,
            camera: Camera::fit(
                info.dimension,
                scenery.extent,
                info.gravity,
                info.angle,
                aspect,
            ),
            scenery,
            aspect,
            pixels: [style.width, style.height].map(|side| side as f32),
            palette: color::palette(&info.swatches),
            by,
            range: Range::of(by, (ends.0 as f32, ends.1 as f32)),
            info,
        })
    }

    /// The name of what draws.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Draws one moment.
    ///
    /// # Errors
    /// The picture is too large for the adapter, or drawing failed; then no other can be drawn.
    pub fn render(&mut self, snapshot: &Snapshot) -> Result<Picture, PaintError> {
        let colors = (self.by, self.palette.as_slice(), &self.range);
        let picture = renderer::Picture {
            slot: 0,
            sprites: Arc::new(sprites(snapshot, &self.info, &self.scenery, colors)),
            lines: self.scenery.lines_at(&self.info, snapshot.time),
            view: View::new(
                &self.camera,
                self.scenery.origin,
                self.aspect,
                self.pixels,
                usual_radius(&self.info),
            ),
            solid: self.info.dimension == 3,
            background: color::background(&self.info),
        };
        self.offscreen.draw(&picture).map_err(PaintError)
    }
}
