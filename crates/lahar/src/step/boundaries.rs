//! Lets walls and colliders act on the velocities of nodes.

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        scene, workspace, ..
    } = substep;
    T::constrain(
        &mut workspace.boundaries,
        workspace.grid.blocks(),
        workspace.isa,
        &mut workspace.velocity,
        &scene.walls,
        (&workspace.colliders, scene.lattice.dx),
    );
    Ok(())
}
