//! Pictures of a run's frames without a window. They look as the window's replay of the run does.

use std::fmt;
use std::sync::Arc;

use eframe::egui::Color32;
use lahar::Snapshot;
use lahar_io::image::{Coloring, Picture, Style};
use lahar_io::output::Recording;
use lahar_scene::scene::{ColorBy, SceneView};

use crate::camera::Camera;
use crate::color::Range;
use crate::palette;
use crate::renderer::{self, Offscreen, View};
use crate::scene_library;
use crate::scenery::{Scenery, sprites, usual_radius};
use crate::scenes::SceneInfo;

/// The reason why a picture cannot be drawn: no adapter, a picture too large for it, or an adapter that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PaintError(String);

impl fmt::Display for PaintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for PaintError {}

/// Draws the frames of one run with the window's renderer, all by the same camera and colors. It needs a graphics
/// adapter, which may be one in software, and no display.
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
    /// Chooses the camera for a run. `view` is the view of its scene, and `first` a frame of it, the earlier the better.
    /// Pictures have exactly the size of `style`.
    ///
    /// # Errors
    /// There is no adapter, or it does not work.
    pub fn new(
        recording: &Recording,
        view: SceneView,
        first: &Snapshot,
        style: &Style,
    ) -> Result<Self, PaintError> {
        let info = scene_library::recorded_info(recording, view);
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
                info.camera,
                aspect,
            ),
            scenery,
            aspect,
            pixels: [style.width, style.height].map(|side| side as f32),
            palette: palette::palette(&info.swatches),
            by,
            range: Range::of(by, (ends.0 as f32, ends.1 as f32)),
            info,
        })
    }

    /// The name of the graphics adapter.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Draws one frame.
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
            background: palette::background(&self.info),
        };
        self.offscreen.draw(&picture).map_err(PaintError)
    }
}
