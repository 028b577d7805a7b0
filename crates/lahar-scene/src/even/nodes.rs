//! The nodes around a shape, and where among them a place is.

use lahar::geometry::Bounds;
use lahar::kernel::BSpline;
use lahar::math::Real;

/// Which nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lattice {
    /// The grid's own.
    Grid,
    /// Those half a cell further along every axis.
    Between,
}

impl Lattice {
    pub(super) const BOTH: [Self; 2] = [Self::Grid, Self::Between];

    /// The base node in this lattice, and how far past it, of what is `frac` past the node `base` of the
    /// grid, on one axis.
    #[inline(always)]
    pub(super) fn base<R: Real + PartialOrd>(self, base: usize, frac: R) -> (usize, R) {
        let half = frac.lit(0.5);
        match self {
            Self::Grid => (base, frac),
            Self::Between if frac < half => (base - 1, frac + half),
            Self::Between => (base, frac - half),
        }
    }
}

/// The nodes that particles in a box can touch, the first axis fastest. Both lattices number theirs
/// alike.
pub(super) struct Nodes<const D: usize> {
    /// Where the first of them is \[m\].
    first: [f64; D],
    size: [usize; D],
    dx: f64,
}

impl<const D: usize> Nodes<D> {
    pub(super) fn around(bounds: &Bounds<D>, origin: [f64; D], dx: f64) -> Self {
        /// Nodes beyond a cell that its particles may touch, weights of 0 included.
        const REACH: f64 = 3.0;
        let low: [f64; D] =
            core::array::from_fn(|axis| ((bounds.min[axis] - origin[axis]) / dx).floor() - REACH);
        Self {
            first: core::array::from_fn(|axis| origin[axis] + low[axis] * dx),
            size: core::array::from_fn(|axis| {
                let high = ((bounds.max[axis] - origin[axis]) / dx).ceil() + REACH;
                (high - low[axis]) as usize + 1
            }),
            dx,
        }
    }

    pub(super) fn dx(&self) -> f64 {
        self.dx
    }

    pub(super) fn len(&self) -> usize {
        self.size.iter().product()
    }

    /// Nodes on the axes below `axis`: what is between one and the next along it.
    pub(super) fn stride(&self, axis: usize) -> usize {
        self.size[..axis].iter().product()
    }

    pub(super) fn size(&self, axis: usize) -> usize {
        self.size[axis]
    }

    /// On one axis, the base node of a place \[m\] and how far past it \[cells\], as [`lahar::kernel`] has
    /// them.
    #[inline(always)]
    pub(super) fn base<K: BSpline>(&self, axis: usize, x: f64) -> (usize, f64) {
        let cells = (x - self.first[axis]) / self.dx - K::OFFSET;
        let base = cells as usize;
        (base, cells - base as f64)
    }
}
