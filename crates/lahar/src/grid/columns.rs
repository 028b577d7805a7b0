//! The nodes at walls on their plane, and what the walls do to them.

use super::{BLOCK_NODES, QUAD, axis_index};
use crate::boundary::contact::{Column, ColumnNode};
use crate::boundary::impulse::Taken;
use crate::boundary::walls::{Plane, Walls};
use crate::math::{Lanes, Vector};
use crate::store::block_edge;

/// A node by its place among all blocks' nodes.
#[derive(Clone, Copy, Debug)]
struct NodePlace(u32);

/// A node on a wall and its neighbours across.
#[derive(Clone, Copy, Debug)]
struct Places<const D: usize> {
    /// Beyond the wall, on its plane, inside; none where there is no block.
    across: [Option<NodePlace>; 3],
    /// The index on each axis of the node on the plane.
    node: [i32; D],
}

/// For each of [`Walls::planes`], its columns of nodes in the blocks that there are.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns<const D: usize> {
    walls: Vec<Vec<Places<D>>>,
    /// The normal impulse that each column gave to its wall in the last update \[kg m/s\].
    pressed: Vec<Vec<f64>>,
    /// The masses of all columns' nodes, before the first wall has acted \[kg\].
    masses: Vec<[f64; 3]>,
}

impl<const D: usize> Columns<D> {
    /// Finds the nodes on walls, and their neighbours across, among `blocks`, which are ascending.
    pub(super) fn find(&mut self, blocks: &[[i32; D]], walls: &Walls<D>) {
        let edge = block_edge(D) as i64;
        self.walls.resize(walls.planes.len(), Vec::new());
        for (columns, wall) in self.walls.iter_mut().zip(&walls.planes) {
            columns.clear();
            let of_wall = wall.node.div_euclid(edge);
            for block in blocks {
                if i64::from(block[wall.axis]) == of_wall {
                    push_columns(*block, blocks, wall, columns);
                }
            }
        }
    }

    /// Lets the walls act on the velocities in `nodes`, of `planes` planes. Adds what they take from
    /// particles that keep `blend` of their own velocities to `taken`, by [`Plane::side`].
    pub(super) fn fold<T: Lanes>(
        &mut self,
        nodes: &mut [T],
        planes: usize,
        walls: &Walls<D>,
        blend: f64,
        taken: &mut [Taken<D>],
    ) {
        let _flush = crate::float_mode::FlushToZero::enter();
        // Folding changes masses, and in corners a second wall finds them changed; particles have the
        // masses that they brought.
        self.masses.clear();
        for places in self.walls.iter().flatten() {
            self.masses.push(places.across.map(|place| {
                place.map_or(0.0, |place| nodes[quad_at(place, planes) + 3].to_f64())
            }));
        }
        let mut masses = self.masses.iter();
        self.pressed.resize(walls.planes.len(), Vec::new());
        let pressed = self.pressed.iter_mut();
        for ((columns, wall), pressed) in self.walls.iter().zip(&walls.planes).zip(pressed) {
            pressed.clear();
            pressed.resize(columns.len(), 0.0);
            let taken = &mut taken[wall.side()];
            for ((places, masses), pressed) in columns.iter().zip(&mut masses).zip(pressed) {
                let [beyond, plane, inside] = places
                    .across
                    .map(|place| read::<T, D>(nodes, planes, place));
                if plane.mass <= T::default() {
                    continue;
                }
                let free = [beyond, plane, inside];
                let mut column = Column {
                    beyond,
                    plane,
                    inside,
                };
                let inward = f64::from(wall.inward);
                if !wall.contact.fold(&mut column, wall.axis, inward) {
                    continue;
                }
                let folded = [column.beyond, column.plane, column.inside];
                for (place, node) in places.across.iter().zip(&folded) {
                    write(nodes, planes, *place, node);
                }
                for (k, step) in (-1..=1).enumerate() {
                    let change = Vector::from_fn(|axis| {
                        (folded[k].velocity[axis] - free[k].velocity[axis]).to_f64()
                            - blend * (folded[k].before[axis] - free[k].before[axis]).to_f64()
                    });
                    let mut at = places.node.map(f64::from);
                    at[wall.axis] += f64::from(wall.inward) * f64::from(step);
                    taken.add(at, change * -masses[k]); // (13)
                    *pressed += change[wall.axis] * masses[k] * inward;
                }
            }
        }
    }
}

impl<const D: usize> Columns<D> {
    /// The nodes on wall number `wall` of [`Walls::planes`], by index, and the normal impulse that each
    /// took in the last update \[kg m/s\].
    pub(super) fn pressed(&self, wall: usize) -> impl Iterator<Item = ([i32; D], f64)> {
        let nodes = self.walls[wall].iter().map(|places| places.node);
        nodes.zip(self.pressed[wall].iter().copied())
    }

    /// Adds to the volumes that nodes near walls hold those of the mirror images.
    pub(super) fn mirror_volumes<T: Lanes>(&self, nodes: &mut [T], planes: usize) {
        for columns in &self.walls {
            for places in columns {
                let at = places
                    .across
                    .map(|place| place.map(|place| quad_at(place, planes)));
                for lane in 0..QUAD {
                    let read = |at: Option<usize>| at.map_or(T::default(), |at| nodes[at + lane]);
                    let [beyond, plane, inside] = at.map(read);
                    let mirrored = [beyond + inside, plane + plane, beyond + inside];
                    for (at, sum) in at.into_iter().zip(mirrored) {
                        if let Some(at) = at {
                            nodes[at + lane] = sum;
                        }
                    }
                }
            }
        }
    }
}

impl<const D: usize> Columns<D> {
    /// Gives the nodes beyond walls number `lane` of the quads of their images.
    pub(super) fn mirror_answers<T: Lanes>(&self, nodes: &mut [T], planes: usize, lane: usize) {
        for places in self.walls.iter().flatten() {
            let [beyond, _, inside] = places.across;
            if let (Some(beyond), Some(inside)) = (beyond, inside) {
                nodes[quad_at(beyond, planes) + lane] = nodes[quad_at(inside, planes) + lane];
            }
        }
    }
}

/// The columns of `wall` through `block`, which its plane passes.
fn push_columns<const D: usize>(
    block: [i32; D],
    blocks: &[[i32; D]],
    wall: &Plane,
    columns: &mut Vec<Places<D>>,
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
            columns.push(Places {
                across: across.map(|(block, local)| {
                    let node = foot + local * stride;
                    block.map(|block| NodePlace((block * BLOCK_NODES + node) as u32))
                }),
                node: core::array::from_fn(|axis| {
                    block[axis] * edge as i32 + axis_index::<D>(index, axis) as i32
                }),
            });
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
