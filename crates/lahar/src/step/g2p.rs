//! Grid to particles: velocities and positions, then each law's update, (5)–(8); particles inside of colliders
//! are projected out.

use super::Substep;
use crate::boundary::impulse::Impulse;
use crate::boundary::pointer::ParticlePointer;
use crate::error::Failure;
use crate::instance::Instance;
use crate::particles::{Group, in_range};
use crate::setup::to_3d;
use crate::transfer::g2p::{LARGEST_MOVE, Surroundings};

/// The particles that failed.
#[derive(Clone, Copy, Debug)]
struct Failed {
    material: usize,
    /// The first row.
    row: usize,
    count: u64,
}

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        scene,
        state,
        workspace,
        dt,
        ..
    } = substep;
    let lattice = &scene.lattice;
    let (mut speed_squared, mut moved, mut wave_speed_squared) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut failed = None;
    let pointer = ParticlePointer::of(state.pointer, lattice.origin, lattice.dx, *dt);
    let (scheme, isa, colliders) = (workspace.scheme, workspace.isa, &workspace.colliders);
    for (material, group) in state.groups.iter_mut().enumerate() {
        let surroundings = Surroundings {
            walls: &scene.walls,
            pointer: pointer.as_ref(),
            colliders,
        };
        let by_run = &mut workspace.impulses_by_run;
        let nodes = (&workspace.grid, &workspace.velocity);
        let method = (scheme, lattice);
        let found = T::gather(group, nodes, surroundings, method, isa, *dt, by_run);
        // Run after run: the order of sums does not depend on threads.
        let totals = workspace.boundaries.impulses[2 * D..].iter_mut();
        for (number, total) in totals.enumerate() {
            let mut of_group = Impulse::ZERO;
            for impulse in by_run.iter().skip(number).step_by(colliders.len()) {
                of_group.add_scaled(impulse, 1.0, [0.0; D]);
            }
            total.add_scaled(&of_group, 1.0, [0.0; D]);
        }
        speed_squared = speed_squared.max(found.speed_squared);
        moved = moved.max(found.moved);
        wave_speed_squared = wave_speed_squared.max(found.wave_modulus / group.density);
        if let Some(row) = found.failed {
            failed = failed.or(Some(Failed {
                material,
                row,
                count: found.failures,
            }));
        }
    }
    if let Some(failed) = failed {
        return Err(failure(substep, failed));
    }
    state.drift += moved;
    state.control.speed = speed_squared.sqrt();
    state.control.wave_speed = wave_speed_squared.sqrt();
    Ok(())
}

/// Describes the failure of particles.
fn failure<T: Instance<D>, const D: usize>(substep: &Substep<'_, T, D>, failed: Failed) -> Failure {
    let Substep { scene, state, .. } = substep;
    let group: &Group<T, D> = &state.groups[failed.material];
    // A law says of a chunk only that something in it is wrong.
    let is_bad = |&row: &usize| {
        let mut numbers = group.columns.iter().map(|column| column[row].to_f64());
        !numbers.all(f64::is_finite)
    };
    let bad = (failed.row..group.len()).find(is_bad);
    let row = bad.unwrap_or(failed.row);
    let run = (group.runs.iter())
        .find(|run| run.rows().contains(&row))
        .expect("every row is in a run");
    let problem = if bad.is_some() {
        "a particle's motion or strain is no longer a finite number".to_owned()
    } else if in_range(run.block) {
        format!("a particle has jumped by more than {LARGEST_MOVE} cells")
    } else {
        "a particle is too far from the origin to be placed".to_owned()
    };
    Failure {
        problem,
        particle: group.id[row],
        material: scene.setup.materials[failed.material].name.clone(),
        body: group.body.get(row),
        position: to_3d(group.position(&scene.lattice, run.block, row)),
        count: failed.count,
        substep: state.control.substeps + 1,
        time: substep.start,
        dt: substep.dt,
        dt_limit: substep.limit,
    }
}
