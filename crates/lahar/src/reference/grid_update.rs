//! The grid update of the oracle: forces and boundaries, node by node.

use super::transfer::over;
use super::{Grid, Momentum, Reference, Velocity};
use crate::boundary::impulse::Impulse;
use crate::boundary::pointer::NodePointer;
use crate::force;
use crate::math::Vector;

impl<const D: usize> Reference<D> {
    /// Lets forces and boundaries act on the nodes, for a substep of `dt` \[s\]. Nodes without mass are left out.
    pub fn update_grid(&self, grid: &Grid<Momentum<D>, D>, dt: f64) -> Grid<Velocity<D>, D> {
        let mut impulses = vec![Impulse::ZERO; 2 * D + self.colliders.len()];
        let gravity = Vector(self.setup.gravity);
        let with_mass = grid.iter().filter(|(_, n)| n.mass > 0.0);
        let mut grid = with_mass
            .map(|(&node, n)| {
                let before = over(n.momentum, n.mass);
                let x = core::array::from_fn(|axis| {
                    self.origin[axis] + self.setup.dx * node[axis] as f64
                });
                let mut field = [[0.0; D]];
                let all = &self.setup.forces;
                force::accelerations(
                    all,
                    false,
                    self.time,
                    &[x],
                    &[],
                    &mut [field[0]],
                    &mut field,
                );
                let mut free = over(n.momentum + n.impulse, n.mass);
                free += (gravity + Vector(field[0])) * dt; // (9)
                if let Some((left, medium)) = force::drag(all, dt) {
                    free = Vector(medium) + (free - Vector(medium)) * left; // (10)
                }
                if let Some(pointer) = self.pointer {
                    let pointer = NodePointer::of(pointer, self.origin.0, self.setup.dx);
                    free = pointer.act(free, node, dt);
                }
                let velocity = Velocity {
                    mass: n.mass,
                    before,
                    after: self.walls.constrain(free, node, n.mass, &mut impulses),
                };
                (node, velocity)
            })
            .collect();
        let colliders = self.moving(dt);
        let near: Vec<_> = colliders
            .iter()
            .map(|collider| self.nodes_near(collider, &grid))
            .collect();
        self.fold_walls(&mut grid);
        let near = colliders.iter().zip(near);
        for ((collider, nodes), impulse) in near.zip(&mut impulses[2 * D..]) {
            self.constrain_by(collider, nodes, &mut grid, impulse);
        }
        grid
    }
}
