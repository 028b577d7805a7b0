//! The nodes at walls on their plane, and what the walls do to them.

use super::{BLOCK_NODES, QUAD, axis_index};
use crate::boundary::contact::{Column, ColumnNode};
use crate::boundary::walls::{Plane, Walls};
use crate::math::{Lanes, Vector};
use crate::store::block_edge;

/// A node by its place among all blocks' nodes.
#[derive(Clone, Copy, Debug)]
struct NodePlace(u32);

/// Beyond the wall, on its plane, inside; none where there is no block.
type Places = [Option<NodePlace>; 3];

/// For each of [`Walls::planes`], its columns of nodes in the blocks that there are.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns<const D: usize>(Vec<Vec<Places>>);

impl<const D: usize> Columns<D> {
    /// Finds the nodes on walls, and their neighbours across, among `blocks`, which are ascending.
    pub(super) fn find(&mut self, blocks: &[[i32; D]], walls: &Walls<D>) {
        let edge = block_edge(D) as i64;
        self.0.resize(walls.planes.len(), Vec::new());
        for (columns, wall) in self.0.iter_mut().zip(&walls.planes) {
            columns.clear();
            let of_wall = wall.node.div_euclid(edge);
            for block in blocks {
                if i64::from(block[wall.axis]) == of_wall {
                    push_columns(*block, blocks, wall, columns);
                }
            }
        }
    }

    /// Lets the walls act on the velocities in `nodes`, of `planes` planes.
    pub(super) fn fold<T: Lanes>(&self, nodes: &mut [T], planes: usize, walls: &Walls<D>) {
        let _flush = crate::float_mode::FlushToZero::enter();
        for (columns, wall) in self.0.iter().zip(&walls.planes) {
            for places in columns {
                let [beyond, plane, inside] =
                    places.map(|place| read::<T, D>(nodes, planes, place));
                if plane.mass <= T::default() {
                    continue;
                }
                let mut column = Column {
                    beyond,
                    plane,
                    inside,
                };
                let inward = f64::from(wall.inward);
                if !wall.contact.fold(&mut column, wall.axis, inward) {
                    continue;
                }
                let folded = [&column.beyond, &column.plane, &column.inside];
                for (place, node) in places.iter().zip(folded) {
                    write(nodes, planes, *place, node);
                }
            }
        }
    }
}

/// The columns of `wall` through `block`, which its plane passes.
fn push_columns<const D: usize>(
    block: [i32; D],
    blocks: &[[i32; D]],
    wall: &Plane,
    columns: &mut Vec<Places>,
) {
    let edge = block_edge(D) as i64;
    let inward = i64::from(wall.inward);
    // Of the three nodes: which block has them, and their index in it on the wall's axis.
    let across = [-inward, 0, inward].map(|step| {
        let node = wall.node + step;
        let mut owner = block;
        owner[wall.axis] = node.div_euclid(edge) as i32;
        (
            blocks.binary_search(&owner).ok(),
            node.rem_euclid(edge) as usize,
        )
    });
    let on_plane = across[1].1;
    let stride = (edge as usize).pow((D - 1 - wall.axis) as u32);
    for index in 0..BLOCK_NODES {
        if axis_index::<D>(index, wall.axis) == on_plane {
            let foot = index - on_plane * stride;
            columns.push(across.map(|(block, local)| {
                let node = foot + local * stride;
                block.map(|block| NodePlace((block * BLOCK_NODES + node) as u32))
            }));
        }
    }
}

/// Where a node's quad is in its plane 0.
#[inline(always)]
fn quad_at(place: NodePlace, planes: usize) -> usize {
    let (block, node) = (
        place.0 as usize / BLOCK_NODES,
        place.0 as usize % BLOCK_NODES,
    );
    (block * BLOCK_NODES * planes + node) * QUAD
}

#[inline(always)]
fn read<T: Lanes, const D: usize>(
    nodes: &[T],
    planes: usize,
    place: Option<NodePlace>,
) -> ColumnNode<T, D> {
    let zero = T::default();
    let mut node = ColumnNode {
        mass: zero,
        velocity: Vector([zero; D]),
        before: Vector([zero; D]),
    };
    let Some(place) = place else { return node };
    let at = quad_at(place, planes);
    node.mass = nodes[at + 3];
    for axis in 0..D {
        node.velocity[axis] = nodes[at + axis];
        if planes == 2 {
            let change = nodes[at + BLOCK_NODES * QUAD + axis];
            node.before[axis] = node.velocity[axis] - change;
        }
    }
    node
}

#[inline(always)]
fn write<T: Lanes, const D: usize>(
    nodes: &mut [T],
    planes: usize,
    place: Option<NodePlace>,
    node: &ColumnNode<T, D>,
) {
    let Some(place) = place else { return };
    let at = quad_at(place, planes);
    nodes[at + 3] = node.mass;
    for axis in 0..D {
        nodes[at + axis] = node.velocity[axis];
        if planes == 2 {
            nodes[at + BLOCK_NODES * QUAD + axis] = node.velocity[axis] - node.before[axis];
        }
    }
}
