//! The stencils of a chunk of particles, and the buffers of both transfers: each buffer holds one quantity.
//!
//! A quad is four numbers of one particle. The quads of a chunk follow one another.

use crate::grid::tile_edge;
use crate::kernel::BSpline;
use crate::math::{Lanes, Real, Vector};
use crate::particles::{CHUNK, Rows, block_edge};
use fearless_simd::Simd;

/// One quad per particle of a chunk.
pub(crate) type Quads<T> = [T; 4 * CHUNK];

/// The node of a tile that is the base of a particle at u = 0: tiles begin one node before their block.
pub(super) fn first_node(dimension: usize) -> f64 {
    (block_edge(dimension) / 2) as f64 + 1.0
}

/// Base nodes and weights of a chunk's particles.
#[repr(align(64))]
pub(crate) struct Stencils<T> {
    /// For each axis, the four weights of each particle.
    pub(crate) weights: [Quads<T>; 3],
    /// For each axis, the four weight gradients of each particle (classic force only).
    pub(crate) gradients: [Quads<T>; 3],
    /// Where each particle's first row begins in the tile, in nodes.
    pub(crate) base: [i32; CHUNK],
}

impl<T: Lanes> Stencils<T> {
    pub(crate) fn new() -> Self {
        Self {
            weights: [[T::default(); 4 * CHUNK]; 3],
            gradients: [[T::default(); 4 * CHUNK]; 3],
            base: [0; CHUNK],
        }
    }

    /// Computes the stencils of the register of particles at `u` that begins with particle `p`. Returns s, their
    /// positions from the base node \[cells\].
    #[inline(always)]
    pub(crate) fn place<S: Simd, const D: usize, K: BSpline, const CLASSIC: bool>(
        &mut self,
        u: Vector<T::Of<S>, D>,
        p: usize,
    ) -> Vector<T::Of<S>, D> {
        let first = u[0].lit(first_node(D));
        let edge = u[0].lit(tile_edge::<D>(K::NODES) as f64);
        let floor = Vector::<_, D>::from_fn(|axis| u[axis].floor());
        let frac = u - floor;
        let mut base = floor[0] + first;
        for axis in 1..D {
            base = base * edge + (floor[axis] + first);
        }
        T::store_whole::<S>(base, &mut self.base[p..]);
        for axis in 0..D {
            let weights = K::weights(frac[axis]);
            T::store_quads::<S>(weights, &mut self.weights[axis][4 * p..]);
            if CLASSIC {
                let gradients = K::gradients(frac[axis]);
                T::store_quads::<S>(gradients, &mut self.gradients[axis][4 * p..]);
            }
        }
        frac + Vector::from_fn(|_| u[0].lit(K::OFFSET))
    }
}

/// The momentum that a chunk's particles bring, as [`rows`](super::rows) adds it.
#[repr(align(64))]
pub(crate) struct MomentumQuads<T> {
    /// The Kirchhoff stress τ: `[j·D + i][p]`.
    pub(crate) kirchhoff_stress: [Rows<T>; 9],
    /// P₀ with the mass as its fourth number, and dx Q by column.
    pub(crate) momentum: [Quads<T>; 4],
    /// The same of the impulse of stress, where it is apart. The classic force has the columns only.
    pub(crate) stress: [Quads<T>; 4],
}

impl<T: Lanes> MomentumQuads<T> {
    pub(crate) fn new() -> Self {
        Self {
            kirchhoff_stress: [[T::default(); CHUNK]; 9],
            momentum: [[T::default(); 4 * CHUNK]; 4],
            stress: [[T::default(); 4 * CHUNK]; 4],
        }
    }
}

/// The volumes that a chunk's particles bring.
#[repr(align(64))]
pub(crate) struct VolumeQuads<T> {
    /// Volume changes J − 1.
    pub(crate) expansion: Rows<T>,
    /// The quads of [`Volume`](crate::grid::Volume).
    pub(crate) volumes: Quads<T>,
}

impl<T: Lanes> VolumeQuads<T> {
    pub(crate) fn new() -> Self {
        Self {
            expansion: [T::default(); CHUNK],
            volumes: [T::default(); 4 * CHUNK],
        }
    }
}

/// The sums over nodes that a chunk's particles read of a field of velocities.
#[repr(align(64))]
pub(crate) struct VelocitySums<T> {
    /// Σ w v, and for each axis Σ w v n, with n the node's index from the stencil's middle node.
    pub(crate) moments: [Quads<T>; 4],
    /// Σ w Δv, where the scheme asks for it.
    pub(crate) change: Quads<T>,
    /// For each axis, dx Σ v ∂w (classic force only).
    pub(crate) gradients: [Quads<T>; 3],
    /// Δt ∂v/∂x for the law: `[j·D + i][p]`.
    pub(crate) increment: [Rows<T>; 9],
}

impl<T: Lanes> VelocitySums<T> {
    pub(crate) fn new() -> Self {
        Self {
            moments: [[T::default(); 4 * CHUNK]; 4],
            change: [T::default(); 4 * CHUNK],
            gradients: [[T::default(); 4 * CHUNK]; 3],
            increment: [[T::default(); CHUNK]; 9],
        }
    }
}
