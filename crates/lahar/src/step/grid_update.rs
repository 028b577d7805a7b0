//! Momentum of the nodes to velocity: sums over tiles, forces, walls and colliders.

use super::Substep;
use crate::error::Failure;
use crate::forces;
use crate::grid::{NodeForces, NodePointer};
use crate::instance::Instance;
use crate::math::Vector;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        scene,
        state,
        workspace,
        dt,
        start,
        ..
    } = substep;
    let (dt, dx, origin) = (*dt, scene.lattice.dx, scene.lattice.origin);
    let forces = &scene.setup.forces;
    let fields = forces::any_on_nodes(forces);
    if fields {
        workspace.grid.evaluate(forces, *start, dt, origin, dx);
    }
    let node_forces = NodeForces {
        dt: T::from_f64(dt),
        dx,
        gravity_impulse: Vector(state.gravity.map(|g| T::from_f64(g * dt))),
        drag: forces::drag(forces, dt)
            .map(|(kept, medium)| (T::from_f64(kept), Vector(medium.map(T::from_f64)))),
        pointer: (state.pointer).map(|pointer| NodePointer::of(pointer, origin, dx)),
    };
    let isa = workspace.isa;
    let colliders = &workspace.colliders;
    T::update(
        &mut workspace.grid,
        isa,
        &node_forces,
        &scene.walls,
        colliders,
    );
    if fields {
        state.control.field = workspace.grid.largest_impulse() / dt;
    }
    Ok(())
}
