//! Storage of particles: a group per material, its fields in columns, rows sorted by block.
//!
//! A position is stored relative to the middle of the particle's block, in cells, and shifted by
//! the kernel's offset, so that the base node of a particle at `u` is simply `floor(u)`:
//!
//! ```text
//!  u = x/dx − OFFSET − edge·block − edge/2        −edge/2 ≤ u < edge/2 when freshly sorted
//!
//!  block b:   node 0     1     2     3   |   (edge = 4)
//!     u  =        −2    −1     0     1   2
//! ```
//!
//! World positions exist at the public interface only. In f32 they could not tell neighbours apart
//! far from the origin, nor move what is slow near it.

use crate::material::Law;
use crate::math::Lanes;
use crate::particles::{CHUNK, Rows, pad};

/// Nodes along the edge of a block: 64 nodes a block in 2D and in 3D.
pub(crate) const fn block_edge(dimension: usize) -> usize {
    if dimension == 2 { 8 } else { 4 }
}

/// Block coordinates beyond this are out of range: positions that far are a failure.
pub(crate) const BLOCK_LIMIT: i32 = 1 << 27;

/// A number that is the same for the whole group, or one a particle.
#[derive(Clone, Debug)]
pub(crate) enum PerParticle<T> {
    Uniform(T),
    Each(Vec<T>),
}

impl<T: Copy + PartialEq> PerParticle<T> {
    pub(crate) fn get(&self, index: usize) -> T {
        match self {
            Self::Uniform(value) => *value,
            Self::Each(values) => values[index],
        }
    }

    /// The numbers of rows `start .. start + count`, at least one; in `room` if they do not lie there as they
    /// are asked for.
    #[inline(always)]
    pub(crate) fn rows<'a>(
        &'a self,
        start: usize,
        count: usize,
        room: &'a mut Rows<T>,
    ) -> &'a Rows<T> {
        match self {
            Self::Uniform(value) => room.fill(*value),
            Self::Each(values) if count == CHUNK => {
                return values[start..].first_chunk().expect("a full chunk");
            }
            Self::Each(values) => pad(room, &values[start..start + count]),
        }
        room
    }

    /// The numbers, if there is one a particle; else none.
    pub(crate) fn each_row(&self) -> &[T] {
        match self {
            Self::Uniform(_) => &[],
            Self::Each(values) => values,
        }
    }

    /// Numbers that there is room for, one a particle.
    pub(crate) fn each(&self) -> usize {
        match self {
            Self::Uniform(_) => 0,
            Self::Each(values) => values.capacity(),
        }
    }

    /// Gives back what room is not used.
    fn shrink(&mut self) {
        if let Self::Each(values) = self {
            values.shrink_to_fit();
        }
    }

    /// Adds `more` behind the `count` numbers that are there.
    pub(crate) fn extend(&mut self, count: usize, more: impl Iterator<Item = T> + Clone) {
        if let Self::Uniform(value) = self {
            if count == 0
                && let Some(first) = more.clone().next()
            {
                *value = first;
            }
            let value = *value;
            if more.clone().all(|x| x == value) {
                return;
            }
            *self = Self::Each(vec![value; count]);
        }
        if let Self::Each(values) = self {
            values.extend(more);
        }
    }
}

/// The particles of one block, a range of rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run<const D: usize> {
    pub(crate) block: [i32; D],
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// The block's tile in the grid.
    pub(crate) tile: u32,
    /// Whether this group is the first to scatter to that tile.
    pub(crate) first: bool,
}

impl<const D: usize> Run<D> {
    pub(crate) fn rows(&self) -> core::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// Where to cut a list of runs so that both halves have about as many particles: the index of the
/// first run of the second half and its first row. `None` if the list is not worth cutting.
pub(crate) fn split_runs<const D: usize>(runs: &[Run<D>], grain: usize) -> Option<(usize, usize)> {
    let (first, last) = (runs.first()?, runs.last()?);
    let rows = (last.end - first.start) as usize;
    if rows <= grain || runs.len() < 2 {
        return None;
    }
    let half = first.start + (rows / 2) as u32;
    let middle = runs
        .partition_point(|run| run.start < half)
        .clamp(1, runs.len() - 1);
    Some((middle, runs[middle].start as usize))
}

/// Speed of sound at rest, lengths in metres.
fn sound_speed<T: Lanes, const D: usize>(law: &dyn Law<T, D>, density: f64) -> f64 {
    let rest = vec![vec![T::default()]; law.strain_columns()];
    (law.wave_modulus(&rest, 1) / density).sqrt()
}

/// Where each field's columns begin: position, velocity, affine (column by column), strain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout;

impl Layout {
    pub(crate) const fn velocity(d: usize) -> usize {
        d
    }
    pub(crate) const fn affine(d: usize) -> usize {
        2 * d
    }
    pub(crate) const fn strain(d: usize) -> usize {
        2 * d + d * d
    }
}

/// All particles of one material.
pub(crate) struct Group<T: Lanes, const D: usize> {
    pub(crate) law: Box<dyn Law<T, D>>,
    /// Density at rest.
    pub(crate) density: f64,
    /// Speed of sound at rest.
    pub(crate) sound_speed: f64,
    pub(crate) columns: Vec<Vec<T>>,
    pub(crate) mass: PerParticle<T>,
    pub(crate) volume0: PerParticle<T>,
    pub(crate) id: Vec<u32>,
    pub(crate) body: PerParticle<u32>,
    /// Blocks in ascending order of coordinates (first axis first), which is the order of rows.
    pub(crate) runs: Vec<Run<D>>,
}

impl<T: Lanes, const D: usize> Group<T, D> {
    pub(crate) fn new(law: Box<dyn Law<T, D>>, density: f64) -> Self {
        let sound_speed = sound_speed(&*law, density);
        let columns = Layout::strain(D) + law.strain_columns();
        Self {
            law,
            density,
            sound_speed,
            columns: vec![Vec::new(); columns],
            mass: PerParticle::Uniform(T::default()),
            volume0: PerParticle::Uniform(T::default()),
            id: Vec::new(),
            body: PerParticle::Uniform(0),
            runs: Vec::new(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.id.len()
    }

    /// Puts another law of the same strain in place of the present one.
    pub(crate) fn set_law(&mut self, law: Box<dyn Law<T, D>>) {
        self.sound_speed = sound_speed(&*law, self.density);
        self.law = law;
    }

    /// Gives back what room is not used.
    pub(crate) fn shrink(&mut self) {
        self.columns.iter_mut().for_each(Vec::shrink_to_fit);
        for each in [&mut self.mass, &mut self.volume0] {
            each.shrink();
        }
        self.id.shrink_to_fit();
        self.body.shrink();
    }

    /// Bytes held, spare capacity included.
    pub(crate) fn bytes(&self) -> usize {
        let real = size_of::<T>();
        let columns = self.columns.iter().map(Vec::capacity).sum::<usize>();
        real * (columns + self.mass.each() + self.volume0.each())
            + size_of::<u32>() * (self.id.capacity() + self.body.each())
    }

    /// Position of row `row` of a block, in cells from the origin; `offset` is the kernel's.
    pub(crate) fn cells(&self, block: [i32; D], row: usize, offset: f64) -> [f64; D] {
        let edge = block_edge(D) as f64;
        core::array::from_fn(|axis| {
            self.columns[axis][row].to_f64() + offset + edge * (f64::from(block[axis]) + 0.5)
        })
    }
}

/// The block of a position `cells` from the origin and the position in it, on one axis.
pub(crate) fn locate(cells: f64, offset: f64, dimension: usize) -> (i32, f64) {
    let edge = block_edge(dimension) as f64;
    let block = ((cells - offset) / edge).floor();
    (block as i32, cells - offset - edge * (block + 0.5))
}

/// The most columns a group has: position, velocity, affine, and a plastic strain in 3D, with room to
/// spare.
pub(crate) const MOST_COLUMNS: usize = 32;

/// The rows of columns; empty ones behind them.
pub(crate) fn slices<T>(columns: &[Vec<T>]) -> [&[T]; MOST_COLUMNS] {
    let mut columns = columns.iter();
    core::array::from_fn(|_| columns.next().map_or(&[][..], |column| column))
}

/// Columns of storage, each a slice, that can be cut in two at a row.
pub(crate) struct ColumnsMut<'a, T> {
    pub(crate) slices: [&'a mut [T]; MOST_COLUMNS],
}

impl<'a, T> ColumnsMut<'a, T> {
    pub(crate) fn new(columns: &'a mut [Vec<T>]) -> Self {
        let mut columns = columns.iter_mut();
        Self {
            slices: core::array::from_fn(|_| columns.next().map_or(&mut [][..], |c| &mut c[..])),
        }
    }

    pub(crate) fn split_at(self, row: usize) -> (Self, Self) {
        let mut low: [&mut [T]; MOST_COLUMNS] = core::array::from_fn(|_| &mut [][..]);
        let mut high: [&mut [T]; MOST_COLUMNS] = core::array::from_fn(|_| &mut [][..]);
        for (column, slice) in self.slices.into_iter().enumerate() {
            let cut = row.min(slice.len());
            (low[column], high[column]) = slice.split_at_mut(cut);
        }
        (Self { slices: low }, Self { slices: high })
    }
}
