//! Sums the tiles' contributions to each node, (1) and (2): what particles have brought is momentum on nodes then.
//!
//! Between this stage and the forces a halo exchange would go.

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let workspace = &mut substep.workspace;
    let storage = workspace.take_node_storage();
    workspace.momentum = T::sum_momentum(&workspace.grid, workspace.isa, storage);
    Ok(())
}
