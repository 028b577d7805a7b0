//! Accelerations of particles by forces other than gravity and stress.

use super::State;
use crate::force;
use crate::instance::Instance;
use crate::math::Vector;
use crate::particles::{Group, Run};
use crate::setup::check::CheckedSetup;

/// Particles that forces are asked about at a time.
const ROWS: usize = 64;

/// The forces to evaluate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ActingOn {
    /// Those that act on nodes.
    Nodes,
    /// Those that act on particles, since they depend on where a particle started.
    Particles,
}

impl<T: Instance<D>, const D: usize> State<T, D> {
    /// Returns the largest acceleration of a particle of `groups` \[m/s²\].
    pub(crate) fn largest_acceleration(
        &self,
        scene: &CheckedSetup<D>,
        groups: &[Group<T, D>],
    ) -> f64 {
        let mut largest = 0.0_f64;
        if scene.setup.forces.is_empty() {
            return largest;
        }
        for group in groups {
            for run in &group.runs {
                for acting_on in [ActingOn::Nodes, ActingOn::Particles] {
                    self.for_accelerations(scene, group, run, acting_on, |_, found| {
                        let squared = found.iter().map(|&a| Vector(a).dot(Vector(a)));
                        largest = squared.fold(largest, f64::max);
                    });
                }
            }
        }
        largest.sqrt()
    }

    /// Calls `f(first row, accelerations)` for the rows of `run`, a few at a time. Accelerations are in m/s².
    pub(crate) fn for_accelerations(
        &self,
        scene: &CheckedSetup<D>,
        group: &Group<T, D>,
        run: &Run<D>,
        acting_on: ActingOn,
        mut f: impl FnMut(usize, &[[f64; D]]),
    ) {
        let time = self.control.time();
        let none = [[0.0; D]; ROWS];
        let (mut positions, mut starts, mut scratch, mut found) = (none, none, none, none);
        for first in run.rows().step_by(ROWS) {
            let rows = first..run.rows().end.min(first + ROWS);
            let count = rows.len();
            for (row, position) in rows.clone().zip(&mut positions) {
                *position = group.position(&scene.lattice, run.block, row);
            }
            let mut known = 0;
            if let Some(all) = &self.starts {
                for (&id, start) in group.id[rows].iter().zip(&mut starts) {
                    *start = all[id as usize];
                }
                known = count;
            }
            force::accelerations(
                &scene.setup.forces,
                acting_on == ActingOn::Particles,
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
