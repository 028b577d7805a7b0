//! Walls of [`WallStyle::Nodes`](crate::setup::WallStyle), as in the Taichi examples: each node in a wall is constrained
//! by itself.

use super::{Walls, side};
use crate::boundary::impulse::Impulse;
use crate::float_mode::FlushToZero;
use crate::grid::{BLOCK_NODES, Blocks, NodeField, QUAD, Velocity};
use crate::math::{Scalar, Vector};
use crate::particles::block_edge;

impl<const D: usize> Walls<D> {
    /// Constrains the `velocities` of all nodes in walls of this style. Adds the impulses on the walls to `impulses`, by
    /// side of the domain.
    pub(crate) fn constrain_nodes<T: Scalar>(
        &self,
        blocks: &Blocks<D>,
        velocities: &mut NodeField<Velocity, T>,
        impulses: &mut [Impulse<D>],
    ) {
        let _flush = FlushToZero::enter();
        let (block_len, layers) = (velocities.block_len(), velocities.layers());
        let of_blocks = velocities.numbers_mut().chunks_exact_mut(block_len);
        for (block, nodes) in of_blocks.enumerate() {
            if !self.has_nodes_among(blocks.first_node(block), block_edge(D)) {
                continue;
            }
            let (quads, changes) = nodes.split_at_mut(BLOCK_NODES * QUAD);
            for local in 0..BLOCK_NODES {
                let at = local * QUAD;
                let mass = quads[at + 3];
                if mass <= T::default() {
                    continue;
                }
                let free = Vector::<T, D>::from_fn(|axis| quads[at + axis]);
                let velocity = self.constrain(free, blocks.node(block, local), mass, impulses);
                for axis in 0..D {
                    quads[at + axis] = velocity[axis];
                    if layers == 2 {
                        changes[at + axis] += velocity[axis] - free[axis];
                    }
                }
            }
        }
    }

    /// Returns true if any node of `first .. first + edge` on each axis is in a wall of this style.
    fn has_nodes_among(&self, first: [i64; D], edge: usize) -> bool {
        (0..D).any(|axis| {
            self.low[axis].is_some_and(|end| first[axis] <= end.node)
                || self.high[axis].is_some_and(|end| first[axis] + edge as i64 > end.node)
        })
    }

    /// Returns the velocity of node `node` of `mass` after the walls of this style have acted on it, axis after axis.
    /// Adds the impulses on the walls to `impulses`, by side of the domain.
    #[inline(always)]
    pub(crate) fn constrain<T: Scalar>(
        &self,
        mut velocity: Vector<T, D>,
        node: [i64; D],
        mass: T,
        impulses: &mut [Impulse<D>],
    ) -> Vector<T, D> {
        for axis in 0..D {
            let low = self.low[axis].filter(|end| node[axis] <= end.node);
            let high = self.high[axis].filter(|end| node[axis] >= end.node);
            for (end, inward) in [(low, 1.0), (high, -1.0)] {
                let Some(end) = end else { continue };
                let free = velocity;
                velocity = end.contact.constrain(free, axis, inward);
                let change = Vector::from_fn(|i| (velocity[i] - free[i]).to_f64());
                let at = node.map(|node| node as f64);
                impulses[side(axis, inward < 0.0)].add(at, change * -mass.to_f64()); // (13)
            }
        }
        velocity
    }
}
