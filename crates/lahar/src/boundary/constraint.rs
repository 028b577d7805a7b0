//! The boundaries of a substep: what walls and colliders do to the nodes' velocities, one after the other.

use super::colliders::nodes::NearNodes;
use super::colliders::placed::Moving;
use super::impulse::Impulse;
use super::walls::Walls;
use super::walls::faces::WallFaces;
use crate::grid::{Blocks, NodeField, Velocity};
use crate::material::IsaToken;
use crate::math::Lanes;
use crate::setup::{Scheme, Transfer};

/// The nodes that boundaries act on, and the impulses on the boundaries.
#[derive(Clone, Debug)]
pub(crate) struct Boundaries<const D: usize> {
    pub(crate) faces: WallFaces<D>,
    /// The nodes around each collider.
    near: Vec<NearNodes<D>>,
    /// The share of its own velocity that a particle keeps: FLIP's blend.
    blend: f64,
    /// By side of the domain, and then by collider, the impulse on it in the present substep; lengths in cells from
    /// node 0.
    pub(crate) impulses: Vec<Impulse<D>>,
}

impl<const D: usize> Boundaries<D> {
    /// Makes the boundaries of a scene with this transfer scheme, before there are nodes.
    pub(crate) fn new(scheme: Scheme) -> Self {
        Self {
            faces: WallFaces::default(),
            near: Vec::new(),
            blend: match scheme.transfer {
                Transfer::Flip { blend } => blend,
                Transfer::Pic | Transfer::Apic => 0.0,
            },
            impulses: vec![Impulse::ZERO; 2 * D],
        }
    }

    /// Finds the nodes at walls among those of `blocks`.
    pub(crate) fn rebuild(&mut self, blocks: &Blocks<D>, walls: &Walls<D>) {
        self.faces.find(blocks.coordinates(), walls);
    }

    /// Lets walls and then `colliders` act on `velocities`. `dx` is in m.
    pub(crate) fn constrain<T: Lanes>(
        &mut self,
        blocks: &Blocks<D>,
        isa: IsaToken,
        velocities: &mut NodeField<Velocity, T>,
        walls: &Walls<D>,
        (colliders, dx): (&[Moving<D>], f64),
    ) {
        self.impulses.clear();
        self.impulses.resize(2 * D + colliders.len(), Impulse::ZERO);
        walls.constrain_nodes(blocks, velocities, &mut self.impulses);
        self.near.resize_with(colliders.len(), NearNodes::default);
        // Before walls on their plane change masses.
        for (collider, near) in colliders.iter().zip(&mut self.near) {
            near.find(collider, blocks, velocities, walls, dx);
        }
        self.faces
            .fold(isa, velocities, walls, self.blend, &mut self.impulses);
        let of_colliders = self.impulses[2 * D..].iter_mut();
        for ((collider, near), impulse) in colliders.iter().zip(&mut self.near).zip(of_colliders) {
            near.constrain(collider, blocks, velocities, self.blend, impulse);
        }
    }
}
