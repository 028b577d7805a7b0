//! Sorted new rows into a group that is sorted too.
//!
//! ```text
//! group   a a a | c c | d d d             rows are moved up from the last block on, so that no row is
//! new       a   | b b | d                 overwritten before it was moved; blocks before the first that
//! merged  a a a a | b b | c c | d d d d   gets new rows stay where they are
//! ```

use super::group::Group;
use super::per_particle::PerParticle;
use super::run::Run;
use crate::math::Lanes;
use crate::parallel;
use core::ops::Range;

/// The rows of one block before the merge, and where they begin after it.
struct Move {
    /// Rows of the group.
    old: Range<usize>,
    /// Rows of the new particles.
    new: Range<usize>,
    start: usize,
}

impl<T: Lanes, const D: usize> Group<T, D> {
    /// Moves the rows of `new`, a sorted group of the same material, behind the rows of the same block. Memory
    /// grows by more than is needed, so that many small merges cost as much as few large ones.
    pub(crate) fn merge(&mut self, new: Self) {
        if new.len() == 0 {
            return;
        }
        if self.len() == 0 {
            *self = new;
            return;
        }
        let before = self.len();
        let (runs, moves) = plan(&self.runs, &new.runs);
        self.runs = runs;
        parallel::for_chunks(&mut self.columns, 1, 0, 1, &|first, columns| {
            for (column, new) in columns.iter_mut().zip(&new.columns[first..]) {
                merge_column(column, new, &moves);
            }
        });
        merge_column(&mut self.id, &new.id, &moves);
        self.mass.merge(before, &new.mass, new.id.len(), &moves);
        self.volume0
            .merge(before, &new.volume0, new.id.len(), &moves);
        self.body.merge(before, &new.body, new.id.len(), &moves);
    }
}

/// Lists the runs after the merge, and the moves that lead there in ascending order of blocks.
fn plan<const D: usize>(old: &[Run<D>], new: &[Run<D>]) -> (Vec<Run<D>>, Vec<Move>) {
    let mut runs = Vec::with_capacity(old.len() + new.len());
    let mut moves = Vec::with_capacity(old.len() + new.len());
    let (mut old, mut new) = (old.iter().peekable(), new.iter().peekable());
    let (mut start, mut old_end, mut new_end) = (0, 0, 0);
    loop {
        let block = match (old.peek(), new.peek()) {
            (Some(old), Some(new)) => old.block.min(new.block),
            (Some(run), None) | (None, Some(run)) => run.block,
            (None, None) => return (runs, moves),
        };
        let rows_of = |run: Option<&Run<D>>, end: usize| run.map_or(end..end, Run::rows);
        let old_rows = rows_of(old.next_if(|run| run.block == block), old_end);
        let new_rows = rows_of(new.next_if(|run| run.block == block), new_end);
        (old_end, new_end) = (old_rows.end, new_rows.end);
        let end = start + old_rows.len() + new_rows.len();
        runs.push(Run {
            block,
            start: start as u32,
            end: end as u32,
            tile: 0,
            first: false,
        });
        moves.push(Move {
            old: old_rows,
            new: new_rows,
            start,
        });
        start = end;
    }
}

fn merge_column<U: Copy>(column: &mut Vec<U>, new: &[U], moves: &[Move]) {
    column.extend_from_slice(new); // only for the length
    for Move {
        old,
        new: rows,
        start,
    } in moves.iter().rev()
    {
        if *start == old.start && rows.is_empty() {
            continue;
        }
        column.copy_within(old.clone(), *start);
        column[start + old.len()..][..rows.len()].copy_from_slice(&new[rows.clone()]);
    }
}

impl<T: Copy + PartialEq> PerParticle<T> {
    /// Merges the `new_len` numbers of `new` into the `len` numbers that are here.
    fn merge(&mut self, len: usize, new: &Self, new_len: usize, moves: &[Move]) {
        match (&mut *self, new) {
            (Self::Uniform(value), Self::Uniform(new)) if value == new => {}
            (Self::Uniform(value), new) => {
                *self = Self::Each(vec![*value; len]);
                self.merge(len, new, new_len, moves);
            }
            (Self::Each(values), Self::Uniform(new)) => {
                merge_column(values, &vec![*new; new_len], moves);
            }
            (Self::Each(values), Self::Each(new)) => merge_column(values, new, moves),
        }
    }
}
