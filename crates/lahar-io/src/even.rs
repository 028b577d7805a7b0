//! Rest volumes with which scattered particles fill the grid as evenly as the shape itself would.
//!
//! Particles put down at random stand closer here than there. With the same mass each, the grid sees
//! heavy and light lumps, and these sink and rise: a tank of water stirs for minutes and settles by
//! some tenths of a percent. So where they stand close, each is given less.

use crate::sampling::lattice_size;
use crate::shape::{Bounds, Region};
use lahar::Kernel;
use lahar::kernel::{BSpline, Cubic, Linear, Quadratic};

/// Points along dx at which the shape is looked at.
const FINE: f64 = 4.0;

/// How often volumes are compared with the shape. The first time does nearly all.
const ROUNDS: usize = 4;

/// The most that a round changes a volume by, as a factor: a hole that no particle reaches is not to be
/// filled by its neighbours.
const MOST: f64 = 2.0;

/// Rest volumes \[m³; m² in 2D\] of particles at `position` in `region`, which add up to the region's.
/// Nodes are at multiples of `dx` from `origin`.
pub(crate) fn even_volumes<const D: usize>(
    region: &Region<D>,
    position: &[[f64; D]],
    (origin, dx): ([f64; D], f64),
    kernel: Kernel,
) -> Vec<f64> {
    let between = core::array::from_fn(|axis| origin[axis] + 0.5 * dx);
    let lattices = [origin, between].map(|origin| Nodes::around(region.bounds(), origin, dx));
    match kernel {
        Kernel::Linear => even::<Linear, D>(&lattices, region, position),
        Kernel::Quadratic => even::<Quadratic, D>(&lattices, region, position),
        Kernel::Cubic => even::<Cubic, D>(&lattices, region, position),
    }
}

fn even<K: BSpline, const D: usize>(
    lattices: &[Nodes<D>],
    region: &Region<D>,
    position: &[[f64; D]],
) -> Vec<f64> {
    let whole = region.volume();
    let wanted: Vec<Vec<f64>> = lattices
        .iter()
        .map(|nodes| nodes.filled_by_shape::<K>(region))
        .collect();
    let mut volume = vec![whole / position.len().max(1) as f64; position.len()];
    for _ in 0..ROUNDS {
        for (nodes, wanted) in lattices.iter().zip(&wanted) {
            let mut filled = vec![0.0; wanted.len()];
            for (x, volume) in position.iter().zip(&volume) {
                nodes.touch::<K>(x, |node, weight| filled[node] += weight * volume);
            }
            for (x, volume) in position.iter().zip(&mut volume) {
                let mut factor = 0.0;
                nodes.touch::<K>(x, |node, weight| {
                    factor += weight * wanted[node] / filled[node]
                });
                *volume *= factor.clamp(1.0 / MOST, MOST);
            }
        }
    }
    let sum: f64 = volume.iter().sum();
    volume.iter_mut().for_each(|volume| *volume *= whole / sum);
    volume
}

/// The nodes that particles in a box can touch.
struct Nodes<const D: usize> {
    /// Where the first of them is \[m\].
    first: [f64; D],
    size: [usize; D],
    dx: f64,
}

impl<const D: usize> Nodes<D> {
    fn around(bounds: &Bounds<D>, origin: [f64; D], dx: f64) -> Self {
        /// Nodes beyond the cell of a particle that a kernel may touch.
        const REACH: f64 = 2.0;
        let low: [f64; D] =
            core::array::from_fn(|axis| ((bounds.min[axis] - origin[axis]) / dx).floor() - REACH);
        Self {
            first: core::array::from_fn(|axis| origin[axis] + low[axis] * dx),
            size: core::array::from_fn(|axis| {
                let high = ((bounds.max[axis] - origin[axis]) / dx).ceil() + REACH;
                (high - low[axis]) as usize + 1
            }),
            dx,
        }
    }

    /// Σ w V at each node, of the shape cut into small pieces.
    fn filled_by_shape<K: BSpline>(&self, region: &Region<D>) -> Vec<f64> {
        let bounds = region.bounds();
        let size = lattice_size(region, self.dx / FINE);
        let mut filled = vec![0.0; self.size.iter().product()];
        let mut pieces = 0_u64;
        for number in 0..size.iter().product::<usize>() {
            let mut rest = number;
            let x = core::array::from_fn(|axis| {
                let place = rest % size[axis];
                rest /= size[axis];
                bounds.min[axis] + bounds.side(axis) * ((place as f64 + 0.5) / size[axis] as f64)
            });
            if region.contains(&x) {
                pieces += 1;
                self.touch::<K>(&x, |node, weight| filled[node] += weight);
            }
        }
        let piece = region.volume() / pieces.max(1) as f64;
        filled.iter_mut().for_each(|sum| *sum *= piece);
        filled
    }

    /// Calls `f(node, weight)` for each node that a particle at `x` touches.
    fn touch<K: BSpline>(&self, x: &[f64; D], mut f: impl FnMut(usize, f64)) {
        let mut base = [0; D];
        let mut weights = [[0.0; 4]; D];
        for axis in 0..D {
            let cells = (x[axis] - self.first[axis]) / self.dx - K::OFFSET;
            base[axis] = cells as usize;
            weights[axis] = K::weights(cells - cells.floor());
        }
        for number in 0..K::NODES.pow(D as u32) {
            let mut rest = number;
            let (mut node, mut weight) = (0, 1.0);
            for axis in 0..D {
                let arm = rest % K::NODES;
                rest /= K::NODES;
                node = node * self.size[axis] + base[axis] + arm;
                weight *= weights[axis][arm];
            }
            f(node, weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Random, Sampling, sample};
    use crate::shape::Shape;

    /// The standard deviation of how full the nodes well inside are.
    fn unevenness(region: &Region<2>, position: &[[f64; 2]], volume: &[f64], dx: f64) -> f64 {
        let nodes = Nodes::around(region.bounds(), [0.0; 2], dx);
        let wanted = nodes.filled_by_shape::<Quadratic>(region);
        let mut filled = vec![0.0; wanted.len()];
        for (x, volume) in position.iter().zip(volume) {
            nodes.touch::<Quadratic>(x, |node, weight| filled[node] += weight * volume);
        }
        let inside: Vec<f64> = wanted
            .iter()
            .zip(&filled)
            .filter(|(wanted, _)| **wanted > 0.999 * dx * dx)
            .map(|(wanted, filled)| filled / wanted - 1.0)
            .collect();
        (inside.iter().map(|x| x * x).sum::<f64>() / inside.len() as f64).sqrt()
    }

    #[test]
    fn scattered_particles_fill_the_grid_evenly() {
        let dx = 0.1;
        let ball = Region::new(
            Shape::Ball {
                center: [0.03, -0.4],
                radius: 1.07,
            },
            Bounds::EVERYTHING,
        );
        for (sampling, most) in [(Sampling::Jittered, 0.5), (Sampling::Poisson, 0.5)] {
            let position = sample(&ball, 0.5 * dx, None, sampling, &mut Random::new(1, 0));
            let alike = vec![ball.volume() / position.len() as f64; position.len()];
            let even = even_volumes(&ball, &position, ([0.0; 2], dx), Kernel::Quadratic);
            let (before, after) = (
                unevenness(&ball, &position, &alike, dx),
                unevenness(&ball, &position, &even, dx),
            );
            assert!(after < most * before, "{sampling:?}: {before} to {after}");
            let sum: f64 = even.iter().sum();
            assert!((sum / ball.volume() - 1.0).abs() < 1e-12);
            assert!(even.iter().all(|volume| *volume > 0.0));
        }
    }
}
