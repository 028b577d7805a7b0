//! Impulses on boundaries: force and torque of the material, summed over time.

use crate::math::Vector;

/// The impulse on one boundary since the start: ∫ F dt, with F the force of the material on it. Vectors have three
/// components. In 2D the third component of an impulse is zero, and only the third of an angular impulse is not.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryImpulse {
    /// Name of the side of the domain, as in scenes ("left", "right", "bottom", "top", "back", "front"), or of the
    /// collider.
    pub name: String,
    /// ∫ F dt \[N s; N s/m in 2D\].
    pub impulse: [f64; 3],
    /// ∫ x × F dt \[N m s; N s in 2D\], about the origin of coordinates for a side, and about the present place of its
    /// center for a collider.
    pub angular_impulse: [f64; 3],
}

/// Names of the sides, by axis.
pub(crate) const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];

/// An impulse of the material on a boundary, and its moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Impulse<const D: usize> {
    /// The sum of impulses \[kg m/s\].
    pub(crate) impulse: Vector<f64, D>,
    /// About the point that lengths are counted from; per unit of length.
    pub(crate) angular: [f64; 3],
}

impl<const D: usize> Impulse<D> {
    pub(crate) const ZERO: Self = Self {
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

    /// Adds `other`, whose lengths are counted in units of `unit` from `origin`.
    pub(crate) fn add_scaled(&mut self, other: &Self, unit: f64, origin: [f64; D]) {
        for axis in 0..3 {
            self.angular[axis] += unit * other.angular[axis];
        }
        self.add(origin, other.impulse);
    }
}
