//! Forces where the particles are: those that act on particles, and how strong all of them are.

use crate::forces;
use crate::instance::Instance;
use crate::math::Vector;
use crate::parallel;
use crate::particles::{ColumnsMut, Group, Layout, Run, split_runs};
use crate::simulation::Simulation;

/// Particles that forces are asked about at a time.
const ROWS: usize = 64;

impl<T: Instance<D>, const D: usize> Simulation<T, D> {
    /// Velocities changed by the forces that depend on where particles started: v += Δt a.
    pub(crate) fn push_particles(&mut self, dt: f64) {
        if self.starts.is_none() {
            return;
        }
        let mut groups = core::mem::take(&mut self.groups);
        for group in &mut groups {
            let first = Layout::velocity(D);
            let mut velocities: [Vec<T>; D] =
                core::array::from_fn(|axis| core::mem::take(&mut group.columns[first + axis]));
            let grain = parallel::grain(group.len(), 4096);
            let columns = ColumnsMut::new(&mut velocities);
            self.push_runs(group, &group.runs, 0, columns, dt, grain);
            for (column, velocity) in group.columns[first..].iter_mut().zip(velocities) {
                *column = velocity;
            }
        }
        self.groups = groups;
    }

    /// `velocities` begin with row `first_row`.
    fn push_runs(
        &self,
        group: &Group<T, D>,
        runs: &[Run<D>],
        first_row: usize,
        mut velocities: ColumnsMut<'_, T>,
        dt: f64,
        grain: usize,
    ) {
        if let Some((middle, row)) = split_runs(runs, grain) {
            let (low, high) = runs.split_at(middle);
            let (low_velocities, high_velocities) = velocities.split_at(row - first_row);
            parallel::join(
                || self.push_runs(group, low, first_row, low_velocities, dt, grain),
                || self.push_runs(group, high, row, high_velocities, dt, grain),
            );
            return;
        }
        for run in runs {
            self.for_accelerations(group, run, true, |row, found| {
                for (row, a) in (row - first_row..).zip(found) {
                    for axis in 0..D {
                        velocities.slices[axis][row] += T::from_f64(dt * a[axis]); // (11)
                    }
                }
            });
        }
    }

    /// The largest acceleration of a particle by forces besides gravity \[m/s²\].
    pub(crate) fn largest_acceleration(&self) -> f64 {
        let mut largest = 0.0_f64;
        if self.setup.forces.is_empty() {
            return largest;
        }
        for group in &self.groups {
            for run in &group.runs {
                for on_particles in [false, true] {
                    self.for_accelerations(group, run, on_particles, |_, found| {
                        let squared = found.iter().map(|&a| Vector(a).dot(Vector(a)));
                        largest = squared.fold(largest, f64::max);
                    });
                }
            }
        }
        largest.sqrt()
    }

    /// Calls `f(first row, accelerations)` for the rows of `run`, a few at a time, with what the forces that act
    /// on nodes, or those that act on particles, do to them.
    fn for_accelerations(
        &self,
        group: &Group<T, D>,
        run: &Run<D>,
        on_particles: bool,
        mut f: impl FnMut(usize, &[[f64; D]]),
    ) {
        let time = self.control.time();
        let none = [[0.0; D]; ROWS];
        let (mut positions, mut starts, mut scratch, mut found) = (none, none, none, none);
        for first in run.rows().step_by(ROWS) {
            let rows = first..run.rows().end.min(first + ROWS);
            let count = rows.len();
            for (row, position) in rows.clone().zip(&mut positions) {
                *position = self.position(group, run.block, row);
            }
            let mut known = 0;
            if let Some(all) = &self.starts {
                for (&id, start) in group.id[rows].iter().zip(&mut starts) {
                    *start = all[id as usize];
                }
                known = count;
            }
            forces::accelerations(
                &self.setup.forces,
                on_particles,
                time,
                &positions[..count],
                &starts[..known],
                &mut scratch[..count],
                &mut found[..count],
            );
            f(first, &found[..count]);
        }
    }
}
