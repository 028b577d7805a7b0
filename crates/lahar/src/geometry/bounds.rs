//! Boxes with sides along the axes.

/// A box with sides along the axes, its surface included.
///
/// ```
/// use lahar::geometry::Bounds;
///
/// let tank = Bounds { min: [0.0, 0.0], max: [2.0, 1.0] };
/// assert!(tank.contains(&[2.0, 0.5]));
/// assert_eq!(tank.volume(), 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const D: usize> {
    /// Lower corner \[m\].
    pub min: [f64; D],
    /// Upper corner \[m\].
    pub max: [f64; D],
}

impl<const D: usize> Bounds<D> {
    /// All of space.
    pub const EVERYTHING: Self = Self {
        min: [f64::NEG_INFINITY; D],
        max: [f64::INFINITY; D],
    };

    /// A box that contains nothing: the start for growing one around points.
    pub const NOTHING: Self = Self {
        min: [f64::INFINITY; D],
        max: [f64::NEG_INFINITY; D],
    };

    /// Returns the smallest box around all of `points` \[m\].
    pub fn around_points<'a>(points: impl IntoIterator<Item = &'a [f64; D]>) -> Self {
        points
            .into_iter()
            .fold(Self::NOTHING, |bounds, &point| Self {
                min: core::array::from_fn(|i| bounds.min[i].min(point[i])),
                max: core::array::from_fn(|i| bounds.max[i].max(point[i])),
            })
    }

    /// Returns the smallest box around all of `boxes`.
    pub fn around(boxes: impl IntoIterator<Item = Self>) -> Self {
        boxes.into_iter().fold(Self::NOTHING, |sum, b| Self {
            min: core::array::from_fn(|i| sum.min[i].min(b.min[i])),
            max: core::array::from_fn(|i| sum.max[i].max(b.max[i])),
        })
    }

    /// Returns the part that two boxes share. Its `max` is below its `min` where they share none.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            min: core::array::from_fn(|i| self.min[i].max(other.min[i])),
            max: core::array::from_fn(|i| self.max[i].min(other.max[i])),
        }
    }

    /// Returns true if `p` \[m\] is inside the box or on its surface.
    pub fn contains(&self, p: &[f64; D]) -> bool {
        (0..D).all(|i| self.min[i] <= p[i] && p[i] <= self.max[i])
    }

    /// Returns true if `other` lies inside this box.
    pub fn encloses(&self, other: &Self) -> bool {
        self.contains(&other.min) && self.contains(&other.max)
    }

    /// Returns true if all corners are at finite places.
    pub fn is_finite(&self) -> bool {
        (0..D).all(|i| self.min[i].is_finite() && self.max[i].is_finite())
    }

    /// Returns the length along axis `i` \[m\]; 0 for an empty box.
    pub fn side(&self, i: usize) -> f64 {
        (self.max[i] - self.min[i]).max(0.0)
    }

    /// Returns the product of the sides \[m³; m² in 2D\].
    pub fn volume(&self) -> f64 {
        (0..D).map(|i| self.side(i)).product()
    }

    /// Returns the middle of the box \[m\]; 0 along axes on which the box has no end.
    pub fn middle(&self) -> [f64; D] {
        core::array::from_fn(|i| {
            let middle = 0.5 * (self.min[i] + self.max[i]);
            if middle.is_finite() { middle } else { 0.0 }
        })
    }

    /// Returns the 2ᴰ corners \[m\], the first axis changing fastest.
    pub(crate) fn corners(&self) -> impl Iterator<Item = [f64; D]> + '_ {
        (0..1_usize << D).map(|bits| {
            core::array::from_fn(|i| {
                if bits >> i & 1 == 0 {
                    self.min[i]
                } else {
                    self.max[i]
                }
            })
        })
    }
}
