//! The lattice: positions in the world, in cells from node 0, and relative to the middle of a block.
//!
//! ```text
//! world x [m] ──to_cells──▶ cells from node 0 ──locate──▶ block, u
//!             ◀─to_world──                    ◀──cells──
//! ```

/// Nodes along the edge of a block: a block has 64 nodes in 2D and in 3D.
pub(crate) const fn block_edge(dimension: usize) -> usize {
    if dimension == 2 { 8 } else { 4 }
}

/// The positions of nodes and blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice<const D: usize> {
    /// Distance between nodes \[m\].
    pub(crate) dx: f64,
    /// Position of node 0 \[m\].
    pub(crate) origin: [f64; D],
    /// The kernel's [`OFFSET`](crate::kernel::BSpline::OFFSET) \[cells\].
    pub(crate) offset: f64,
    /// Lengths of the periodic axes \[cells\].
    pub(crate) period: [Option<i64>; D],
}

impl<const D: usize> Lattice<D> {
    /// Converts a position \[m\] to cells from node 0.
    pub(crate) fn to_cells(self, x: [f64; D]) -> [f64; D] {
        core::array::from_fn(|axis| (x[axis] - self.origin[axis]) / self.dx)
    }

    /// Converts a place on `axis`, in cells from node 0, to a coordinate \[m\].
    pub(crate) fn to_world(self, axis: usize, cells: f64) -> f64 {
        self.origin[axis] + self.dx * cells
    }

    /// The point that positions in `block` are stored relative to \[cells\]: the block's middle, shifted by the
    /// kernel's offset. Exact, since all three terms are multiples of one half.
    pub(crate) fn middle(&self, block: [i32; D]) -> [f64; D] {
        let edge = block_edge(D) as f64;
        block.map(|block| edge * (f64::from(block) + 0.5) + self.offset)
    }

    /// Converts a stored position, relative to `block`, to cells from node 0.
    pub(crate) fn cells(&self, block: [i32; D], u: [f64; D]) -> [f64; D] {
        // In this order since the rounding of the sum is part of the run's bits.
        let edge = block_edge(D) as f64;
        core::array::from_fn(|axis| u[axis] + self.offset + edge * (f64::from(block[axis]) + 0.5))
    }

    /// Converts a stored position, relative to `block`, to the world \[m\]; inside the domain on periodic axes.
    pub(crate) fn position(&self, block: [i32; D], u: [f64; D]) -> [f64; D] {
        let cells = self.cells(block, u);
        core::array::from_fn(|axis| {
            let inside = match self.period[axis] {
                Some(period) => cells[axis].rem_euclid(period as f64),
                None => cells[axis],
            };
            self.to_world(axis, inside)
        })
    }

    /// Finds the block of a coordinate, in cells from node 0 on one axis, and the position relative to it.
    pub(crate) fn locate(&self, cells: f64) -> (i32, f64) {
        let edge = block_edge(D) as f64;
        let block = ((cells - self.offset) / edge).floor();
        let u = cells - self.offset - edge * (block + 0.5);
        (block as i32, u)
    }

    /// The distance from `a` to `b` on `axis` \[cells\]; the shorter way round where the axis is periodic.
    pub(crate) fn offset_on(&self, axis: usize, a: f64, b: f64) -> f64 {
        match self.period[axis] {
            Some(period) => (b - a) - period as f64 * ((b - a) / period as f64).round(),
            None => b - a,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Lattice;

    #[test]
    fn a_position_comes_back_from_its_block() {
        let lattice = Lattice::<2> {
            dx: 0.25,
            origin: [-1.0, 3.0],
            offset: 0.5,
            period: [None, Some(16)],
        };
        for x in [[-1.0, 3.0], [7.125, 3.5], [-90.0, 6.75]] {
            let cells = lattice.to_cells(x);
            let place = cells.map(|cells| lattice.locate(cells));
            let (block, u) = (place.map(|(block, _)| block), place.map(|(_, u)| u));
            assert!(u.iter().all(|u| (-4.0..4.0).contains(u)), "{u:?}");
            assert_eq!(lattice.cells(block, u), cells);
            assert_eq!(lattice.position(block, u), x);
            let middle = lattice.middle(block);
            assert_eq!([0, 1].map(|axis| middle[axis] + u[axis]), cells);
        }
        assert_eq!(lattice.offset_on(0, 1.0, 14.0), 13.0);
        assert_eq!(lattice.offset_on(1, 1.0, 14.0), -3.0);
    }
}
