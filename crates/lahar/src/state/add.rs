//! Particles that are added, at the start or while a simulation runs.
//!
//! Only the new particles are placed, sorted and measured; then they are merged into the groups. Rows that are
//! there keep their order and are not sorted anew.

use super::State;
use super::workspace::Workspace;
use crate::error::SetupError;
use crate::instance::Instance;
use crate::particles::{Escaped, Group, PerParticle, Placement};
use crate::setup::ParticleBatch;
use crate::setup::check::CheckedSetup;
use core::borrow::Borrow;
use core::ops::Range;
use std::sync::Arc;

/// Adds the particles of `batches`, with ids that go on from the last. Batches that are not borrowed are dropped
/// one after the other.
///
/// # Errors
/// Names the field of the first batch that cannot be simulated; nothing is added then.
pub(crate) fn add<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    batches: impl IntoIterator<Item: Borrow<ParticleBatch<D>>>,
) -> Result<(), SetupError> {
    workspace.place_colliders(scene, state, 0.0);
    let placement = Placement {
        lattice: &scene.lattice,
        bounds: &scene.walls.bounds,
        colliders: &workspace.colliders,
    };
    let mut new: Vec<_> = (state.groups.iter())
        .map(Group::without_particles)
        .collect();
    let (mut next_id, mut starts, mut measured) = (state.next_id, Vec::new(), Vec::new());
    for batch in batches {
        let batch = batch.borrow();
        batch.check(&scene.setup, next_id, |material| {
            new[material].law.variables()
        })?;
        placement.check_range(&batch.position)?;
        new[batch.material].append(batch, &placement, next_id);
        let first = next_id;
        next_id += batch.position.len() as u32;
        if batch.measure_volume {
            measured.push(first..next_id);
        }
        if state.starts.is_some() {
            starts.extend_from_slice(&batch.position);
        }
    }
    // All batches are sound: from here on the state changes.
    state.next_id = next_id;
    if let Some(known) = &mut state.starts {
        Arc::make_mut(known).append(&mut starts);
    }
    let mut escaped = Escaped::default();
    for group in &mut new {
        group.shrink();
        escaped += workspace.sorter.sort(group, &scene.walls, &scene.lattice);
    }
    state.escaped += escaped;
    state.limit_by_new_particles(scene, &new);
    for (group, new) in state.groups.iter_mut().zip(new) {
        group.merge(new);
    }
    workspace.rebuild(scene, state);
    measure_volumes(state, workspace, &measured);
    state.limit_by_colliders(scene, &workspace.grid);
    Ok(())
}

/// Sets the rest volumes of particles with these ids to those that they fill on the grid.
fn measure_volumes<T: Instance<D>, const D: usize>(
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    ids: &[Range<u32>],
) {
    if ids.is_empty() {
        return;
    }
    let volumes_on_nodes = workspace.rest_volumes(state);
    let is_measured = |id: &u32| ids.iter().any(|ids| ids.contains(id));
    for group in &mut state.groups {
        if !group.id.iter().any(is_measured) {
            continue;
        }
        let mut expansion = vec![T::default(); group.len()];
        let (scheme, isa) = (workspace.scheme, workspace.isa);
        let nodes = (&workspace.grid, &volumes_on_nodes);
        T::expansion(group, nodes, scheme, isa, &mut expansion);
        let volume = |row: usize| {
            let given = group.volume0.get(row);
            if is_measured(&group.id[row]) {
                given + given * expansion[row]
            } else {
                given
            }
        };
        let volumes: Vec<T> = (0..group.len()).map(volume).collect();
        group.volume0 = PerParticle::Uniform(T::default());
        group.volume0.extend(0, volumes.into_iter());
    }
    workspace.give_node_storage(volumes_on_nodes);
}
