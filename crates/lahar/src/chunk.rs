//! A few particles at a time, read and written by whole registers.

use crate::math::{Lanes, Real};
use crate::store::MOST_COLUMNS;
use fearless_simd::Simd;

/// Particles worked on between two looks at the tile.
pub(crate) const CHUNK: usize = 32;

/// How many rows ahead memory is asked for: two chunks.
pub(crate) const AHEAD: usize = 2 * CHUNK;

/// A column's numbers of a chunk of particles.
pub(crate) type Rows<T> = [T; CHUNK];

/// Particles `start .. start + count` of `columns`, at most a chunk; from `start` on there is a whole one.
#[derive(Clone, Copy)]
pub(crate) struct Chunk<'a, T> {
    pub(crate) columns: &'a [&'a [T]],
    pub(crate) start: usize,
    pub(crate) count: usize,
}

/// Room for the rows of chunks that are not full.
#[repr(align(64))]
pub(crate) struct Padded<T>([Rows<T>; MOST_COLUMNS]);

impl<T: Copy + Default> Padded<T> {
    pub(crate) fn new() -> Self {
        Self([[T::default(); CHUNK]; MOST_COLUMNS])
    }

    /// What `work` makes of rows `start .. start + count` of `columns`, `count` from 1 to [`CHUNK`]; what comes
    /// after them in the chunk are other rows, or the last one again.
    #[inline(always)]
    pub(crate) fn with<R>(
        &mut self,
        columns: &[&[T]],
        start: usize,
        count: usize,
        work: impl FnOnce(Chunk<'_, T>) -> R,
    ) -> R {
        if columns.iter().all(|column| start + CHUNK <= column.len()) {
            return work(Chunk {
                columns,
                start,
                count,
            });
        }
        let mut rows = [&[][..]; MOST_COLUMNS];
        for ((rows, padded), column) in rows.iter_mut().zip(&mut self.0).zip(columns) {
            pad(padded, &column[start..start + count]);
            *rows = padded;
        }
        work(Chunk {
            columns: &rows[..columns.len()],
            start: 0,
            count,
        })
    }

    /// The same for `work` that changes its columns, given with the row where the chunk begins; after rows
    /// `start .. start + count` comes the last one again.
    #[inline(always)]
    pub(crate) fn with_mut<R>(
        &mut self,
        columns: &mut [&mut [T]],
        start: usize,
        count: usize,
        work: impl FnOnce(&mut [&mut [T]], usize) -> R,
    ) -> R {
        if count == CHUNK {
            return work(columns, start);
        }
        let mut rows = self.0.each_mut().map(|rows| &mut rows[..]);
        for (rows, column) in rows.iter_mut().zip(&*columns) {
            pad(rows, &column[start..start + count]);
        }
        let result = work(&mut rows[..columns.len()], 0);
        for (rows, column) in rows.iter().zip(columns) {
            column[start..start + count].copy_from_slice(&rows[..count]);
        }
        result
    }
}

/// The largest of many numbers that are not negative, lane by lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Largest<T> {
    lanes: [T; 16],
    /// Zeros; not numbers where one was not finite, which a maximum would drop.
    check: [T; 16],
}

impl<T: Lanes> Largest<T> {
    pub(crate) fn none() -> Self {
        Self {
            lanes: [T::default(); 16],
            check: [T::default(); 16],
        }
    }

    /// Takes a register of numbers into account.
    #[inline(always)]
    pub(crate) fn take<S: Simd>(&mut self, simd: S, numbers: T::Of<S>) {
        let largest = T::load(simd, &self.lanes).max(numbers);
        T::store::<S>(largest, &mut self.lanes);
        let check = T::load(simd, &self.check) + numbers * numbers.zero();
        T::store::<S>(check, &mut self.check);
    }

    /// The largest so far; not a number if one was not finite.
    pub(crate) fn get(&self) -> f64 {
        let (mut largest, mut check) = (T::default(), T::default());
        for (x, bad) in self.lanes.iter().zip(&self.check) {
            largest = largest.max(*x);
            check += *bad;
        }
        (largest + check).to_f64()
    }
}

/// Writes `numbers`, at least one, and repeats the last.
pub(crate) fn pad<T: Copy>(padded: &mut [T], numbers: &[T]) {
    padded[..numbers.len()].copy_from_slice(numbers);
    padded[numbers.len()..].fill(numbers[numbers.len() - 1]);
}

#[cfg(test)]
mod tests {
    use super::{CHUNK, Largest, Padded};
    use crate::dispatch::on_portable;
    use crate::math::Lanes;

    #[test]
    fn the_largest_is_not_lost_nor_what_is_no_number() {
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
                    largest.take(simd, f32::load(simd, &register));
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
    fn rows_that_are_not_there_repeat_the_last() {
        let numbers: Vec<f32> = (0..100).map(|i| i as f32).collect();
        let mut padded = Padded::new();
        for (start, count) in [(0, CHUNK), (17, CHUNK), (40, 5), (90, 10), (99, 1)] {
            padded.with(&[&numbers], start, count, |chunk| {
                assert_eq!((chunk.columns.len(), chunk.count), (1, count));
                for p in 0..CHUNK {
                    let expected = (start + p).min(99) as f32;
                    assert_eq!(chunk.columns[0][chunk.start + p], expected);
                }
            });
        }
    }

    #[test]
    fn what_is_written_past_the_end_is_dropped() {
        let mut numbers = vec![0.0_f64; 50];
        let mut padded = Padded::new();
        for (start, count) in [(0, CHUNK), (CHUNK, 10)] {
            padded.with_mut(&mut [&mut numbers], start, count, |columns, at| {
                columns[0][at..at + CHUNK].fill(count as f64);
            });
        }
        let expected = [[32.0; 32].as_slice(), &[10.0; 10], &[0.0; 8]].concat();
        assert_eq!(numbers, expected);
    }
}
