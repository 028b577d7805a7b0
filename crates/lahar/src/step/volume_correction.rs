//! Corrects the volumes of fluids that drift: (7h) and (7i), at intervals.

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;
use crate::material::VolumeCorrection;
use crate::particles::{Group, Layout};
use crate::setup::CORRECTION_INTERVAL;

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
    let dx = scene.lattice.dx;
    let corrected = |group: &Group<T, D>| {
        let (column, rates) = group.law.corrected_column()?;
        (group.len() > 0).then_some((column, rates))
    };
    let time = state.time_since_correction + *dt;
    state.time_since_correction = time;
    let fluids = (state.groups.iter()).filter(|group| corrected(group).is_some());
    let cells = fluids
        .map(|group| time * group.sound_speed / dx)
        .fold(0.0, f64::max);
    if cells < CORRECTION_INTERVAL {
        return Ok(());
    }
    state.time_since_correction = 0.0;
    let (scheme, isa) = (workspace.scheme, workspace.isa);
    for index in 0..state.groups.len() {
        let Some((column, rates)) = corrected(&state.groups[index]) else {
            continue;
        };
        for (other, group) in state.groups.iter().enumerate() {
            let tiles = workspace.grid.tiles_mut();
            T::add_volumes(group, scheme, isa, other == index, tiles);
        }
        let storage = workspace.take_node_storage();
        let (grid, excess) = (&workspace.grid, &mut workspace.excess);
        let volumes = T::sum_volumes(grid, isa, storage);
        let walls = (&scene.walls, &workspace.boundaries.faces);
        let filling = T::measure_filling(grid, isa, volumes, walls, dx, excess);
        let shares = VolumeCorrection {
            smoothing: rates.smoothing * time,
            correction: rates.correction * time,
        };
        let group = &mut state.groups[index];
        let column = Layout::strain(D) + column;
        let mut e = core::mem::take(&mut group.columns[column]);
        let nodes = (&workspace.grid, &filling);
        T::correct_volume(group, nodes, scheme, isa, shares, &mut e);
        group.columns[column] = e;
        workspace.give_node_storage(filling);
    }
    Ok(())
}
