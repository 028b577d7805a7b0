//! The hand that stirs, as nodes and particles feel it.

use crate::grid::NodePointer;
use crate::math::{Real, Scalar, Vector};
use crate::setup::{Pointer, PointerAction};

impl<const D: usize> NodePointer<D> {
    /// `pointer` in cells; node 0 is at `origin` \[m\].
    pub(crate) fn of(pointer: Pointer, origin: [f64; D], dx: f64) -> Self {
        Self {
            centre: core::array::from_fn(|axis| (pointer.position[axis] - origin[axis]) / dx),
            radius: pointer.radius / dx,
            softening: pointer.softening / dx,
            action: pointer.action,
        }
    }

    /// Velocity of node `node` after the hand has acted for `dt`. Its grip falls off smoothly to
    /// nothing at its radius.
    #[inline(always)]
    pub(crate) fn act<T: Scalar>(
        &self,
        velocity: Vector<T, D>,
        node: [i64; D],
        dt: T,
    ) -> Vector<T, D> {
        let offset = Vector::<f64, D>::from_fn(|axis| self.centre[axis] - node[axis] as f64);
        let distance = offset.norm();
        if distance >= self.radius {
            return velocity;
        }
        let near = 1.0 - (distance / self.radius).powi(2);
        let grip = near * near;
        match self.action {
            PointerAction::Attract(acceleration) => {
                let softened = distance + self.softening;
                if softened == 0.0 {
                    return velocity;
                }
                let per_length = acceleration * grip * dt.to_f64() / softened;
                velocity + Vector::from_fn(|axis| T::from_f64(offset[axis] * per_length))
            }
            PointerAction::Drag(target) => {
                velocity
                    + Vector::from_fn(|axis| {
                        (T::from_f64(target[axis]) - velocity[axis]) * T::from_f64(grip)
                    })
            }
            PointerAction::Push { .. } => velocity,
        }
    }
}

/// Nearer to the hand than this many cells, a push has no direction.
const NO_DIRECTION: f64 = 1e-12;

/// A hand that pushes particles, lengths in cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push<const D: usize> {
    centre: [f64; D],
    radius: f64,
    power: f64,
    /// Δt A \[m/s\].
    velocity: f64,
}

impl<const D: usize> Push<D> {
    /// What `pointer` does to particles in a substep of `dt` \[s\], if it does something; node 0 is at
    /// `origin` \[m\].
    pub(crate) fn of(pointer: Option<Pointer>, origin: [f64; D], dx: f64, dt: f64) -> Option<Self> {
        let pointer = pointer?;
        let PointerAction::Push {
            acceleration,
            power,
        } = pointer.action
        else {
            return None;
        };
        Some(Self {
            centre: core::array::from_fn(|axis| (pointer.position[axis] - origin[axis]) / dx),
            radius: pointer.radius / dx,
            power,
            velocity: dt * acceleration,
        })
    }

    /// The same where positions are counted from `middle`.
    pub(crate) fn seen_from(&self, middle: [f64; D]) -> Self {
        Self {
            centre: core::array::from_fn(|axis| self.centre[axis] - middle[axis]),
            ..*self
        }
    }

    /// Velocity \[m/s\] of a particle at `x` that had `v` before the hand pushed it.
    #[inline(always)]
    pub(crate) fn act<R: Real>(&self, v: Vector<R, D>, x: Vector<R, D>) -> Vector<R, D> {
        let mut d = x;
        for axis in 0..D {
            d[axis] = x[axis] - x[axis].lit(self.centre[axis]);
        }
        let distance = d.dot(d).sqrt();
        let reach = distance.lit(self.radius);
        let part = if self.radius.is_finite() {
            distance / reach
        } else {
            distance.one()
        };
        let push = part.power(self.power) * part.lit(self.velocity);
        let push = R::select(distance.lt(reach), push, push.zero());
        v + d * (push / distance.max(distance.lit(NO_DIRECTION)))
    }
}
