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
//! World positions exist at the public interface only. In f32 they could not tell neighbors apart
//! far from the origin, nor move what is slow near it.

use super::lattice::Lattice;
use super::per_particle::PerParticle;
use super::run::Run;
use crate::material::Law;
use crate::math::Lanes;
use crate::parallel;
use std::sync::Arc;

/// The first column of each field: position, velocity, affine (column by column), strain.
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
    /// The material's law with its present stiffness.
    pub(crate) law: Arc<dyn Law<T, D>>,
    /// Density at rest \[kg/m³\].
    pub(crate) density: f64,
    /// Speed of sound at rest \[m/s\].
    pub(crate) sound_speed: f64,
    /// The fields by [`Layout`], one number per particle in each column.
    pub(crate) columns: Vec<Vec<T>>,
    /// Masses of the particles \[kg\].
    pub(crate) mass: PerParticle<T>,
    /// Volumes at rest \[m³; m² in 2D\].
    pub(crate) volume0: PerParticle<T>,
    pub(crate) id: Vec<u32>,
    pub(crate) body: PerParticle<u32>,
    /// Blocks in ascending order of coordinates (first axis first), which is the order of rows.
    pub(crate) runs: Vec<Run<D>>,
}

/// Returns the speed of sound at rest \[m/s\].
fn sound_speed<T: Lanes, const D: usize>(law: &dyn Law<T, D>, density: f64) -> f64 {
    let rest = vec![vec![T::default()]; law.strain_columns()];
    (law.wave_modulus(&rest, 1) / density).sqrt()
}

impl<T: Lanes, const D: usize> Group<T, D> {
    /// Creates a group without particles.
    pub(crate) fn new(law: Arc<dyn Law<T, D>>, density: f64) -> Self {
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

    /// Creates a group of the same material without particles.
    pub(crate) fn without_particles(&self) -> Self {
        Self::new(self.law.clone(), self.density)
    }

    pub(crate) fn len(&self) -> usize {
        self.id.len()
    }

    /// Replaces the law by another with the same strain.
    pub(crate) fn set_law(&mut self, law: Arc<dyn Law<T, D>>) {
        self.sound_speed = sound_speed(&*law, self.density);
        self.law = law;
    }

    /// Frees the memory of spare capacity.
    pub(crate) fn shrink(&mut self) {
        self.columns.iter_mut().for_each(Vec::shrink_to_fit);
        self.mass.shrink();
        self.volume0.shrink();
        self.id.shrink_to_fit();
        self.body.shrink();
    }

    /// Memory of the particles \[bytes\], spare capacity included.
    pub(crate) fn bytes(&self) -> usize {
        let columns = self.columns.iter().map(Vec::capacity).sum::<usize>();
        size_of::<T>() * (columns + self.mass.capacity() + self.volume0.capacity())
            + size_of::<u32>() * (self.id.capacity() + self.body.capacity())
            + size_of::<Run<D>>() * self.runs.capacity()
    }

    /// Position of row `row`, which is in `block`, in cells from node 0.
    pub(crate) fn cells(&self, lattice: &Lattice<D>, block: [i32; D], row: usize) -> [f64; D] {
        lattice.cells(block, self.stored_position(row))
    }

    /// Position of row `row`, which is in `block`, in the world \[m\].
    pub(crate) fn position(&self, lattice: &Lattice<D>, block: [i32; D], row: usize) -> [f64; D] {
        lattice.position(block, self.stored_position(row))
    }

    fn stored_position(&self, row: usize) -> [f64; D] {
        core::array::from_fn(|axis| self.columns[axis][row].to_f64())
    }
}

/// Copies `from` into the memory of `to`, on all threads.
pub(crate) fn copy_columns<T: Lanes>(to: &mut Vec<Vec<T>>, from: &[Vec<T>]) {
    to.resize_with(from.len(), Vec::new);
    parallel::for_chunks(to, 1, 0, 1, &|first, to| {
        for (to, from) in to.iter_mut().zip(&from[first..]) {
            to.clone_from(from);
        }
    });
}

impl<T: Lanes, const D: usize> Clone for Group<T, D> {
    fn clone(&self) -> Self {
        let mut copy = self.without_particles();
        copy.clone_from(self);
        copy
    }

    /// Copies `from` into the memory of this group, on all threads.
    fn clone_from(&mut self, from: &Self) {
        // Each field by name, so that a new one is not forgotten.
        let Self {
            law,
            density,
            sound_speed,
            columns,
            mass,
            volume0,
            id,
            body,
            runs,
        } = self;
        law.clone_from(&from.law);
        *density = from.density;
        *sound_speed = from.sound_speed;
        copy_columns(columns, &from.columns);
        mass.clone_from(&from.mass);
        volume0.clone_from(&from.volume0);
        id.clone_from(&from.id);
        body.clone_from(&from.body);
        runs.clone_from(&from.runs);
    }
}

impl<T: Lanes, const D: usize> PartialEq for Group<T, D> {
    /// Compares the particles and the stiffness; a law has nothing else that changes.
    fn eq(&self, other: &Self) -> bool {
        self.law.bulk_modulus() == other.law.bulk_modulus()
            && self.columns == other.columns
            && self.mass == other.mass
            && self.volume0 == other.volume0
            && self.id == other.id
            && self.body == other.body
            && self.runs == other.runs
    }
}
