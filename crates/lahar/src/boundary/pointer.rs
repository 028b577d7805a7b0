//! The hand that stirs, as the nodes feel it.

use crate::grid::NodePointer;
use crate::math::{Scalar, Vector};
use crate::simulation::PointerAction;

impl<const D: usize> NodePointer<D> {
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
        }
    }
}
