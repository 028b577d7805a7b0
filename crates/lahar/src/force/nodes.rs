//! Forces on nodes other than stress: momentum becomes velocity, v = (p + Δt f) / m.

use super::accelerations;
use crate::boundary::pointer::NodePointer;
use crate::dispatch::on_level;
use crate::grid::operations::NodeVector;
use crate::grid::{BLOCK_NODES, Blocks, Momentum, NodeField, QUAD, Velocity};
use crate::material::IsaToken;
use crate::math::{Lanes, Real, Register, Vector};
use crate::particles::Lattice;
use crate::setup::Force;
use fearless_simd::Simd;

/// The smallest number of blocks that is worth a thread's attention.
const SMALLEST_PIECE: usize = 16;

/// Numbers of the first layer of a block.
const LAYER: usize = BLOCK_NODES * QUAD;

/// The forces of one substep that act on all nodes alike, or by the pointer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeForces<T, const D: usize> {
    pub(crate) dt: T,
    /// Δt g \[m/s\].
    pub(crate) gravity_impulse: Vector<T, D>,
    /// The share of the velocity relative to the medium that is left after Δt, and the medium's velocity \[m/s\].
    pub(crate) drag: Option<(T, Vector<T, D>)>,
    pub(crate) pointer: Option<NodePointer<D>>,
}

/// Δt a of the forces that differ from node to node \[m/s\].
pub(crate) type NodeImpulses<T, const D: usize> = NodeVector<T, D>;

/// Computes Δt a of the `forces` that act on nodes, at `time` \[s\], for each node of `blocks`.
pub(crate) fn evaluate<T: Lanes, const D: usize>(
    forces: &[Force<D>],
    (time, dt): (f64, f64),
    lattice: &Lattice<D>,
    blocks: &Blocks<D>,
    impulses: &mut NodeImpulses<T, D>,
) {
    impulses.resize(blocks.len());
    impulses.fill_with(|block, impulses| {
        let (mut scratch, mut found) = ([[0.0; D]; BLOCK_NODES], [[0.0; D]; BLOCK_NODES]);
        let positions: [[f64; D]; BLOCK_NODES] = core::array::from_fn(|local| {
            let node = blocks.node(block, local);
            core::array::from_fn(|axis| lattice.to_world(axis, node[axis] as f64))
        });
        accelerations(
            forces,
            false,
            time,
            &positions,
            &[],
            &mut scratch,
            &mut found,
        );
        for (impulse, a) in impulses.iter_mut().zip(&found) {
            *impulse = a.map(|a| T::from_f64(dt * a));
        }
    });
}

/// Returns the largest |Δt a| of `impulses` on a node with mass \[m/s\].
pub(crate) fn largest_impulse<T: Lanes, const D: usize>(
    impulses: &NodeImpulses<T, D>,
    velocities: &NodeField<Velocity, T>,
) -> f64 {
    let nodes = velocities.quads().zip(impulses.nodes());
    let squared = nodes
        .filter(|(quad, _)| quad[3] > T::default())
        .map(|(_, impulse)| impulse.iter().map(|a| a.to_f64() * a.to_f64()).sum());
    squared.fold(0.0, f64::max).sqrt()
}

/// Lets the forces act: p becomes v = (p + Δt f)/m, (9) and (10). The second layer, the impulse of stress, is one of the
/// forces; it becomes the change of velocity by all of them. `impulses` are those of the forces that differ from node to
/// node, if there are any.
pub(crate) fn apply<T: Lanes, const D: usize>(
    blocks: &Blocks<D>,
    isa: IsaToken,
    momentum: NodeField<Momentum, T>,
    forces: &NodeForces<T, D>,
    impulses: Option<&NodeImpulses<T, D>>,
) -> NodeField<Velocity, T> {
    let task = Task {
        blocks,
        forces,
        impulses,
    };
    let (block_len, layers) = (momentum.block_len(), momentum.layers());
    momentum.rewritten(SMALLEST_PIECE, &|first, piece| {
        on_level!(isa.0, simd => {
            for (index, block) in piece.chunks_exact_mut(block_len).enumerate() {
                if layers == 1 {
                    task.block(simd, first + index, block);
                } else {
                    task.block_with_change(simd, first + index, block);
                }
            }
        });
    })
}

struct Task<'a, T, const D: usize> {
    blocks: &'a Blocks<D>,
    forces: &'a NodeForces<T, D>,
    impulses: Option<&'a NodeImpulses<T, D>>,
}

impl<T: Lanes, const D: usize> Task<'_, T, D> {
    /// One layer: momenta to velocities.
    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, block: usize, nodes: &mut [T]) {
        for first in (0..BLOCK_NODES).step_by(T::WIDTH) {
            let quads = &mut nodes[first * QUAD..];
            let momentum = T::load_quads(simd, quads);
            let velocity = self.velocities(simd, block * BLOCK_NODES + first, momentum, None);
            T::store_quads::<S>(velocity, quads);
        }
        self.let_pointer_act(block, nodes);
    }

    /// Two layers: momenta to velocities, impulses of stress to changes of velocity.
    #[inline(always)]
    fn block_with_change<S: Simd>(&self, simd: S, block: usize, nodes: &mut [T]) {
        let (quads, second) = nodes.split_at_mut(LAYER);
        let mut velocities_before = [T::default(); LAYER];
        for first in (0..BLOCK_NODES).step_by(T::WIDTH) {
            let at = first * QUAD;
            let momentum = T::load_quads(simd, &quads[at..]);
            let stress = T::load_quads(simd, &second[at..]);
            let per_mass = momentum[3].one() / momentum[3];
            let before = momentum.map(|sum| sum * per_mass);
            let node = block * BLOCK_NODES + first;
            let velocity = self.velocities(simd, node, momentum, Some(stress));
            T::store_quads::<S>(before, &mut velocities_before[at..]);
            T::store_quads::<S>(velocity, &mut quads[at..]);
        }
        self.let_pointer_act(block, quads);
        let nodes = quads.chunks_exact(QUAD).zip(second.chunks_exact_mut(QUAD));
        let with_before = nodes.zip(velocities_before.chunks_exact(QUAD));
        for ((velocity, change), before) in with_before {
            if velocity[3] <= T::default() {
                continue; // no particle feels a node without mass
            }
            for axis in 0..D {
                change[axis] = velocity[axis] - before[axis];
            }
        }
    }

    /// The velocities of the register of nodes that begins with `node`, without the pointer; nodes without mass keep
    /// their zeros.
    #[inline(always)]
    fn velocities<S: Simd>(
        &self,
        simd: S,
        node: usize,
        momentum: [T::Of<S>; QUAD],
        stress: Option<[T::Of<S>; QUAD]>,
    ) -> [T::Of<S>; QUAD] {
        let forces = self.forces;
        let mut velocities = momentum;
        let mass = momentum[3];
        let empty = mass.le(mass.zero());
        let per_mass = mass.one() / mass;
        for axis in 0..D {
            let sum = momentum[axis];
            // Forces act on momentum, and then comes one division: added to velocities, gravity's impulse
            // would round the same way on every node of a body that moves as one.
            let mut impulse = mass.splat(forces.gravity_impulse[axis]) * mass;
            if let Some(stress) = stress {
                impulse += stress[axis];
            }
            if let Some(impulses) = self.impulses {
                impulse += Self::load(simd, impulses, node, axis) * mass; // (9)
            }
            let mut velocity = (sum + impulse) * per_mass;
            if let Some((left, medium)) = forces.drag {
                let medium = mass.splat(medium[axis]);
                velocity = medium + (velocity - medium) * mass.splat(left); // (10)
            }
            velocities[axis] = Real::select(empty, sum, velocity);
        }
        velocities
    }

    /// One axis of Δt a on the register of nodes that begins with `node`.
    #[inline(always)]
    fn load<S: Simd>(simd: S, impulses: &NodeImpulses<T, D>, node: usize, axis: usize) -> T::Of<S> {
        let mut lanes = [T::default(); 16];
        let nodes = &impulses.nodes()[node..][..T::WIDTH];
        for (lane, impulse) in lanes.iter_mut().zip(nodes) {
            *lane = impulse[axis];
        }
        T::load(simd, &lanes)
    }

    /// Lets the pointer act on the velocities of a block's nodes.
    fn let_pointer_act(&self, block: usize, quads: &mut [T]) {
        let Some(pointer) = &self.forces.pointer else {
            return;
        };
        for (local, quad) in quads.chunks_exact_mut(QUAD).enumerate() {
            if quad[3] <= T::default() {
                continue;
            }
            let velocity = Vector::from_fn(|axis| quad[axis]);
            let node = self.blocks.node(block, local);
            let velocity = pointer.act(velocity, node, self.forces.dt);
            quad[..D].copy_from_slice(&velocity.0);
        }
    }
}
