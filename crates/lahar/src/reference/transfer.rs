//! The two transfers of the oracle, particle by particle and node by node: (1)–(6), (8).

use super::{Grid, Momentum, Particle, Reference, Velocity};
use crate::boundary::pointer::ParticlePointer;
use crate::kernel::{BSpline, Cubic, Linear, Quadratic};
use crate::math::{Matrix, Vector};
use crate::setup::{ForceForm, Kernel, Transfer};

impl<const D: usize> Reference<D> {
    /// Transfers particles to the grid, for a substep of `dt` \[s\].
    pub fn particles_to_grid(&self, dt: f64) -> Grid<Momentum<D>, D> {
        let (zero, d_inv) = (Vector([0.0; D]), self.inverse_inertia());
        let mut grid = Grid::new();
        for particle in &self.particles {
            let Particle {
                mass: m,
                volume0: v0,
                velocity: v,
                affine: c,
                ..
            } = *particle;
            let tau = self.law(particle).kirchhoff_stress(&particle.strain, c);
            let q = match self.setup.transfer {
                Transfer::Pic | Transfer::Flip { .. } => Matrix([zero; D]),
                Transfer::Apic => c * m, // (4) without stress
            };
            for Touch {
                node,
                w,
                r,
                gradient,
            } in self.touched_nodes(particle)
            {
                let n = grid.entry(node).or_insert(Momentum {
                    mass: 0.0,
                    momentum: zero,
                    impulse: zero,
                });
                n.mass += w * m; // (1)
                n.momentum += (v * m + q * r) * w; // (2) without stress
                n.impulse += match self.setup.force {
                    ForceForm::Mls => tau * r * (w * -dt * v0 * d_inv), // (2), stress in (4)
                    ForceForm::Classic => tau * gradient * (-dt * v0),
                };
            }
        }
        grid
    }

    /// Transfers the grid's velocities to particles, for a substep of `dt` \[s\].
    pub fn grid_to_particles(&mut self, grid: &Grid<Velocity<D>, D>, dt: f64) {
        let pointer = ParticlePointer::of(self.pointer, self.origin.0, self.setup.dx, dt);
        let colliders = self.moving(dt);
        let mut particles = core::mem::take(&mut self.particles);
        for particle in &mut particles {
            let (mut pic, mut change) = (Vector([0.0; D]), Vector([0.0; D]));
            let mut b = Matrix([Vector([0.0; D]); D]);
            let mut gradient_of_v = Matrix([Vector([0.0; D]); D]);
            for Touch {
                node,
                w,
                r,
                gradient,
            } in self.touched_nodes(particle)
            {
                let Some(n) = grid.get(&node) else { continue };
                pic += n.after * w; // (5)
                change += (n.after - n.before) * w;
                b += outer(n.after, r) * w; // (6)
                gradient_of_v += outer(n.after, gradient);
            }
            let c = match self.setup.kernel {
                Kernel::Linear => gradient_of_v,
                Kernel::Quadratic | Kernel::Cubic => b * self.inverse_inertia(), // (3)
            };
            let velocity_gradient = match self.setup.force {
                ForceForm::Mls => c,
                ForceForm::Classic => gradient_of_v,
            };
            let law = self.law(particle);
            particle.strain = law.advance(&particle.strain, velocity_gradient * dt); // (7)
            particle.position += pic * dt; // (8)
            particle.velocity = match self.setup.transfer {
                Transfer::Pic | Transfer::Apic => pic,
                Transfer::Flip { blend } => {
                    (particle.velocity + change) * blend + pic * (1.0 - blend)
                }
            };
            particle.affine = c;
            self.clamp(particle);
            if let Some(pointer) = pointer {
                particle.velocity = pointer.act(particle.velocity, self.in_cells(particle)); // (12)
            }
            self.wrap_and_slow(particle);
            self.project_out(particle, &colliders);
        }
        let (inside, escaped) = particles.into_iter().partition(|p| !self.is_outside(p));
        self.particles = inside;
        self.escaped.extend::<Vec<_>>(escaped);
    }

    /// Returns D⁻¹ of (3) \[1/m²\]; infinite for the linear kernel.
    fn inverse_inertia(&self) -> f64 {
        let in_cells = match self.setup.kernel {
            Kernel::Linear => Linear::INVERSE_INERTIA,
            Kernel::Quadratic => Quadratic::INVERSE_INERTIA,
            Kernel::Cubic => Cubic::INVERSE_INERTIA,
        };
        in_cells / (self.setup.dx * self.setup.dx)
    }

    /// Returns the nodes that a particle touches.
    pub(super) fn touched_nodes(&self, particle: &Particle<D>) -> Vec<Touch<D>> {
        let (x, dx) = (self.in_cells(particle), self.setup.dx);
        let mut touched = match self.setup.kernel {
            Kernel::Linear => stencil::<Linear, D>(x, dx),
            Kernel::Quadratic => stencil::<Quadratic, D>(x, dx),
            Kernel::Cubic => stencil::<Cubic, D>(x, dx),
        };
        for touch in &mut touched {
            touch.node = self.walls.canonical(touch.node);
        }
        touched
    }
}

/// A particle and one of the nodes it touches.
pub(super) struct Touch<const D: usize> {
    pub(super) node: [i64; D],
    /// Weight w of the node.
    pub(super) w: f64,
    /// Lever arm r = x_i − x_p \[m\].
    pub(super) r: Vector<f64, D>,
    /// ∇w, by the particle's position \[1/m\].
    gradient: Vector<f64, D>,
}

/// Returns the nodes that a particle at `x` \[cells from node 0\] touches.
fn stencil<K: BSpline, const D: usize>(x: Vector<f64, D>, dx: f64) -> Vec<Touch<D>> {
    let base = Vector::<f64, D>::from_fn(|axis| (x[axis] - K::OFFSET).floor());
    let countable = 1.0 / f64::EPSILON;
    assert!(
        base.0.iter().all(|b| b.abs() < countable),
        "a particle is {x:?} cells from the origin"
    );
    let frac = Vector::<f64, D>::from_fn(|axis| x[axis] - K::OFFSET - base[axis]);
    let weights: [_; D] = core::array::from_fn(|axis| K::weights(frac[axis]));
    let gradients: [_; D] = core::array::from_fn(|axis| K::gradients(frac[axis]));
    let mut touched = Vec::with_capacity(K::NODES.pow(D as u32));
    for number in 0..K::NODES.pow(D as u32) {
        // `number` counts through K::NODES nodes per axis.
        let k: [usize; D] =
            core::array::from_fn(|axis| number / K::NODES.pow(axis as u32) % K::NODES);
        let w = (0..D).map(|axis| weights[axis][k[axis]]).product();
        let r = Vector::from_fn(|axis| (k[axis] as f64 - (K::OFFSET + frac[axis])) * dx);
        let gradient = Vector::from_fn(|axis| {
            let factor = |other: usize| {
                if other == axis {
                    gradients[other][k[other]] / dx
                } else {
                    weights[other][k[other]]
                }
            };
            (0..D).map(factor).product()
        });
        touched.push(Touch {
            node: core::array::from_fn(|axis| base[axis] as i64 + k[axis] as i64),
            w,
            r,
            gradient,
        });
    }
    touched
}

/// Returns a / b. It is not a times 1 / b, which overflows where b is the mass of a node that is barely touched.
pub(super) fn over<const D: usize>(a: Vector<f64, D>, b: f64) -> Vector<f64, D> {
    Vector::from_fn(|axis| a[axis] / b)
}

/// Returns a bᵀ.
pub(super) fn outer<const D: usize>(a: Vector<f64, D>, b: Vector<f64, D>) -> Matrix<f64, D> {
    Matrix::from_fn(|i, j| a[i] * b[j])
}
