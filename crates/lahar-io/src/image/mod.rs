//! Pictures of snapshots, drawn by the processor: for runs without a display, and for films.
//!
//! ```text
//! Snapshot ─► plane (2D: one filled shape) ─┐
//!          └► space (3D: lit spheres) ──────┴─► Picture ─► PNG
//!                                                      └─► Film ─► GIF
//! ```
//! Everything a film must not change between frames (view, colors, ranges) is decided once, by [`Renderer::new`].

mod camera;
mod drawable;
mod film;
mod flat;
mod mp4;
mod palette;
mod perspective;
mod side_by_side;

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use crate::files::{Durability, write_whole_io};
use drawable::DrawableParticles;
use lahar::boundary::Placed;
use lahar::{Collider, Field, Simulate, Snapshot};
use lahar_scene::scene::{ColliderInfo, Scene};

pub use camera::Camera;
pub use film::Film;
pub use mp4::{Mp4, Mp4Maker};
pub use palette::{
    BACKGROUND, COLLIDER, Color, PRESSURE_RAMP, REST_RAMP, SPEED_RAMP, along, body_color,
    model_colors,
};
pub use side_by_side::side_by_side;

/// The fields that a picture is drawn from; those that a snapshot lacks are done without.
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

/// Pixels, sRGB, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green and blue, pixel after pixel.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// Writes it as PNG.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write_png(&self, writer: impl Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(writer, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        Ok(writer.finish()?)
    }

    /// Reads one that [`Self::write_png`] has written.
    ///
    /// # Errors
    /// If it is not there, or is no PNG of eight bits a channel and three channels.
    pub fn load_png(path: impl AsRef<Path>) -> io::Result<Self> {
        let decoder = png::Decoder::new(io::BufReader::new(File::open(path)?));
        let mut reader = decoder.read_info()?;
        let (width, height) = reader.info().size();
        let is_rgb = reader.output_color_type() == (png::ColorType::Rgb, png::BitDepth::Eight);
        let bytes = reader.output_buffer_size().filter(|_| is_rgb);
        let Some(bytes) = bytes else {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "not a PNG of eight bits a channel and three channels",
            ));
        };
        let mut rgb = vec![0; bytes];
        reader.next_frame(&mut rgb)?;
        Ok(Self { width, height, rgb })
    }

    /// Writes it as a PNG file at `path`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save_png(&self, path: impl AsRef<Path>) -> io::Result<()> {
        write_whole_io(path.as_ref(), Durability::Eventual, |mut writer| {
            self.write_png(&mut writer)?;
            Ok(writer)
        })
    }
}

/// What of a scene a renderer has to know.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenery {
    /// 2 or 3.
    pub dimension: usize,
    /// Corners of what is shown \[m\]: the domain, or the particles and some room around them.
    pub bounds: ([f64; 3], [f64; 3]),
    /// Whether the bounds are a domain with walls to be drawn.
    pub walls: bool,
    /// The axis that points up (0, 1, 2): against gravity.
    pub up: usize,
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// A speed that the scene is expected to reach \[m/s\]; 0 if nothing is known.
    pub speed: f64,
    /// Color behind everything.
    pub background: Color,
    /// Colors of the materials, by index; those beyond the end take them again from the start.
    pub colors: Vec<Color>,
    /// Colors of bodies that have their own, by number.
    pub bodies: Vec<Option<Color>>,
    /// Colliders and their colors; in 2D without end along z.
    pub colliders: Vec<(Collider<3>, Color)>,
}

impl Scenery {
    /// What can be seen from the simulation at its start; `models` are the names of the materials' models, by
    /// index ("fluid", "snow", ...), which choose the colors.
    pub fn of(simulation: &dyn Simulate, models: &[&str]) -> Self {
        let bounds = match simulation.domain() {
            Some(domain) => Bounds::Domain(domain),
            None => Bounds::Around(&simulation.snapshot(&[Field::Position])),
        };
        let (dimension, dx) = (simulation.dimension(), simulation.dx());
        Self::new(dimension, bounds, simulation.gravity(), dx, models)
    }

    /// What can be seen of a run; `first` is a frame of it, the earlier the better. Gravity that is a formula pulls
    /// down the second axis for who looks at it.
    pub fn recorded(scene: &Scene, first: &Snapshot) -> Self {
        let resolved = scene.resolved();
        let bounds = match resolved.get("domain") {
            Some(_) => Bounds::Domain(scene.bounds()),
            None => Bounds::Around(first),
        };
        let mut gravity = [0.0; 3];
        let given = resolved["gravity"].as_array();
        for (own, value) in gravity.iter_mut().zip(given.into_iter().flatten()) {
            *own = value.as_f64().unwrap_or_default();
        }
        let models: Vec<&str> = (scene.materials.iter())
            .map(|material| material.model.as_str())
            .collect();
        let dx = resolved["dx"].as_f64().unwrap_or_default();
        Self::new(scene.dimension, bounds, gravity, dx, &models).with_colliders(&scene.colliders)
    }

    fn new(
        dimension: usize,
        bounds: Bounds<'_>,
        gravity: [f64; 3],
        dx: f64,
        models: &[&str],
    ) -> Self {
        let pull = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        let up = (0..dimension)
            .max_by(|&a, &b| gravity[a].abs().total_cmp(&gravity[b].abs()))
            .filter(|_| pull > 0.0)
            .unwrap_or(1);
        let walls = matches!(bounds, Bounds::Domain(_));
        let bounds = match bounds {
            Bounds::Domain(domain) => domain,
            Bounds::Around(snapshot) => around(snapshot, dx),
        };
        Self {
            dimension,
            walls,
            bounds,
            up,
            dx,
            // What falls half the height of the scene.
            speed: (pull * (bounds.1[up] - bounds.0[up]).max(0.0)).sqrt(),
            background: BACKGROUND,
            colors: model_colors(models),
            bodies: Vec::new(),
            colliders: Vec::new(),
        }
    }

    /// With `colliders`.
    #[must_use]
    pub fn with_colliders(mut self, colliders: &[ColliderInfo]) -> Self {
        self.colliders = colliders
            .iter()
            .map(|info| {
                let color = info.color.unwrap_or(COLLIDER);
                (info.collider.clone(), color)
            })
            .collect();
        self
    }
}

/// What is in the picture.
enum Bounds<'a> {
    Domain(([f64; 3], [f64; 3])),
    /// These particles and some room.
    Around(&'a Snapshot),
}

/// The box of the particles, half as large again.
fn around(snapshot: &Snapshot, dx: f64) -> ([f64; 3], [f64; 3]) {
    let d = snapshot.dimension;
    let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
    let positions = snapshot
        .get(Field::Position)
        .map(lahar::Data::to_f64)
        .unwrap_or_default();
    for axis in 0..d {
        let along = || positions.iter().skip(axis).step_by(d).copied();
        let low = along().fold(f64::INFINITY, f64::min);
        let high = along().fold(f64::NEG_INFINITY, f64::max);
        (min[axis], max[axis]) = if low <= high { (low, high) } else { (0.0, 1.0) };
    }
    let extent = (0..d)
        .map(|axis| max[axis] - min[axis])
        .fold(4.0 * dx, f64::max);
    for axis in 0..d {
        min[axis] -= 0.25 * extent;
        max[axis] += 0.25 * extent;
    }
    (min, max)
}

/// What colors mean. Numbers are on fixed scales, the window's colors: [`SPEED_RAMP`], [`PRESSURE_RAMP`],
/// [`REST_RAMP`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Coloring {
    /// The material, or the body's own color; brighter where it is fast.
    #[default]
    Material,
    /// The body.
    Body,
    /// Speed \[m/s\] from 0 to the given one.
    Speed(f64),
    /// Pressure \[Pa\] from the first to the second.
    Pressure(f64, f64),
    /// Density \[kg/m³; kg/m² in 2D\] from the first to the second.
    Density(f64, f64),
    /// J from the first to the second.
    Jacobian(f64, f64),
}

/// How pictures look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Pixels a row at most; less for scenes that are higher than wide.
    pub width: u32,
    /// Rows at most.
    pub height: u32,
    /// Samples a pixel and axis.
    pub samples: u32,
    /// What colors mean.
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

/// Draws the snapshots of one scene, all by the same view and colors.
#[derive(Clone, Debug)]
pub struct Renderer {
    scenery: Scenery,
    style: Style,
    view: View,
}

/// Samples of a picture that there is memory for: 16 bytes each.
const MOST_SAMPLES: u64 = 1 << 28;

/// Samples a pixel and axis: large pictures have fewer.
fn affordable(style: &Style) -> u32 {
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
    /// Chooses the view for `scenery`.
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

    /// Looks from `camera` instead; nothing in 2D.
    #[must_use]
    pub fn with_camera(mut self, camera: Camera) -> Self {
        if let View::Perspective(space) = &mut self.view {
            space.camera = camera;
        }
        self
    }

    /// Shows `height` \[m\] of the scene around `center` \[m\] instead of all of it; nothing in 3D.
    #[must_use]
    pub fn with_frame(mut self, center: [f64; 3], height: f64) -> Self {
        if let View::Flat(plane) = &mut self.view {
            plane.frame(&self.style, [center[0], center[1]], height);
        }
        self
    }

    /// Width and height of the pictures \[pixels\].
    pub fn size(&self) -> [u32; 2] {
        match &self.view {
            View::Flat(plane) => plane.size(),
            View::Perspective(space) => space.size(),
        }
    }

    /// Draws one moment.
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

/// A collider as the painters take it.
struct Solid {
    placed: Placed<3>,
    /// In linear light.
    color: [f32; 3],
}

#[cfg(test)]
mod tests {
    use super::*;
    use lahar::Data;

    fn snapshot(dimension: usize, positions: &[f64], volume: f32, materials: &[u32]) -> Snapshot {
        Snapshot {
            time: 0.0,
            dimension,
            count: materials.len(),
            columns: vec![
                (Field::Position, Data::F64(positions.to_vec())),
                (Field::Volume0, Data::F32(vec![volume; materials.len()])),
                (Field::Material, Data::U32(materials.to_vec())),
            ],
        }
    }

    fn scenery(dimension: usize) -> Scenery {
        Scenery {
            dimension,
            bounds: ([0.0; 3], [2.0, 1.0, if dimension == 3 { 1.0 } else { 0.0 }]),
            walls: true,
            up: 1,
            dx: 0.1,
            speed: 0.0,
            background: BACKGROUND,
            colors: model_colors(&["fluid", "corotated"]),
            bodies: Vec::new(),
            colliders: Vec::new(),
        }
    }

    /// A collider is in the picture where it is at the time, and nowhere else.
    #[test]
    fn colliders_are_drawn_where_they_are() {
        for (dimension, up) in [(2, 1), (3, 1)] {
            let red = [255, 0, 0];
            let mut collider = Collider::still(
                "ball",
                vec![lahar::Solid::Ball {
                    center: [0.5, 0.5, 0.5 * f64::from(dimension - 2)],
                    radius: 0.3,
                }],
                lahar::Contact::Sticky,
            );
            collider.motion = lahar::Motion::Steady {
                velocity: [1.0, 0.0, 0.0],
                spin: [0.0; 3],
            };
            let scenery = Scenery {
                up,
                colliders: vec![(collider, red)],
                ..scenery(dimension as usize)
            };
            let renderer = Renderer::new(scenery, Style::default());
            let middle = |time: f64| {
                let mut moment = snapshot(dimension as usize, &[], 0.01, &[]);
                moment.time = time;
                let picture = renderer.render(&moment);
                let (mut columns, mut count) = (0.0, 0.0);
                for (at, pixel) in picture.rgb.as_chunks::<3>().0.iter().enumerate() {
                    if pixel[0] > 60 && pixel[1] < pixel[0] / 2 && pixel[2] < pixel[0] / 2 {
                        columns += (at % picture.width as usize) as f64;
                        count += 1.0;
                    }
                }
                assert!(count > 1000.0, "{dimension}D: {count} pixels");
                columns / count / f64::from(picture.width)
            };
            let (early, late) = (middle(0.0), middle(1.0));
            assert!((0.15..0.4).contains(&early), "{dimension}D: {early}");
            assert!((0.6..0.85).contains(&late), "{dimension}D: {late}");
        }
    }

    #[test]
    fn large_pictures_have_fewer_samples() {
        let samples = |width, height| {
            affordable(&Style {
                width,
                height,
                ..Style::default()
            })
        };
        assert_eq!(samples(1920, 1080), 3);
        assert_eq!(samples(8192, 8192), 2);
        assert_eq!(samples(16384, 16384), 1);
    }

    #[test]
    fn bodies_have_their_own_colors() {
        let mut scenery = scenery(2);
        scenery.bodies = vec![None, Some([250, 10, 20])];
        let mut moment = snapshot(2, &[0.5, 0.5, 1.5, 0.5], 0.09, &[0, 0]);
        moment.columns.push((Field::Body, Data::U32(vec![0, 1])));
        for coloring in [Coloring::Material, Coloring::Body] {
            let style = Style {
                coloring,
                ..Style::default()
            };
            let picture = Renderer::new(scenery.clone(), style).render(&moment);
            assert!(
                count(&picture, |p| p == [250, 10, 20]) > 100,
                "{coloring:?}"
            );
        }
    }

    /// Three bodies, pressed, at rest and torn, in 2D and 3D: the scale's ends and its middle.
    #[test]
    fn density_and_the_jacobian_have_colors() {
        for dimension in [2, 3] {
            let middle = [0.5; 3];
            let positions: Vec<f64> = [0.4, 1.0, 1.6]
                .iter()
                .flat_map(|&x| [x, middle[1], middle[2]].into_iter().take(dimension))
                .collect();
            let mut moment = snapshot(
                dimension,
                &positions,
                0.1_f32.powi(dimension as i32),
                &[0; 3],
            );
            let mass = 1000.0 * 0.1_f32.powi(dimension as i32);
            moment.columns.push((Field::Mass, Data::F32(vec![mass; 3])));
            let jacobian = Data::F32(vec![0.9, 1.0, 1.1]);
            moment.columns.push((Field::Jacobian, jacobian));
            let drawn =
                |coloring| DrawableParticles::from(&moment, &scenery(dimension), coloring).color;
            let [below, rest, above] = REST_RAMP.map(palette::linear);
            assert_eq!(drawn(Coloring::Jacobian(0.9, 1.1)), [below, rest, above]);
            let density = drawn(Coloring::Density(950.0, 1050.0));
            assert_eq!(density, [above, rest, below]);
        }
    }

    #[test]
    fn a_frame_shows_less() {
        let moment = snapshot(2, &[0.5, 0.5], 0.01, &[0]);
        let renderer = Renderer::new(scenery(2), Style::default());
        let is_drawn = |p: [u8; 3]| p != BACKGROUND;
        let all = renderer.clone().render(&moment);
        let near = renderer.with_frame([0.5, 0.5, 0.0], 0.25).render(&moment);
        assert_eq!((near.width, near.height), (640, 480));
        assert!(count(&near, is_drawn) > 10 * count(&all, is_drawn) / 2);
        let middle = &near.rgb[(240 * 640 + 320) * 3..][..3];
        assert_ne!(middle, BACKGROUND);
    }

    fn count(picture: &Picture, wanted: impl Fn([u8; 3]) -> bool) -> usize {
        picture
            .rgb
            .chunks_exact(3)
            .filter(|p| wanted([p[0], p[1], p[2]]))
            .count()
    }

    #[test]
    fn a_lone_particle_is_a_disc_of_its_color() {
        let renderer = Renderer::new(scenery(2), Style::default());
        let picture = renderer.render(&snapshot(2, &[1.0, 0.5], 0.01, &[1]));
        let pixels = 640.0 / 2.1;
        // (1 − r²/h²)² is at the threshold.
        let part = (1.0 - f64::from(flat::THRESHOLD).sqrt()).sqrt();
        let radius = part * f64::from(flat::REACH) * 0.1 * pixels;
        // Half red light or more.
        let area = count(&picture, |p| p[0] > 0xB0) as f64;
        let expected = std::f64::consts::PI * f64::powi(radius, 2);
        assert!(
            (0.93..1.07).contains(&(area / expected)),
            "{area} of {expected}"
        );
    }

    #[test]
    fn a_jittered_body_has_no_holes() {
        let (mut positions, mut state) = (vec![], 7_u64);
        let mut jitter = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        for i in 0..40 {
            for j in 0..40 {
                positions.extend([
                    0.5 + 0.02 * (f64::from(i) + jitter()),
                    0.1 + 0.02 * (f64::from(j) + jitter()),
                ]);
            }
        }
        let renderer = Renderer::new(scenery(2), Style::default());
        let picture = renderer.render(&snapshot(2, &positions, 4e-4, &[0; 1600]));
        let pixels = 640.0 / 2.1;
        let fluid = scenery(2).colors[0];
        let filled = count(&picture, |p| p == fluid) as f64;
        assert!(filled > 0.64 * pixels * pixels * 0.97, "{filled}");
    }

    #[test]
    fn walls_clip_and_nothing_is_drawn_for_what_is_not_a_number() {
        let renderer = Renderer::new(scenery(2), Style::default());
        let empty = renderer.render(&snapshot(2, &[], 0.01, &[]));
        let lost = renderer.render(&snapshot(
            2,
            &[f64::NAN, 0.5, 9.0, 9.0, 1e300, -1e300],
            0.01,
            &[0; 3],
        ));
        assert_eq!(empty, lost);
        let pixels = empty.rgb.len() / 3;
        let background = count(&empty, |p| p == BACKGROUND);
        assert!(
            background < pixels && background > pixels * 9 / 10,
            "{background} of {pixels}"
        );
    }

    #[test]
    fn balls_are_lit_and_hide_what_is_behind() {
        for up in [1, 2] {
            let renderer = Renderer::new(Scenery { up, ..scenery(3) }, Style::default());
            let picture = renderer.render(&snapshot(3, &[1.0, 0.5, 0.5], 0.008, &[1]));
            // Red above all, in many shades.
            let red = |p: [u8; 3]| f64::from(p[0]) > 1.4 * f64::from(p[1]) && p[0] > 60;
            let area = count(&picture, red);
            assert!((1500..20_000).contains(&area), "{area}");
            let mut shades: Vec<u8> = picture
                .rgb
                .chunks_exact(3)
                .filter(|p| red([p[0], p[1], p[2]]))
                .map(|p| p[0])
                .collect();
            shades.sort_unstable();
            shades.dedup();
            assert!(shades.len() > 30, "{} shades", shades.len());

            let Camera { eye, .. } = Camera::showing(scenery(3).bounds, up, 640.0 / 480.0);
            let towards: Vec<f64> = (0..3)
                .map(|i| [1.0, 0.5, 0.5][i] * 0.9 + 0.1 * f64::from(eye[i]))
                .collect();
            let both: Vec<f64> = [&[1.0, 0.5, 0.5], towards.as_slice()].concat();
            let hidden = renderer.render(&snapshot(3, &both, 0.008, &[1, 0]));
            assert!(count(&hidden, red) < area / 10);
        }
    }

    #[test]
    fn a_png_reads_back() {
        let renderer = Renderer::new(
            scenery(2),
            Style {
                width: 64,
                height: 64,
                ..Style::default()
            },
        );
        let picture = renderer.render(&snapshot(2, &[1.0, 0.5], 0.01, &[0]));
        let mut bytes = Vec::new();
        picture.write_png(&mut bytes).unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut rgb).unwrap();
        assert_eq!(
            (info.width, info.height, rgb),
            (picture.width, picture.height, picture.rgb)
        );
    }
}
