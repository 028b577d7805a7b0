//! Sorts the particles by block, if one of them may have left its block's tile.

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        scene,
        state,
        workspace,
        ..
    } = substep;
    workspace.sort_if_drifted(scene, state);
    Ok(())
}
