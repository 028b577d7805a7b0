//! Adds the impulses on boundaries in the substep to their totals since the start, and to the gauges in walls.

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;
use crate::state::sensor;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        scene,
        state,
        workspace,
        ..
    } = substep;
    let (dx, boundaries) = (scene.lattice.dx, &workspace.boundaries);
    let (sides, of_colliders) = state.boundary_totals.split_at_mut(2 * D);
    for (total, impulse) in sides.iter_mut().zip(&boundaries.impulses) {
        total.add_scaled(impulse, dx, scene.lattice.origin);
    }
    let each = of_colliders.iter_mut().zip(&boundaries.impulses[2 * D..]);
    for ((total, impulse), collider) in each.zip(&workspace.colliders) {
        // Angular impulses are about the collider's center at the time.
        let from_center = (-collider.start.center() * dx).0;
        total.add_scaled(impulse, dx, from_center);
    }
    sensor::press(scene, state, &boundaries.faces);
    Ok(())
}
