//! Reads forces, and estimates the accelerations that they cause.

use super::formula::{Formulas, Variables};
use super::key::words;
use super::read::Reader;
use crate::error::SceneError;
use lahar::geometry::Bounds;
use lahar::{Force, Pull};
use std::sync::Arc;

/// The kinds of forces.
#[derive(Clone, Copy)]
enum Kind {
    Acceleration,
    Central,
    Vortex,
    Drag,
    Damping,
}

/// The key of each kind; a force has one of them.
const KINDS: [(&str, Kind); 5] = [
    ("acceleration", Kind::Acceleration),
    ("central", Kind::Central),
    ("vortex", Kind::Vortex),
    ("drag", Kind::Drag),
    ("damping", Kind::Damping),
];

/// Reads gravity and the forces. Returns the constant part of gravity, and all other accelerations as forces.
pub(crate) fn read_forces<const D: usize>(
    scene: &Reader<'_>,
    dx: f64,
) -> Result<([f64; D], Vec<Force<D>>), SceneError> {
    let gravity: Formulas<D> = scene.formulas("gravity", Variables::PlaceAndTime)?;
    let constant = gravity.constants();
    let mut forces = Vec::new();
    if !gravity.is_constant() {
        forces.push(Force::Field(Arc::new(gravity.without_constants())));
    }
    for (_, table) in scene.tables("forces") {
        forces.push(read_force(&table, dx)?);
    }
    Ok((constant, forces))
}

fn read_force<const D: usize>(table: &Reader<'_>, dx: f64) -> Result<Force<D>, SceneError> {
    let given: Vec<_> = (KINDS.into_iter())
        .filter(|(key, _)| table.has(key))
        .collect();
    let (key, kind) = match given[..] {
        [given] => given,
        [] => {
            return Err(table
                .error("this force does nothing")
                .hint(format!("give one of: {}", words(&KINDS).join(", "))));
        }
        [(first, _), (second, _), ..] => {
            return Err(table
                .error_at_key(second, format!("this force has \"{first}\" already"))
                .hint("make a second [[forces]] of it"));
        }
    };
    let inner = || {
        (table.opt_table(key))
            .ok_or_else(|| table.error_at(key, format!("\"{key}\" must be a table")))
    };
    let pull = |inner: &Reader<'_>| -> Result<Pull<D>, SceneError> {
        Ok(Pull {
            center: inner.vector("center")?,
            acceleration: inner.number("acceleration")?,
            distance: inner.number("distance")?,
            power: inner.number("power")?,
            softening: inner.opt_number("softening").unwrap_or(dx),
        })
    };
    Ok(match kind {
        Kind::Central => Force::Central(pull(&inner()?)?),
        Kind::Vortex => {
            let inner = inner()?;
            let axis = inner.opt_vector::<3>("axis").unwrap_or([0.0, 0.0, 1.0]);
            let length = axis.iter().map(|n| n * n).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                return Err(inner.error_at("axis", "the axis has no direction"));
            }
            Force::Vortex {
                pull: pull(&inner)?,
                axis: axis.map(|n| n / length),
            }
        }
        Kind::Drag => {
            let inner = inner()?;
            Force::Drag {
                rate: inner.number("rate")?,
                velocity: inner.vector("velocity")?,
            }
        }
        Kind::Damping => Force::Drag {
            rate: table.number("damping")?,
            velocity: [0.0; D],
        },
        Kind::Acceleration => Force::Field(Arc::new(
            table.formulas::<D>("acceleration", Variables::PlaceAndTime)?,
        )),
    })
}

/// Statistics of the accelerations by forces, over the bodies and the duration of a run.
pub(crate) struct Expected<const D: usize> {
    /// The mean acceleration \[m/s²\].
    pub(crate) mean: [f64; D],
    /// The largest deviation from the mean \[m/s²\].
    pub(crate) swing: f64,
}

/// Points along an axis of a body at which forces are evaluated.
const PLACES: usize = 5;
/// Moments of a run at which forces are evaluated.
const MOMENTS: usize = 128;

/// Part of the run between one moment and the next, wrapped around. The golden section is in step with no
/// oscillation.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Evaluates the forces on a lattice over each of the `bodies`, from time 0 to `duration` \[s\].
pub(crate) fn expect<const D: usize>(
    forces: &[Force<D>],
    bodies: &[Bounds<D>],
    duration: f64,
) -> Expected<D> {
    let places: Vec<[f64; D]> = bodies.iter().flat_map(|b| lattice(b, PLACES)).collect();
    let mut all: Vec<[f64; D]> = Vec::new();
    for moment in 0..MOMENTS {
        let time = duration * (moment as f64 * GOLDEN).fract();
        let mut sum = vec![[0.0; D]; places.len()];
        for force in forces {
            for (sum, a) in sum
                .iter_mut()
                .zip(force.accelerations(time, &places, &places))
            {
                for i in 0..D {
                    sum[i] += a[i];
                }
            }
        }
        all.extend(sum.into_iter().filter(|a| a.iter().all(|a| a.is_finite())));
    }
    let count = all.len().max(1) as f64;
    let mean = core::array::from_fn(|i| all.iter().map(|a| a[i]).sum::<f64>() / count);
    let far = |a: &[f64; D]| (0..D).map(|i| (a[i] - mean[i]).powi(2)).sum::<f64>();
    let swing = all.iter().map(far).fold(0.0, f64::max).sqrt();
    Expected { mean, swing }
}

/// Returns a lattice with `n` points along each axis of a box, its faces included.
pub(crate) fn lattice<const D: usize>(bounds: &Bounds<D>, n: usize) -> Vec<[f64; D]> {
    (0..n.pow(D as u32))
        .map(|number| {
            core::array::from_fn(|i| {
                let step = number / n.pow(i as u32) % n;
                bounds.min[i] + bounds.side(i) * step as f64 / (n - 1) as f64
            })
        })
        .collect()
}
