//! How full the grid is, by what particles say of their volumes: (7h), (7i).
//!
//! Particles bring their rest volume V⁰ and V⁰ (J − 1), all of them and those of one fluid apart: a
//! node's quad. Nodes answer with the fluid's mean J − 1, and with how much more room the particles
//! around say they take than there is.

use super::{BLOCK_NODES, Grid, QUAD, Reach, axis_index};
use crate::boundary::walls::Walls;
use crate::material::IsaToken;
use crate::math::Lanes;
use crate::parallel;
use crate::particles::block_edge;
use crate::transfer::TileCopy;

/// A node whose cell is less full than this is outside of the bodies. Far from both 0 and 1, so that
/// the unevenness of particles, some percent, does not decide which nodes are asked.
pub(crate) const OUTSIDE: f64 = 0.5;

/// Nodes along a block, in 2D; fewer in 3D.
const LARGEST_EDGE: usize = block_edge(2);

/// What the nodes answer, as a quad.
const MEAN: usize = 0;
const EXCESS: usize = 1;

impl<T: Lanes, const D: usize> Grid<T, D> {
    /// Sums the tiles' quads [Σ w V⁰, Σ w V⁰ (J − 1), the same two of the fluid that is set right],
    /// and replaces each node's by [the fluid's mean J − 1, the excess, 0, 0].
    ///
    /// The excess is Σ w V⁰ J / Δx^d − 1 on nodes inside: no neighbour that the walls do not hide is
    /// outside of the bodies. Elsewhere it is zero: near a free surface the sum does not see all of a
    /// cell.
    pub(crate) fn measure_filling(&mut self, isa: IsaToken, walls: &Walls<D>, dx: f64) {
        self.sum_tiles(isa);
        self.columns.mirror_volumes(&mut self.nodes, self.planes);
        let cell = T::from_f64(dx.powi(D as i32));
        let mut excess = core::mem::take(&mut self.excess);
        excess.resize(self.blocks.len() * BLOCK_NODES, T::default());
        let grain = parallel::grain(self.blocks.len(), 16);
        let this = &*self;
        parallel::for_chunks(&mut excess, BLOCK_NODES, 0, grain, &|first, piece| {
            let _flush = crate::float_mode::FlushToZero::enter();
            let mut tile = TileCopy::new();
            for (index, excess) in piece.chunks_exact_mut(BLOCK_NODES).enumerate() {
                let block = first + index;
                match this.tile_blocks.binary_search(&this.blocks[block]) {
                    Ok(number) => {
                        this.load_tile(isa, number, Reach::WHOLE, &mut tile.0);
                        this.excess(block, &tile.0, walls, cell, excess);
                    }
                    Err(_) => this.excess_without_tile(block, walls, cell, excess),
                }
            }
        });
        self.excess = excess;
        self.answer();
        // Nodes beyond walls answer as their images do.
        self.columns
            .mirror_answers(&mut self.nodes, self.planes, EXCESS);
    }

    /// The excess on the nodes of a block that has a tile: what [`excess_at`] says, for a row of nodes at a
    /// time. A tile begins one node before its block.
    fn excess(&self, block: usize, tile: &[T], walls: &Walls<D>, cell: T, out: &mut [T]) {
        let edge = block_edge(D);
        let full = cell * T::from_f64(OUTSIDE);
        let before = self.blocks[block].map(|b| i64::from(b) * edge as i64 - 1);
        // The nodes on an axis that are behind a wall, a bit each: the block's and one on either side.
        let behind: [u32; D] = core::array::from_fn(|axis| {
            let is_behind = |node: usize| walls.is_behind_on(axis, before[axis] + node as i64);
            (0..edge + 2).fold(0, |bits, node| bits | u32::from(is_behind(node)) << node)
        });
        let all = (1 << (edge + 2)) - 1;
        // Rows along the last axis, of nodes that are full or behind a wall; [i][j], or [0][i] in 2D.
        let planes = if D == 2 { 1 } else { edge + 2 };
        let row_at = |i: usize, j: usize| (i * self.tile_edge + j) * self.tile_edge;
        let hidden = |i: usize, j: usize| {
            let by_i = D == 3 && behind[0] >> i & 1 == 1;
            by_i || behind[D - 2] >> j & 1 == 1
        };
        let mut rows = [[0_u32; LARGEST_EDGE + 2]; LARGEST_EDGE + 2];
        for i in 0..planes {
            for j in 0..edge + 2 {
                let quads = &tile[row_at(i, j) * QUAD..][..(edge + 2) * QUAD];
                let volumes = quads.chunks_exact(QUAD).map(|quad| quad[0]).enumerate();
                let is_full =
                    volumes.fold(0, |bits, (k, volume)| bits | u32::from(volume >= full) << k);
                let row = is_full | behind[D - 1] | if hidden(i, j) { all } else { 0 };
                // Its neighbours on the row, too.
                rows[i][j] = row & row >> 1 & row << 1;
            }
        }
        for (row, out) in out.chunks_exact_mut(edge).enumerate() {
            let (i, j) = if D == 2 {
                (0, row + 1)
            } else {
                (row / edge + 1, row % edge + 1)
            };
            let beside = if D == 2 { 0..=0 } else { i - 1..=i + 1 };
            let around = beside.flat_map(|i| &rows[i][j - 1..=j + 1]);
            let mut inside = around.fold(all, |inside, row| inside & row) & !behind[D - 1];
            if hidden(i, j) {
                inside = 0;
            }
            for (k, out) in out.iter_mut().enumerate() {
                let volumes = &tile[(row_at(i, j) + k + 1) * QUAD..][..QUAD];
                *out = if inside >> (k + 1) & 1 == 1 {
                    excess_of(volumes, cell)
                } else {
                    T::default()
                };
            }
        }
    }

    /// The excess on the nodes of a block that no particle is in. Few of them are full.
    fn excess_without_tile(&self, block: usize, walls: &Walls<D>, cell: T, out: &mut [T]) {
        let edge = block_edge(D) as i64;
        let full = cell * T::from_f64(OUTSIDE);
        let first = self.blocks[block].map(|b| i64::from(b) * edge);
        for (local, out) in out.iter_mut().enumerate() {
            let volume = self.nodes[block * self.block_len() + local * QUAD];
            *out = T::default();
            if volume >= full {
                let node =
                    core::array::from_fn(|axis| first[axis] + axis_index::<D>(local, axis) as i64);
                *out = excess_at(node, walls, cell, |node| {
                    Some(&self.nodes[self.quad_of_node(walls.canonical(node))?..][..QUAD])
                });
            }
        }
    }

    /// Where the quad of a node is, if there is that node.
    fn quad_of_node(&self, node: [i64; D]) -> Option<usize> {
        let edge = block_edge(D) as i64;
        let block = node.map(|index| index.div_euclid(edge) as i32);
        let local = node
            .iter()
            .fold(0, |at, index| at * edge + index.rem_euclid(edge));
        let block = self.blocks.binary_search(&block).ok()?;
        Some(block * self.block_len() + local as usize * QUAD)
    }

    /// Replaces the nodes' quads by their answers.
    fn answer(&mut self) {
        let block_len = self.block_len();
        let grain = parallel::grain(self.blocks.len(), 64);
        let excess = &self.excess;
        parallel::for_chunks(&mut self.nodes, block_len, 0, grain, &|first, piece| {
            let _flush = crate::float_mode::FlushToZero::enter();
            let of_piece = excess[first * BLOCK_NODES..].chunks_exact(BLOCK_NODES);
            for (nodes, excess) in piece.chunks_exact_mut(block_len).zip(of_piece) {
                let quads = nodes[..BLOCK_NODES * QUAD].chunks_exact_mut(QUAD);
                for (quad, &excess) in quads.zip(excess) {
                    let mean = if quad[2] > T::default() {
                        quad[3] / quad[2] // (7h)
                    } else {
                        T::default()
                    };
                    quad.fill(T::default());
                    quad[MEAN] = mean;
                    quad[EXCESS] = excess;
                }
            }
        });
    }
}

/// The excess at `node`; `quad_of` says what volumes a node has, if there is that node.
fn excess_at<'a, T: Lanes, const D: usize>(
    node: [i64; D],
    walls: &Walls<D>,
    cell: T,
    quad_of: impl Fn([i64; D]) -> Option<&'a [T]>,
) -> T {
    let full = cell * T::from_f64(OUTSIDE);
    let is_full = |node| quad_of(node).is_some_and(|quad| quad[0] >= full);
    let inside = !walls.is_behind_plane(node)
        && is_full(node)
        && neighbours(node).all(|beside| walls.is_behind_plane(beside) || is_full(beside));
    match quad_of(node) {
        Some(volumes) if inside => excess_of(volumes, cell),
        _ => T::default(),
    }
}

/// How much more room the particles around an inner node say they take than there is, in cells.
fn excess_of<T: Lanes>(volumes: &[T], cell: T) -> T {
    (volumes[0] + volumes[1]) / cell - T::from_f64(1.0) // (7i)
}

/// The nodes around `node`, itself among them.
fn neighbours<const D: usize>(node: [i64; D]) -> impl Iterator<Item = [i64; D]> {
    (0..3_usize.pow(D as u32)).map(move |number| {
        core::array::from_fn(|axis| node[axis] + (number / 3_usize.pow(axis as u32) % 3) as i64 - 1)
    })
}
