//! The nodes around a collider: found, handed to the contact law and written back.

use super::contact::{self, BAND, NearNode, Scratch};
use super::placed::Moving;
use crate::boundary::impulse::Impulse;
use crate::boundary::walls::Walls;
use crate::float_mode::FlushToZero;
use crate::grid::{BLOCK_NODES, Blocks, NodeField, QUAD, Velocity};
use crate::math::{Lanes, Vector};
use crate::particles::block_edge;

/// No node, or no block.
const NONE: u32 = u32::MAX;

/// The nodes with mass around one collider, block after block. It lives from substep to substep, so that its buffers are
/// allocated once.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearNodes<const D: usize> {
    nodes: Vec<NearNode<D>>,
    /// Where each node's quad begins in the field.
    quads: Vec<usize>,
    /// By block, its number among the near blocks.
    slots: Vec<u32>,
    /// By near block and node in it, the place in `nodes`.
    index: Vec<[u32; BLOCK_NODES]>,
    /// The nodes before the collider acts.
    free: Vec<NearNode<D>>,
    scratch: Scratch<D>,
}

impl<const D: usize> NearNodes<D> {
    /// Finds the nodes around `collider`, before walls on their plane change masses. `dx` is in m.
    pub(crate) fn find<T: Lanes>(
        &mut self,
        collider: &Moving<D>,
        blocks: &Blocks<D>,
        velocities: &NodeField<Velocity, T>,
        walls: &Walls<D>,
        dx: f64,
    ) {
        let edge = block_edge(D) as i64;
        let half_diagonal = 0.5 * (edge - 1) as f64 * (D as f64).sqrt();
        self.nodes.clear();
        self.quads.clear();
        self.slots.clear();
        self.slots.resize(blocks.len(), NONE);
        self.index.clear();
        for block in 0..blocks.len() {
            let first = blocks.first_node(block);
            let middle = first.map(|n| n as f64 + 0.5 * (edge - 1) as f64);
            if collider.start.distance(middle).0 > BAND + half_diagonal
                && !walls.have_nodes_beyond(first, edge)
            {
                continue;
            }
            let mut index = [NONE; BLOCK_NODES];
            for (local, index) in index.iter_mut().enumerate() {
                let quad = block * velocities.block_len() + local * QUAD;
                let mass = velocities.numbers()[quad + 3];
                if mass <= T::default() {
                    continue;
                }
                let near = contact::near(collider, blocks.node(block, local), walls);
                if let Some(mut node) = near {
                    node.moving = node.moving * dx;
                    node.brought = mass.to_f64();
                    *index = self.nodes.len() as u32;
                    self.nodes.push(node);
                    self.quads.push(quad);
                }
            }
            if index.iter().any(|&index| index != NONE) {
                self.slots[block] = self.index.len() as u32;
                self.index.push(index);
            }
        }
    }

    /// Lets `collider` act on the nodes around it. Adds the impulse on it to `impulse`; `blend` is FLIP's.
    pub(crate) fn constrain<T: Lanes>(
        &mut self,
        collider: &Moving<D>,
        blocks: &Blocks<D>,
        velocities: &mut NodeField<Velocity, T>,
        blend: f64,
        impulse: &mut Impulse<D>,
    ) {
        let _flush = FlushToZero::enter();
        let change_of = BLOCK_NODES * QUAD;
        let has_change = velocities.layers() == 2;
        let numbers = velocities.numbers_mut();
        let Self {
            nodes,
            quads,
            slots,
            index,
            free,
            scratch,
        } = self;
        for (node, &quad) in nodes.iter_mut().zip(&*quads) {
            node.mass = numbers[quad + 3].to_f64();
            node.velocity = Vector::from_fn(|axis| numbers[quad + axis].to_f64());
            if has_change {
                node.before = Vector::from_fn(|axis| {
                    node.velocity[axis] - numbers[quad + change_of + axis].to_f64()
                });
            }
        }
        let find = |node: [i64; D]| {
            let (block, local) = blocks.find(node)?;
            let index = index.get(slots[block] as usize)?[local];
            (index != NONE).then_some(index as usize)
        };
        free.clone_from(nodes);
        contact::constrain(nodes, find, collider.contact, blend, impulse, scratch);
        for ((node, free), &quad) in nodes.iter().zip(&*free).zip(&*quads) {
            // A node that the collider has not changed keeps its bits.
            if node.velocity == free.velocity && node.before == free.before {
                continue;
            }
            for axis in 0..D {
                numbers[quad + axis] = T::from_f64(node.velocity[axis]);
                if has_change {
                    let change = node.velocity[axis] - node.before[axis];
                    numbers[quad + change_of + axis] = T::from_f64(change);
                }
            }
        }
    }
}
