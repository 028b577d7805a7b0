//! Changes velocities by the forces that depend on where a particle started: v += Δt a, (11).

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;
use crate::parallel;
use crate::particles::{ColumnsMut, Group, Layout, Run, split_runs};
use crate::setup::check::CheckedSetup;
use crate::state::State;
use crate::state::accelerations::ActingOn;

/// The smallest number of particles that is worth a thread's attention.
const SMALLEST_PIECE: usize = 4096;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        scene, state, dt, ..
    } = substep;
    if state.starts.is_none() {
        return Ok(());
    }
    let mut groups = core::mem::take(&mut state.groups);
    for group in &mut groups {
        let first = Layout::velocity(D);
        let mut velocities: [Vec<T>; D] =
            core::array::from_fn(|axis| core::mem::take(&mut group.columns[first + axis]));
        let grain = parallel::grain(group.len(), SMALLEST_PIECE);
        let columns = ColumnsMut::new(&mut velocities);
        let task = Task {
            scene,
            state,
            group,
            dt: *dt,
            grain,
        };
        task.halve(&group.runs, 0, columns);
        for (column, velocity) in group.columns[first..].iter_mut().zip(velocities) {
            *column = velocity;
        }
    }
    state.groups = groups;
    Ok(())
}

struct Task<'a, T: Instance<D>, const D: usize> {
    scene: &'a CheckedSetup<D>,
    /// The state without its particles.
    state: &'a State<T, D>,
    group: &'a Group<T, D>,
    dt: f64,
    grain: usize,
}

impl<T: Instance<D>, const D: usize> Task<'_, T, D> {
    /// Changes the velocities of the particles of `runs`; `velocities` begin with row `first_row`.
    fn halve(&self, runs: &[Run<D>], first_row: usize, mut velocities: ColumnsMut<'_, T>) {
        if let Some((middle, row)) = split_runs(runs, self.grain) {
            let (low, high) = runs.split_at(middle);
            let (low_velocities, high_velocities) = velocities.split_at(row - first_row);
            parallel::join(
                || self.halve(low, first_row, low_velocities),
                || self.halve(high, row, high_velocities),
            );
            return;
        }
        for run in runs {
            let (scene, acting_on) = (self.scene, ActingOn::Particles);
            self.state
                .for_accelerations(scene, self.group, run, acting_on, |row, found| {
                    for (row, a) in (row - first_row..).zip(found) {
                        for axis in 0..D {
                            velocities.slices[axis][row] += T::from_f64(self.dt * a[axis]); // (11)
                        }
                    }
                });
        }
    }
}
