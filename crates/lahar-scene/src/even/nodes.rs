//! The nodes around a shape, and the base node of a point among them.

use lahar::geometry::Bounds;
use lahar::kernel::BSpline;
use lahar::math::Real;

/// A lattice of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lattice {
    /// The nodes of the grid.
    Grid,
    /// The middles of the cells: nodes half a cell further along every axis.
    Between,
}

impl Lattice {
    pub(super) const BOTH: [Self; 2] = [Self::Grid, Self::Between];

    /// Returns the base node in this lattice along one axis and the distance from it \[cells\], of a point that
    /// is `frac` cells past the node `base` of the grid.
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

/// The nodes that particles in a box can touch, numbered with the first axis fastest. Both lattices have the
/// same numbers.
pub(super) struct Nodes<const D: usize> {
    /// Position of the first node \[m\].
    first: [f64; D],
    size: [usize; D],
    dx: f64,
}

impl<const D: usize> Nodes<D> {
    pub(super) fn around(bounds: &Bounds<D>, origin: [f64; D], dx: f64) -> Self {
        /// Nodes beyond a cell that its particles may touch, including those with a weight of 0.
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

    /// Returns the difference between the numbers of neighbors along `axis`.
    pub(super) fn stride(&self, axis: usize) -> usize {
        self.size[..axis].iter().product()
    }

    pub(super) fn size(&self, axis: usize) -> usize {
        self.size[axis]
    }

    /// Returns the base node of a coordinate \[m\] along one axis, and the distance from it \[cells\], as in
    /// [`lahar::kernel`].
    #[inline(always)]
    pub(super) fn base<K: BSpline>(&self, axis: usize, x: f64) -> (usize, f64) {
        let cells = (x - self.first[axis]) / self.dx - K::OFFSET;
        let base = cells as usize;
        (base, cells - base as f64)
    }
}
