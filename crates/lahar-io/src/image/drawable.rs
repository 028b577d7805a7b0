//! Particles as the painters take them: places, sizes, colors.

use super::palette::{self, Color, PRESSURE_RAMP, REST_RAMP, SPEED_RAMP, along};
use super::{Coloring, Scenery};
use lahar::{Field, Snapshot};

/// Particles as the painters take them.
pub(super) struct DrawableParticles {
    /// Where \[m\]; 0 beyond the dimension.
    pub(super) position: Vec<[f32; 3]>,
    /// Edge of the cube (square) that one fills at rest \[m\].
    pub(super) size: Vec<f32>,
    /// In linear light.
    pub(super) color: Vec<[f32; 3]>,
}

impl DrawableParticles {
    pub(super) fn from(snapshot: &Snapshot, scenery: &Scenery, coloring: Coloring) -> Self {
        let d = snapshot.dimension;
        let n = snapshot.count;
        let numbers = |field: Field| snapshot.get(field).map(lahar::Data::to_f32);
        let positions = snapshot
            .get(Field::Position)
            .map(lahar::Data::to_f64)
            .unwrap_or_default();
        let position = positions
            .chunks_exact(d)
            .map(|x| core::array::from_fn(|axis| if axis < d { x[axis] as f32 } else { 0.0 }))
            .collect();
        // No larger than a cell: volumes that only have a part in a mass can be anything.
        let size = numbers(Field::Volume0).map_or_else(
            || vec![0.5 * scenery.dx as f32; n],
            |volumes| {
                volumes
                    .iter()
                    .map(|v| if d == 2 { v.sqrt() } else { v.cbrt() })
                    .map(|edge| edge.min(scenery.dx as f32))
                    .collect()
            },
        );
        let speed: Vec<f32> = numbers(Field::Velocity).map_or_else(
            || vec![0.0; n],
            |v| {
                v.chunks_exact(d)
                    .map(|v| v.iter().map(|c| c * c).sum::<f32>().sqrt())
                    .collect()
            },
        );
        let index = |field: Field| numbers(field).unwrap_or_else(|| vec![0.0; n]);
        // Dust has none: as if at rest.
        let jacobian = || numbers(Field::Jacobian).unwrap_or_else(|| vec![1.0; n]);
        let shades = |color| {
            [
                palette::linear(color),
                palette::linear(palette::bright(color)),
            ]
        };
        let colors: Vec<[[f32; 3]; 2]> = scenery.colors.iter().copied().map(shades).collect();
        let own: Vec<Option<[[f32; 3]; 2]>> = scenery
            .bodies
            .iter()
            .map(|color| color.map(shades))
            .collect();
        let of_body = |body: f32| own.get(body as usize).copied().flatten();
        let of_index = |i: f32| colors[i as usize % colors.len().max(1)];
        let color = if colors.is_empty() {
            vec![[1.0; 3]; n]
        } else {
            match coloring {
                Coloring::Material => {
                    let scale = if scenery.speed > 0.0 {
                        1.0 / scenery.speed as f32
                    } else {
                        0.0
                    };
                    index(Field::Material)
                        .iter()
                        .zip(&speed)
                        .zip(index(Field::Body))
                        .map(|((&material, &speed), body)| {
                            let [base, bright] =
                                of_body(body).unwrap_or_else(|| of_index(material));
                            let part = (speed * scale).clamp(0.0, 1.0);
                            palette::mix(base, bright, part * part)
                        })
                        .collect()
                }
                Coloring::Body => index(Field::Body)
                    .iter()
                    .map(|&body| {
                        let other = palette::body_color(body as usize);
                        of_body(body).map_or_else(|| palette::linear(other), |[base, _]| base)
                    })
                    .collect(),
                Coloring::Speed(largest) => on_scale(&SPEED_RAMP, &speed, 0.0, largest),
                Coloring::Pressure(low, high) => {
                    let pressure = index(Field::Pressure);
                    on_scale(&PRESSURE_RAMP, &pressure, low, high)
                }
                Coloring::Density(low, high) => {
                    let (mass, volume) = (index(Field::Mass), index(Field::Volume0));
                    let each = mass.iter().zip(&volume).zip(jacobian());
                    let density: Vec<f32> = each.map(|((m, v), j)| m / (v * j)).collect();
                    on_scale(&REST_RAMP, &density, low, high)
                }
                Coloring::Jacobian(low, high) => on_scale(&REST_RAMP, &jacobian(), low, high),
            }
        };
        Self {
            position,
            size,
            color,
        }
    }
}

fn on_scale(ramp: &[Color], values: &[f32], low: f64, high: f64) -> Vec<[f32; 3]> {
    let at = |value: f32| (f64::from(value) - low) / (high - low);
    values
        .iter()
        .map(|&value| palette::linear(along(ramp, at(value) as f32)))
        .collect()
}
