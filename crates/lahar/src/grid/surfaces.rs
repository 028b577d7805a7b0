//! The nodes around colliders, and what the colliders do to them.

use super::{BLOCK_NODES, Grid, QUAD, axis_index};
use crate::boundary::collider::Moving;
use crate::boundary::surface::{BAND, NearNode, Room, hold, near};
use crate::boundary::walls::Walls;
use crate::math::{Lanes, Vector};
use crate::particles::block_edge;

/// No node, or no block.
const NONE: u32 = u32::MAX;

/// The nodes with mass around one collider, block after block. Kept from substep to substep for its room.
#[derive(Clone, Debug, Default)]
pub(super) struct Near<const D: usize> {
    nodes: Vec<NearNode<D>>,
    /// Where each node's quad is.
    quads: Vec<usize>,
    /// By block, which of the near blocks it is.
    slots: Vec<u32>,
    /// By near block and node in it, which of `nodes` it is.
    index: Vec<[u32; BLOCK_NODES]>,
    /// The nodes before the collider acts.
    free: Vec<NearNode<D>>,
    room: Room<D>,
}

impl<T: Lanes, const D: usize> Grid<T, D> {
    /// Finds the nodes around `collider`, before the domain's walls change masses. `dx` \[m\].
    pub(super) fn around(
        &self,
        collider: &Moving<D>,
        walls: &Walls<D>,
        dx: f64,
        found: &mut Near<D>,
    ) {
        let edge = block_edge(D) as i64;
        let half_diagonal = 0.5 * (edge - 1) as f64 * (D as f64).sqrt();
        found.nodes.clear();
        found.quads.clear();
        found.slots.clear();
        found.slots.resize(self.blocks.len(), NONE);
        found.index.clear();
        for (block, coordinates) in self.blocks.iter().enumerate() {
            let first: [i64; D] = coordinates.map(|b| i64::from(b) * edge);
            let middle = first.map(|n| n as f64 + 0.5 * (edge - 1) as f64);
            if collider.start.distance(middle).0 > BAND + half_diagonal
                && !walls.passes(first, edge)
            {
                continue;
            }
            let mut index = [NONE; BLOCK_NODES];
            for (local, index) in index.iter_mut().enumerate() {
                let quad = block * self.block_len() + local * QUAD;
                let mass = self.nodes[quad + 3];
                if mass <= T::default() {
                    continue;
                }
                let node =
                    core::array::from_fn(|axis| first[axis] + axis_index::<D>(local, axis) as i64);
                if let Some(mut node) = near(collider, node, walls) {
                    node.moving = node.moving * dx;
                    node.brought = mass.to_f64();
                    *index = found.nodes.len() as u32;
                    found.nodes.push(node);
                    found.quads.push(quad);
                }
            }
            if index.iter().any(|&index| index != NONE) {
                found.slots[block] = found.index.len() as u32;
                found.index.push(index);
            }
        }
    }

    /// Lets `collider` act on the nodes around it, and adds what it takes to `self.taken[number]`.
    pub(super) fn hold(
        &mut self,
        collider: &Moving<D>,
        number: usize,
        near: &mut Near<D>,
        walls: &Walls<D>,
    ) {
        let _flush = crate::float_mode::FlushToZero::enter();
        let changes = BLOCK_NODES * QUAD;
        let Near {
            nodes,
            quads,
            slots,
            index,
            free,
            room,
        } = near;
        for (node, &quad) in nodes.iter_mut().zip(&*quads) {
            node.mass = self.nodes[quad + 3].to_f64();
            node.velocity = Vector::from_fn(|axis| self.nodes[quad + axis].to_f64());
            if self.planes == 2 {
                node.before = Vector::from_fn(|axis| {
                    node.velocity[axis] - self.nodes[quad + changes + axis].to_f64()
                });
            }
        }
        let edge = block_edge(D) as i64;
        let find = |node: [i64; D]| {
            let node = walls.canonical(node);
            let block = self
                .blocks
                .binary_search(&node.map(|n| n.div_euclid(edge) as i32))
                .ok()?;
            let local = node.iter().fold(0, |local, n| {
                local * edge as usize + n.rem_euclid(edge) as usize
            });
            let index = index.get(slots[block] as usize)?[local];
            (index != NONE).then_some(index as usize)
        };
        let mut taken = self.taken[number];
        free.clone_from(nodes);
        hold(nodes, find, collider.contact, self.blend, &mut taken, room);
        self.taken[number] = taken;
        for ((node, free), &quad) in nodes.iter().zip(&*free).zip(&*quads) {
            // What the collider has not changed keeps its bits.
            if node.velocity == free.velocity && node.before == free.before {
                continue;
            }
            for axis in 0..D {
                self.nodes[quad + axis] = T::from_f64(node.velocity[axis]);
                if self.planes == 2 {
                    let change = node.velocity[axis] - node.before[axis];
                    self.nodes[quad + changes + axis] = T::from_f64(change);
                }
            }
        }
    }
}
