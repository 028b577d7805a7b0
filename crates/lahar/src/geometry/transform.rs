//! Scaling, rotating and translating.

use crate::math::{Matrix, Vector};

/// x ↦ R S (x − about) + about + by: a scaling S along the axes, then a rotation R, then a translation.
///
/// ```
/// use lahar::geometry::Transform;
///
/// // A quarter turn about (1, 0).
/// let turn = Transform::new([1.0; 2], [0.0, 0.0, std::f64::consts::FRAC_PI_2], [1.0, 0.0], [0.0; 2]);
/// let [x, y] = turn.apply(&[2.0, 0.0]);
/// assert!((x - 1.0).abs() < 1e-15 && (y - 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<const D: usize> {
    rotation: Matrix<f64, D>,
    /// Factors along the axes.
    scale: [f64; D],
    /// The point that stays in place before the translation \[m\].
    about: [f64; D],
    /// The translation \[m\].
    by: [f64; D],
}

impl<const D: usize> Transform<D> {
    /// Scales by `scale` and rotates by `turn` about the point `about` \[m\], then translates by `by`
    /// \[m\]. The length of `turn` is the angle \[rad\] and its direction the axis, counter-clockwise;
    /// in 2D, `turn` is (0, 0, angle).
    pub fn new(scale: [f64; D], turn: [f64; 3], about: [f64; D], by: [f64; D]) -> Self {
        Self {
            rotation: rotation(turn),
            scale,
            about,
            by,
        }
    }

    /// Translates by `by` \[m\].
    pub fn translation(by: [f64; D]) -> Self {
        Self::new([1.0; D], [0.0; 3], [0.0; D], by)
    }

    /// Returns the point that `p` is taken to \[m\].
    pub fn apply(&self, p: &[f64; D]) -> [f64; D] {
        core::array::from_fn(|i| {
            let turned: f64 = (0..D)
                .map(|j| self.rotation[(i, j)] * self.scale[j] * (p[j] - self.about[j]))
                .sum();
            self.about[i] + self.by[i] + turned
        })
    }

    /// Returns the point that is taken to `p` \[m\].
    pub fn invert(&self, p: &[f64; D]) -> [f64; D] {
        core::array::from_fn(|i| {
            let turned: f64 = (0..D)
                .map(|j| self.rotation[(j, i)] * (p[j] - self.about[j] - self.by[j]))
                .sum();
            self.about[i] + turned / self.scale[i]
        })
    }

    /// Returns `direction` after the rotation.
    pub fn rotate(&self, direction: &[f64; D]) -> [f64; D] {
        core::array::from_fn(|i| (0..D).map(|j| self.rotation[(i, j)] * direction[j]).sum())
    }

    /// Returns the factor by which volumes grow.
    pub fn volume_factor(&self) -> f64 {
        self.scale.iter().product::<f64>().abs()
    }

    /// Returns the scale if it is the same along all axes.
    pub(super) fn uniform_scale(&self) -> Option<f64> {
        let first = self.scale[0];
        self.scale.iter().all(|s| *s == first).then_some(first)
    }

    /// Returns the scale along each axis.
    pub(super) fn scale(&self) -> [f64; D] {
        self.scale
    }

    /// Returns true if the rotation is not the identity.
    pub(super) fn rotates(&self) -> bool {
        self.rotation != Matrix::identity(1.0)
    }
}

/// Returns the rotation by the angle |`turn`| \[rad\] about the direction of `turn`, counter-clockwise
/// (Rodrigues): R = cos I + (1 − cos) n nᵀ + sin \[n\]×. In 2D the third component is the angle.
pub(crate) fn rotation<const D: usize>(turn: [f64; 3]) -> Matrix<f64, D> {
    let angle = Vector(turn).norm();
    let n = turn.map(|t| if angle > 0.0 { t / angle } else { 0.0 });
    let (sin, cos) = libm::sincos(angle);
    let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    Matrix::from_fn(|i, j| {
        let unit = if i == j { cos } else { 0.0 };
        unit + (1.0 - cos) * n[i] * n[j] + sin * cross[i][j]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_is_undone_by_its_inverse() {
        let transform = Transform::new(
            [2.0, 3.0, 0.5],
            [0.3, -1.2, 0.7],
            [1.0, 2.0, 3.0],
            [0.1, 0.2, 0.3],
        );
        let p = [0.7, -0.4, 2.2];
        let back = transform.invert(&transform.apply(&p));
        assert!((0..3).all(|i| (back[i] - p[i]).abs() < 1e-14), "{back:?}");
        assert!((transform.volume_factor() - 3.0).abs() < 1e-15);
    }

    #[test]
    fn rotations_are_counter_clockwise() {
        let quarter = core::f64::consts::FRAC_PI_2;
        for (turn, from, to) in [
            ([0.0, 0.0, quarter], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([quarter, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.0, quarter, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ] {
            let found = Transform::new([1.0; 3], turn, [0.0; 3], [0.0; 3]).apply(&from);
            assert!(
                (0..3).all(|i| (found[i] - to[i]).abs() < 1e-15),
                "{found:?}"
            );
        }
    }
}
