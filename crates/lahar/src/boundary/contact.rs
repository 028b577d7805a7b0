//! The contact law at one node: the velocity that a boundary leaves to it.

use crate::math::{Real, Scalar, Vector};
use crate::setup::Contact;

impl Contact {
    /// Returns the velocity of a node inside a wall across `axis` whose material side is towards `inward`: +1 for the
    /// low end of the axis, −1 for the high end. `velocity` is relative to the wall \[m/s\].
    ///
    /// With v_n the velocity into the wall and v_t the rest: sticky sets v = 0, slip v_n = 0, separate v_n = 0 only where
    /// it points into the wall. Coulomb friction removes at most μ Δv_n of v_t, where Δv_n is the change of v_n.
    #[inline(always)]
    pub(crate) fn constrain<T: Scalar, const D: usize>(
        self,
        mut velocity: Vector<T, D>,
        axis: usize,
        inward: f64,
    ) -> Vector<T, D> {
        let zero = T::default();
        let normal = velocity[axis] * T::from_f64(inward);
        let friction = match self {
            Self::Open => return velocity,
            Self::Sticky => return Vector([zero; D]),
            Self::Separate { .. } if normal > zero => return velocity,
            Self::Slip { friction } | Self::Separate { friction } => friction,
        };
        velocity[axis] = zero;
        if friction > 0.0 {
            velocity = shortened(velocity, T::from_f64(friction) * Real::abs(normal));
        }
        velocity
    }
}

/// Returns `velocity` made shorter by `amount` \[m/s\], or zero if it is not that long.
#[inline(always)]
pub(crate) fn shortened<R: Real, const D: usize>(
    velocity: Vector<R, D>,
    amount: R,
) -> Vector<R, D> {
    let speed = velocity.norm();
    velocity * R::select(speed.gt(amount), (speed - amount) / speed, amount.zero())
}
