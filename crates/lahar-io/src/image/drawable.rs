//! The particles of a snapshot as painters need them: positions, sizes, colors.

use lahar::{Data, Field, Snapshot};

use super::palette::{self, Color, PRESSURE_RAMP, REST_RAMP, SPEED_RAMP, along};
use super::renderer::Coloring;
use super::scenery::Scenery;

/// The particles of a snapshot, ready to be drawn. All lists have one entry per particle.
pub(super) struct DrawableParticles {
    /// Position \[m\]; in 2D the third coordinate is 0.
    pub(super) position: Vec<[f32; 3]>,
    /// Edge of the cube (in 2D: of the square) that a particle fills at rest \[m\].
    pub(super) size: Vec<f32>,
    /// Color in linear light.
    pub(super) color: Vec<[f32; 3]>,
}

impl DrawableParticles {
    pub(super) fn from(snapshot: &Snapshot, scenery: &Scenery, coloring: Coloring) -> Self {
        Self {
            position: positions(snapshot),
            size: sizes(snapshot, scenery),
            color: match scenery.colors.is_empty() {
                true => vec![[1.0; 3]; snapshot.count],
                false => colors(snapshot, scenery, coloring),
            },
        }
    }
}

fn positions(snapshot: &Snapshot) -> Vec<[f32; 3]> {
    let d = snapshot.dimension;
    let positions = snapshot.get(Field::Position).map(Data::to_f64);
    let point =
        |x: &[f64]| core::array::from_fn(|axis| if axis < d { x[axis] as f32 } else { 0.0 });
    (positions.unwrap_or_default().chunks_exact(d))
        .map(point)
        .collect()
}

fn sizes(snapshot: &Snapshot, scenery: &Scenery) -> Vec<f32> {
    let Some(volumes) = numbers(snapshot, Field::Volume0) else {
        return vec![0.5 * scenery.dx as f32; snapshot.count];
    };
    let edge = |volume: &f32| match snapshot.dimension {
        2 => volume.sqrt(),
        _ => volume.cbrt(),
    };
    // No larger than a cell: the volume of a particle without stress can be any number.
    let size = |volume| edge(volume).min(scenery.dx as f32);
    volumes.iter().map(size).collect()
}

fn colors(snapshot: &Snapshot, scenery: &Scenery, coloring: Coloring) -> Vec<[f32; 3]> {
    let index =
        |field: Field| numbers(snapshot, field).unwrap_or_else(|| vec![0.0; snapshot.count]);
    match coloring {
        Coloring::Material => by_material(snapshot, scenery, &index),
        Coloring::Body => {
            let color = |&body: &f32| {
                let own = scenery.bodies.get(body as usize).copied().flatten();
                palette::linear(own.unwrap_or_else(|| palette::body_color(body as usize)))
            };
            index(Field::Body).iter().map(color).collect()
        }
        Coloring::Speed(largest) => on_scale(&SPEED_RAMP, &speeds(snapshot), 0.0, largest),
        Coloring::Pressure(low, high) => {
            on_scale(&PRESSURE_RAMP, &index(Field::Pressure), low, high)
        }
        Coloring::Density(low, high) => {
            let (mass, volume) = (index(Field::Mass), index(Field::Volume0));
            let particles = mass.iter().zip(&volume).zip(jacobians(snapshot));
            let density: Vec<f32> = particles.map(|((m, v), j)| m / (v * j)).collect();
            on_scale(&REST_RAMP, &density, low, high)
        }
        Coloring::Jacobian(low, high) => on_scale(&REST_RAMP, &jacobians(snapshot), low, high),
    }
}

/// The color of the body if it has its own, else that of the material; brighter with the square of the speed.
fn by_material(
    snapshot: &Snapshot,
    scenery: &Scenery,
    index: &impl Fn(Field) -> Vec<f32>,
) -> Vec<[f32; 3]> {
    // The color at rest and the color at the scene's speed.
    let shades = |color| {
        [
            palette::linear(color),
            palette::linear(palette::bright(color)),
        ]
    };
    let materials: Vec<_> = scenery.colors.iter().copied().map(shades).collect();
    let bodies: Vec<_> = (scenery.bodies.iter())
        .map(|color| color.map(shades))
        .collect();
    let scale = match scenery.speed > 0.0 {
        true => 1.0 / scenery.speed as f32,
        false => 0.0,
    };
    let particles = (index(Field::Material).into_iter())
        .zip(speeds(snapshot))
        .zip(index(Field::Body));
    let color = |((material, speed), body): ((f32, f32), f32)| {
        let own = bodies.get(body as usize).copied().flatten();
        let [slow, fast] = own.unwrap_or_else(|| materials[material as usize % materials.len()]);
        let part = (speed * scale).clamp(0.0, 1.0);
        palette::mix(slow, fast, part * part)
    };
    particles.map(color).collect()
}

fn numbers(snapshot: &Snapshot, field: Field) -> Option<Vec<f32>> {
    snapshot.get(field).map(Data::to_f32)
}

fn speeds(snapshot: &Snapshot) -> Vec<f32> {
    let Some(velocities) = numbers(snapshot, Field::Velocity) else {
        return vec![0.0; snapshot.count];
    };
    let speed = |v: &[f32]| v.iter().map(|c| c * c).sum::<f32>().sqrt();
    (velocities.chunks_exact(snapshot.dimension))
        .map(speed)
        .collect()
}

/// The Jacobians J; 1 for particles that store none.
fn jacobians(snapshot: &Snapshot) -> Vec<f32> {
    numbers(snapshot, Field::Jacobian).unwrap_or_else(|| vec![1.0; snapshot.count])
}

fn on_scale(ramp: &[Color], values: &[f32], low: f64, high: f64) -> Vec<[f32; 3]> {
    let at = |value: f32| (f64::from(value) - low) / (high - low);
    values
        .iter()
        .map(|&value| palette::linear(along(ramp, at(value) as f32)))
        .collect()
}
