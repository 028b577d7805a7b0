//! Particles to grid: mass, momentum and the impulse of stress, (1)–(4), summed on each block's tile.

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        state,
        workspace,
        dt,
        ..
    } = substep;
    let (scheme, isa) = (workspace.scheme, workspace.isa);
    for group in &state.groups {
        let tiles = workspace.grid.tiles_mut();
        T::add_momentum(group, scheme, isa, *dt, tiles);
    }
    Ok(())
}
