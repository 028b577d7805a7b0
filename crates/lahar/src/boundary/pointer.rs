//! The pointer of the window, which attracts, drags and pushes material: on nodes and on particles.

use crate::math::{Real, Scalar, Vector};
use crate::setup::{Pointer, PointerAction};

/// A [`Pointer`] that acts on nodes, with lengths in cells from node 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodePointer<const D: usize> {
    center: [f64; D],
    radius: f64,
    softening: f64,
    action: PointerAction,
}

impl<const D: usize> NodePointer<D> {
    /// Converts `pointer` to cells; node 0 is at `origin` \[m\].
    pub(crate) fn of(pointer: Pointer, origin: [f64; D], dx: f64) -> Self {
        Self {
            center: core::array::from_fn(|axis| (pointer.position[axis] - origin[axis]) / dx),
            radius: pointer.radius / dx,
            softening: pointer.softening / dx,
            action: pointer.action,
        }
    }

    /// Returns the velocity of node `node` after the pointer has acted for `dt`. Its effect falls off smoothly to
    /// nothing at its radius.
    #[inline(always)]
    pub(crate) fn act<T: Scalar>(
        &self,
        velocity: Vector<T, D>,
        node: [i64; D],
        dt: T,
    ) -> Vector<T, D> {
        let offset = Vector::<f64, D>::from_fn(|axis| self.center[axis] - node[axis] as f64);
        let distance = offset.norm();
        if distance >= self.radius {
            return velocity;
        }
        let near = 1.0 - (distance / self.radius).powi(2);
        let share = near * near;
        match self.action {
            PointerAction::Attract(acceleration) => {
                let softened = distance + self.softening;
                if softened == 0.0 {
                    return velocity;
                }
                let per_length = acceleration * share * dt.to_f64() / softened;
                velocity + Vector::from_fn(|axis| T::from_f64(offset[axis] * per_length))
            }
            PointerAction::Drag(target) => {
                velocity
                    + Vector::from_fn(|axis| {
                        (T::from_f64(target[axis]) - velocity[axis]) * T::from_f64(share)
                    })
            }
            PointerAction::Push { .. } => velocity,
        }
    }
}

/// Within this distance from the pointer \[cells\] a push has no direction.
const NO_DIRECTION: f64 = 1e-12;

/// A [`Pointer`] that pushes particles away, with lengths in cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ParticlePointer<const D: usize> {
    center: [f64; D],
    radius: f64,
    power: f64,
    /// Δt A \[m/s\].
    velocity: f64,
}

impl<const D: usize> ParticlePointer<D> {
    /// Makes the action of `pointer` on particles in a substep of `dt` \[s\], if it has one; node 0 is at `origin` \[m\].
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
            center: core::array::from_fn(|axis| (pointer.position[axis] - origin[axis]) / dx),
            radius: pointer.radius / dx,
            power,
            velocity: dt * acceleration,
        })
    }

    /// Returns the same with positions counted from `middle`.
    pub(crate) fn relative_to(&self, middle: [f64; D]) -> Self {
        Self {
            center: core::array::from_fn(|axis| self.center[axis] - middle[axis]),
            ..*self
        }
    }

    /// Returns the velocity \[m/s\] of a particle at `x` after the push; `v` is its velocity before, (12).
    #[inline(always)]
    pub(crate) fn act<R: Real>(&self, v: Vector<R, D>, x: Vector<R, D>) -> Vector<R, D> {
        let mut d = x;
        for axis in 0..D {
            d[axis] = x[axis] - x[axis].lit(self.center[axis]);
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
