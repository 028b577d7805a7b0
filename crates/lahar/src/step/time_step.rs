//! Advances the clock, and bounds the next substep by the speeds of colliders.

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
        dt,
        limit,
        ..
    } = substep;
    state.control.advance(*dt, *limit);
    state.limit_by_colliders(scene, &workspace.grid);
    Ok(())
}
