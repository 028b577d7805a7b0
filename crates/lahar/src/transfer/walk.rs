//! The walk of a transfer over the runs of a group, divided among threads by halves. The data that belongs to the runs is
//! divided with them.

use crate::float_mode::FlushToZero;
use crate::parallel;
use crate::particles::{Run, split_runs};

/// The smallest number of particles that is worth a thread's attention.
const SMALLEST_PIECE: usize = 4096;

/// A place between two runs where a list of runs is divided.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    /// Runs before it.
    pub(crate) runs: usize,
    /// Rows before it.
    pub(crate) rows: usize,
    /// The tile of the first run behind it.
    pub(crate) tile: usize,
}

/// Runs side by side, and the data that belongs to them.
pub(crate) struct Piece<'a, P, const D: usize> {
    pub(crate) runs: &'a [Run<D>],
    /// The first row of the data.
    pub(crate) first_row: usize,
    pub(crate) data: P,
}

/// A transfer over pieces of a group.
pub(crate) trait Walk<const D: usize>: Sync {
    /// The data that belongs to some runs.
    type Data: Send;
    /// The result for some runs.
    type Found: Send;

    /// Divides the data.
    fn cut(&self, data: Self::Data, cut: Cut) -> (Self::Data, Self::Data);

    /// Does the work on one piece, on one thread.
    fn work(&self, piece: Piece<'_, Self::Data, D>) -> Self::Found;

    /// Joins the results of two pieces.
    fn join(&self, low: Self::Found, high: Self::Found) -> Self::Found;

    /// Walks over the `runs` of a group of `particles`; `data` begins with row 0.
    fn walk(&self, runs: &[Run<D>], particles: usize, data: Self::Data) -> Self::Found {
        let first_row = 0;
        let piece = Piece {
            runs,
            first_row,
            data,
        };
        self.halve(piece, parallel::grain(particles, SMALLEST_PIECE))
    }

    /// Divides `piece` if it has more than `grain` particles.
    fn halve(&self, piece: Piece<'_, Self::Data, D>, grain: usize) -> Self::Found {
        let Some((middle, row)) = split_runs(piece.runs, grain) else {
            let _flush = FlushToZero::enter();
            return self.work(piece);
        };
        let Piece {
            runs,
            first_row,
            data,
        } = piece;
        let (low_runs, high_runs) = runs.split_at(middle);
        let cut = Cut {
            runs: middle,
            rows: row - first_row,
            tile: high_runs[0].tile as usize,
        };
        let (low_data, high_data) = self.cut(data, cut);
        let low = Piece {
            runs: low_runs,
            first_row,
            data: low_data,
        };
        let high = Piece {
            runs: high_runs,
            first_row: row,
            data: high_data,
        };
        let (low, high) = parallel::join(|| self.halve(low, grain), || self.halve(high, grain));
        self.join(low, high)
    }
}
