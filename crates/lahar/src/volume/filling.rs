//! The filling of the grid, from the volumes that particles have brought: (7h), (7i).
//!
//! Each node gets the mean J − 1 of the fluid, and the excess: how much more volume than there is the particles around it
//! would fill.

use crate::boundary::walls::Walls;
use crate::boundary::walls::faces::WallFaces;
use crate::grid::operations::NodeVector;
use crate::grid::{BLOCK_NODES, Filling, Grid, NodeField, QUAD, Reach, Volume};
use crate::material::IsaToken;
use crate::math::Lanes;
use crate::particles::block_edge;
use crate::transfer::TileCopy;

/// A node whose cell is filled by less than this share is outside of the bodies. It is far from both 0 and 1, so that the
/// unevenness of particles, some percent, does not decide which nodes are inside.
pub(crate) const OUTSIDE: f64 = 0.5;

/// Nodes along a block in 2D; there are fewer in 3D.
const LARGEST_EDGE: usize = block_edge(2);

/// The smallest number of blocks that is worth a thread's attention.
const SMALLEST_PIECE: usize = 16;

/// Channels of [`Filling`].
const MEAN: usize = 0;
const EXCESS: usize = 1;

/// Makes the filling of `volumes`. `excess` is a buffer.
///
/// The excess is Σ w V⁰ J / dxᴰ − 1 on nodes inside the bodies: no neighbor is outside, not counting those that are hidden
/// by walls. Elsewhere it is zero, since the sum near a free surface does not see all of a cell.
pub(crate) fn measure<T: Lanes, const D: usize>(
    grid: &Grid<T, D>,
    isa: IsaToken,
    mut volumes: NodeField<Volume, T>,
    (walls, faces): (&Walls<D>, &WallFaces<D>),
    dx: f64,
    excess: &mut NodeVector<T, 1>,
) -> NodeField<Filling, T> {
    faces.mirror_volumes(&mut volumes);
    let task = Task {
        grid,
        isa,
        volumes: &volumes,
        walls,
        cell: T::from_f64(dx.powi(D as i32)),
    };
    excess.resize(grid.blocks().len());
    task.find_excess(excess);
    let mut filling = fill(volumes, excess);
    // Nodes beyond walls have the excess of their mirror images.
    faces.mirror_channel(&mut filling, EXCESS);
    filling
}

/// Replaces the nodes' volumes by mean and excess.
fn fill<T: Lanes>(
    volumes: NodeField<Volume, T>,
    excess: &NodeVector<T, 1>,
) -> NodeField<Filling, T> {
    volumes.rewritten(SMALLEST_PIECE, &|first, piece| {
        let of_piece = &excess.nodes()[first * BLOCK_NODES..];
        for (quad, [excess]) in piece.chunks_exact_mut(QUAD).zip(of_piece) {
            let mean = if quad[2] > T::default() {
                quad[3] / quad[2] // (7h)
            } else {
                T::default()
            };
            quad.fill(T::default());
            quad[MEAN] = mean;
            quad[EXCESS] = *excess;
        }
    })
}

struct Task<'a, T: Lanes, const D: usize> {
    grid: &'a Grid<T, D>,
    isa: IsaToken,
    volumes: &'a NodeField<Volume, T>,
    walls: &'a Walls<D>,
    /// dxᴰ \[m³; m² in 2D\].
    cell: T,
}

impl<T: Lanes, const D: usize> Task<'_, T, D> {
    /// Writes the excess of all nodes.
    fn find_excess(&self, excess: &mut NodeVector<T, 1>) {
        let grid = self.grid;
        excess.for_pieces(SMALLEST_PIECE, &|first, piece| {
            let mut tile = TileCopy::new();
            for (index, excess) in piece.chunks_exact_mut(BLOCK_NODES).enumerate() {
                let block = first + index;
                let excess = excess.as_flattened_mut();
                match grid.tile_of(block) {
                    Some(number) => {
                        let out = &mut tile.0;
                        grid.load_tile(self.isa, self.volumes, number, Reach::WHOLE, out);
                        self.excess_with_tile(block, &tile.0, excess);
                    }
                    None => self.excess_without_tile(block, excess),
                }
            }
        });
    }

    /// The excess on the nodes of a block that has a tile: that of [`Self::excess_at`], for a row of nodes at a time. A
    /// tile begins one node before its block.
    fn excess_with_tile(&self, block: usize, tile: &[T], out: &mut [T]) {
        let edge = block_edge(D);
        let tile_edge = self.grid.tile_edge();
        let full = self.cell * T::from_f64(OUTSIDE);
        let before = self.grid.blocks().first_node(block).map(|first| first - 1);
        // The nodes on an axis that are beyond a wall, one bit each: those of the block and one on either side.
        let beyond: [u32; D] = core::array::from_fn(|axis| {
            let is_beyond = |node: usize| self.walls.is_beyond_on(axis, before[axis] + node as i64);
            (0..edge + 2).fold(0, |bits, node| bits | u32::from(is_beyond(node)) << node)
        });
        let all = (1 << (edge + 2)) - 1;
        // Rows along the last axis, of nodes that are full or beyond a wall; [i][j], or [0][j] in 2D.
        let layers = if D == 2 { 1 } else { edge + 2 };
        let row_at = |i: usize, j: usize| (i * tile_edge + j) * tile_edge;
        let hidden = |i: usize, j: usize| {
            let by_i = D == 3 && beyond[0] >> i & 1 == 1;
            by_i || beyond[D - 2] >> j & 1 == 1
        };
        let mut rows = [[0_u32; LARGEST_EDGE + 2]; LARGEST_EDGE + 2];
        for i in 0..layers {
            for j in 0..edge + 2 {
                let quads = &tile[row_at(i, j) * QUAD..][..(edge + 2) * QUAD];
                let volumes = quads.chunks_exact(QUAD).map(|quad| quad[0]).enumerate();
                let is_full =
                    volumes.fold(0, |bits, (k, volume)| bits | u32::from(volume >= full) << k);
                let row = is_full | beyond[D - 1] | if hidden(i, j) { all } else { 0 };
                // With the neighbors on the row.
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
            let mut inside = around.fold(all, |inside, row| inside & row) & !beyond[D - 1];
            if hidden(i, j) {
                inside = 0;
            }
            for (k, out) in out.iter_mut().enumerate() {
                let volumes = &tile[(row_at(i, j) + k + 1) * QUAD..][..QUAD];
                *out = if inside >> (k + 1) & 1 == 1 {
                    excess_of(volumes, self.cell)
                } else {
                    T::default()
                };
            }
        }
    }

    /// The excess on the nodes of a block that no particle is in. Few of them are full.
    fn excess_without_tile(&self, block: usize, out: &mut [T]) {
        let full = self.cell * T::from_f64(OUTSIDE);
        for (local, out) in out.iter_mut().enumerate() {
            let volume = self.quad(block, local)[0];
            *out = T::default();
            if volume >= full {
                *out = self.excess_at(self.grid.blocks().node(block, local));
            }
        }
    }

    /// The volumes at node number `local` of a block.
    fn quad(&self, block: usize, local: usize) -> &[T] {
        let at = block * self.volumes.block_len() + local * QUAD;
        &self.volumes.numbers()[at..][..QUAD]
    }

    /// Returns the excess at `node`.
    fn excess_at(&self, node: [i64; D]) -> T {
        let full = self.cell * T::from_f64(OUTSIDE);
        let quad_of = |node| {
            let (block, local) = self.grid.blocks().find(node)?;
            Some(self.quad(block, local))
        };
        let is_full = |node| quad_of(node).is_some_and(|quad| quad[0] >= full);
        let is_beyond = |node| self.walls.is_beyond_plane(node);
        let inside = !is_beyond(node)
            && is_full(node)
            && neighbors(node).all(|beside| is_beyond(beside) || is_full(beside));
        match quad_of(node) {
            Some(volumes) if inside => excess_of(volumes, self.cell),
            _ => T::default(),
        }
    }
}

/// Returns the excess at a node inside: the volume that the particles around it would fill, less that of a cell, in cells.
fn excess_of<T: Lanes>(volumes: &[T], cell: T) -> T {
    (volumes[0] + volumes[1]) / cell - T::from_f64(1.0) // (7i)
}

/// Returns the nodes around `node`, including itself.
fn neighbors<const D: usize>(node: [i64; D]) -> impl Iterator<Item = [i64; D]> {
    (0..3_usize.pow(D as u32)).map(move |number| {
        core::array::from_fn(|axis| node[axis] + (number / 3_usize.pow(axis as u32) % 3) as i64 - 1)
    })
}
