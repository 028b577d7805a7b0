//! Lets gravity, the other forces on nodes, drag and the pointer act: momentum on nodes becomes velocity.

use super::Substep;
use crate::boundary::pointer::NodePointer;
use crate::error::Failure;
use crate::force;
use crate::force::nodes::{NodeForces, evaluate, largest_impulse};
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
    let (dt, lattice) = (*dt, &scene.lattice);
    let forces = &scene.setup.forces;
    let blocks = workspace.grid.blocks();
    let impulses = force::any_on_nodes(forces).then(|| {
        let impulses = &mut workspace.node_impulses;
        evaluate(forces, (*start, dt), lattice, blocks, impulses);
        &workspace.node_impulses
    });
    let node_forces = NodeForces {
        dt: T::from_f64(dt),
        gravity_impulse: Vector(state.gravity.map(|g| T::from_f64(g * dt))),
        drag: force::drag(forces, dt)
            .map(|(left, medium)| (T::from_f64(left), Vector(medium.map(T::from_f64)))),
        pointer: (state.pointer)
            .map(|pointer| NodePointer::of(pointer, lattice.origin, lattice.dx)),
    };
    let momentum = core::mem::take(&mut workspace.momentum);
    let velocity = T::apply_forces(blocks, workspace.isa, momentum, &node_forces, impulses);
    if let Some(impulses) = impulses {
        state.control.field = largest_impulse(impulses, &velocity) / dt;
    }
    workspace.velocity = velocity;
    Ok(())
}
