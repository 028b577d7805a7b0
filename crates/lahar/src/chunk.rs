//! A few particles at a time, read and written by whole registers.

use crate::store::MOST_COLUMNS;

/// Particles worked on between two looks at the tile.
pub(crate) const CHUNK: usize = 32;

/// A column's numbers of a chunk of particles.
pub(crate) type Rows<T> = [T; CHUNK];

/// Particles `start .. start + count` of `columns`, at most a chunk; from `start` on there is a whole one.
#[derive(Clone, Copy)]
pub(crate) struct Chunk<'a, T> {
    pub(crate) columns: &'a [&'a [T]],
    pub(crate) start: usize,
    pub(crate) count: usize,
}

/// Room for the rows of chunks that are not full: they repeat the last particle.
pub(crate) struct Padded<T>([Rows<T>; MOST_COLUMNS]);

impl<T: Copy + Default> Padded<T> {
    pub(crate) fn new() -> Self {
        Self([[T::default(); CHUNK]; MOST_COLUMNS])
    }

    /// What `work` makes of rows `start .. start + count` of `columns`, `count` from 1 to [`CHUNK`].
    #[inline(always)]
    pub(crate) fn with<R>(
        &mut self,
        columns: &[&[T]],
        start: usize,
        count: usize,
        work: impl FnOnce(Chunk<'_, T>) -> R,
    ) -> R {
        if count == CHUNK {
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

    /// The same for `work` that changes its columns, given with the row where the chunk begins.
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

/// Writes `numbers`, at least one, and repeats the last.
pub(crate) fn pad<T: Copy>(padded: &mut [T], numbers: &[T]) {
    padded[..numbers.len()].copy_from_slice(numbers);
    padded[numbers.len()..].fill(numbers[numbers.len() - 1]);
}

#[cfg(test)]
mod tests {
    use super::{CHUNK, Padded};

    #[test]
    fn rows_that_are_not_there_repeat_the_last() {
        let numbers: Vec<f32> = (0..100).map(|i| i as f32).collect();
        let mut padded = Padded::new();
        for (start, count) in [(0, CHUNK), (17, CHUNK), (90, 10), (99, 1)] {
            padded.with(&[&numbers], start, count, |chunk| {
                assert_eq!((chunk.columns.len(), chunk.count), (1, count));
                for p in 0..CHUNK {
                    let expected = (start + p.min(count - 1)) as f32;
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
