//! Links between tiles and the blocks that they cover.

use super::tiles::{Piece, Reach, axis_pieces};

/// A part of a block that a tile covers: node `l` of the block (on each axis, `low ≤ l < high`) is
/// node `l + shift` of the tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link<const D: usize> {
    pub(super) block: u32,
    pub(super) tile: u32,
    pub(super) shift: [i16; D],
    low: [u8; D],
    high: [u8; D],
}

impl<const D: usize> Link<D> {
    /// Links `pieces` of block number `block` to tile number `tile`.
    pub(super) fn new(block: usize, tile: usize, pieces: [Piece; D]) -> Self {
        Self {
            block: block as u32,
            tile: tile as u32,
            shift: pieces.map(|piece| piece.shift),
            low: pieces.map(|piece| piece.low),
            high: pieces.map(|piece| piece.high),
        }
    }

    /// Returns its nodes within `reach`, if there are any: `low ≤ node < high` in the block.
    #[inline(always)]
    pub(super) fn within(&self, reach: Reach<D>) -> Option<([usize; D], [usize; D])> {
        let (mut low, mut high) = ([0; D], [0; D]);
        for axis in 0..D {
            let in_block =
                |node: u8| (isize::from(node) - self.shift[axis] as isize).max(0) as usize;
            low[axis] = usize::from(self.low[axis]).max(in_block(reach.low[axis]));
            high[axis] = usize::from(self.high[axis]).min(in_block(reach.high[axis]));
            if low[axis] >= high[axis] {
                return None;
            }
        }
        Some((low, high))
    }
}

/// All links in two orders: that of the sums over tiles, and that of the copies of nodes.
#[derive(Clone, Debug)]
pub(super) struct Links<const D: usize> {
    /// By block, and then by ascending coordinates of the tile's block.
    by_block: Vec<Link<D>>,
    starts_of_blocks: Vec<u32>,
    /// By tile, so that the links of a tile lie side by side.
    by_tile: Vec<Link<D>>,
    starts_of_tiles: Vec<u32>,
    /// Buffers that live from sort to sort.
    scratch: Scratch<D>,
}

#[derive(Clone, Debug)]
struct Scratch<const D: usize> {
    pieces: [Vec<Piece>; D],
    grown: Vec<[i32; D]>,
    /// By the number of a link in its tile, the block of that link of the last tile.
    last: Vec<usize>,
    /// By block, the place of its next link.
    next: Vec<u32>,
}

impl<const D: usize> Links<D> {
    pub(super) fn new() -> Self {
        Self {
            by_block: Vec::new(),
            starts_of_blocks: vec![0],
            by_tile: Vec::new(),
            starts_of_tiles: vec![0],
            scratch: Scratch {
                pieces: core::array::from_fn(|_| Vec::new()),
                grown: Vec::new(),
                last: Vec::new(),
                next: Vec::new(),
            },
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Link<D>>() * (self.by_block.capacity() + self.by_tile.capacity())
            + 4 * (self.starts_of_blocks.capacity() + self.starts_of_tiles.capacity())
    }

    /// Returns the links of a block, in the order in which its nodes are summed; none beyond the last block.
    #[inline(always)]
    pub(super) fn of_block(&self, block: usize) -> &[Link<D>] {
        match self.starts_of_blocks.get(block..block + 2) {
            Some(&[start, end]) => &self.by_block[start as usize..end as usize],
            _ => &[],
        }
    }

    /// Returns the links of a tile.
    #[inline(always)]
    pub(super) fn of_tile(&self, tile: usize) -> &[Link<D>] {
        let ends = &self.starts_of_tiles[tile..tile + 2];
        &self.by_tile[ends[0] as usize..ends[1] as usize]
    }

    /// Finds the `blocks` that the tiles of `tile_blocks` cover, and links them; both lists are ascending.
    pub(super) fn find(
        &mut self,
        tile_blocks: &[[i32; D]],
        tile_edge: usize,
        period: &[Option<i64>; D],
        blocks: &mut Vec<[i32; D]>,
    ) {
        blocks.clear();
        blocks.extend_from_slice(tile_blocks);
        for axis in 0..D {
            self.grow(axis, tile_edge, period[axis], blocks);
        }
        self.link_tiles(tile_blocks, tile_edge, period, blocks);
        self.order_by_block(blocks.len());
        if period.iter().any(Option::is_some) {
            // Tiles in ascending order are not periodic images in ascending order. Ascending coordinates of
            // tiles are descending shifts.
            for block in 0..blocks.len() {
                let ends = [block, block + 1].map(|at| self.starts_of_blocks[at] as usize);
                self.by_block[ends[0]..ends[1]]
                    .sort_unstable_by_key(|link| link.shift.map(|shift| -shift));
            }
        }
    }

    /// Adds the blocks that tiles of `blocks` reach along `axis`.
    fn grow(
        &mut self,
        axis: usize,
        tile_edge: usize,
        period: Option<i64>,
        blocks: &mut Vec<[i32; D]>,
    ) {
        let Scratch { pieces, grown, .. } = &mut self.scratch;
        let pieces = &mut pieces[axis];
        grown.clear();
        if period.is_some() {
            for &block in &*blocks {
                axis_pieces::<D>(block[axis], tile_edge, period, pieces);
                grown.extend(pieces.iter().map(|piece| with(block, axis, piece.block)));
            }
            grown.sort_unstable();
            grown.dedup();
        } else {
            // The block before, itself and the one after: three ascending lists to merge.
            let mut at = [0; 3];
            loop {
                let next: [Option<[i32; D]>; 3] = core::array::from_fn(|list| {
                    let block = blocks.get(at[list])?;
                    Some(with(*block, axis, block[axis] + list as i32 - 1))
                });
                let Some(least) = next.into_iter().flatten().min() else {
                    break;
                };
                grown.push(least);
                for (at, next) in at.iter_mut().zip(next) {
                    *at += usize::from(next == Some(least));
                }
            }
        }
        core::mem::swap(blocks, grown);
    }

    /// Makes the list by tile.
    fn link_tiles(
        &mut self,
        tile_blocks: &[[i32; D]],
        tile_edge: usize,
        period: &[Option<i64>; D],
        blocks: &[[i32; D]],
    ) {
        let Scratch { pieces, last, .. } = &mut self.scratch;
        last.clear();
        self.by_tile.clear();
        self.starts_of_tiles.clear();
        for (tile, &own) in tile_blocks.iter().enumerate() {
            let start = self.by_tile.len();
            self.starts_of_tiles.push(start as u32);
            for axis in 0..D {
                axis_pieces::<D>(own[axis], tile_edge, period[axis], &mut pieces[axis]);
            }
            let (mut choice, mut before) = ([0; D], 0);
            loop {
                let piece: [Piece; D] = core::array::from_fn(|axis| pieces[axis][choice[axis]]);
                let covered = piece.map(|piece| piece.block);
                let number = self.by_tile.len() - start;
                if number == last.len() {
                    last.push(0);
                }
                let block = place(blocks, covered, before + 1, last[number]);
                (before, last[number]) = (block, block);
                self.by_tile.push(Link::new(block, tile, piece));
                let mut axes = (0..D).rev();
                let Some(axis) = axes.find(|&axis| choice[axis] + 1 < pieces[axis].len()) else {
                    break;
                };
                choice[axis] += 1;
                choice[axis + 1..].fill(0);
            }
        }
        self.starts_of_tiles.push(self.by_tile.len() as u32);
    }

    /// Makes the list by block, tiles in ascending order.
    fn order_by_block(&mut self, blocks: usize) {
        let starts = &mut self.starts_of_blocks;
        starts.clear();
        starts.resize(blocks + 1, 0);
        for link in &self.by_tile {
            starts[link.block as usize + 1] += 1;
        }
        for block in 0..blocks {
            starts[block + 1] += starts[block];
        }
        self.by_block.clone_from(&self.by_tile); // for its length: all are replaced
        self.scratch.next.clone_from(starts);
        for link in &self.by_tile {
            let next = &mut self.scratch.next[link.block as usize];
            self.by_block[*next as usize] = *link;
            *next += 1;
        }
    }
}

/// Returns `block` with another index on `axis`.
fn with<const D: usize>(mut block: [i32; D], axis: usize, index: i32) -> [i32; D] {
    block[axis] = index;
    block
}

/// Returns the place of `wanted` in `blocks`, which is often `guess`, or a little behind `from`.
fn place<const D: usize>(
    blocks: &[[i32; D]],
    wanted: [i32; D],
    guess: usize,
    from: usize,
) -> usize {
    if blocks.get(guess) == Some(&wanted) {
        return guess;
    }
    let behind = blocks[from..].iter().take(16);
    let near = behind.take_while(|block| **block < wanted).count();
    if blocks.get(from + near) == Some(&wanted) {
        return from + near;
    }
    let found = blocks.binary_search(&wanted);
    found.expect("every block that a tile covers is in the list")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    /// Scattered blocks: neighbors, rows, and one far away.
    fn scattered<const D: usize>() -> Vec<[i32; D]> {
        let mut state = 12345_u32;
        let mut blocks = BTreeSet::from([[1 << 26; D], [-(1 << 26); D]]);
        for _ in 0..300 {
            blocks.insert(core::array::from_fn(|_| {
                state = state.wrapping_mul(1664525).wrapping_add(1013904223);
                (state >> 24) as i32 % 7 - 3
            }));
        }
        blocks.into_iter().collect()
    }

    /// Each node of each tile lies in one link of the tile, and the links of a block are those of its tiles,
    /// in the order of the tiles' periodic images.
    fn check<const D: usize>(tiles: &[[i32; D]], tile_edge: usize, period: [Option<i64>; D]) {
        let (mut links, mut blocks) = (Links::new(), Vec::new());
        links.find(&[[5; D]], tile_edge, &[None; D], &mut blocks); // leaves buffers of another sort
        links.find(tiles, tile_edge, &period, &mut blocks);
        assert!(blocks.is_sorted_by(|a, b| a < b));

        let edge = crate::particles::block_edge(D) as i64;
        let mut of_blocks: BTreeMap<[i32; D], Vec<([i32; D], u32)>> = BTreeMap::new();
        for (tile, block) in tiles.iter().enumerate() {
            let mut seen = BTreeSet::new();
            for link in links.of_tile(tile) {
                assert_eq!(link.tile as usize, tile);
                let (low, high) = link.within(Reach::WHOLE).expect("no link is empty");
                let shift = link.shift.map(|shift| -i32::from(shift));
                let owner = blocks[link.block as usize];
                of_blocks.entry(owner).or_default().push((shift, link.tile));
                for number in 0..edge.pow(D as u32) {
                    let local: [i64; D] =
                        core::array::from_fn(|axis| number / edge.pow(axis as u32) % edge);
                    if (0..D).any(|axis| {
                        local[axis] < low[axis] as i64 || local[axis] >= high[axis] as i64
                    }) {
                        continue;
                    }
                    let of_tile: [i64; D] =
                        core::array::from_fn(|axis| local[axis] + i64::from(link.shift[axis]));
                    assert!(seen.insert(of_tile), "a node of the tile in two blocks");
                    for axis in 0..D {
                        let node = edge * i64::from(block[axis]) - 1 + of_tile[axis];
                        let node = period[axis].map_or(node, |period| node.rem_euclid(period));
                        assert_eq!(edge * i64::from(owner[axis]) + local[axis], node);
                    }
                }
            }
            assert_eq!(seen.len(), tile_edge.pow(D as u32));
        }
        assert_eq!(of_blocks.len(), blocks.len());
        for (block, expected) in of_blocks.values_mut().enumerate() {
            expected.sort_unstable();
            let found = links.of_block(block).iter();
            let found: Vec<_> = found
                .map(|link| (link.shift.map(|shift| -i32::from(shift)), link.tile))
                .collect();
            assert_eq!(&found, expected);
        }
        assert!(links.of_block(blocks.len()).is_empty());
    }

    #[test]
    fn every_node_of_a_tile_is_in_one_block() {
        for tile_edge in [11, 12, 13] {
            check(&scattered::<2>(), tile_edge, [None; 2]);
        }
        for tile_edge in [7, 8, 9] {
            check(&scattered::<3>(), tile_edge, [None; 3]);
        }
        check::<2>(&[], 12, [None; 2]);
    }

    #[test]
    fn tiles_wrap_around_periods_of_any_length() {
        for period in [1, 3, 8, 17, 30] {
            let last = (period - 1) / 8;
            let tiles: Vec<_> = (0..=last as i32).flat_map(|i| [[i, -2], [i, 4]]).collect();
            check(&tiles, 12, [Some(period), None]);
            let tiles: Vec<_> = (-1..2)
                .flat_map(|j| (0..=last as i32).map(move |i| [j, i]))
                .collect();
            check(&tiles, 12, [None, Some(period)]);
        }
        check(
            &[[0, 0, 0], [0, 0, 1], [1, 2, 0]],
            8,
            [Some(5), None, Some(6)],
        );
    }
}
