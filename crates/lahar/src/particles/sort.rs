//! Sorts the particles of a group by block.
//!
//! This is a counting sort. Rows of a block are in the order of their old rows, so that the result depends on nothing
//! but the rows themselves. The sort is lazy: tiles reach one cell beyond their block on every side, so rows are sorted
//! only when some particle may have moved by more than that ([`DRIFT_LIMIT`]).

use super::columns::ColumnsMut;
use super::group::Group;
use super::lattice::{Lattice, block_edge};
use super::per_particle::PerParticle;
use super::run::Run;
use crate::boundary::walls::Walls;
use crate::math::Lanes;
use crate::parallel;
use core::ops::Range;
use core::sync::atomic::{AtomicU32, Ordering};
use std::collections::HashMap;

/// How far particles may move before they must be sorted \[cells\]: a little below the tiles' margin of one cell, for the
/// rounding of sums of steps.
pub(crate) const DRIFT_LIMIT: f64 = 0.999;

/// Block coordinates beyond this are out of range: positions that far are a failure.
const BLOCK_LIMIT: i32 = 1 << 27;

/// Buffers that live from sort to sort.
#[derive(Default)]
pub(crate) struct Sorter<T, const D: usize> {
    /// The number of each old row's block, in the row's piece.
    keys: Vec<u32>,
    /// The old row of each new one. Pieces write to it at the same time, each place once.
    source: Vec<AtomicU32>,
    column: Vec<T>,
    ids: Vec<u32>,
    pieces: Vec<Piece<D>>,
    /// Blocks with their piece, and their number in that piece.
    found: Vec<([i32; D], u32, u32)>,
}

/// Rows that one thread sorts.
#[derive(Default)]
struct Piece<const D: usize> {
    runs: Range<usize>,
    rows: Range<usize>,
    /// Blocks that rows were found in, by number.
    blocks: Vec<[i32; D]>,
    /// Number of rows in each block; later the place of the block's next row.
    places: Vec<u32>,
    numbers: HashMap<[i32; D], u32>,
}

/// The key of a particle that has left through an open side.
const GONE: u32 = u32::MAX;

/// The smallest number of rows that is worth a piece of its own.
const SMALLEST_PIECE: usize = 1 << 14;

/// Particles that have left through open sides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Escaped {
    pub(crate) count: u64,
    /// Their mass \[kg\].
    pub(crate) mass: f64,
}

impl core::ops::AddAssign for Escaped {
    fn add_assign(&mut self, more: Self) {
        self.count += more.count;
        self.mass += more.mass;
    }
}

impl<T: Lanes, const D: usize> Sorter<T, D> {
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.keys.capacity() + self.source.capacity() + self.ids.capacity())
            + size_of::<T>() * self.column.capacity()
    }

    /// Sorts the rows of `group`, removes those that have left through open sides, and returns their count and mass. The
    /// runs are new, without tiles.
    pub(crate) fn sort(
        &mut self,
        group: &mut Group<T, D>,
        walls: &Walls<D>,
        lattice: &Lattice<D>,
    ) -> Escaped {
        let used = self.cut(&group.runs, group.len());
        self.keys.resize(group.len(), GONE); // each row's is written anew
        let old = Old {
            runs: &group.runs,
            walls,
            lattice,
        };
        let columns = ColumnsMut::new(&mut group.columns[..D]);
        old.assign(&mut self.pieces[..used], columns, &mut self.keys, 0);
        let escaped = match walls.has_open() {
            true => self.escaped(&group.mass),
            false => Escaped::default(),
        };
        let rows = self.find_runs(used, &mut group.runs);
        self.find_sources(used, rows);

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

    /// Counts and weighs the rows that have left.
    fn escaped(&self, mass: &PerParticle<T>) -> Escaped {
        let mut escaped = Escaped::default();
        let gone = self.keys.iter().enumerate();
        for (row, _) in gone.filter(|&(_, &key)| key == GONE) {
            escaped.count += 1;
            escaped.mass += mass.get(row).to_f64();
        }
        escaped
    }

    /// Writes the new runs, in ascending order of blocks, from the rows that the first `used` pieces have found in each
    /// block. Leaves the first place of each block's rows in each piece. Returns the number of rows.
    fn find_runs(&mut self, used: usize, runs: &mut Vec<Run<D>>) -> usize {
        let pieces = &mut self.pieces[..used];
        self.found.clear();
        for (piece, number) in pieces.iter().zip(0..) {
            let of_piece = piece.blocks.iter().zip(0..);
            self.found
                .extend(of_piece.map(|(&block, local)| (block, number, local)));
        }
        self.found.sort_unstable(); // pieces in the order of their rows
        runs.clear();
        let mut start = 0;
        for &(block, piece, local) in &self.found {
            let place = &mut pieces[piece as usize].places[local as usize];
            let end = start + core::mem::replace(place, start);
            match runs.last_mut() {
                Some(run) if run.block == block => run.end = end,
                _ => runs.push(Run {
                    block,
                    start,
                    end,
                    tile: 0,
                    first: false,
                }),
            }
            start = end;
        }
        start as usize
    }

    /// Finds the old row of each of the `rows` new rows, piece by piece on all threads.
    fn find_sources(&mut self, used: usize, rows: usize) {
        self.source.resize_with(rows, AtomicU32::default);
        let (keys, source) = (&self.keys, &self.source);
        let pieces = &mut self.pieces[..used];
        parallel::for_chunks(pieces, 1, 0, 1, &|_, pieces: &mut [Piece<D>]| {
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
    }

    /// Cuts the `rows` rows of `runs` into pieces of about equal size. Returns the number of pieces.
    fn cut(&mut self, runs: &[Run<D>], rows: usize) -> usize {
        let grain = parallel::grain(rows, SMALLEST_PIECE);
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

/// The order of rows before the sort.
struct Old<'a, const D: usize> {
    runs: &'a [Run<D>],
    walls: &'a Walls<D>,
    lattice: &'a Lattice<D>,
}

impl<const D: usize> Old<'_, D> {
    /// Finds the blocks of the rows of `pieces`; `positions` and `keys` begin with row `first_row`.
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
                parallel::join(
                    || self.assign(low, low_positions, low_keys, first_row),
                    || self.assign(high, high_positions, high_keys, row),
                );
            }
        }
    }

    /// Finds the block of each row of a piece, makes the position relative to that block, and numbers the blocks in the
    /// order of their first row. `positions` and `keys` are those of the piece.
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
            // The number of the block that most rows stay in, once it is known.
            let mut own = GONE;
            for row in run.rows() {
                let at = row - piece.rows.start;
                let mut u: [T; D] = core::array::from_fn(|axis| positions[axis][at]);
                if has_open
                    && has_left(&self.lattice.cells(run.block, u.map(T::to_f64)), self.walls)
                {
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
}

/// Finds the block, on one axis, of a position that is stored as `u` relative to `block`. Returns it with the position
/// relative to it.
fn relocate<T: Lanes, const D: usize>(block: i32, u: T, period: Option<i64>) -> (i32, T) {
    let edge = block_edge(D) as i64;
    let half = T::from_f64(0.5 * edge as f64);
    let whole = T::from_f64(edge as f64);
    let shift = ((u + half) / whole).floor();
    // Exact: the shift is a whole number of this size, and the result is no larger than `u`.
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

/// Returns true if a position has passed an open side.
fn has_left<const D: usize>(cells: &[f64; D], walls: &Walls<D>) -> bool {
    (0..D).any(|axis| {
        walls.open[axis].0.is_some_and(|low| cells[axis] < low)
            || walls.open[axis].1.is_some_and(|high| cells[axis] > high)
    })
}

/// Permutes a column: `column[i] ← column[source[i]]`.
fn permute<U: Copy + Default + Send + Sync>(
    source: &[AtomicU32],
    column: &mut Vec<U>,
    buffer: &mut Vec<U>,
) {
    buffer.resize(source.len(), U::default()); // every number is replaced
    let from = &column[..];
    parallel::for_chunks(
        buffer,
        1,
        0,
        parallel::grain(source.len(), SMALLEST_PIECE),
        &|first, piece| {
            for (value, row) in piece.iter_mut().zip(&source[first..]) {
                *value = from[row.load(Ordering::Relaxed) as usize];
            }
        },
    );
    core::mem::swap(column, buffer);
}

/// Returns true if the coordinates of `block` are in range.
pub(crate) fn in_range<const D: usize>(block: [i32; D]) -> bool {
    block
        .iter()
        .all(|b| b.unsigned_abs() < BLOCK_LIMIT.unsigned_abs())
}
