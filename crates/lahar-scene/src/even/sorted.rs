//! Particles sorted by the nodes that they touch, so that threads can add to separate slabs of nodes.
//!
//! ```text
//! layers of nodes along the last axis, SLAB = 4
//!  0 1 2 3 4 5 6 7 8 9 ...
//! [first  ]. . .              particles of a slab have their base nodes in it, and reach three layers further:
//!                 [third  ]   every other slab can be filled at the same time, then the slabs between
//! ```

use super::nodes::{Lattice, Nodes};
use crate::parallel::*;
use lahar::kernel::{BSpline, STENCIL};

/// Layers of nodes in a slab: at least as many as kernels reach beyond it.
const SLAB: usize = 4;

/// Particles that a thread takes at a time.
const CHUNK: usize = 1 << 13;

/// Largest factor by which a round changes a volume. Particles beside a hole must not fill it alone.
const LARGEST_CHANGE: f32 = 2.0;

/// Factor on the correction of a volume. Particles share the error at a node with others, so that a factor of
/// 1 corrects too little; at 2.5 the error grows.
const OVER_RELAXATION: f32 = 1.5;

/// A particle among the nodes of the grid.
#[derive(Clone, Copy)]
struct Placed<const D: usize> {
    /// Number of its base node.
    base: u32,
    /// Distance from the base node along each axis \[cells\].
    frac: [f32; D],
}

/// Particles sorted by half layers, so that those of one base layer are side by side for either lattice.
pub(super) struct Sorted<'a, const D: usize> {
    nodes: &'a Nodes<D>,
    particles: Vec<Placed<D>>,
    /// The index of each sorted particle in the given order.
    given: Vec<u32>,
    /// The index of the first particle of each half layer.
    starts: Vec<usize>,
}

impl<'a, const D: usize> Sorted<'a, D> {
    pub(super) fn of<K: BSpline>(nodes: &'a Nodes<D>, position: &[[f64; D]]) -> Self {
        let strides: [usize; D] = core::array::from_fn(|axis| nodes.stride(axis));
        let place = |x: &[f64; D]| {
            let (mut base, mut frac) = (0, [0.0; D]);
            for axis in 0..D {
                let (node, past) = nodes.base::<K>(axis, x[axis]);
                base += node * strides[axis];
                frac[axis] = past as f32;
            }
            Placed {
                base: base as u32,
                frac,
            }
        };
        let placed: Vec<Placed<D>> = position.par_iter().with_min_len(CHUNK).map(place).collect();
        let half = |particle: &Placed<D>| {
            let plane = particle.base as usize / strides[D - 1];
            2 * plane + usize::from(particle.frac[D - 1] >= 0.5)
        };
        let mut starts = vec![0; 2 * nodes.size(D - 1) + 1];
        for particle in &placed {
            starts[half(particle) + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut given = vec![0; placed.len()];
        for (number, particle) in placed.iter().enumerate() {
            let place = &mut next[half(particle)];
            given[*place] = number as u32;
            *place += 1;
        }
        let particles = (given.par_iter().with_min_len(CHUNK))
            .map(|&number| placed[number as usize])
            .collect();
        Self {
            nodes,
            particles,
            given,
            starts,
        }
    }

    /// Returns Σ w V at each node of a lattice.
    pub(super) fn fill<K: BSpline>(&self, volume: &[f32], lattice: Lattice) -> Vec<f32> {
        let plane = self.nodes.stride(D - 1);
        let mut filled = vec![0.0; self.nodes.len()];
        for odd in 0..2 {
            let first = odd * SLAB;
            let rest = filled.get_mut(first * plane..).unwrap_or_default();
            rest.par_chunks_mut(2 * SLAB * plane)
                .enumerate()
                .for_each(|(number, nodes)| {
                    let low = first + 2 * SLAB * number;
                    for i in self.rows_between(low, low + SLAB, lattice) {
                        let (base, rows) = self.rows::<K>(&self.particles[i], lattice);
                        let nodes = &mut nodes[base - low * plane..];
                        rows.for_each(|offset, weight, along| {
                            let weight = weight * volume[i];
                            let row = &mut nodes[offset..offset + STENCIL];
                            for (node, along) in row.iter_mut().zip(along) {
                                *node += weight * along;
                            }
                        });
                    }
                });
        }
        filled
    }

    /// Multiplies each volume by the ratio that its particle finds at the nodes of a lattice.
    pub(super) fn correct<K: BSpline>(&self, ratio: &[f32], volume: &mut [f32], lattice: Lattice) {
        let chunks = volume
            .par_chunks_mut(CHUNK)
            .zip(self.particles.par_chunks(CHUNK));
        chunks.for_each(|(volume, particles)| {
            for (volume, particle) in volume.iter_mut().zip(particles) {
                let (base, rows) = self.rows::<K>(particle, lattice);
                let nodes = &ratio[base..];
                let mut sums = [0.0; STENCIL];
                rows.for_each(|offset, weight, along| {
                    let row = &nodes[offset..offset + STENCIL];
                    for k in 0..STENCIL {
                        sums[k] += weight * along[k] * row[k];
                    }
                });
                let factor: f32 = sums.iter().sum();
                let factor = 1.0 + OVER_RELAXATION * (factor - 1.0);
                *volume *= factor.clamp(1.0 / LARGEST_CHANGE, LARGEST_CHANGE);
            }
        });
    }

    /// Returns the volumes in the given order of particles, scaled so that they add up to `whole`.
    pub(super) fn in_given_order(&self, volume: &[f32], whole: f64) -> Vec<f64> {
        let sum: f64 = volume.iter().map(|volume| f64::from(*volume)).sum();
        let mut result = vec![0.0; volume.len()];
        for (volume, &number) in volume.iter().zip(&self.given) {
            result[number as usize] = whole / sum * f64::from(*volume);
        }
        result
    }

    /// Returns the particles with base nodes in the layers `low..high` of a lattice.
    fn rows_between(&self, low: usize, high: usize, lattice: Lattice) -> core::ops::Range<usize> {
        let shift = usize::from(lattice == Lattice::Between);
        let start = |plane: usize| self.starts[(2 * plane + shift).min(self.starts.len() - 1)];
        start(low)..start(high)
    }

    /// Returns the base node of a particle, and its rows of nodes.
    #[inline(always)]
    fn rows<K: BSpline>(&self, particle: &Placed<D>, lattice: Lattice) -> (usize, Rows<D>) {
        let mut base = particle.base as usize;
        let mut weights = [[0.0; STENCIL]; D];
        let mut strides = [0; D];
        for axis in 0..D {
            strides[axis] = self.nodes.stride(axis);
            let (on, frac) = lattice.base(1, particle.frac[axis]);
            base -= (1 - on) * strides[axis];
            weights[axis] = K::weights(frac);
        }
        let rows = Rows {
            arms: K::NODES,
            weights,
            strides,
        };
        (base, rows)
    }
}

/// The rows of nodes along the first axis that a particle touches.
struct Rows<const D: usize> {
    arms: usize,
    weights: [[f32; STENCIL]; D],
    strides: [usize; D],
}

impl<const D: usize> Rows<D> {
    /// Calls `f(offset, weight, along)` for each row: its offset from the base node, its weight by the other
    /// axes, and the weights along it.
    #[inline(always)]
    fn for_each(&self, mut f: impl FnMut(usize, f32, &[f32; STENCIL])) {
        let along = &self.weights[0];
        for j in 0..self.arms {
            let (offset, weight) = (j * self.strides[1], self.weights[1][j]);
            if D == 2 {
                f(offset, weight, along);
                continue;
            }
            for k in 0..self.arms {
                f(
                    offset + k * self.strides[2],
                    weight * self.weights[2][k],
                    along,
                );
            }
        }
    }
}
