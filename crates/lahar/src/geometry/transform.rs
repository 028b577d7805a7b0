//! Scaling, turning and moving.

use super::Bounds;

/// x ↦ M (x − about) + about + by, with M a scaling along the axes and then a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<const D: usize> {
    /// R: an orthogonal matrix, row by row.
    rotation: [[f64; D]; D],
    /// S: factors along the axes.
    scale: [f64; D],
    /// \[m\]
    about: [f64; D],
    /// \[m\]
    by: [f64; D],
}

impl<const D: usize> Motion<D> {
    /// Scales by `scale` and turns by `turn` about `about` \[m\], then moves by `by` \[m\]. The angle
    /// \[rad\] is the length of `turn` and its axis the direction; counter-clockwise.
    pub fn new(scale: [f64; D], turn: [f64; 3], about: [f64; D], by: [f64; D]) -> Self {
        let angle = turn.iter().map(|t| t * t).sum::<f64>().sqrt();
        let n = turn.map(|t| if angle > 0.0 { t / angle } else { 0.0 });
        let (sin, cos) = libm::sincos(angle);
        // Rodrigues: R = cos I + (1 − cos) n nᵀ + sin [n]×.
        let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
        let rotation = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let unit = if i == j { cos } else { 0.0 };
                unit + (1.0 - cos) * n[i] * n[j] + sin * cross[i][j]
            })
        });
        Self {
            rotation,
            scale,
            about,
            by,
        }
    }

    /// Moves by `by` \[m\] only.
    pub fn shift(by: [f64; D]) -> Self {
        Self::new([1.0; D], [0.0; 3], [0.0; D], by)
    }

    /// Where `p` goes.
    pub(super) fn forth(&self, p: &[f64; D]) -> [f64; D] {
        core::array::from_fn(|i| {
            let turned: f64 = (0..D)
                .map(|j| self.rotation[i][j] * self.scale[j] * (p[j] - self.about[j]))
                .sum();
            self.about[i] + self.by[i] + turned
        })
    }

    /// Where `p` comes from.
    pub(super) fn back(&self, p: &[f64; D]) -> [f64; D] {
        core::array::from_fn(|i| {
            let turned: f64 = (0..D)
                .map(|j| self.rotation[j][i] * (p[j] - self.about[j] - self.by[j]))
                .sum();
            self.about[i] + turned / self.scale[i]
        })
    }

    /// The one factor of all axes, if there is one.
    pub(super) fn factor(&self) -> Option<f64> {
        let first = self.scale[0];
        self.scale.iter().all(|s| *s == first).then_some(first)
    }

    /// The factors along the axes.
    pub(super) fn factors(&self) -> [f64; D] {
        self.scale
    }

    /// Whether it turns anything.
    pub(super) fn turns(&self) -> bool {
        (0..D).any(|i| (0..D).any(|j| self.rotation[i][j] != f64::from(u8::from(i == j))))
    }

    /// A direction after the turn.
    pub(super) fn turned(&self, direction: &[f64; D]) -> [f64; D] {
        core::array::from_fn(|i| (0..D).map(|j| self.rotation[i][j] * direction[j]).sum())
    }

    /// How much volumes grow.
    pub(super) fn stretch(&self) -> f64 {
        self.scale.iter().product::<f64>().abs()
    }
}

impl<const D: usize> Bounds<D> {
    /// Its middle \[m\]; 0 where it has no end.
    pub fn middle(&self) -> [f64; D] {
        core::array::from_fn(|i| {
            let middle = 0.5 * (self.min[i] + self.max[i]);
            if middle.is_finite() { middle } else { 0.0 }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let motion = Motion::new(
            [2.0, 3.0, 0.5],
            [0.3, -1.2, 0.7],
            [1.0, 2.0, 3.0],
            [0.1, 0.2, 0.3],
        );
        let p = [0.7, -0.4, 2.2];
        let back = motion.back(&motion.forth(&p));
        assert!((0..3).all(|i| (back[i] - p[i]).abs() < 1e-14), "{back:?}");
        assert!((motion.stretch() - 3.0).abs() < 1e-15);
    }

    #[test]
    fn turning_is_counter_clockwise() {
        let turned = |turn| Motion::new([1.0; 3], turn, [0.0; 3], [0.0; 3]);
        let quarter = core::f64::consts::FRAC_PI_2;
        for (turn, from, to) in [
            ([0.0, 0.0, quarter], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([quarter, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.0, quarter, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ] {
            let found = turned(turn).forth(&from);
            assert!(
                (0..3).all(|i| (found[i] - to[i]).abs() < 1e-15),
                "{found:?}"
            );
        }
    }
}
