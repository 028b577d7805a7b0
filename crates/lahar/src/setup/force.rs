//! Forces besides stress and gravity: accelerations that depend on place and time, and drag.
//!
//! A force that depends on place and time only acts on nodes, as gravity does. A force that depends on where a particle
//! *started* cannot: it changes the particles' velocities before P2G. Either way all particles around a node are
//! accelerated alike, so a force adds Σ m a Δt to the momentum.

use crate::error::SetupError;
use core::fmt::Debug;
use std::sync::Arc;

/// An acceleration as a function of place and time, defined outside of this crate.
pub trait AccelerationField<const D: usize>: Debug + Send + Sync {
    /// Writes the acceleration \[m/s²\] at each of `positions` \[m\] at `time` \[s\] to `out`, which is as long. `starts` are
    /// the first positions of the particles \[m\] if [`Self::depends_on_start`], else empty.
    ///
    /// The same numbers must give the same bits, however they are divided among calls.
    fn accelerations(
        &self,
        time: f64,
        positions: &[[f64; D]],
        starts: &[[f64; D]],
        out: &mut [[f64; D]],
    );

    /// Returns true if the acceleration depends on where particles started.
    fn depends_on_start(&self) -> bool {
        false
    }
}

/// A force besides stress and gravity.
#[derive(Clone, Debug)]
pub enum Force<const D: usize> {
    /// An acceleration by a formula.
    Field(Arc<dyn AccelerationField<D>>),
    /// An acceleration towards a point.
    Central(Pull<D>),
    /// An acceleration around a point (in 3D around an axis through it), counter-clockwise.
    Vortex {
        /// The point and the strength.
        pull: Pull<D>,
        /// Unit vector of the axis; (0, 0, 1) in 2D.
        axis: [f64; 3],
    },
    /// Resistance of a medium: a = −rate (v − velocity).
    Drag {
        /// Rate at which the difference decays \[1/s\].
        rate: f64,
        /// Velocity of the medium \[m/s\].
        velocity: [f64; D],
    },
}

/// An acceleration that depends on the distance r from a point: A (d/s)ⁿ r/s with
/// s = √(r² + softening²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull<const D: usize> {
    /// The point \[m\].
    pub center: [f64; D],
    /// A, the acceleration at the distance d \[m/s²\]; a negative one points the other way.
    pub acceleration: f64,
    /// The distance d \[m\].
    pub distance: f64,
    /// The power n: 2 for gravity of a point, 0 for the same strength everywhere, −1 for a spring.
    pub power: f64,
    /// The softening length: the acceleration hardly depends on smaller distances \[m\].
    pub softening: f64,
}

impl<const D: usize> Pull<D> {
    /// Returns A (d/s)ⁿ / s for a particle at the offset `r`: the acceleration over the offset \[1/s²\].
    fn per_offset(&self, r: [f64; 3]) -> f64 {
        let squared = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        let s = (squared + self.softening * self.softening).sqrt();
        self.acceleration * libm::pow(self.distance / s, self.power) / s // (9c)
    }

    fn offset(&self, x: &[f64; D]) -> [f64; 3] {
        core::array::from_fn(|i| if i < D { x[i] - self.center[i] } else { 0.0 })
    }
}

impl<const D: usize> Force<D> {
    /// Returns the accelerations \[m/s²\] at `positions` \[m\] and `time` \[s\] of particles that started at `starts` \[m\].
    /// Drag, which depends on velocities, gives none.
    pub fn accelerations(
        &self,
        time: f64,
        positions: &[[f64; D]],
        starts: &[[f64; D]],
    ) -> Vec<[f64; D]> {
        let mut sum = vec![[0.0; D]; positions.len()];
        self.add(time, positions, starts, &mut sum.clone(), &mut sum);
        sum
    }

    /// Returns true if it acts on particles, before P2G.
    pub(crate) fn acts_on_particles(&self) -> bool {
        matches!(self, Self::Field(field) if field.depends_on_start())
    }

    /// Adds the acceleration at `positions` to `out`; `scratch` is as long. Drag, which depends on
    /// the velocity, adds nothing here.
    pub(crate) fn add(
        &self,
        time: f64,
        positions: &[[f64; D]],
        starts: &[[f64; D]],
        scratch: &mut [[f64; D]],
        out: &mut [[f64; D]],
    ) {
        match self {
            Self::Field(field) => {
                field.accelerations(time, positions, starts, scratch);
                for (sum, a) in out.iter_mut().zip(scratch) {
                    for i in 0..D {
                        sum[i] += a[i];
                    }
                }
            }
            Self::Central(pull) => {
                for (sum, x) in out.iter_mut().zip(positions) {
                    let r = pull.offset(x);
                    let k = pull.per_offset(r);
                    for i in 0..D {
                        sum[i] -= k * r[i];
                    }
                }
            }
            Self::Vortex { pull, axis: n } => {
                for (sum, x) in out.iter_mut().zip(positions) {
                    let r = pull.offset(x);
                    let along = r[0] * n[0] + r[1] * n[1] + r[2] * n[2];
                    let across: [f64; 3] = core::array::from_fn(|i| r[i] - along * n[i]);
                    let k = pull.per_offset(across);
                    for i in 0..D {
                        let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                        sum[i] += k * (n[j] * across[l] - n[l] * across[j]); // (9v)
                    }
                }
            }
            Self::Drag { .. } => {}
        }
    }

    fn is_finite(&self) -> bool {
        let pull_is = |pull: &Pull<D>| {
            pull.center.iter().all(|x| x.is_finite())
                && pull.acceleration.is_finite()
                && pull.distance > 0.0
                && pull.distance.is_finite()
                && pull.power.is_finite()
                && pull.softening > 0.0
                && pull.softening.is_finite()
        };
        match self {
            Self::Field(_) => true,
            Self::Central(pull) => pull_is(pull),
            Self::Vortex { pull, axis } => {
                let length: f64 = axis.iter().map(|n| n * n).sum();
                pull_is(pull) && (length - 1.0).abs() < 1e-9
            }
            Self::Drag { rate, velocity } => {
                *rate >= 0.0 && rate.is_finite() && velocity.iter().all(|v| v.is_finite())
            }
        }
    }
}

/// Checks the forces of a setup.
pub(super) fn check_forces<const D: usize>(forces: &[Force<D>]) -> Result<(), SetupError> {
    match forces.iter().position(|force| !force.is_finite()) {
        Some(index) => Err(SetupError {
            key: format!("forces.{index}"),
            message: "its numbers must be finite, distance and softening positive, the drag's rate not negative and the axis of length 1".into(),
        }),
        None => Ok(()),
    }
}
