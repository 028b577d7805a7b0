//! The grid: blocks of 64 nodes that exist only where particles are, and the tiles that transfers work on.
//!
//! A *tile* is a block with its halo: all nodes that the block's particles touch, even after they have drifted by one
//! cell. P2G adds to tiles, each of them by one thread. The sum over tiles gives each node what all tiles hold of it.
//! G2P reads a copy of a tile's worth of nodes.
//!
//! ```text
//!            tile of block b (quadratic, edge 4):   nodes −1 .. 7
//!   −1 | 0  1  2  3 | 4  5  6          nodes outside of 0..4 belong to neighbors
//! ```
//!
//! Each node sums its contributions in ascending order of the contributing blocks' coordinates. That order is the
//! definition; it depends neither on threads nor on where the scene lies.
//!
//! A node has a *quad* of four numbers, or two quads where the transfer scheme keeps the impulse of stress apart. One
//! quad of each node of a block or tile is a *layer*. What a quad means is the type of a `NodeField`.

mod blocks;
mod links;
mod nodes;
pub mod operations;
mod sum;
mod tiles;

pub use blocks::{BLOCK_NODES, Blocks};
pub(crate) use nodes::{Filling, Momentum, NodeField, Velocity, Volume};
pub(crate) use tiles::{Reach, Tiles, tile_edge, tile_layer};

use crate::math::Lanes;
use crate::particles::{Group, block_edge};
use crate::setup::Scheme;
use links::Links;

/// Numbers of a node in one layer.
pub(crate) const QUAD: usize = 4;

/// Nodes that are read and written together.
const ROW: usize = 4;

/// Blocks, tiles, and the links between them.
#[derive(Clone)]
pub(crate) struct Grid<T, const D: usize> {
    /// Quads per node of a tile: 2 if the scheme keeps the impulse of stress apart, else 1.
    layers: usize,
    /// Nodes along the edge of a tile.
    tile_edge: usize,
    /// Coordinates of the blocks that particles are in, ascending; each has a tile.
    tile_blocks: Vec<[i32; D]>,
    /// By tile, whether a run has it as its first; while tiles are assigned.
    claimed: Vec<bool>,
    blocks: Blocks<D>,
    links: Links<D>,
    tiles: Vec<T>,
    /// By tile, the nodes that its particles reached in the last P2G.
    reach: Vec<Reach<D>>,
}

impl<T: Lanes, const D: usize> Grid<T, D> {
    /// Makes an empty grid for the kernel and transfer of `scheme`.
    pub(crate) fn new(scheme: Scheme) -> Self {
        Self {
            layers: scheme.layers(),
            tile_edge: tile_edge::<D>(scheme.kernel_nodes()),
            tile_blocks: Vec::new(),
            claimed: Vec::new(),
            blocks: Blocks::new(Vec::new(), [None; D]),
            links: Links::new(),
            tiles: Vec::new(),
            reach: Vec::new(),
        }
    }

    /// The blocks that have nodes.
    pub(crate) fn blocks(&self) -> &Blocks<D> {
        &self.blocks
    }

    /// Bytes of memory that the grid occupies, without the fields on its nodes.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<T>() * self.tiles.capacity()
            + self.links.bytes()
            + size_of::<Reach<D>>() * self.reach.capacity()
            + size_of::<[i32; D]>()
                * (self.blocks.coordinates.capacity() + self.tile_blocks.capacity())
    }

    /// Nodes along the edge of a tile.
    pub(crate) fn tile_edge(&self) -> usize {
        self.tile_edge
    }

    /// Numbers of one layer of a tile, padding included.
    pub(crate) fn tile_layer(&self) -> usize {
        tile_layer::<D>(self.tile_edge)
    }

    /// Numbers of a tile, all layers.
    fn tile_len(&self) -> usize {
        self.tile_layer() * self.layers
    }

    /// The tile of block number `block`, if particles are in it.
    pub(crate) fn tile_of(&self, block: usize) -> Option<usize> {
        let coordinates = &self.blocks.coordinates[block];
        self.tile_blocks.binary_search(coordinates).ok()
    }

    /// The tiles, to add particles to.
    pub(crate) fn tiles_mut(&mut self) -> Tiles<'_, T, D> {
        Tiles {
            first: 0,
            len: self.tile_len(),
            numbers: &mut self.tiles,
            reach: &mut self.reach,
        }
    }

    /// Makes blocks and tiles where the particles of `groups` are, and tells their runs which tile is theirs. `period`
    /// are the numbers of nodes along the periodic axes.
    pub(crate) fn rebuild(&mut self, groups: &mut [Group<T, D>], period: [Option<i64>; D]) {
        self.tile_blocks.clear();
        for group in groups.iter() {
            self.tile_blocks
                .extend(group.runs.iter().map(|run| run.block));
        }
        self.tile_blocks.sort_unstable();
        self.tile_blocks.dedup();
        self.claimed.clear();
        self.claimed.resize(self.tile_blocks.len(), false);
        for group in groups {
            let mut tile = 0;
            for run in &mut group.runs {
                while self.tile_blocks[tile] != run.block {
                    tile += 1;
                }
                run.tile = tile as u32;
                run.first = !core::mem::replace(&mut self.claimed[tile], true);
            }
        }
        self.blocks.period = period;
        let blocks = &mut self.blocks.coordinates;
        self.links
            .find(&self.tile_blocks, self.tile_edge, &period, blocks);
        // Stale numbers are never read: the first run of a tile clears it.
        self.tiles
            .resize(self.tile_blocks.len() * self.tile_len(), T::default());
        self.reach.resize(self.tile_blocks.len(), Reach::NOTHING);
    }

    /// The nodes that G2P reads of tile `tile`, for the particles that were added to it last: rows are read four nodes
    /// at a time.
    pub(crate) fn reach_of_rows(&self, tile: usize) -> Reach<D> {
        let kernel_nodes = self.tile_edge - block_edge(D) - 1;
        let mut reach = self.reach[tile];
        reach.high[D - 1] += (ROW - kernel_nodes) as u8;
        if usize::from(reach.high[D - 1]) > self.tile_edge {
            return Reach::WHOLE; // such a row ends in another
        }
        reach
    }

    /// The box around all blocks that particles are in, in cells from node 0.
    pub(crate) fn occupied(&self) -> ([f64; D], [f64; D]) {
        let edge = block_edge(D) as f64;
        let mut bounds = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for block in &self.tile_blocks {
            for axis in 0..D {
                let low = edge * f64::from(block[axis]);
                bounds.0[axis] = bounds.0[axis].min(low);
                bounds.1[axis] = bounds.1[axis].max(low + edge);
            }
        }
        bounds
    }
}
