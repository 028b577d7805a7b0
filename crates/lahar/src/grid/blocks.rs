//! Blocks: boxes of 64 nodes that exist only where they are needed.

use crate::particles::block_edge;

/// Nodes per block, in 2D and 3D.
pub const BLOCK_NODES: usize = 64;

/// A set of blocks, and how its axes wrap around. Block `b` holds the nodes `edge b .. edge (b + 1)` on each axis, with
/// an edge of 8 nodes in 2D and 4 nodes in 3D. The last axis varies fastest within a block.
///
/// ```
/// use lahar::grid::Blocks;
///
/// let blocks = Blocks::<2>::new(vec![[3, 0], [0, 0], [3, 0]], [Some(32), None]);
/// assert_eq!(blocks.coordinates(), [[0, 0], [3, 0]]);
/// assert_eq!(blocks.find([1, 2]), Some((0, 10)));
/// assert_eq!(blocks.find([-1, 2]), Some((1, 58)), "an axis of 32 nodes wraps around");
/// assert_eq!(blocks.find([1, -1]), None);
/// ```
#[derive(Clone, Debug)]
pub struct Blocks<const D: usize> {
    pub(super) coordinates: Vec<[i32; D]>,
    pub(super) period: [Option<i64>; D],
}

impl<const D: usize> Blocks<D> {
    /// Makes the set of the blocks at `coordinates`, given in any order; `period` are the numbers of nodes along the
    /// periodic axes.
    pub fn new(mut coordinates: Vec<[i32; D]>, period: [Option<i64>; D]) -> Self {
        coordinates.sort_unstable();
        coordinates.dedup();
        Self {
            coordinates,
            period,
        }
    }

    /// Returns how many blocks there are.
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }

    /// Returns true if there are no blocks.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// Returns the blocks' coordinates, ascending.
    pub fn coordinates(&self) -> &[[i32; D]] {
        &self.coordinates
    }

    /// Returns the index of the first node of block number `block`.
    pub fn first_node(&self, block: usize) -> [i64; D] {
        self.coordinates[block].map(|b| i64::from(b) * block_edge(D) as i64)
    }

    /// Returns the index of node number `local` of block number `block`.
    #[inline(always)]
    pub fn node(&self, block: usize, local: usize) -> [i64; D] {
        let first = self.first_node(block);
        core::array::from_fn(|axis| first[axis] + axis_index::<D>(local, axis) as i64)
    }

    /// Finds a node: the number of its block, if there is that block, and its own number there.
    pub fn find(&self, node: [i64; D]) -> Option<(usize, usize)> {
        let edge = block_edge(D) as i64;
        let node: [i64; D] = core::array::from_fn(|axis| match self.period[axis] {
            Some(period) => node[axis].rem_euclid(period),
            None => node[axis],
        });
        let block = node.map(|index| index.div_euclid(edge) as i32);
        let local = node
            .iter()
            .fold(0, |at, index| at * edge + index.rem_euclid(edge));
        let block = self.coordinates.binary_search(&block).ok()?;
        Some((block, local as usize))
    }
}

/// Index of node number `local` of a block on one axis.
#[inline(always)]
pub(super) const fn axis_index<const D: usize>(local: usize, axis: usize) -> usize {
    let edge = block_edge(D);
    match D - 1 - axis {
        0 => local % edge,
        1 => local / edge % edge,
        _ => local / (edge * edge),
    }
}
