//! Places the colliders for the substep.

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
        ..
    } = substep;
    workspace.place_colliders(scene, state, *dt);
    Ok(())
}
