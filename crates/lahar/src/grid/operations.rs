//! Vectors over the nodes, and the operations that iterative solvers are made of: products, sums and linear operators.
//!
//! The order of each sum depends on the number of blocks only. Results have the same bits on any number of threads.
//!
//! ```
//! use lahar::grid::operations::{Halos, NodeOperator, NodeVector, Neighborhood};
//! use lahar::grid::{BLOCK_NODES, Blocks};
//!
//! /// −Δ by central differences, times dx²; zero outside of the blocks.
//! struct MinusLaplacian;
//!
//! impl NodeOperator<f64, 1, 2> for MinusLaplacian {
//!     fn apply_to_block(&self, x: &Neighborhood<f64, 1, 2>, out: &mut [[f64; 1]; BLOCK_NODES]) {
//!         for (node, out) in out.iter_mut().enumerate() {
//!             let beside = [[-1, 0], [1, 0], [0, -1], [0, 1]].map(|offset| x.at(node, offset)[0]);
//!             out[0] = 4.0 * x.at(node, [0, 0])[0] - beside.iter().sum::<f64>();
//!         }
//!     }
//! }
//!
//! // A x = b by steepest descent.
//! let blocks = Blocks::<2>::new(vec![[0, 0], [0, 1]], [None; 2]);
//! let halos = Halos::of(&blocks);
//! let (mut x, mut a_r) = (NodeVector::zeros(blocks.len()), NodeVector::zeros(blocks.len()));
//! let mut r = NodeVector::zeros(blocks.len());
//! let block = 0;
//! r.block_mut(block)[20] = [1.0]; // b, and the first residual, since x is 0
//! for _ in 0..500 {
//!     a_r.apply(&MinusLaplacian, &r, &halos);
//!     let step = r.dot(&r) / r.dot(&a_r);
//!     x.axpy(step, &r);
//!     r.axpy(-step, &a_r);
//! }
//! assert!(r.dot(&r) < 1e-18);
//! ```

use super::blocks::{BLOCK_NODES, Blocks};
use super::links::Link;
use super::tiles::{Piece, Reach, axis_pieces};
use crate::float_mode::FlushToZero;
use crate::math::Scalar;
use crate::parallel;
use crate::particles::block_edge;

/// Blocks that are summed one after the other; sums of as many are added in a tree. Part of the bits of [`dot`].
///
/// [`dot`]: NodeVector::dot
const BLOCKS_PER_LEAF: usize = 32;

/// Sums that are kept side by side within a block, so that they can be computed in one register.
const LANES: usize = 8;

/// The smallest number of blocks that is worth a thread's attention.
const SMALLEST_PIECE: usize = 16;

/// `N` numbers per node, block after block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeVector<T, const N: usize> {
    nodes: Vec<[T; N]>,
}

impl<T: Scalar, const N: usize> NodeVector<T, N> {
    /// Makes the zero vector over `blocks` blocks.
    pub fn zeros(blocks: usize) -> Self {
        let mut vector = Self { nodes: Vec::new() };
        vector.resize(blocks);
        vector
    }

    /// Changes the number of blocks. Numbers of new blocks are zero; the others belong to other nodes now.
    pub fn resize(&mut self, blocks: usize) {
        self.nodes.resize(blocks * BLOCK_NODES, [T::default(); N]);
    }

    /// Returns the numbers of all nodes, block after block.
    pub fn nodes(&self) -> &[[T; N]] {
        &self.nodes
    }

    /// Returns the numbers of the nodes of a block, to change.
    ///
    /// # Panics
    /// If there is no such block.
    pub fn block_mut(&mut self, block: usize) -> &mut [[T; N]] {
        &mut self.nodes[block * BLOCK_NODES..][..BLOCK_NODES]
    }

    /// Replaces all numbers: calls `write(block, numbers of its nodes)` for each block, on all threads.
    pub fn fill_with(&mut self, write: impl Fn(usize, &mut [[T; N]; BLOCK_NODES]) + Sync) {
        self.for_blocks(&write);
    }

    /// Returns the scalar product with `other`: products and sums are computed in `f64`.
    ///
    /// # Panics
    /// If the vectors are of different length.
    pub fn dot(&self, other: &Self) -> f64 {
        self.check_length(other);
        let _flush = FlushToZero::enter();
        dot_tree(self.nodes.as_flattened(), other.nodes.as_flattened(), N)
    }

    /// Adds `factor` times `x`, rounded once per product and once per sum.
    ///
    /// # Panics
    /// If the vectors are of different length.
    pub fn axpy(&mut self, factor: f64, x: &Self) {
        self.check_length(x);
        let factor = T::from_f64(factor);
        self.for_blocks(&|block, nodes| {
            let x = x.nodes[block * BLOCK_NODES..][..BLOCK_NODES].as_flattened();
            for (y, &x) in nodes.as_flattened_mut().iter_mut().zip(x) {
                *y += factor * x;
            }
        });
    }

    /// Multiplies all numbers by `factor`.
    pub fn scale(&mut self, factor: f64) {
        let factor = T::from_f64(factor);
        self.for_blocks(&|_, nodes| {
            for y in nodes.as_flattened_mut() {
                *y *= factor;
            }
        });
    }

    /// Makes this vector `operator` applied to `x`.
    ///
    /// # Panics
    /// If the vectors and `halos` are not of the same blocks.
    pub fn apply<const D: usize>(
        &mut self,
        operator: &impl NodeOperator<T, N, D>,
        x: &Self,
        halos: &Halos<D>,
    ) {
        self.check_length(x);
        assert_eq!(halos.blocks() * BLOCK_NODES, x.nodes.len());
        self.for_blocks(&|block, out| {
            operator.apply_to_block(&Neighborhood::of(block, x, halos), out);
        });
    }

    fn check_length(&self, other: &Self) {
        assert_eq!(self.nodes.len(), other.nodes.len(), "of as many blocks");
    }

    /// Calls `work(block, numbers of its nodes)` for each block, on all threads.
    fn for_blocks(&mut self, work: &(impl Fn(usize, &mut [[T; N]; BLOCK_NODES]) + Sync)) {
        self.for_pieces(SMALLEST_PIECE, &|first, piece| {
            let blocks = piece.as_chunks_mut::<BLOCK_NODES>().0;
            for (index, block) in blocks.iter_mut().enumerate() {
                work(first + index, block);
            }
        });
    }

    /// Calls `work(first block, numbers of some blocks)` for pieces of at least `smallest` blocks, on all threads.
    pub(crate) fn for_pieces(
        &mut self,
        smallest: usize,
        work: &(impl Fn(usize, &mut [[T; N]]) + Sync),
    ) {
        let grain = parallel::grain(self.nodes.len() / BLOCK_NODES, smallest);
        parallel::for_chunks(&mut self.nodes, BLOCK_NODES, 0, grain, &|first, piece| {
            let _flush = FlushToZero::enter();
            work(first, piece);
        });
    }
}

/// The scalar product of vectors with `n` numbers per node, by halves. Where a list is halved depends on its length only.
fn dot_tree<T: Scalar>(a: &[T], b: &[T], n: usize) -> f64 {
    let block_len = BLOCK_NODES * n;
    let blocks = a.len() / block_len;
    if blocks <= BLOCKS_PER_LEAF {
        return a
            .chunks_exact(block_len)
            .zip(b.chunks_exact(block_len))
            .map(|(a, b)| dot_of_block(a, b))
            .sum();
    }
    let middle = blocks / 2 * block_len;
    let ((a_low, a_high), (b_low, b_high)) = (a.split_at(middle), b.split_at(middle));
    let (low, high) = parallel::join(
        || dot_tree(a_low, b_low, n),
        || {
            let _flush = FlushToZero::enter();
            dot_tree(a_high, b_high, n)
        },
    );
    low + high
}

/// The scalar product over the nodes of one block.
fn dot_of_block<T: Scalar>(a: &[T], b: &[T]) -> f64 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for lane in 0..LANES {
            sums[lane] += a[lane].to_f64() * b[lane].to_f64();
        }
    }
    sums.iter().sum()
}

/// A linear operator on [`NodeVector`]s that takes the value at a node from the node and its neighbors: those at most
/// one node away on each axis.
pub trait NodeOperator<T, const N: usize, const D: usize>: Sync {
    /// Writes the values at the nodes of one block to `out`, from the vector `x` around that block.
    fn apply_to_block(&self, x: &Neighborhood<T, N, D>, out: &mut [[T; N]; BLOCK_NODES]);
}

/// For each block, the parts of blocks that it and one node around it lie in.
#[derive(Clone, Debug)]
pub struct Halos<const D: usize> {
    links: Vec<Link<D>>,
    /// By block, its first link; and the number of links.
    starts: Vec<u32>,
}

impl<const D: usize> Halos<D> {
    /// Finds the halos of `blocks`.
    pub fn of(blocks: &Blocks<D>) -> Self {
        let edge = block_edge(D) + 2;
        let (mut links, mut starts) = (Vec::new(), vec![0]);
        let mut pieces: [Vec<Piece>; D] = core::array::from_fn(|_| Vec::new());
        for (number, block) in blocks.coordinates().iter().enumerate() {
            for axis in 0..D {
                axis_pieces::<D>(block[axis], edge, blocks.period[axis], &mut pieces[axis]);
            }
            let combinations: usize = pieces.iter().map(Vec::len).product();
            for combination in 0..combinations {
                let mut left = combination;
                let piece: [Piece; D] = core::array::from_fn(|axis| {
                    let piece = pieces[axis][left % pieces[axis].len()];
                    left /= pieces[axis].len();
                    piece
                });
                let owner = piece.map(|piece| piece.block);
                if let Ok(owner) = blocks.coordinates().binary_search(&owner) {
                    links.push(Link::new(owner, number, piece));
                }
            }
            starts.push(links.len() as u32);
        }
        Self { links, starts }
    }

    /// Returns how many blocks there are.
    pub fn blocks(&self) -> usize {
        self.starts.len() - 1
    }

    fn of_block(&self, block: usize) -> &[Link<D>] {
        &self.links[self.starts[block] as usize..self.starts[block + 1] as usize]
    }
}

/// Nodes of a block and one node around it: those of 2D, which are more than the 6³ of 3D.
const LARGEST_NEIGHBORHOOD: usize = {
    let (flat, deep) = ((block_edge(2) + 2).pow(2), (block_edge(3) + 2).pow(3));
    if flat > deep { flat } else { deep }
};

/// The numbers of a vector at the nodes of one block and one node around it.
#[derive(Debug)]
pub struct Neighborhood<T, const N: usize, const D: usize> {
    block: usize,
    nodes: [[T; N]; LARGEST_NEIGHBORHOOD],
}

impl<T: Scalar, const N: usize, const D: usize> Neighborhood<T, N, D> {
    const EDGE: usize = block_edge(D) + 2;

    /// Copies the nodes of `x` around `block`; zeros where there is no block.
    fn of(block: usize, x: &NodeVector<T, N>, halos: &Halos<D>) -> Self {
        let mut nodes = [[T::default(); N]; LARGEST_NEIGHBORHOOD];
        for link in halos.of_block(block) {
            let Some((low, high)) = link.within(Reach::WHOLE) else {
                continue;
            };
            let from = &x.nodes[link.block as usize * BLOCK_NODES..][..BLOCK_NODES];
            let last = D - 1;
            let mut node = low;
            loop {
                let (in_block, in_halo) = Self::places(link, node);
                let len = high[last] - low[last];
                nodes[in_halo..][..len].copy_from_slice(&from[in_block..][..len]);
                // The next row.
                let Some(axis) = (0..last).rev().find(|&axis| node[axis] + 1 < high[axis]) else {
                    break;
                };
                node[axis] += 1;
                node[axis + 1..last].copy_from_slice(&low[axis + 1..last]);
            }
        }
        Self { block, nodes }
    }

    /// Where a node of `link` is in its block and in the neighborhood.
    fn places(link: &Link<D>, node: [usize; D]) -> (usize, usize) {
        let (mut in_block, mut in_halo) = (0, 0);
        for axis in 0..D {
            let of_halo = (node[axis] as isize + link.shift[axis] as isize) as usize;
            in_block = in_block * block_edge(D) + node[axis];
            in_halo = in_halo * Self::EDGE + of_halo;
        }
        (in_block, in_halo)
    }

    /// Returns the number of the block.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Returns the numbers at the node that is `offset` away from node `local` of the block; zeros if its block does not
    /// exist. Each offset is −1, 0 or 1.
    #[inline(always)]
    pub fn at(&self, local: usize, offset: [isize; D]) -> [T; N] {
        let mut place = 0;
        for axis in 0..D {
            let index = super::blocks::axis_index::<D>(local, axis) as isize + 1 + offset[axis];
            place = place * Self::EDGE + index as usize;
        }
        self.nodes[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differs from node to node and is not symmetric: the sum over neighbors of weights by block, node and offset.
    struct Weights;

    impl Weights {
        fn weight<const D: usize>(block: usize, local: usize, offset: [isize; D]) -> f64 {
            let direction = offset.iter().fold(0, |code, o| 3 * code + o);
            ((block * 31 + local * 7) as f64 + 13.0 * direction as f64).sin()
        }

        fn offsets<const D: usize>() -> impl Iterator<Item = [isize; D]> {
            (0..3_usize.pow(D as u32)).map(|code| {
                core::array::from_fn(|axis| (code / 3_usize.pow(axis as u32) % 3) as isize - 1)
            })
        }
    }

    impl<T: Scalar, const D: usize> NodeOperator<T, 2, D> for Weights {
        fn apply_to_block(&self, x: &Neighborhood<T, 2, D>, out: &mut [[T; 2]; BLOCK_NODES]) {
            for (local, out) in out.iter_mut().enumerate() {
                let mut sum = [T::default(); 2];
                for offset in Self::offsets::<D>() {
                    let weight = T::from_f64(Self::weight(x.block(), local, offset));
                    let [a, b] = x.at(local, offset);
                    sum = [sum[0] + weight * a, sum[1] + weight * b];
                }
                *out = sum;
            }
        }
    }

    fn some_blocks<const D: usize>(count: usize, period: [Option<i64>; D]) -> Blocks<D> {
        let edge = block_edge(D) as i64;
        let mut state = 12345_u32;
        let coordinates = (0..count).map(|_| {
            core::array::from_fn(|axis| {
                state = state.wrapping_mul(1664525).wrapping_add(1013904223);
                let blocks = period[axis].map_or(9, |period| (period + edge - 1) / edge);
                ((state >> 8) % blocks as u32) as i32 - if period[axis].is_some() { 0 } else { 4 }
            })
        });
        Blocks::new(coordinates.collect(), period)
    }

    fn some_vector<T: Scalar>(blocks: usize, seed: f64) -> NodeVector<T, 2> {
        let mut vector = NodeVector::zeros(blocks);
        vector.fill_with(|block, nodes| {
            for (node, numbers) in nodes.iter_mut().enumerate() {
                let at = (block * BLOCK_NODES + node) as f64;
                *numbers = [1.0, 2.0].map(|k| T::from_f64((seed + k * at).sin()));
            }
        });
        vector
    }

    /// Compares with sums over all nodes, found one by one.
    fn check<const D: usize>(period: [Option<i64>; D]) {
        let blocks = some_blocks::<D>(60, period);
        let x = some_vector::<f64>(blocks.len(), 0.3);
        let y = some_vector::<f64>(blocks.len(), 0.7);
        let mut result = NodeVector::zeros(blocks.len());
        result.apply(&Weights, &x, &Halos::of(&blocks));
        for block in 0..blocks.len() {
            for local in 0..BLOCK_NODES {
                let node = blocks.node(block, local);
                // Nodes of the last block that are beyond the period do not exist.
                if (0..D).any(|axis| period[axis].is_some_and(|period| node[axis] >= period)) {
                    continue;
                }
                let mut sum = [0.0; 2];
                for offset in Weights::offsets::<D>() {
                    let beside = core::array::from_fn(|axis| node[axis] + offset[axis] as i64);
                    if let Some((owner, beside)) = blocks.find(beside) {
                        let weight = Weights::weight(block, local, offset);
                        let x = x.nodes()[owner * BLOCK_NODES + beside];
                        sum = [sum[0] + weight * x[0], sum[1] + weight * x[1]];
                    }
                }
                assert_eq!(result.nodes()[block * BLOCK_NODES + local], sum, "{node:?}");
            }
        }

        let flat = |v: &NodeVector<f64, 2>| v.nodes().as_flattened().to_vec();
        let dense: f64 = flat(&x).iter().zip(flat(&y)).map(|(x, y)| x * y).sum();
        assert!((x.dot(&y) - dense).abs() < 1e-10 * x.dot(&x));
        let mut sum = y.clone();
        sum.axpy(0.5, &x);
        sum.scale(-3.0);
        for ((sum, x), y) in flat(&sum).iter().zip(flat(&x)).zip(flat(&y)) {
            assert_eq!(*sum, -3.0 * (y + 0.5 * x));
        }
    }

    #[test]
    fn operations_agree_with_dense_arithmetic() {
        check::<2>([None; 2]);
        check::<2>([Some(21), None]);
        check::<3>([None; 3]);
        check::<3>([None, Some(8), Some(5)]);
    }

    #[cfg(feature = "threads")]
    #[test]
    fn bits_do_not_depend_on_threads() {
        let blocks = some_blocks::<3>(400, [None; 3]);
        assert!(blocks.len() > 4 * BLOCKS_PER_LEAF);
        let run = || {
            let x = some_vector::<f32>(blocks.len(), 0.1);
            let mut y = some_vector::<f32>(blocks.len(), 0.2);
            y.apply(&Weights, &x, &Halos::of(&blocks));
            y.axpy(0.3, &x);
            y.scale(1.7);
            (x.dot(&y).to_bits(), y)
        };
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(run)
        };
        let serial = on(1);
        for threads in [2, 3, 8] {
            assert_eq!(on(threads), serial, "{threads} threads");
        }
    }
}
