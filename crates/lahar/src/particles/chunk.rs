//! Chunks: a few particles at a time, read and written by whole registers.

use super::columns::{ColumnsMut, MOST_COLUMNS};
use crate::math::{Lanes, Real};
use fearless_simd::Simd;

/// Number of particles in a chunk: those that laws and transfers work on in turn, while their numbers stay in the
/// first-level cache.
pub(crate) const CHUNK: usize = 32;

/// How many rows ahead memory is prefetched: two chunks.
pub(crate) const AHEAD: usize = 2 * CHUNK;

/// The numbers of one column for a chunk of particles.
pub(crate) type Rows<T> = [T; CHUNK];

/// Particles `start .. start + count` of `columns`. There are at most as many as a chunk has, but from `start` on a whole
/// chunk can be read.
#[derive(Clone, Copy)]
pub(crate) struct Chunk<'a, T> {
    pub(crate) columns: &'a [&'a [T]],
    pub(crate) start: usize,
    pub(crate) count: usize,
}

/// Buffer for the rows of chunks that are not full.
#[repr(align(64))]
pub(crate) struct Padded<T>([Rows<T>; MOST_COLUMNS]);

impl<T: Copy + Default> Padded<T> {
    pub(crate) fn new() -> Self {
        Self([[T::default(); CHUNK]; MOST_COLUMNS])
    }

    /// Returns rows `start .. start + count` of `columns`, with `count` from 1 to [`CHUNK`]. They are not copied if a whole
    /// chunk of rows begins there; else they are copied, with the last row repeated up to a whole chunk, and `copies`
    /// keeps the slices of the copies.
    #[inline(always)]
    pub(crate) fn chunk<'a>(
        &'a mut self,
        columns: &'a [&'a [T]],
        start: usize,
        count: usize,
        copies: &'a mut Option<[&'a [T]; MOST_COLUMNS]>,
    ) -> Chunk<'a, T> {
        if columns.iter().all(|column| start + CHUNK <= column.len()) {
            return Chunk {
                columns,
                start,
                count,
            };
        }
        let copies = copies.insert(self.copy(columns, start, count));
        Chunk {
            columns: &copies[..columns.len()],
            start: 0,
            count,
        }
    }

    /// Makes the copies of [`Self::chunk`]; the slices behind those of the columns are empty.
    fn copy(&mut self, columns: &[&[T]], start: usize, count: usize) -> [&[T]; MOST_COLUMNS] {
        let mut rows = [&[][..]; MOST_COLUMNS];
        for ((rows, padded), column) in rows.iter_mut().zip(&mut self.0).zip(columns) {
            pad(padded, &column[start..start + count]);
            *rows = padded;
        }
        rows
    }

    /// Returns the whole buffer, as columns of one chunk each.
    pub(crate) fn columns(&mut self) -> ColumnsMut<'_, T> {
        let mut rows = self.0.iter_mut();
        ColumnsMut {
            slices: core::array::from_fn(|_| rows.next().map_or(&mut [][..], |rows| &mut rows[..])),
        }
    }
}

/// Returns the columns to work on for rows `start .. start + count` of the first `used` columns, and the row at which
/// they begin there. These are `columns` if the chunk is full, else `copies`, with the last row repeated.
#[inline(always)]
pub(crate) fn open_chunk<'a, 'c, T: Copy>(
    columns: &'a mut ColumnsMut<'c, T>,
    copies: &'a mut ColumnsMut<'c, T>,
    used: usize,
    start: usize,
    count: usize,
) -> (&'a mut ColumnsMut<'c, T>, usize) {
    if count == CHUNK {
        return (columns, start);
    }
    for (copy, column) in copies.slices.iter_mut().zip(&columns.slices[..used]) {
        pad(copy, &column[start..start + count]);
    }
    (copies, 0)
}

/// Copies back the rows of a chunk that [`open_chunk`] has copied.
#[inline(always)]
pub(crate) fn close_chunk<T: Copy>(
    columns: &mut ColumnsMut<'_, T>,
    copies: &ColumnsMut<'_, T>,
    used: usize,
    start: usize,
    count: usize,
) {
    if count < CHUNK {
        for (column, copy) in columns.slices.iter_mut().zip(&copies.slices[..used]) {
            column[start..start + count].copy_from_slice(&copy[..count]);
        }
    }
}

/// The largest of many non-negative numbers, lane by lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Largest<T> {
    lanes: [T; 16],
    /// Zeros, or NaN in lanes where a number was not finite: a maximum would drop it.
    check: [T; 16],
}

impl<T: Lanes> Largest<T> {
    pub(crate) fn none() -> Self {
        Self {
            lanes: [T::default(); 16],
            check: [T::default(); 16],
        }
    }

    /// Includes a register of numbers.
    #[inline(always)]
    pub(crate) fn include<S: Simd>(&mut self, simd: S, numbers: T::Of<S>) {
        let largest = T::load(simd, &self.lanes).max(numbers);
        T::store::<S>(largest, &mut self.lanes);
        let check = T::load(simd, &self.check) + numbers * numbers.zero();
        T::store::<S>(check, &mut self.check);
    }

    /// Returns the largest number so far, or NaN if one was not finite.
    pub(crate) fn get(&self) -> f64 {
        let (mut largest, mut check) = (T::default(), T::default());
        for (x, bad) in self.lanes.iter().zip(&self.check) {
            largest = largest.max(*x);
            check += *bad;
        }
        (largest + check).to_f64()
    }
}

/// Writes `numbers`, of which there is at least one, and repeats the last up to the end of `padded`.
pub(crate) fn pad<T: Copy>(padded: &mut [T], numbers: &[T]) {
    padded[..numbers.len()].copy_from_slice(numbers);
    padded[numbers.len()..].fill(numbers[numbers.len() - 1]);
}

#[cfg(test)]
mod tests {
    use super::super::columns::ColumnsMut;
    use super::{CHUNK, Largest, Padded, close_chunk, open_chunk};
    use crate::dispatch::on_portable;
    use crate::math::Lanes;

    #[test]
    fn the_largest_number_and_nan_are_found() {
        let mut numbers = [1.0_f32; 16];
        numbers[3] = 7.0;
        let registers = |bad: f32| {
            let mut second = [2.0; 16];
            second[9] = bad;
            [numbers, second, [3.0; 16]]
        };
        let largest = |bad: f32| {
            let mut largest = Largest::<f32>::none();
            on_portable!(simd => {
                for register in registers(bad) {
                    largest.include(simd, f32::load(simd, &register));
                }
            });
            largest.get()
        };
        assert_eq!(largest(5.0), 7.0);
        assert_eq!(largest(11.0), 11.0);
        assert!(largest(f32::NAN).is_nan());
        assert!(largest(f32::INFINITY).is_nan());
    }

    #[test]
    fn a_chunk_that_is_not_full_repeats_its_last_row() {
        let numbers: Vec<f32> = (0..100).map(|i| i as f32).collect();
        let mut padded = Padded::new();
        for (start, count) in [(0, CHUNK), (17, CHUNK), (40, 5), (90, 10), (99, 1)] {
            let (columns, mut copies) = ([&numbers[..]], None);
            let chunk = padded.chunk(&columns, start, count, &mut copies);
            assert_eq!((chunk.columns.len(), chunk.count), (1, count));
            for p in 0..CHUNK {
                let expected = (start + p).min(99) as f32;
                assert_eq!(chunk.columns[0][chunk.start + p], expected);
            }
        }
    }

    #[test]
    fn numbers_written_past_the_end_are_dropped() {
        let mut numbers = [vec![0.0_f64; 50]];
        let mut columns = ColumnsMut::new(&mut numbers);
        let mut padded = Padded::new();
        let mut copies = padded.columns();
        for (start, count) in [(0, CHUNK), (CHUNK, 10)] {
            let (chunk, at) = open_chunk(&mut columns, &mut copies, 1, start, count);
            chunk.slices[0][at..at + CHUNK].fill(count as f64);
            close_chunk(&mut columns, &copies, 1, start, count);
        }
        let expected = [[32.0; 32].as_slice(), &[10.0; 10], &[0.0; 8]].concat();
        assert_eq!(numbers[0], expected);
    }
}
