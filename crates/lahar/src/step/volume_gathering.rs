//! Sets the volumes of materials that take them from the grid: (7g).

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;
use crate::particles::{Group, Layout};

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        state, workspace, ..
    } = substep;
    let gathers = |group: &Group<T, D>| group.law.gathered_column().is_some();
    if !state.groups.iter().any(gathers) {
        return Ok(());
    }
    let volumes = workspace.rest_volumes(state);
    for group in &mut state.groups {
        if let Some(column) = group.law.gathered_column() {
            let column = Layout::strain(D) + column;
            let mut out = core::mem::take(&mut group.columns[column]);
            let (scheme, isa) = (workspace.scheme, workspace.isa);
            T::expansion(group, (&workspace.grid, &volumes), scheme, isa, &mut out);
            group.columns[column] = out;
        }
    }
    workspace.give_node_storage(volumes);
    Ok(())
}
