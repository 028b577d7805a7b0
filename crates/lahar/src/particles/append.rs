//! Batches of particles to rows of a group, each in its block.

use super::group::{Group, Layout};
use super::lattice::Lattice;
use super::run::Run;
use super::sort::in_range;
use crate::boundary::colliders::placed::Moving;
use crate::boundary::colliders::projection::project_out;
use crate::error::SetupError;
use crate::math::{Lanes, Vector};
use crate::setup::{Deformation, ParticleBatch};

/// Bounds of the places that particles may have on each axis \[cells\].
type Bounds<const D: usize> = [(Option<f64>, Option<f64>); D];

/// The space that new particles are placed in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement<'a, const D: usize> {
    pub(crate) lattice: &'a Lattice<D>,
    pub(crate) bounds: &'a Bounds<D>,
    /// The colliders at the present time.
    pub(crate) colliders: &'a [Moving<D>],
}

impl<const D: usize> Placement<'_, D> {
    /// Finds the block of a position \[m\] on each axis, and the position relative to it. A position outside of
    /// the bounds is put where the first substep would put it.
    fn locate(&self, position: [f64; D]) -> [(i32, f64); D] {
        let cells = self.lattice.to_cells(position);
        core::array::from_fn(|axis| {
            let (low, high) = self.bounds[axis];
            let cells = cells[axis];
            let cells = cells.max(low.unwrap_or(cells)).min(high.unwrap_or(cells));
            self.lattice.locate(cells)
        })
    }

    /// Checks that each position \[m\] is in a block that can be numbered.
    ///
    /// # Errors
    /// Names the first that is not.
    pub(crate) fn check_range(&self, positions: &[[f64; D]]) -> Result<(), SetupError> {
        let is_far =
            |position: &&[f64; D]| !in_range(self.locate(**position).map(|(block, _)| block));
        match positions.iter().enumerate().find(|(_, x)| is_far(x)) {
            None => Ok(()),
            Some((i, position)) => Err(SetupError {
                key: "position".into(),
                message: format!("particle {i} at {position:?} m is too far from the origin"),
            }),
        }
    }
}

impl<T: Lanes, const D: usize> Group<T, D> {
    /// Appends the particles of `batch`, which was checked, with ids from `first_id` on. Rows are put behind the
    /// present ones, in runs of their own, which are not sorted.
    pub(crate) fn append(
        &mut self,
        batch: &ParticleBatch<D>,
        placement: &Placement<'_, D>,
        first_id: u32,
    ) {
        let count = batch.position.len();
        let before = self.len();
        for column in &mut self.columns {
            column.reserve(count);
        }
        for i in 0..count {
            self.append_position(batch, i, placement);
            self.append_motion(batch, i);
            self.append_strain(batch, i);
        }
        let pick = |values: &[f64], i: usize| {
            if values.len() == 1 {
                values[0]
            } else {
                values[i]
            }
        };
        let density = self.density;
        let volume = |i| T::from_f64(pick(&batch.volume, i));
        let mass = |i| {
            T::from_f64(if batch.mass.is_empty() {
                density * pick(&batch.volume, i)
            } else {
                pick(&batch.mass, i)
            })
        };
        self.volume0.extend(before, (0..count).map(volume));
        self.mass.extend(before, (0..count).map(mass));
        self.body
            .extend(before, core::iter::repeat_n(batch.body, count));
        self.id.extend((0..count as u32).map(|i| first_id + i));
    }

    fn append_position(
        &mut self,
        batch: &ParticleBatch<D>,
        i: usize,
        placement: &Placement<'_, D>,
    ) {
        let row = self.columns[0].len() as u32;
        let place = placement.locate(batch.position[i]);
        let block = place.map(|(block, _)| block);
        let mut x = Vector(place.map(|(_, x)| x));
        // The batch's velocity is kept: only the position leaves the colliders.
        project_out(
            placement.colliders,
            placement.bounds,
            placement.lattice.middle(block),
            (&mut x, &mut Vector([0.0; D])),
            placement.lattice.dx,
            |_, _, _| {},
        );
        for axis in 0..D {
            self.columns[axis].push(T::from_f64(x[axis]));
        }
        match self.runs.last_mut() {
            Some(run) if run.block == block => run.end = row + 1,
            _ => self.runs.push(Run {
                block,
                start: row,
                end: row + 1,
                tile: 0,
                first: false,
            }),
        }
    }

    fn append_motion(&mut self, batch: &ParticleBatch<D>, i: usize) {
        let velocity = match batch.velocity.len() {
            0 => [0.0; D],
            1 => batch.velocity[0],
            _ => batch.velocity[i],
        };
        for axis in 0..D {
            self.columns[Layout::velocity(D) + axis].push(T::from_f64(velocity[axis]));
            for row in 0..D {
                let c = batch.affine.get(i).map_or(0.0, |c| c[row][axis]);
                self.columns[Layout::affine(D) + axis * D + row].push(T::from_f64(c));
            }
        }
    }

    fn append_strain(&mut self, batch: &ParticleBatch<D>, i: usize) {
        let diagonal =
            |d| core::array::from_fn(|a| core::array::from_fn(|b| if a == b { d } else { 0.0 }));
        let gradient: Option<[[f64; D]; D]> = match &batch.deformation {
            Deformation::Rest => None,
            Deformation::Jacobian(j) => Some(diagonal(libm::pow(j[i], 1.0 / D as f64))),
            Deformation::Gradient(f) => Some(f[i]),
        };
        let variables = batch.variables_of(i);
        let gradient = gradient.or_else(|| (!variables.is_empty()).then(|| diagonal(1.0)));
        let strain = &mut self.columns[Layout::strain(D)..];
        match gradient {
            None => {
                for column in strain {
                    column.push(T::default());
                }
            }
            Some(f) => {
                let start = self.law.start(f, &variables);
                for (column, value) in strain.iter_mut().zip(start) {
                    column.push(T::from_f64(value));
                }
            }
        }
    }
}
