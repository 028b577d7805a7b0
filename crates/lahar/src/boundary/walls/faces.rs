//! The nodes at walls on their plane, and the action of the walls on them, many nodes at a time.
//!
//! A wall cuts a block in a *face*: the block's nodes on the plane of the wall. Each of them is the middle of a *triple*
//! of nodes across the wall, which [`Contact::fold`](crate::setup::Contact) changes together.

use super::fold::{Triple, TripleNode};
use super::{Plane, Walls};
use crate::boundary::impulse::Impulse;
use crate::dispatch::on_level;
use crate::grid::{BLOCK_NODES, Filling, NodeField, QUAD, Velocity, Volume};
use crate::material::IsaToken;
use crate::math::{Lanes, Mask, Real, Vector};
use crate::particles::block_edge;
use crate::prefetch::prefetch;
use fearless_simd::Simd;

/// The largest number of triples in a face: that of 3D.
const LARGEST_FACE: usize = triples_per_face(3);

/// Triples in a face: 8 in 2D, 16 in 3D.
const fn triples_per_face(dimension: usize) -> usize {
    BLOCK_NODES / block_edge(dimension)
}

/// One number per triple of a face.
type PerTriple<T> = [T; LARGEST_FACE];

/// The triples of a wall whose middle nodes lie in one block, in ascending order.
#[derive(Clone, Copy, Debug)]
struct Face<const D: usize> {
    /// The axis across the wall.
    axis: usize,
    /// For the nodes beyond the wall, on its plane and inside: their block, if there is one, and their index on
    /// `axis` in it.
    across: [(Option<u32>, u8); 3],
    /// The index of the first node on the plane.
    first: [i32; D],
    /// Where its masses are saved, if a wall that acts before this one may change them.
    saved: Option<u32>,
}

/// The faces of each of [`Walls::planes`].
#[derive(Clone, Debug, Default)]
pub(crate) struct WallFaces<const D: usize> {
    walls: Vec<Vec<Face<D>>>,
    /// By wall and triple, the normal impulse on the wall in the last grid update \[kg m/s\].
    normal_impulses: Vec<Vec<f64>>,
    /// The masses of faces in corners before the first wall has acted \[kg\].
    masses: Vec<[PerTriple<f64>; 3]>,
    /// By block, whether a wall changes its nodes; while faces are found.
    changed: Vec<bool>,
}

impl<const D: usize> WallFaces<D> {
    /// Finds the faces of `walls` in `blocks`, which are ascending.
    pub(crate) fn find(&mut self, blocks: &[[i32; D]], walls: &Walls<D>) {
        let edge = block_edge(D) as i64;
        self.walls.resize(walls.planes.len(), Vec::new());
        self.normal_impulses.resize(walls.planes.len(), Vec::new());
        self.changed.clear();
        self.changed.resize(blocks.len(), false);
        let mut saved = 0;
        let of_walls = self.walls.iter_mut().zip(&mut self.normal_impulses);
        for ((faces, by_triple), wall) in of_walls.zip(&walls.planes) {
            faces.clear();
            let of_wall = wall.node.div_euclid(edge);
            for block in blocks {
                if i64::from(block[wall.axis]) != of_wall {
                    continue;
                }
                let mut face = Face::of(*block, blocks, wall);
                if face.blocks().any(|block| self.changed[block]) {
                    face.saved = Some(saved);
                    saved += 1;
                }
                faces.push(face);
            }
            for block in faces.iter().flat_map(Face::blocks) {
                self.changed[block] = true;
            }
            by_triple.resize(faces.len() * triples_per_face(D), 0.0);
        }
        self.masses.clear(); // masses of missing nodes are never written
        self.masses.resize(saved as usize, [[0.0; LARGEST_FACE]; 3]);
    }

    /// Lets the walls act on `velocities`. Adds the impulses on them to `impulses`, by [`Plane::side`]; `blend` is the
    /// share of its own velocity that a particle keeps.
    pub(crate) fn fold<T: Lanes>(
        &mut self,
        isa: IsaToken,
        velocities: &mut NodeField<Velocity, T>,
        walls: &Walls<D>,
        blend: f64,
        impulses: &mut [Impulse<D>],
    ) {
        let layers = velocities.layers();
        let nodes = velocities.numbers_mut();
        let _flush = crate::float_mode::FlushToZero::enter();
        // Folding changes masses, and in corners a second wall finds them changed. Impulses are those of the masses that
        // particles have brought.
        for face in self.walls.iter().flatten() {
            if let Some(saved) = face.saved {
                let masses = &mut self.masses[saved as usize];
                face.for_runs(layers, |side, triple, place| {
                    let quads = nodes[place..][..face.run() * QUAD].chunks_exact(QUAD);
                    for (mass, quad) in masses[side][triple..].iter_mut().zip(quads) {
                        *mass = quad[3].to_f64();
                    }
                });
            }
        }
        let of_walls = self.walls.iter().zip(&mut self.normal_impulses);
        for ((faces, by_triple), wall) in of_walls.zip(&walls.planes) {
            let mut fold = Fold::new(wall, layers, blend);
            on_level!(isa.0, simd => {
                let by_face = by_triple.chunks_exact_mut(triples_per_face(D));
                for (number, (face, of_face)) in faces.iter().zip(by_face).enumerate() {
                    if let Some(next) = faces.get(number + 1) {
                        next.for_runs(layers, |_, _, place| {
                            prefetch(&nodes[place..][..next.run() * QUAD]);
                        });
                    }
                    let saved = face.saved.map(|saved| &self.masses[saved as usize]);
                    fold.face(simd, face, nodes, saved, of_face);
                }
            });
            fold.add_to(&mut impulses[wall.side()]);
        }
    }

    /// Returns the nodes on wall number `wall` of [`Walls::planes`], by index, and the normal impulse on the wall at each
    /// in the last grid update \[kg m/s\].
    pub(crate) fn normal_impulses(&self, wall: usize) -> impl Iterator<Item = ([i32; D], f64)> {
        let nodes = self.walls[wall]
            .iter()
            .flat_map(|face| (0..triples_per_face(D)).map(|triple| face.node(triple)));
        nodes.zip(self.normal_impulses[wall].iter().copied())
    }

    /// Adds the volumes of the mirror images behind walls to those of the nodes near them.
    pub(crate) fn mirror_volumes<T: Lanes>(&self, volumes: &mut NodeField<Volume, T>) {
        let layers = volumes.layers();
        let nodes = volumes.numbers_mut();
        for face in self.walls.iter().flatten() {
            for triple in 0..triples_per_face(D) {
                let at: [_; 3] = core::array::from_fn(|side| face.quad_at(triple, side, layers));
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

    /// Copies channel `channel` of the nodes inside to the nodes beyond walls, which are their mirror images.
    pub(crate) fn mirror_channel<T: Lanes>(
        &self,
        filling: &mut NodeField<Filling, T>,
        channel: usize,
    ) {
        let layers = filling.layers();
        let nodes = filling.numbers_mut();
        for face in self.walls.iter().flatten() {
            for triple in 0..triples_per_face(D) {
                let [beyond, inside] = [0, 2].map(|side| face.quad_at(triple, side, layers));
                if let (Some(beyond), Some(inside)) = (beyond, inside) {
                    nodes[beyond + channel] = nodes[inside + channel];
                }
            }
        }
    }
}

impl<const D: usize> Face<D> {
    /// The face of `wall` in `block`, which its plane passes.
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
            saved: None,
        }
    }

    /// The numbers of the blocks that its nodes are in.
    fn blocks(&self) -> impl Iterator<Item = usize> {
        let blocks = self.across.into_iter().filter_map(|(block, _)| block);
        blocks.map(|block| block as usize)
    }

    /// Triples whose nodes lie side by side in storage; a face consists of runs of so many.
    #[inline(always)]
    fn run(&self) -> usize {
        block_edge(D).pow((D - 1 - self.axis) as u32)
    }

    /// Where the quad of a node of triple `triple` begins, in layer 0, if there is that node: the one beyond the wall,
    /// on its plane or inside, for `side` 0, 1 or 2.
    #[inline(always)]
    fn quad_at(&self, triple: usize, side: usize, layers: usize) -> Option<usize> {
        let (block, local) = self.across[side];
        let run = self.run();
        let node = (triple / run * block_edge(D) + usize::from(local)) * run + triple % run;
        Some((block? as usize * BLOCK_NODES * layers + node) * QUAD)
    }

    /// Calls `f(side, triple, place)` for each run of quads in layer 0 that exists: `triple` is its first, whose quad
    /// begins at `place`.
    #[inline(always)]
    fn for_runs(&self, layers: usize, mut f: impl FnMut(usize, usize, usize)) {
        let run = self.run();
        for side in 0..3 {
            let Some(mut place) = self.quad_at(0, side, layers) else {
                continue;
            };
            for triple in (0..triples_per_face(D)).step_by(run) {
                f(side, triple, place);
                place += block_edge(D) * run * QUAD;
            }
        }
    }

    /// The index of a triple's node on the plane.
    fn node(&self, triple: usize) -> [i32; D] {
        let local = local::<D>(self.axis, triple);
        core::array::from_fn(|axis| self.first[axis] + local[axis])
    }
}

/// The index of triple `triple` within its face; 0 on the wall's axis.
fn local<const D: usize>(wall_axis: usize, triple: usize) -> [i32; D] {
    let edge = block_edge(D);
    let mut left = triple;
    let mut local = [0; D];
    for axis in (0..D).rev().filter(|&axis| axis != wall_axis) {
        local[axis] = (left % edge) as i32;
        left /= edge;
    }
    local
}

/// One wall and the sums over its faces.
struct Fold<'a, const D: usize> {
    wall: &'a Plane,
    layers: usize,
    blend: f64,
    /// By axis and triple, the index within the face.
    local: [PerTriple<f64>; D],
    /// The impulse on the wall so far, by axis and by the number of the triple in its face.
    impulse: [PerTriple<f64>; D],
    angular: [PerTriple<f64>; 3],
}

impl<'a, const D: usize> Fold<'a, D> {
    fn new(wall: &'a Plane, layers: usize, blend: f64) -> Self {
        let mut index = [[0.0; LARGEST_FACE]; D];
        for triple in 0..triples_per_face(D) {
            let local = local::<D>(wall.axis, triple);
            for axis in 0..D {
                index[axis][triple] = f64::from(local[axis]);
            }
        }
        Self {
            wall,
            layers,
            blend,
            local: index,
            impulse: [[0.0; LARGEST_FACE]; D],
            angular: [[0.0; LARGEST_FACE]; 3],
        }
    }

    /// Adds the impulse on the wall to `total`.
    fn add_to(&self, total: &mut Impulse<D>) {
        for axis in 0..D {
            total.impulse[axis] += self.impulse[axis].iter().sum::<f64>();
        }
        for axis in 0..3 {
            total.angular[axis] += self.angular[axis].iter().sum::<f64>();
        }
    }

    /// Lets the wall act on the triples of `face`. Particles have brought the masses `saved`, or those that the nodes
    /// have. Writes the normal impulse on the wall at each triple to `normal_impulses`.
    #[inline(always)]
    fn face<T: Lanes, S: Simd>(
        &mut self,
        simd: S,
        face: &Face<D>,
        nodes: &mut [T],
        saved: Option<&[PerTriple<f64>; 3]>,
        normal_impulses: &mut [f64],
    ) {
        normal_impulses.fill(0.0);
        let zero = T::broadcast(simd, T::default());
        let (layers, len) = (self.layers, face.run() * QUAD);
        let mut quads = [[[T::default(); LARGEST_FACE * QUAD]; 2]; 3];
        face.for_runs(layers, |side, triple, place| {
            for layer in 0..layers {
                let from = &nodes[place + layer * BLOCK_NODES * QUAD..][..len];
                T::copy_quads(simd, &mut quads[side][layer][triple * QUAD..][..len], from);
            }
        });

        // By side: the masses that particles have brought, and the changes of velocity by the wall.
        let mut brought = [[0.0; LARGEST_FACE]; 3];
        let mut change = [[[0.0; LARGEST_FACE]; D]; 3];
        let mut acted = false;
        for first in (0..triples_per_face(D)).step_by(T::WIDTH) {
            let at = first * QUAD;
            let mut loaded = [[[zero; QUAD]; 2]; 3];
            let mut free = [TripleNode::<_, D>::of([zero; QUAD], [zero; QUAD]); 3];
            for side in 0..3 {
                for layer in 0..layers {
                    loaded[side][layer] = T::load_quads(simd, &quads[side][layer][at..]);
                }
                free[side] = TripleNode::of(loaded[side][0], loaded[side][1]);
                add_difference::<T, S>(1.0, free[side].mass, zero, &mut brought[side][first..]);
            }
            let mut triple = Triple {
                beyond: free[0],
                on_plane: free[1],
                inside: free[2],
            };
            let inward = f64::from(self.wall.inward);
            let acts = self.wall.contact.fold(&mut triple, self.wall.axis, inward);
            if !acts.any() {
                continue;
            }
            acted = true;
            let folded = [triple.beyond, triple.on_plane, triple.inside];
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
                for layer in 0..layers {
                    T::store_quads::<S>(loaded[side][layer], &mut quads[side][layer][at..]);
                }
            }
        }
        if !acted {
            return;
        }

        face.for_runs(layers, |side, triple, place| {
            for layer in 0..layers {
                let to = &mut nodes[place + layer * BLOCK_NODES * QUAD..][..len];
                T::copy_quads(simd, to, &quads[side][layer][triple * QUAD..][..len]);
            }
        });
        let brought = saved.unwrap_or(&brought);
        for side in 0..3 {
            self.add_impulses(face, side, &brought[side], &change[side], normal_impulses);
        }
    }

    /// Adds up the impulses on the wall that follow from `change`, the change of the velocities of the nodes on one side;
    /// `brought` are the masses that particles have brought to them.
    #[inline(always)]
    fn add_impulses(
        &mut self,
        face: &Face<D>,
        side: usize,
        brought: &PerTriple<f64>,
        change: &[PerTriple<f64>; D],
        normal_impulses: &mut [f64],
    ) {
        let (wall_axis, inward) = (self.wall.axis, f64::from(self.wall.inward));
        let mut impulse = [[0.0; LARGEST_FACE]; D];
        let mut at = [[0.0; LARGEST_FACE]; D];
        for axis in 0..D {
            let mut first = f64::from(face.first[axis]);
            if axis == wall_axis {
                first += inward * (side as f64 - 1.0);
            }
            for triple in 0..LARGEST_FACE {
                impulse[axis][triple] = change[axis][triple] * -brought[triple]; // (13)
                self.impulse[axis][triple] += impulse[axis][triple];
                at[axis][triple] = first + self.local[axis][triple];
            }
        }
        for (normal, impulse) in normal_impulses.iter_mut().zip(&impulse[wall_axis]) {
            *normal -= impulse * inward;
        }
        for axis in 0..3 {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            if i < D && j < D {
                for triple in 0..LARGEST_FACE {
                    self.angular[axis][triple] +=
                        at[i][triple] * impulse[j][triple] - at[j][triple] * impulse[i][triple];
                }
            }
        }
    }
}

impl<R: Real, const D: usize> TripleNode<R, D> {
    /// Makes a node of its quads: velocity and mass, and the change of velocity by forces, or zeros.
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
    let (mut of_a, mut of_b) = ([T::default(); LARGEST_FACE], [T::default(); LARGEST_FACE]);
    T::store(a, &mut of_a);
    T::store(b, &mut of_b);
    for ((sum, a), b) in sum.iter_mut().zip(&of_a).zip(&of_b).take(T::WIDTH) {
        *sum += scale * (a.to_f64() - b.to_f64());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch;
    use crate::setup::{Contact, Domain, Setup, Sides, WallStyle};

    /// Lets the walls act on the nodes of `blocks`, all of them with mass and moving down and to the left. Returns the
    /// impulses on the walls.
    fn fold(faces: &mut WallFaces<2>, blocks: &[[i32; 2]]) -> Vec<Impulse<2>> {
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
        let nodes: Vec<f64> = (0..blocks.len() * BLOCK_NODES)
            .flat_map(|node| {
                let part = (node % 7) as f64;
                [-1.0 - part, -2.0 + 0.1 * part, 0.0, 1.0 + 0.5 * part]
            })
            .collect();
        let isa = IsaToken(dispatch::portable());
        let mut impulses = vec![Impulse::ZERO; 4];
        faces.find(blocks, &walls);
        let mut velocities = NodeField::of(nodes, 1);
        faces.fold(isa, &mut velocities, &walls, 0.0, &mut impulses);
        impulses
    }

    #[test]
    fn nodes_that_are_gone_give_no_impulse() {
        let mut faces = WallFaces::default();
        let corner = [[-1, -1], [-1, 0], [0, -1], [0, 0]];
        let all = fold(&mut faces, &corner);
        assert!(all[0].impulse[0] < 0.0 && all[2].impulse[1] < 0.0);
        for fewer in [&corner[3..], &corner[2..], &corner[1..]] {
            let again = fold(&mut faces, fewer);
            assert_eq!(again, fold(&mut WallFaces::default(), fewer));
            assert_ne!(again, all);
        }
    }
}
