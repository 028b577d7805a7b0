//! Particles to blocks.
//!
//! A counting sort by block. Rows that stay in a block keep their order; those that come in stand
//! where their old row puts them: the order depends on nothing but the rows themselves. It is lazy:
//! tiles reach one cell beyond their block on every side, so that rows need to be sorted only when
//! some particle may have moved by more than that ([`DRIFT_LIMIT`]).

use crate::boundary::walls::Walls;
use crate::math::Lanes;
use crate::particles::{BLOCK_LIMIT, ColumnsMut, Group, PerParticle, Run, block_edge};
use core::ops::Range;
use core::sync::atomic::{AtomicU32, Ordering};
use std::collections::HashMap;

/// How far, in cells, particles may move before they must be sorted: a little below the tiles'
/// margin of one cell, for the rounding of sums of steps.
pub(crate) const DRIFT_LIMIT: f64 = 0.999;

/// Buffers that live from sort to sort.
#[derive(Default)]
pub(crate) struct Sorter<T, const D: usize> {
    /// By old row, its block's number in its piece.
    keys: Vec<u32>,
    /// By new row, the old one. Pieces write to it side by side, each place once.
    source: Vec<AtomicU32>,
    column: Vec<T>,
    ids: Vec<u32>,
    pieces: Vec<Piece<D>>,
    /// Block, piece, and the block's number in that piece.
    found: Vec<([i32; D], u32, u32)>,
}

/// Rows that one thread sorts.
#[derive(Default)]
struct Piece<const D: usize> {
    runs: Range<usize>,
    rows: Range<usize>,
    /// Blocks that rows were found in, by number.
    blocks: Vec<[i32; D]>,
    /// How many were; then, where the next goes.
    places: Vec<u32>,
    numbers: HashMap<[i32; D], u32>,
}

/// The key of a particle that has left through an open side.
const GONE: u32 = u32::MAX;

/// The smallest number of rows that is worth a piece.
const SMALLEST_PIECE: usize = 1 << 14;

/// What a sort removed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Escaped {
    pub(crate) count: u64,
    pub(crate) mass: f64,
}

impl<T: Lanes, const D: usize> Sorter<T, D> {
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.keys.capacity() + self.source.capacity() + self.ids.capacity())
            + size_of::<T>() * self.column.capacity()
    }

    /// Sorts the rows of `group`, whose runs say which block each row's position is relative to.
    /// Tiles are not yet assigned.
    pub(crate) fn sort(
        &mut self,
        group: &mut Group<T, D>,
        walls: &Walls<D>,
        offset: f64,
    ) -> Escaped {
        let used = self.cut(&group.runs, group.len());
        self.keys.resize(group.len(), GONE); // each row's is written anew
        let old = Old {
            runs: &group.runs,
            walls,
            offset,
        };
        let pieces = &mut self.pieces[..used];
        let columns = ColumnsMut::new(&mut group.columns[..D]);
        old.assign(pieces, columns, &mut self.keys, 0);
        let mut escaped = Escaped::default();
        if walls.has_open() {
            let gone = self
                .keys
                .iter()
                .enumerate()
                .filter(|&(_, &key)| key == GONE);
            for (row, _) in gone {
                escaped.count += 1;
                escaped.mass += group.mass.get(row).to_f64();
            }
        }

        // Blocks in ascending order; where each begins, and in it each piece.
        self.found.clear();
        for (piece, number) in pieces.iter().zip(0..) {
            let of_piece = piece.blocks.iter().zip(0..);
            self.found
                .extend(of_piece.map(|(&block, local)| (block, number, local)));
        }
        self.found.sort_unstable(); // pieces in the order of their rows
        group.runs.clear();
        let mut start = 0;
        for &(block, piece, local) in &self.found {
            let place = &mut pieces[piece as usize].places[local as usize];
            let end = start + core::mem::replace(place, start);
            match group.runs.last_mut() {
                Some(run) if run.block == block => run.end = end,
                _ => group.runs.push(Run {
                    block,
                    start,
                    end,
                    tile: 0,
                    first: false,
                }),
            }
            start = end;
        }

        // Which old row goes to each new one.
        self.source.resize_with(start as usize, AtomicU32::default);
        let (keys, source) = (&self.keys, &self.source);
        crate::parallel::for_chunks(pieces, 1, 0, 1, &|_, pieces: &mut [Piece<D>]| {
            for piece in pieces {
                for row in piece.rows.clone() {
                    let key = keys[row];
                    if key != GONE {
                        let place = &mut piece.places[key as usize];
                        source[*place as usize].store(row as u32, Ordering::Relaxed);
                        *place += 1;
                    }
                }
            }
        });

        for column in &mut group.columns {
            permute(&self.source, column, &mut self.column);
        }
        for each in [&mut group.mass, &mut group.volume0] {
            if let PerParticle::Each(column) = each {
                permute(&self.source, column, &mut self.column);
            }
        }
        permute(&self.source, &mut group.id, &mut self.ids);
        if let PerParticle::Each(column) = &mut group.body {
            permute(&self.source, column, &mut self.ids);
        }
        escaped
    }

    /// Cuts `rows` rows in `runs` into pieces of about as many; returns how many pieces.
    fn cut(&mut self, runs: &[Run<D>], rows: usize) -> usize {
        let grain = crate::parallel::grain(rows, SMALLEST_PIECE);
        let (mut used, mut first) = (0, 0);
        for (index, run) in runs.iter().enumerate() {
            let start = runs[first].start as usize;
            let is_last = index + 1 == runs.len();
            if !is_last && (run.end as usize - start) < grain {
                continue;
            }
            if used == self.pieces.len() {
                self.pieces.push(Piece::default());
            }
            let piece = &mut self.pieces[used];
            piece.runs = first..index + 1;
            piece.rows = start..run.end as usize;
            (used, first) = (used + 1, index + 1);
        }
        used
    }
}

/// What was known of rows when they were sorted before.
struct Old<'a, const D: usize> {
    runs: &'a [Run<D>],
    walls: &'a Walls<D>,
    offset: f64,
}

impl<const D: usize> Old<'_, D> {
    /// Finds the blocks of all `pieces`' rows; `positions` and `keys` begin with row `first_row`.
    fn assign<T: Lanes>(
        &self,
        pieces: &mut [Piece<D>],
        mut positions: ColumnsMut<'_, T>,
        keys: &mut [u32],
        first_row: usize,
    ) {
        match pieces {
            [] => {}
            [piece] => self.assign_piece(piece, &mut positions.slices[..D], keys),
            _ => {
                let (low, high) = pieces.split_at_mut(pieces.len() / 2);
                let row = high[0].rows.start;
                let (low_positions, high_positions) = positions.split_at(row - first_row);
                let (low_keys, high_keys) = keys.split_at_mut(row - first_row);
                crate::parallel::join(
                    || self.assign(low, low_positions, low_keys, first_row),
                    || self.assign(high, high_positions, high_keys, row),
                );
            }
        }
    }

    /// Finds the block of each row, makes its position relative to that block, and numbers the
    /// blocks as they are met. `positions` and `keys` are the piece's.
    fn assign_piece<T: Lanes>(
        &self,
        piece: &mut Piece<D>,
        positions: &mut [&mut [T]],
        keys: &mut [u32],
    ) {
        let half = T::from_f64(0.5 * block_edge(D) as f64);
        piece.blocks.clear();
        piece.places.clear();
        piece.numbers.clear();
        let has_open = self.walls.has_open();
        let has_periods = self.walls.period.iter().any(Option::is_some);
        let mut last = ([i32::MAX; D], GONE);
        for run in &self.runs[piece.runs.clone()] {
            // The number of the run's own block, where most rows stay, once it is known.
            let mut own = GONE;
            for row in run.rows() {
                let at = row - piece.rows.start;
                let mut u: [T; D] = core::array::from_fn(|axis| positions[axis][at]);
                if has_open && has_left(&self.cells(run.block, u), self.walls) {
                    keys[at] = GONE;
                    continue;
                }
                let stays = u.iter().all(|&u| -half <= u && u < half);
                if stays && own != GONE && !has_periods {
                    keys[at] = own;
                    piece.places[own as usize] += 1;
                    continue;
                }
                let block: [i32; D] = core::array::from_fn(|axis| {
                    let (block, inside) =
                        relocate::<T, D>(run.block[axis], u[axis], self.walls.period[axis]);
                    u[axis] = inside;
                    block
                });
                for axis in 0..D {
                    positions[axis][at] = u[axis];
                }
                if block != last.0 {
                    let fresh = piece.blocks.len() as u32;
                    last = (block, *piece.numbers.entry(block).or_insert(fresh));
                    if last.1 == fresh {
                        piece.blocks.push(block);
                        piece.places.push(0);
                    }
                }
                if block == run.block {
                    own = last.1;
                }
                keys[at] = last.1;
                piece.places[last.1 as usize] += 1;
            }
        }
    }

    /// A position as stored, in cells from node 0.
    fn cells<T: Lanes>(&self, block: [i32; D], u: [T; D]) -> [f64; D] {
        let edge = block_edge(D) as f64;
        core::array::from_fn(|axis| {
            u[axis].to_f64() + self.offset + edge * (f64::from(block[axis]) + 0.5)
        })
    }
}

/// The block, on one axis, of a position stored as `u` relative to `block`, and how it is stored there.
fn relocate<T: Lanes, const D: usize>(block: i32, u: T, period: Option<i64>) -> (i32, T) {
    let edge = block_edge(D) as i64;
    let half = T::from_f64(0.5 * edge as f64);
    let whole = T::from_f64(edge as f64);
    let shift = ((u + half) / whole).floor();
    // Exact: whole numbers of this size are, and the result is no larger.
    let u = u - shift * whole;
    let block = block + shift.to_f64() as i32;
    if let Some(period) = period {
        let base = edge * i64::from(block) + edge / 2 + u.floor().to_f64() as i64;
        let inside = base.rem_euclid(period);
        if inside != base {
            let block = inside.div_euclid(edge);
            let local = inside - edge * block - edge / 2;
            return (block as i32, (u - u.floor()) + T::from_f64(local as f64));
        }
    }
    (block, u)
}

fn has_left<const D: usize>(cells: &[f64; D], walls: &Walls<D>) -> bool {
    (0..D).any(|axis| {
        walls.open[axis].0.is_some_and(|low| cells[axis] < low)
            || walls.open[axis].1.is_some_and(|high| cells[axis] > high)
    })
}

/// `column[i] ← column[source[i]]`.
fn permute<U: Copy + Default + Send + Sync>(
    source: &[AtomicU32],
    column: &mut Vec<U>,
    buffer: &mut Vec<U>,
) {
    buffer.resize(source.len(), U::default()); // what it holds is replaced
    let from = &column[..];
    crate::parallel::for_chunks(
        buffer,
        1,
        0,
        crate::parallel::grain(source.len(), 1 << 14),
        &|first, piece| {
            for (value, row) in piece.iter_mut().zip(&source[first..]) {
                *value = from[row.load(Ordering::Relaxed) as usize];
            }
        },
    );
    core::mem::swap(column, buffer);
}

/// Whether a block can be named.
pub(crate) fn in_range<const D: usize>(block: [i32; D]) -> bool {
    block
        .iter()
        .all(|b| b.unsigned_abs() < BLOCK_LIMIT.unsigned_abs())
}
