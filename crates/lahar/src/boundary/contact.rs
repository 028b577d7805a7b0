//! Contact laws: what a boundary does to a node's velocity.

use super::Contact;
use crate::math::{Real, Scalar, Vector};

impl Contact {
    /// The velocity after contact with a wall across `axis`, whose material side is towards
    /// `inward` (+1: the wall is at the low end, −1: at the high end). `velocity` is relative to
    /// the wall \[m/s\].
    ///
    /// With v_n the velocity into the wall and v_t the rest: sticky v = 0; slip v_n = 0;
    /// separate v_n = 0 only where it points into the wall. What the wall took, Δv_n, lets Coulomb
    /// friction take at most μ Δv_n of v_t.
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
            let tangential = velocity.norm();
            let taken = T::from_f64(friction) * Real::abs(normal);
            let kept = if tangential > taken {
                (tangential - taken) / tangential
            } else {
                zero
            };
            velocity = velocity * kept;
        }
        velocity
    }
}
