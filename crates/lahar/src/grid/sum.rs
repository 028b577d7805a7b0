//! From tiles to nodes and back: the sums over tiles, and the copies of nodes that G2P reads.

use super::links::Link;
use super::nodes::{NodeField, Summed};
use super::{BLOCK_NODES, Grid, QUAD, Reach};
use crate::dispatch::on_level;
use crate::material::IsaToken;
use crate::math::Lanes;
use crate::parallel;
use crate::particles::block_edge;
use crate::prefetch::prefetch;
use core::ops::Range;
use fearless_simd::Simd;

/// The smallest number of blocks that is worth a thread's attention.
const SMALLEST_PIECE: usize = 16;

impl<T: Lanes, const D: usize> Grid<T, D> {
    /// Sums the tiles' contributions to each node: (1) and (2), where the particles have brought momentum. Makes the
    /// field in `storage`.
    pub(crate) fn sum<Q: Summed>(&self, isa: IsaToken, mut storage: Vec<T>) -> NodeField<Q, T> {
        let layers = Q::layers(self.layers);
        // Stale numbers are never read: each block is written as a whole.
        storage.resize(
            self.blocks.len() * BLOCK_NODES * QUAD * layers,
            T::default(),
        );
        self.sum_layers(isa, layers, &mut storage);
        NodeField::of(storage, layers)
    }

    /// Sums the first `layers` layers of the tiles to `nodes`.
    fn sum_layers(&self, isa: IsaToken, layers: usize, nodes: &mut [T]) {
        let block_len = BLOCK_NODES * QUAD * layers;
        let grain = parallel::grain(self.blocks.len(), SMALLEST_PIECE);
        parallel::for_chunks(nodes, block_len, 0, grain, &|first, piece| {
            let _flush = crate::float_mode::FlushToZero::enter();
            on_level!(isa.0, simd => {
                for (index, block) in piece.chunks_exact_mut(block_len).enumerate() {
                    self.prefetch_tiles_of(first + index + 1);
                    self.sum_block(simd, first + index, layers, block);
                }
            });
        });
    }

    /// Sums the tiles' contributions to the nodes of a block.
    #[inline(always)]
    fn sum_block<S: Simd>(&self, simd: S, block: usize, layers: usize, nodes: &mut [T]) {
        nodes.fill(T::default());
        for link in self.links.of_block(block) {
            let tile = &self.tiles[link.tile as usize * self.tile_len()..][..self.tile_len()];
            let reach = self.reach[link.tile as usize];
            for layer in 0..layers {
                let from = &tile[layer * self.tile_layer()..];
                let to = &mut nodes[layer * BLOCK_NODES * QUAD..];
                self.for_rows(link, reach, |block_at, tile_at, len| {
                    T::add_quads(simd, &mut to[block_at..][..len], &from[tile_at..][..len]);
                });
            }
        }
    }

    /// Copies the nodes of `field` that tile `tile` covers, as far as `reach`, to `out`.
    #[inline(always)]
    pub(crate) fn copy_tile<Q, S: Simd>(
        &self,
        simd: S,
        field: &NodeField<Q, T>,
        tile: usize,
        reach: Reach<D>,
        out: &mut [T],
    ) {
        let (block_len, nodes) = (field.block_len(), field.numbers());
        for link in self.links.of_tile(tile) {
            let block = &nodes[link.block as usize * block_len..][..block_len];
            for layer in 0..field.layers() {
                let from = &block[layer * BLOCK_NODES * QUAD..];
                let to = &mut out[layer * self.tile_layer()..];
                self.for_rows(link, reach, |block_at, tile_at, len| {
                    T::copy_quads(simd, &mut to[tile_at..][..len], &from[block_at..][..len]);
                });
            }
        }
    }

    /// [`Self::copy_tile`] outside of code that is compiled for an instruction set.
    pub(crate) fn load_tile<Q>(
        &self,
        isa: IsaToken,
        field: &NodeField<Q, T>,
        tile: usize,
        reach: Reach<D>,
        out: &mut [T],
    ) {
        on_level!(isa.0, simd => self.copy_tile(simd, field, tile, reach, out));
    }

    /// Prefetches the numbers that [`Self::sum_block`] reads for `block`, if there is that block.
    #[inline(always)]
    fn prefetch_tiles_of(&self, block: usize) {
        for link in self.links.of_block(block) {
            let tile = link.tile as usize * self.tile_len();
            self.for_spans(link, self.reach[link.tile as usize], |_, span| {
                prefetch(&self.tiles[tile + span.start..][..span.len()]);
            });
        }
    }

    /// Prefetches the numbers that [`Self::copy_tile`] reads for `tile`.
    #[inline(always)]
    pub(crate) fn prefetch_nodes_of<Q>(
        &self,
        field: &NodeField<Q, T>,
        tile: usize,
        reach: Reach<D>,
    ) {
        for link in self.links.of_tile(tile) {
            let block = link.block as usize * field.block_len();
            self.for_spans(link, reach, |span, _| {
                prefetch(&field.numbers()[block + span.start..][..span.len()]);
            });
        }
    }

    /// Calls `row(place in the block, place in the tile, numbers)` for each run of nodes of `link` within
    /// `reach`.
    #[inline(always)]
    fn for_rows(&self, link: &Link<D>, reach: Reach<D>, mut row: impl FnMut(usize, usize, usize)) {
        let Some((low, high)) = link.within(reach) else {
            return;
        };
        let len = (high[D - 1] - low[D - 1]) * QUAD;
        for i in low[0]..high[0] {
            if D == 2 {
                let (in_block, in_tile) = self.places(link, [i, low[1], 0]);
                row(in_block, in_tile, len);
            } else {
                for j in low[1]..high[1] {
                    let (in_block, in_tile) = self.places(link, [i, j, low[D - 1]]);
                    row(in_block, in_tile, len);
                }
            }
        }
    }

    /// Calls `span(places in the block, places in the tile)` for the nodes of `link` within `reach`, of each
    /// index on the first axis: from the first to the last, with others between.
    #[inline(always)]
    fn for_spans(
        &self,
        link: &Link<D>,
        reach: Reach<D>,
        mut span: impl FnMut(Range<usize>, Range<usize>),
    ) {
        let Some((low, high)) = link.within(reach) else {
            return;
        };
        for i in low[0]..high[0] {
            let first = self.places(link, [i, low[1], low[D - 1]]);
            let last = self.places(link, [i, high[1] - 1, high[D - 1] - 1]);
            span(first.0..last.0 + QUAD, first.1..last.1 + QUAD);
        }
    }

    /// Where the quad of a node of `link` is in its block and in its tile; in 2D the third index is not used.
    #[inline(always)]
    fn places(&self, link: &Link<D>, node: [usize; 3]) -> (usize, usize) {
        let (mut in_block, mut in_tile) = (0, 0);
        for axis in 0..D {
            let of_tile = (node[axis] as isize + link.shift[axis] as isize) as usize;
            in_block = in_block * block_edge(D) + node[axis];
            in_tile = in_tile * self.tile_edge + of_tile;
        }
        (in_block * QUAD, in_tile * QUAD)
    }
}
