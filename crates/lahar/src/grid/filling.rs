//! How full the grid is, by what particles say of their volumes: (7h), (7i).
//!
//! Particles bring their rest volume V⁰ and V⁰ (J − 1), all of them and those of one fluid apart: a
//! node's quad. Nodes answer with the fluid's mean J − 1, and with how much more room the particles
//! around say they take than there is.

use super::{BLOCK_NODES, Grid, QUAD, axis_index};
use crate::boundary::walls::Walls;
use crate::material::IsaToken;
use crate::math::Lanes;
use crate::parallel;
use crate::store::block_edge;
use crate::transfer::LARGEST_TILE;

/// A node whose cell is less full than this is outside of the bodies. Far from both 0 and 1, so that
/// the unevenness of particles, some percent, does not decide which nodes are asked.
pub(crate) const OUTSIDE: f64 = 0.5;

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
        excess.resize(self.tile_blocks.len() * BLOCK_NODES, T::default());
        let grain = parallel::grain(self.tile_blocks.len(), 16);
        let this = &*self;
        parallel::for_chunks(&mut excess, BLOCK_NODES, 0, grain, &|first, piece| {
            let _flush = crate::float_mode::FlushToZero::enter();
            let mut tile = [T::default(); LARGEST_TILE];
            for (index, excess) in piece.chunks_exact_mut(BLOCK_NODES).enumerate() {
                this.load_tile(first + index, &mut tile);
                this.excess(first + index, &tile, walls, cell, excess);
            }
        });
        self.excess = excess;
        let apart = self.excess_without_tiles(walls, cell);
        self.answer();
        for (place, excess) in apart {
            self.nodes[place + EXCESS] = excess;
        }
        // Nodes beyond walls answer as their images do.
        self.columns
            .mirror_answers(&mut self.nodes, self.planes, EXCESS);
    }

    /// The excess on the nodes of tile number `index`'s own block.
    fn excess(&self, index: usize, tile: &[T], walls: &Walls<D>, cell: T, out: &mut [T]) {
        let edge = block_edge(D) as i64;
        let first = self.tile_blocks[index].map(|block| i64::from(block) * edge);
        let tile_edge = self.tile_edge as i64;
        // A tile begins one node before its block.
        let quad_of = |node: [i64; D]| {
            let at = (0..D).fold(0, |at, axis| {
                at * tile_edge + (node[axis] - first[axis] + 1)
            });
            &tile[at as usize * QUAD..][..QUAD]
        };
        for (local, out) in out.iter_mut().enumerate() {
            let node =
                core::array::from_fn(|axis| first[axis] + axis_index::<D>(local, axis) as i64);
            *out = excess_at(node, walls, cell, |node| Some(quad_of(node)));
        }
    }

    /// The excess on the nodes of blocks that no particle is in, where it is not zero: by the place of
    /// the node's quad. Few nodes there are full.
    fn excess_without_tiles(&self, walls: &Walls<D>, cell: T) -> Vec<(usize, T)> {
        let edge = block_edge(D) as i64;
        let full = cell * T::from_f64(OUTSIDE);
        let mut found = Vec::new();
        for (block, coordinates) in self.blocks.iter().enumerate() {
            if self.tile_blocks.binary_search(coordinates).is_ok() {
                continue;
            }
            for local in 0..BLOCK_NODES {
                let place = block * self.block_len() + local * QUAD;
                if self.nodes[place] >= full {
                    let node = core::array::from_fn(|axis| {
                        i64::from(coordinates[axis]) * edge + axis_index::<D>(local, axis) as i64
                    });
                    let excess = excess_at(node, walls, cell, |node| {
                        Some(&self.nodes[self.quad_of_node(walls.canonical(node))?..][..QUAD])
                    });
                    found.push((place, excess));
                }
            }
        }
        found
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
        let mut tile = 0;
        let zero = T::default();
        let block_len = self.block_len();
        for (block, nodes) in self
            .blocks
            .iter()
            .zip(self.nodes.chunks_exact_mut(block_len))
        {
            while self.tile_blocks.get(tile).is_some_and(|of| of < block) {
                tile += 1;
            }
            let excess = (self.tile_blocks.get(tile) == Some(block))
                .then(|| &self.excess[tile * BLOCK_NODES..][..BLOCK_NODES]);
            let quads = nodes[..BLOCK_NODES * QUAD].chunks_exact_mut(QUAD);
            for (local, quad) in quads.enumerate() {
                let mean = if quad[2] > zero {
                    quad[3] / quad[2] // (7h)
                } else {
                    zero
                };
                quad.fill(zero);
                quad[MEAN] = mean;
                quad[EXCESS] = excess.map_or(zero, |excess| excess[local]);
            }
        }
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
        Some(volumes) if inside => (volumes[0] + volumes[1]) / cell - T::from_f64(1.0), // (7i)
        _ => T::default(),
    }
}

/// The nodes around `node`, itself among them.
fn neighbours<const D: usize>(node: [i64; D]) -> impl Iterator<Item = [i64; D]> {
    (0..3_usize.pow(D as u32)).map(move |number| {
        core::array::from_fn(|axis| node[axis] + (number / 3_usize.pow(axis as u32) % 3) as i64 - 1)
    })
}
