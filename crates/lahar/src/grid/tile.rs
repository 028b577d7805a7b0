//! Tiles: what is fixed about them, and how much of each its particles reach.

use super::QUAD;
use crate::particles::block_edge;

/// Nodes behind a tile, so that the row of four at its very end stays inside.
const TILE_PADDING: usize = 4;

/// Nodes along a tile: the block, one cell of drift on either side, and the kernel's reach.
pub(crate) const fn tile_edge<const D: usize>(kernel_nodes: usize) -> usize {
    block_edge(D) + 2 + (kernel_nodes - 1)
}

/// Numbers of one plane of a tile with that edge.
pub(crate) const fn tile_plane<const D: usize>(tile_edge: usize) -> usize {
    (tile_edge.pow(D as u32) + TILE_PADDING) * QUAD
}

/// The part of a tile's axis that lies in one block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) block: i32,
    pub(super) shift: i16,
    pub(super) low: u8,
    pub(super) high: u8,
}

/// Cuts the nodes that a tile covers on one axis into blocks, wrapped if the axis is periodic.
pub(super) fn axis_pieces<const D: usize>(
    block: i32,
    tile_edge: usize,
    period: Option<i64>,
    pieces: &mut Vec<Piece>,
) {
    let edge = block_edge(D) as i64;
    let first = edge * i64::from(block) - 1;
    pieces.clear();
    let mut done = 0; // nodes of the tile
    while done < tile_edge as i64 {
        let mut node = first + done;
        let mut left = tile_edge as i64 - done;
        if let Some(period) = period {
            node = node.rem_euclid(period);
            left = left.min(period - node);
        }
        let local = node.rem_euclid(edge);
        let len = left.min(edge - local);
        pieces.push(Piece {
            block: node.div_euclid(edge) as i32,
            shift: (done - local) as i16,
            low: local as u8,
            high: (local + len) as u8,
        });
        done += len;
    }
}

/// The nodes of a tile that its particles reach: `low ≤ node < high` on each axis. The others hold
/// zeros: particles drift by a whole cell only just before they are sorted again.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach<const D: usize> {
    pub(crate) low: [u8; D],
    pub(crate) high: [u8; D],
}

impl<const D: usize> Reach<D> {
    pub(crate) const NOTHING: Self = Self {
        low: [u8::MAX; D],
        high: [0; D],
    };
    pub(crate) const WHOLE: Self = Self {
        low: [0; D],
        high: [u8::MAX; D],
    };

    /// Both.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            low: core::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: core::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }
}

/// Tiles side by side, to scatter to.
pub(crate) struct Tiles<'a, T, const D: usize> {
    pub(crate) numbers: &'a mut [T],
    pub(crate) reach: &'a mut [Reach<D>],
    /// Numbers of a tile.
    pub(crate) len: usize,
}

impl<T, const D: usize> Tiles<'_, T, D> {
    /// The first `tiles`, and the others.
    pub(crate) fn split_at(&mut self, tiles: usize) -> (Tiles<'_, T, D>, Tiles<'_, T, D>) {
        let len = self.len;
        let (low, high) = self.numbers.split_at_mut(tiles * len);
        let (low_reach, high_reach) = self.reach.split_at_mut(tiles);
        let of = |numbers, reach| Tiles {
            numbers,
            reach,
            len,
        };
        (of(low, low_reach), of(high, high_reach))
    }
}
