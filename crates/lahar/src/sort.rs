//! Particles to blocks.
//!
//! A counting sort by block. Rows that stay in a block keep their order; those that come in stand
//! where their old row puts them: the order depends on nothing but the rows themselves. It is lazy:
//! tiles reach one cell beyond their block on every side, so that rows need to be sorted only when
//! some particle may have moved by more than that ([`DRIFT_LIMIT`]).

use crate::boundary::walls::Walls;
use crate::math::Lanes;
use crate::store::{BLOCK_LIMIT, Group, PerParticle, Run, block_edge};
use std::collections::HashMap;

/// How far, in cells, particles may move before they must be sorted: a little below the tiles'
/// margin of one cell, for the rounding of sums of steps.
pub(crate) const DRIFT_LIMIT: f64 = 0.999;

/// Buffers that live from sort to sort.
#[derive(Default)]
pub(crate) struct Sorter<T, const D: usize> {
    keys: Vec<u32>,
    source: Vec<u32>,
    column: Vec<T>,
    ids: Vec<u32>,
    blocks: Vec<[i32; D]>,
    found: HashMap<[i32; D], u32>,
}

/// The key of a particle that has left through an open side.
const GONE: u32 = u32::MAX;

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
        let escaped = self.assign(group, walls, offset);

        // Blocks in ascending order; where each begins.
        let mut order: Vec<u32> = (0..self.blocks.len() as u32).collect();
        order.sort_unstable_by_key(|&block| self.blocks[block as usize]);
        let mut counts = vec![0_u32; self.blocks.len()];
        for &key in &self.keys {
            if key != GONE {
                counts[key as usize] += 1;
            }
        }
        group.runs.clear();
        let mut next = vec![0_u32; self.blocks.len()];
        let mut start = 0;
        for &block in &order {
            let count = counts[block as usize];
            next[block as usize] = start;
            if count > 0 {
                let end = start + count;
                group.runs.push(Run {
                    block: self.blocks[block as usize],
                    start,
                    end,
                    tile: 0,
                    first: false,
                });
                start = end;
            }
        }

        // Which old row goes to each new one.
        self.source.clear();
        self.source.resize(start as usize, 0);
        for (row, &key) in self.keys.iter().enumerate() {
            if key != GONE {
                let place = &mut next[key as usize];
                self.source[*place as usize] = row as u32;
                *place += 1;
            }
        }

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

    /// Finds the block of each row, makes its position relative to that block, and numbers the
    /// blocks as they are met.
    fn assign(&mut self, group: &mut Group<T, D>, walls: &Walls<D>, offset: f64) -> Escaped {
        let edge = block_edge(D) as i32;
        let half = T::from_f64(0.5 * f64::from(edge));
        let whole = T::from_f64(f64::from(edge));
        let mut escaped = Escaped::default();
        self.keys.clear();
        self.blocks.clear();
        self.found.clear();
        let mut last = ([i32::MAX; D], GONE);
        let has_open = walls
            .open
            .iter()
            .any(|side| side.0.is_some() || side.1.is_some());
        for run in &group.runs {
            for row in run.rows() {
                if has_open && has_left(&group.cells(run.block, row, offset), walls) {
                    escaped.count += 1;
                    escaped.mass += group.mass.get(row).to_f64();
                    self.keys.push(GONE);
                    continue;
                }
                let mut block = run.block;
                for axis in 0..D {
                    let u = group.columns[axis][row];
                    let shift = ((u + half) / whole).floor();
                    if shift != T::default() {
                        // Exact: whole numbers of this size are, and the result is no larger.
                        group.columns[axis][row] = u - shift * whole;
                        block[axis] += shift.to_f64() as i32;
                    }
                    if let Some(period) = walls.period[axis] {
                        let u = group.columns[axis][row];
                        let base = i64::from(edge) * i64::from(block[axis])
                            + i64::from(edge / 2)
                            + u.floor().to_f64() as i64;
                        let inside = base.rem_euclid(period);
                        if inside != base {
                            block[axis] = inside.div_euclid(i64::from(edge)) as i32;
                            let local = inside
                                - i64::from(edge) * i64::from(block[axis])
                                - i64::from(edge / 2);
                            group.columns[axis][row] = (u - u.floor()) + T::from_f64(local as f64);
                        }
                    }
                }
                if block != last.0 {
                    let fresh = self.blocks.len() as u32;
                    let key = *self.found.entry(block).or_insert(fresh);
                    if key == fresh {
                        self.blocks.push(block);
                    }
                    last = (block, key);
                }
                self.keys.push(last.1);
            }
        }
        escaped
    }
}

fn has_left<const D: usize>(cells: &[f64; D], walls: &Walls<D>) -> bool {
    (0..D).any(|axis| {
        walls.open[axis].0.is_some_and(|low| cells[axis] < low)
            || walls.open[axis].1.is_some_and(|high| cells[axis] > high)
    })
}

/// `column[i] ← column[source[i]]`.
fn permute<U: Copy + Default + Send + Sync>(
    source: &[u32],
    column: &mut Vec<U>,
    buffer: &mut Vec<U>,
) {
    buffer.clear();
    buffer.resize(source.len(), U::default());
    let from = &column[..];
    crate::parallel::for_chunks(
        buffer,
        1,
        0,
        crate::parallel::grain(source.len(), 1 << 14),
        &|first, piece| {
            for (value, &row) in piece.iter_mut().zip(&source[first..]) {
                *value = from[row as usize];
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
