//! The boundaries of the oracle: walls and colliders on nodes and on particles.

use super::{Grid, Particle, Reference, Velocity};
use crate::boundary::colliders::contact::{self, NearNode, Scratch, near};
use crate::boundary::colliders::placed::Moving;
use crate::boundary::colliders::projection::project_out;
use crate::boundary::impulse::Impulse;
use crate::boundary::walls::fold::{Triple, TripleNode};
use crate::math::Vector;
use crate::setup::{Collider, Transfer};
use std::collections::BTreeMap;

impl<const D: usize> Reference<D> {
    /// Returns the colliders in a substep of `dt` \[s\].
    pub(super) fn moving(&self, dt: f64) -> Vec<Moving<D>> {
        let period = self
            .walls
            .period
            .map(|cells| cells.map(|cells| cells as f64));
        let of = |collider: &Collider<D>| {
            let mut moving = Moving::of(collider, period);
            moving.move_to(collider, self.time, dt);
            moving
        };
        self.colliders.iter().map(of).collect()
    }

    /// Returns the nodes around a collider, before walls have changed their masses.
    pub(super) fn nodes_near(
        &self,
        collider: &Moving<D>,
        grid: &Grid<Velocity<D>, D>,
    ) -> Vec<NearNode<D>> {
        let with_mass = grid.iter().filter_map(|(&node, n)| {
            let mut near = near(collider, node, &self.walls)?;
            near.brought = n.mass;
            near.moving = near.moving * self.setup.dx;
            Some(near)
        });
        with_mass.collect()
    }

    /// Lets a collider act on the nodes around it. Adds the impulse on it to `impulse`.
    pub(super) fn constrain_by(
        &self,
        collider: &Moving<D>,
        mut nodes: Vec<NearNode<D>>,
        grid: &mut Grid<Velocity<D>, D>,
        impulse: &mut Impulse<D>,
    ) {
        for near in &mut nodes {
            let n = &grid[&near.node];
            (near.mass, near.velocity, near.before) = (n.mass, n.after, n.before);
        }
        let places: BTreeMap<[i64; D], usize> = nodes
            .iter()
            .enumerate()
            .map(|(i, near)| (near.node, i))
            .collect();
        let find = |node| places.get(&self.walls.canonical(node)).copied();
        let blend = match self.setup.transfer {
            Transfer::Flip { blend } => blend,
            Transfer::Pic | Transfer::Apic => 0.0,
        };
        let scratch = &mut Scratch::default();
        contact::constrain(&mut nodes, find, collider.contact, blend, impulse, scratch);
        for near in &nodes {
            let velocity = Velocity {
                mass: near.mass,
                before: near.before,
                after: near.velocity,
            };
            grid.insert(near.node, velocity);
        }
    }

    /// Lets the walls on their planes act on velocities.
    pub(super) fn fold_walls(&self, grid: &mut Grid<Velocity<D>, D>) {
        for wall in &self.walls.planes {
            let on_plane = grid.keys().filter(|node| node[wall.axis] == wall.node);
            for node in on_plane.copied().collect::<Vec<_>>() {
                let inward = i64::from(wall.inward);
                let places = [-inward, 0, inward].map(|step| {
                    let mut place = node;
                    place[wall.axis] += step;
                    place
                });
                let nothing = Velocity {
                    mass: 0.0,
                    before: Vector([0.0; D]),
                    after: Vector([0.0; D]),
                };
                let [beyond, on_plane, inside] = places.map(|place| {
                    let node = grid.get(&place).unwrap_or(&nothing);
                    TripleNode {
                        mass: node.mass,
                        velocity: node.after,
                        before: node.before,
                    }
                });
                let mut triple = Triple {
                    beyond,
                    on_plane,
                    inside,
                };
                let inward = f64::from(wall.inward);
                if !wall.contact.fold(&mut triple, wall.axis, inward) {
                    continue;
                }
                let folded = [triple.beyond, triple.on_plane, triple.inside];
                for (place, node) in places.into_iter().zip(folded) {
                    let velocity = Velocity {
                        mass: node.mass,
                        before: node.before,
                        after: node.velocity,
                    };
                    grid.insert(place, velocity);
                }
            }
        }
    }

    /// Clamps a particle's position to the bounds of walls and clamps.
    pub(super) fn clamp(&self, particle: &mut Particle<D>) {
        let dx = self.setup.dx;
        for axis in 0..D {
            let x = &mut particle.position[axis];
            let (low, high) = self.walls.bounds[axis];
            if let Some(low) = low {
                *x = x.max(self.origin[axis] + low * dx);
            }
            if let Some(high) = high {
                *x = x.min(self.origin[axis] + high * dx);
            }
        }
    }

    /// Projects a particle inside a collider onto its surface.
    pub(super) fn project_out(&self, particle: &mut Particle<D>, colliders: &[Moving<D>]) {
        let mut x = self.in_cells(particle);
        let (bounds, motion) = (&self.walls.bounds, (&mut x, &mut particle.velocity));
        let dx = self.setup.dx;
        if project_out(colliders, bounds, [0.0; D], motion, dx, |_, _, _| {}) {
            particle.position = self.origin + x * self.setup.dx;
        }
    }

    /// Wraps a particle's position around periodic axes, and slows it down in a cushion.
    pub(super) fn wrap_and_slow(&self, particle: &mut Particle<D>) {
        let dx = self.setup.dx;
        for axis in 0..D {
            let x = &mut particle.position[axis];
            if let Some(cells) = self.walls.period[axis] {
                let length = cells as f64 * dx;
                *x -= ((*x - self.origin[axis]) / length).floor() * length;
            }
            if let Some(cushion) = &self.setup.cushion {
                let ahead = |side: f64| (side - *x) / cushion.time;
                let (low, high) = (cushion.inside.min[axis], cushion.inside.max[axis]);
                let v = &mut particle.velocity[axis];
                *v = v.max(ahead(low)).min(ahead(high));
            }
        }
    }

    /// Returns true if a particle is beyond an open side.
    pub(super) fn is_outside(&self, particle: &Particle<D>) -> bool {
        let x = self.in_cells(particle);
        (0..D).any(|axis| {
            let (low, high) = self.walls.open[axis];
            low.is_some_and(|low| x[axis] < low) || high.is_some_and(|high| x[axis] > high)
        })
    }
}
