//! Tiles: their size, the blocks that they cover, and the part that particles reach.

use super::QUAD;
use crate::particles::block_edge;

/// Nodes behind a tile, so that the row of four at its end stays inside.
const TILE_PADDING: usize = 4;

/// Nodes along a tile: the block, one cell of drift on either side, and the kernel's reach.
pub(crate) const fn tile_edge<const D: usize>(kernel_nodes: usize) -> usize {
    block_edge(D) + 2 + (kernel_nodes - 1)
}

/// Numbers of one layer of a tile with this edge.
pub(crate) const fn tile_layer<const D: usize>(tile_edge: usize) -> usize {
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

/// The nodes of a tile that its particles reach: `low ≤ node < high` on each axis. The others are zero, since particles
/// drift by a whole cell only just before they are sorted again.
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

    /// The smallest reach that contains this one and `other`.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            low: core::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: core::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }
}

/// Tiles side by side, which particles are added to.
pub(crate) struct Tiles<'a, T, const D: usize> {
    pub(super) numbers: &'a mut [T],
    pub(super) reach: &'a mut [Reach<D>],
    /// The number of the first of them.
    pub(super) first: usize,
    /// Numbers of a tile.
    pub(super) len: usize,
}

impl<T, const D: usize> Tiles<'_, T, D> {
    /// Divides them before the tile with number `tile`.
    pub(crate) fn split_before(self, tile: usize) -> (Self, Self) {
        let (len, before) = (self.len, tile - self.first);
        let (low, high) = self.numbers.split_at_mut(before * len);
        let (low_reach, high_reach) = self.reach.split_at_mut(before);
        let of = |numbers, reach, first| Self {
            numbers,
            reach,
            first,
            len,
        };
        (of(low, low_reach, self.first), of(high, high_reach, tile))
    }

    /// The numbers of the tile with number `tile`, and the nodes that its particles reach.
    #[inline(always)]
    pub(crate) fn get_mut(&mut self, tile: usize) -> (&mut [T], &mut Reach<D>) {
        let index = tile - self.first;
        let numbers = &mut self.numbers[index * self.len..][..self.len];
        (numbers, &mut self.reach[index])
    }
}
