//! The scene around the particles: bounds, colors, colliders.

use lahar::{Collider, Field, Simulate, Snapshot};
use lahar_scene::scene::{ColliderInfo, Scene};

use super::palette::{BACKGROUND, COLLIDER, Color, model_colors};

/// The parts of a scene that a renderer needs besides the particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenery {
    /// Dimension: 2 or 3.
    pub dimension: usize,
    /// Lower and upper corner of the box shown \[m\]: the domain, or the particles and a margin around them.
    pub bounds: ([f64; 3], [f64; 3]),
    /// True if the bounds are a domain with walls to be drawn.
    pub walls: bool,
    /// The axis that points up (0, 1 or 2): against gravity.
    pub up: usize,
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// Speed that the scene is expected to reach \[m/s\]; 0 if it is not known.
    pub speed: f64,
    /// Color of the background.
    pub background: Color,
    /// Colors of the materials by index; materials beyond the end use them again from the start.
    pub colors: Vec<Color>,
    /// Colors of bodies by number; `None`: the color of the material.
    pub bodies: Vec<Option<Color>>,
    /// Colliders and their colors; in 2D they extend without end along z.
    pub colliders: Vec<(Collider<3>, Color)>,
}

impl Scenery {
    /// Describes a simulation at its start. The names of the materials' models ("fluid", "snow", ...), by index, choose
    /// the colors.
    pub fn of(simulation: &dyn Simulate, models: &[&str]) -> Self {
        let bounds = match simulation.domain() {
            Some(domain) => Bounds::Domain(domain),
            None => Bounds::Around(&simulation.snapshot(&[Field::Position])),
        };
        let (dimension, dx) = (simulation.dimension(), simulation.dx());
        Self::new(dimension, bounds, simulation.gravity(), dx, models)
    }

    /// Describes a run that was recorded; `first` is a frame of it, the earlier the better. If gravity is a formula,
    /// the second axis points up.
    pub fn recorded(scene: &Scene, first: &Snapshot) -> Self {
        let view = scene.view();
        let bounds = match view.domain {
            Some(_) => Bounds::Domain(scene.bounds()),
            None => Bounds::Around(first),
        };
        let models: Vec<&str> = (scene.materials.iter())
            .map(|material| material.model.as_str())
            .collect();
        Self::new(scene.dimension, bounds, view.gravity, view.dx, &models)
            .with_colliders(&scene.colliders)
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
            // The speed after a fall through half the height of the scene.
            speed: (pull * (bounds.1[up] - bounds.0[up]).max(0.0)).sqrt(),
            background: BACKGROUND,
            colors: model_colors(models),
            bodies: Vec::new(),
            colliders: Vec::new(),
        }
    }

    /// Adds the colliders of a scene.
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

/// The box that pictures show.
enum Bounds<'a> {
    /// The domain of the scene.
    Domain(([f64; 3], [f64; 3])),
    /// The particles of a snapshot and a margin around them.
    Around(&'a Snapshot),
}

/// Returns the box of the particles, half as large again.
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
