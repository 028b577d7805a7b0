//! The nodes at walls on their plane, and what the walls do to them.

use super::{BLOCK_NODES, QUAD};
use crate::boundary::contact::{Column, ColumnNode};
use crate::boundary::impulse::Taken;
use crate::boundary::walls::{Plane, Walls};
use crate::dispatch::on_level;
use crate::material::IsaToken;
use crate::math::{Lanes, Mask, Real, Vector};
use crate::particles::block_edge;
use crate::prefetch::prefetch;
use fearless_simd::Simd;

/// The most columns of a wall that pass a block: those of 3D.
const MOST_COLUMNS: usize = columns_a_face(3);

/// Columns of a wall that pass a block: 8 in 2D, 16 in 3D.
const fn columns_a_face(dimension: usize) -> usize {
    BLOCK_NODES / block_edge(dimension)
}

/// A number a column.
type OfColumns<T> = [T; MOST_COLUMNS];

/// The columns of a wall that pass one block: its nodes on the plane, ascending, and their neighbours across.
#[derive(Clone, Copy, Debug)]
struct Face<const D: usize> {
    /// The wall's.
    axis: usize,
    /// Of the nodes beyond the wall, on its plane, inside: their block, if there is one, and their index in
    /// it across the wall.
    across: [(Option<u32>, u8); 3],
    /// The index on each axis of the first node on the plane.
    first: [i32; D],
    /// Where masses are kept, if a wall that acts before this one may change them.
    kept: Option<u32>,
}

/// For each of [`Walls::planes`], its columns of nodes in the blocks that there are.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns<const D: usize> {
    walls: Vec<Vec<Face<D>>>,
    /// The normal impulse that each column gave to its wall in the last update \[kg m/s\].
    pressed: Vec<Vec<f64>>,
    /// Of faces in corners, the masses of their nodes before the first wall has acted \[kg\].
    masses: Vec<[OfColumns<f64>; 3]>,
    /// By block, whether a wall changes nodes of it; while faces are found.
    changed: Vec<bool>,
}

impl<const D: usize> Columns<D> {
    /// Finds the nodes on walls, and their neighbours across, among `blocks`, which are ascending.
    pub(super) fn find(&mut self, blocks: &[[i32; D]], walls: &Walls<D>) {
        let edge = block_edge(D) as i64;
        self.walls.resize(walls.planes.len(), Vec::new());
        self.pressed.resize(walls.planes.len(), Vec::new());
        self.changed.clear();
        self.changed.resize(blocks.len(), false);
        let mut kept = 0;
        let of_walls = self.walls.iter_mut().zip(&mut self.pressed);
        for ((faces, pressed), wall) in of_walls.zip(&walls.planes) {
            faces.clear();
            let of_wall = wall.node.div_euclid(edge);
            for block in blocks {
                if i64::from(block[wall.axis]) != of_wall {
                    continue;
                }
                let mut face = Face::of(*block, blocks, wall);
                if face.blocks().any(|block| self.changed[block]) {
                    face.kept = Some(kept);
                    kept += 1;
                }
                faces.push(face);
            }
            for block in faces.iter().flat_map(Face::blocks) {
                self.changed[block] = true;
            }
            pressed.resize(faces.len() * columns_a_face(D), 0.0);
        }
        self.masses.clear(); // of nodes that are not there none are written
        self.masses.resize(kept as usize, [[0.0; MOST_COLUMNS]; 3]);
    }

    /// Lets the walls act on the velocities in `nodes`, of `planes` planes. Adds what they take from
    /// particles that keep `blend` of their own velocities to `taken`, by [`Plane::side`].
    pub(super) fn fold<T: Lanes>(
        &mut self,
        isa: IsaToken,
        nodes: &mut [T],
        planes: usize,
        walls: &Walls<D>,
        blend: f64,
        taken: &mut [Taken<D>],
    ) {
        let _flush = crate::float_mode::FlushToZero::enter();
        // Folding changes masses, and in corners a second wall finds them changed; particles have the
        // masses that they brought.
        for face in self.walls.iter().flatten() {
            if let Some(kept) = face.kept {
                let masses = &mut self.masses[kept as usize];
                face.for_runs(planes, |side, column, place| {
                    let quads = nodes[place..][..face.run() * QUAD].chunks_exact(QUAD);
                    for (mass, quad) in masses[side][column..].iter_mut().zip(quads) {
                        *mass = quad[3].to_f64();
                    }
                });
            }
        }
        let of_walls = self.walls.iter().zip(&mut self.pressed);
        for ((faces, pressed), wall) in of_walls.zip(&walls.planes) {
            let mut fold = Fold::new(wall, planes, blend);
            on_level!(isa.0, simd => {
                let pressed = pressed.chunks_exact_mut(columns_a_face(D));
                for (number, (face, pressed)) in faces.iter().zip(pressed).enumerate() {
                    if let Some(next) = faces.get(number + 1) {
                        next.for_runs(planes, |_, _, place| {
                            prefetch(&nodes[place..][..next.run() * QUAD]);
                        });
                    }
                    let kept = face.kept.map(|kept| &self.masses[kept as usize]);
                    fold.face(simd, face, nodes, kept, pressed);
                }
            });
            fold.add_to(&mut taken[wall.side()]);
        }
    }

    /// The nodes on wall number `wall` of [`Walls::planes`], by index, and the normal impulse that each
    /// took in the last update \[kg m/s\].
    pub(super) fn pressed(&self, wall: usize) -> impl Iterator<Item = ([i32; D], f64)> {
        let nodes = self.walls[wall]
            .iter()
            .flat_map(|face| (0..columns_a_face(D)).map(|column| face.node(column)));
        nodes.zip(self.pressed[wall].iter().copied())
    }

    /// Adds to the volumes that nodes near walls hold those of the mirror images.
    pub(super) fn mirror_volumes<T: Lanes>(&self, nodes: &mut [T], planes: usize) {
        for face in self.walls.iter().flatten() {
            for column in 0..columns_a_face(D) {
                let at: [_; 3] = core::array::from_fn(|side| face.quad_at(column, side, planes));
                for number in 0..QUAD {
                    let read = |at: Option<usize>| at.map_or(T::default(), |at| nodes[at + number]);
                    let [beyond, plane, inside] = at.map(read);
                    let mirrored = [beyond + inside, plane + plane, beyond + inside];
                    for (at, sum) in at.into_iter().zip(mirrored) {
                        if let Some(at) = at {
                            nodes[at + number] = sum;
                        }
                    }
                }
            }
        }
    }

    /// Gives the nodes beyond walls number `number` of the quads of their images.
    pub(super) fn mirror_answers<T: Lanes>(&self, nodes: &mut [T], planes: usize, number: usize) {
        for face in self.walls.iter().flatten() {
            for column in 0..columns_a_face(D) {
                let [beyond, inside] = [0, 2].map(|side| face.quad_at(column, side, planes));
                if let (Some(beyond), Some(inside)) = (beyond, inside) {
                    nodes[beyond + number] = nodes[inside + number];
                }
            }
        }
    }
}

impl<const D: usize> Face<D> {
    /// The columns of `wall` through `block`, which its plane passes.
    fn of(block: [i32; D], blocks: &[[i32; D]], wall: &Plane) -> Self {
        let edge = block_edge(D) as i64;
        let across = [-1, 0, 1].map(|step| {
            let node = wall.node + step * i64::from(wall.inward);
            let mut owner = block;
            owner[wall.axis] = node.div_euclid(edge) as i32;
            let owner = blocks.binary_search(&owner).ok();
            (owner.map(|block| block as u32), node.rem_euclid(edge) as u8)
        });
        let mut first = block.map(|index| index * edge as i32);
        first[wall.axis] = wall.node as i32;
        Self {
            axis: wall.axis,
            across,
            first,
            kept: None,
        }
    }

    /// The blocks that its nodes are in.
    fn blocks(&self) -> impl Iterator<Item = usize> {
        let blocks = self.across.into_iter().filter_map(|(block, _)| block);
        blocks.map(|block| block as usize)
    }

    /// Nodes that lie side by side in storage; columns come in runs of so many.
    #[inline(always)]
    fn run(&self) -> usize {
        block_edge(D).pow((D - 1 - self.axis) as u32)
    }

    /// Where the quads of a run of columns are, from column `column` on, in plane 0: the nodes `side` steps
    /// further inside than those beyond the wall.
    #[inline(always)]
    fn quad_at(&self, column: usize, side: usize, planes: usize) -> Option<usize> {
        let (block, local) = self.across[side];
        let run = self.run();
        let node = (column / run * block_edge(D) + usize::from(local)) * run + column % run;
        Some((block? as usize * BLOCK_NODES * planes + node) * QUAD)
    }

    /// Calls `f(side, column, place)` for each run of quads that there is, in plane 0: where that of `column`
    /// is, the first of [`Self::run`].
    #[inline(always)]
    fn for_runs(&self, planes: usize, mut f: impl FnMut(usize, usize, usize)) {
        let run = self.run();
        for side in 0..3 {
            let Some(mut place) = self.quad_at(0, side, planes) else {
                continue;
            };
            for column in (0..columns_a_face(D)).step_by(run) {
                f(side, column, place);
                place += block_edge(D) * run * QUAD;
            }
        }
    }

    /// The index of a column's node on the plane.
    fn node(&self, column: usize) -> [i32; D] {
        let local = local::<D>(self.axis, column);
        core::array::from_fn(|axis| self.first[axis] + local[axis])
    }
}

/// Where the foot of a column is among those of its face: 0 on the wall's axis.
fn local<const D: usize>(wall_axis: usize, column: usize) -> [i32; D] {
    let edge = block_edge(D);
    let mut left = column;
    let mut local = [0; D];
    for axis in (0..D).rev().filter(|&axis| axis != wall_axis) {
        local[axis] = (left % edge) as i32;
        left /= edge;
    }
    local
}

/// A wall that acts on its faces, one after the other.
struct Fold<'a, const D: usize> {
    wall: &'a Plane,
    planes: usize,
    blend: f64,
    /// By column of a face, where its foot is among them.
    local: [OfColumns<f64>; D],
    /// What the wall takes, each column of a face for itself.
    impulse: [OfColumns<f64>; D],
    angular: [OfColumns<f64>; 3],
}

impl<'a, const D: usize> Fold<'a, D> {
    fn new(wall: &'a Plane, planes: usize, blend: f64) -> Self {
        let mut of_columns = [[0.0; MOST_COLUMNS]; D];
        for column in 0..columns_a_face(D) {
            let local = local::<D>(wall.axis, column);
            for axis in 0..D {
                of_columns[axis][column] = f64::from(local[axis]);
            }
        }
        Self {
            wall,
            planes,
            blend,
            local: of_columns,
            impulse: [[0.0; MOST_COLUMNS]; D],
            angular: [[0.0; MOST_COLUMNS]; 3],
        }
    }

    /// Adds what has been taken to `taken`.
    fn add_to(&self, taken: &mut Taken<D>) {
        for axis in 0..D {
            taken.impulse[axis] += self.impulse[axis].iter().sum::<f64>();
        }
        for axis in 0..3 {
            taken.angular[axis] += self.angular[axis].iter().sum::<f64>();
        }
    }

    /// Lets the wall act on the columns of `face`, whose particles brought the masses `kept`, or those that
    /// the nodes have. Writes the normal impulse of each to `pressed`.
    #[inline(always)]
    fn face<T: Lanes, S: Simd>(
        &mut self,
        simd: S,
        face: &Face<D>,
        nodes: &mut [T],
        kept: Option<&[OfColumns<f64>; 3]>,
        pressed: &mut [f64],
    ) {
        pressed.fill(0.0);
        let zero = T::broadcast(simd, T::default());
        let (planes, len) = (self.planes, face.run() * QUAD);
        let mut quads = [[[T::default(); MOST_COLUMNS * QUAD]; 2]; 3];
        face.for_runs(planes, |side, column, place| {
            for plane in 0..planes {
                let from = &nodes[place + plane * BLOCK_NODES * QUAD..][..len];
                T::copy_quads(simd, &mut quads[side][plane][column * QUAD..][..len], from);
            }
        });

        // Of each side: the masses that particles brought, and what the wall changes of velocities.
        let mut brought = [[0.0; MOST_COLUMNS]; 3];
        let mut change = [[[0.0; MOST_COLUMNS]; D]; 3];
        let mut acted = false;
        for first in (0..columns_a_face(D)).step_by(T::WIDTH) {
            let at = first * QUAD;
            let mut loaded = [[[zero; QUAD]; 2]; 3];
            let mut free = [ColumnNode::<_, D>::of([zero; QUAD], [zero; QUAD]); 3];
            for side in 0..3 {
                for plane in 0..planes {
                    loaded[side][plane] = T::load_quads(simd, &quads[side][plane][at..]);
                }
                free[side] = ColumnNode::of(loaded[side][0], loaded[side][1]);
                add_difference::<T, S>(1.0, free[side].mass, zero, &mut brought[side][first..]);
            }
            let mut column = Column {
                beyond: free[0],
                plane: free[1],
                inside: free[2],
            };
            let inward = f64::from(self.wall.inward);
            let acts = self.wall.contact.fold(&mut column, self.wall.axis, inward);
            if !acts.any() {
                continue;
            }
            acted = true;
            let folded = [column.beyond, column.plane, column.inside];
            for side in 0..3 {
                let (free, folded) = (free[side], folded[side]);
                let [velocities, changes] = &mut loaded[side];
                for axis in 0..D {
                    let (was, now) = (free.velocity[axis], folded.velocity[axis]);
                    let (was_before, now_before) = (free.before[axis], folded.before[axis]);
                    changes[axis] = Real::select(acts, now - now_before, changes[axis]);
                    let now = Real::select(acts, now, was);
                    velocities[axis] = now;
                    let change = &mut change[side][axis][first..];
                    add_difference::<T, S>(1.0, now, was, change);
                    if self.blend != 0.0 {
                        let now_before = Real::select(acts, now_before, was_before);
                        add_difference::<T, S>(-self.blend, now_before, was_before, change);
                    }
                }
                velocities[3] = Real::select(acts, folded.mass, free.mass);
                for plane in 0..planes {
                    T::store_quads::<S>(loaded[side][plane], &mut quads[side][plane][at..]);
                }
            }
        }
        if !acted {
            return;
        }

        face.for_runs(planes, |side, column, place| {
            for plane in 0..planes {
                let to = &mut nodes[place + plane * BLOCK_NODES * QUAD..][..len];
                T::copy_quads(simd, to, &quads[side][plane][column * QUAD..][..len]);
            }
        });
        let brought = kept.unwrap_or(&brought);
        for side in 0..3 {
            self.take(face, side, &brought[side], &change[side], pressed);
        }
    }

    /// Adds up what the wall takes by changing the velocities of the nodes on one side by `change`, if their
    /// particles brought the masses `brought`.
    #[inline(always)]
    fn take(
        &mut self,
        face: &Face<D>,
        side: usize,
        brought: &OfColumns<f64>,
        change: &[OfColumns<f64>; D],
        pressed: &mut [f64],
    ) {
        let (wall_axis, inward) = (self.wall.axis, f64::from(self.wall.inward));
        let mut impulse = [[0.0; MOST_COLUMNS]; D];
        let mut at = [[0.0; MOST_COLUMNS]; D];
        for axis in 0..D {
            let mut first = f64::from(face.first[axis]);
            if axis == wall_axis {
                first += inward * (side as f64 - 1.0);
            }
            for column in 0..MOST_COLUMNS {
                impulse[axis][column] = change[axis][column] * -brought[column]; // (13)
                self.impulse[axis][column] += impulse[axis][column];
                at[axis][column] = first + self.local[axis][column];
            }
        }
        for (pressed, impulse) in pressed.iter_mut().zip(&impulse[wall_axis]) {
            *pressed -= impulse * inward;
        }
        for axis in 0..3 {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            if i < D && j < D {
                for column in 0..MOST_COLUMNS {
                    self.angular[axis][column] +=
                        at[i][column] * impulse[j][column] - at[j][column] * impulse[i][column];
                }
            }
        }
    }
}

impl<R: Real, const D: usize> ColumnNode<R, D> {
    /// From what nodes hold: velocity and mass; and the change of velocity by forces, or zero.
    #[inline(always)]
    fn of(velocity: [R; QUAD], change: [R; QUAD]) -> Self {
        let mut node = Self {
            mass: velocity[3],
            velocity: Vector([velocity[0]; D]),
            before: Vector([velocity[0]; D]),
        };
        for axis in 0..D {
            node.velocity[axis] = velocity[axis];
            node.before[axis] = velocity[axis] - change[axis];
        }
        node
    }
}

/// `sum += scale (a - b)`
#[inline(always)]
fn add_difference<T: Lanes, S: Simd>(scale: f64, a: T::Of<S>, b: T::Of<S>, sum: &mut [f64]) {
    let (mut of_a, mut of_b) = ([T::default(); MOST_COLUMNS], [T::default(); MOST_COLUMNS]);
    T::store(a, &mut of_a);
    T::store(b, &mut of_b);
    for ((sum, a), b) in sum.iter_mut().zip(&of_a).zip(&of_b).take(T::WIDTH) {
        *sum += scale * (a.to_f64() - b.to_f64());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::{Contact, Domain, Sides, WallStyle};
    use crate::dispatch;
    use crate::setup::Setup;

    /// What the walls take from the nodes of `blocks`, all of them with mass and moving down and to the left.
    fn fold(columns: &mut Columns<2>, blocks: &[[i32; 2]]) -> Vec<Taken<2>> {
        let wall = Contact::Slip { friction: 0.3 };
        let mut setup = Setup::new(1.0, Vec::new());
        setup.domain = Some(Domain {
            min: [0.0; 2],
            max: [64.0; 2],
            sides: [Sides::Walls {
                low: wall,
                high: wall,
            }; 2],
            style: WallStyle::Plane,
        });
        let walls = Walls::of(&setup).expect("good walls");
        let mut nodes: Vec<f64> = (0..blocks.len() * BLOCK_NODES)
            .flat_map(|node| {
                let part = (node % 7) as f64;
                [-1.0 - part, -2.0 + 0.1 * part, 0.0, 1.0 + 0.5 * part]
            })
            .collect();
        let isa = IsaToken(dispatch::portable());
        let mut taken = vec![Taken::NOTHING; 4];
        columns.find(blocks, &walls);
        columns.fold(isa, &mut nodes, 1, &walls, 0.0, &mut taken);
        taken
    }

    #[test]
    fn nodes_that_are_gone_take_nothing() {
        let mut columns = Columns::default();
        let corner = [[-1, -1], [-1, 0], [0, -1], [0, 0]];
        let all = fold(&mut columns, &corner);
        assert!(all[0].impulse[0] < 0.0 && all[2].impulse[1] < 0.0);
        for fewer in [&corner[3..], &corner[2..], &corner[1..]] {
            let again = fold(&mut columns, fewer);
            assert_eq!(again, fold(&mut Columns::default(), fewer));
            assert_ne!(again, all);
        }
    }
}
