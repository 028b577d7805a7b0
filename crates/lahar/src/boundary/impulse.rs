//! What boundaries have taken from the material: force and torque, summed over time.

use crate::math::Vector;

/// What one boundary has taken from the material since the start: the impulse of the force on it.
/// Vectors have three components; in 2D the third of an impulse is zero, and of an angular impulse it
/// is the only one that is not.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryImpulse {
    /// A side of the domain by its name in scenes ("left", "right", "bottom", "top", "back", "front"), or
    /// a collider by its own.
    pub name: String,
    /// ∫ F dt, with F the force of the material on it \[N s; N s/m in 2D\].
    pub impulse: [f64; 3],
    /// ∫ x × F dt \[N m s; N s in 2D\]: about the coordinates' origin for a side, about where its centre
    /// is at the time for a collider.
    pub angular_impulse: [f64; 3],
}

/// Names of the sides, by axis.
pub(crate) const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];

/// An impulse and where it acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Taken<const D: usize> {
    /// \[kg m/s\]
    pub(crate) impulse: Vector<f64, D>,
    /// About the point that lengths are counted from; per unit of length.
    pub(crate) angular: [f64; 3],
}

impl<const D: usize> Taken<D> {
    pub(crate) const NOTHING: Self = Self {
        impulse: Vector([0.0; D]),
        angular: [0.0; 3],
    };

    /// Adds `impulse`, which acts at `at`.
    #[inline(always)]
    pub(crate) fn add(&mut self, at: [f64; D], impulse: Vector<f64, D>) {
        self.impulse += impulse;
        for axis in 0..3 {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            if i < D && j < D {
                self.angular[axis] += at[i] * impulse[j] - at[j] * impulse[i];
            }
        }
    }

    /// Adds what was taken, with lengths counted in units of `unit` from `origin`.
    pub(crate) fn add_scaled(&mut self, other: &Self, unit: f64, origin: [f64; D]) {
        for axis in 0..3 {
            self.angular[axis] += unit * other.angular[axis];
        }
        self.add(origin, other.impulse);
    }
}
