//! The oracle: the method by its plain equations, to check the fast engine against.
//!
//! It computes in `f64`, one particle after the other, with nodes in an ordered map and without blocks, tiles, lanes or
//! threads. Nothing here is fast. Each line that *is* an equation carries its number. Kernels, laws and contact laws are
//! those of the engine, since a formula has one copy; the loops over nodes are not.
//!
//! ```text
//! particles ──P2G, (1) (2) (4)──▶ Grid<Momentum> ──+ gravity, walls──▶ Grid<Velocity>
//!     ▲                                                                    │
//!     └──────────────────────── G2P, (3) (5)–(8) ──────────────────────────┘
//! ```
//!
//! The impulse of stress on a node, −Δt V⁰ D⁻¹ τ of (4), is apart from the momentum that particles bring, because FLIP and
//! the staggered energy ask for a node's velocity before forces. Lever arms are r = x_i − x_p.
//!
//! ```
//! use lahar::reference::Reference;
//! use lahar::{Material, Model, ParticleBatch, Setup, material::Corotated};
//!
//! let jelly = Material { name: "jelly".into(), density: 1000.0, model: Model::Corotated(Corotated { lambda: 1e4, mu: 1e4 }) };
//! let mut setup = Setup::<2>::new(0.1, vec![jelly]);
//! setup.gravity = [0.0, -9.81];
//! let batch = ParticleBatch { position: vec![[0.2, 0.3]], volume: vec![0.0025], ..Default::default() };
//! let mut reference = Reference::new(&setup, &[batch])?;
//! reference.substep(1e-3);
//! assert!((reference.momentum()[1] + 9.81e-3 * reference.mass()).abs() < 1e-9);
//! # Ok::<(), lahar::SetupError>(())
//! ```

mod boundaries;
mod grid_update;
mod law;
mod start;
#[cfg(test)]
mod tests;
mod totals;
mod transfer;
mod volumes;

use crate::boundary::walls::Walls;
use crate::force;
use crate::math::{Matrix, Vector};
use crate::setup::{Collider, Pointer, Setup};
use law::{Law, law};
use std::collections::BTreeMap;

/// A particle of the oracle.
#[derive(Clone, Debug)]
pub struct Particle<const D: usize> {
    /// Its number, counted through all batches from 0.
    pub id: u32,
    /// The index of its material in [`Setup::materials`].
    pub material: usize,
    /// The number of its body.
    pub body: u32,
    /// Mass m \[kg\].
    pub mass: f64,
    /// Rest volume V⁰ \[m³; m² in 2D\].
    pub volume0: f64,
    /// Position x \[m\], in the scene's coordinates.
    pub position: Vector<f64, D>,
    /// Velocity v \[m/s\].
    pub velocity: Vector<f64, D>,
    /// Affine matrix C \[1/s\], `affine[(i, j)]` = ∂v_i/∂x_j. All transfer schemes gather it; only APIC transfers it back to
    /// the grid.
    pub affine: Matrix<f64, D>,
    /// The columns of its model's [`Strain`](crate::material::Strain).
    pub strain: Vec<f64>,
}

/// The sums at a node after P2G.
#[derive(Clone, Copy, Debug)]
pub struct Momentum<const D: usize> {
    /// Mass m_i \[kg\].
    pub mass: f64,
    /// Momentum m_i v_i \[kg m/s\], without the impulse of stress.
    pub momentum: Vector<f64, D>,
    /// The impulse of stress: Δt times its force \[kg m/s\].
    pub impulse: Vector<f64, D>,
}

/// The velocity of a node after the grid update.
#[derive(Clone, Copy, Debug)]
pub struct Velocity<const D: usize> {
    /// Mass m_i \[kg\].
    pub mass: f64,
    /// Velocity before forces and boundaries \[m/s\].
    pub before: Vector<f64, D>,
    /// Velocity after them \[m/s\].
    pub after: Vector<f64, D>,
}

/// Nodes by their index: node n is at `origin` + n dx. Indices on periodic axes are within one period.
pub type Grid<N, const D: usize> = BTreeMap<[i64; D], N>;

/// The particles of a scene, and the plainest way to advance them.
#[derive(Clone, Debug)]
pub struct Reference<const D: usize> {
    setup: Setup<D>,
    /// The position of node 0 \[m\].
    origin: Vector<f64, D>,
    walls: Walls<D>,
    /// Lengths in cells from node 0.
    colliders: Vec<Collider<D>>,
    particles: Vec<Particle<D>>,
    escaped: Vec<Particle<D>>,
    /// The first position of each particle \[m\], by id.
    starts: Vec<[f64; D]>,
    /// Simulated time \[s\].
    time: f64,
    pointer: Option<Pointer>,
    /// Time since the last correction of the fluids' volumes \[s\].
    uncorrected: f64,
}

impl<const D: usize> Reference<D> {
    /// Returns the particles in the scene, by ascending id.
    pub fn particles(&self) -> &[Particle<D>] {
        &self.particles
    }

    /// Returns the particles that have left through open sides, in the order in which they left.
    pub fn escaped(&self) -> &[Particle<D>] {
        &self.escaped
    }

    /// Returns H = F − I of a particle; (J^(1/D) − 1) I for models that store J only.
    pub fn displacement_gradient(&self, particle: &Particle<D>) -> Matrix<f64, D> {
        self.law(particle).displacement_gradient(&particle.strain)
    }

    /// Returns J_P of a particle, 1 for models without plastic flow.
    pub fn plastic_jacobian(&self, particle: &Particle<D>) -> f64 {
        self.law(particle).plastic_jacobian(&particle.strain)
    }

    /// Returns J − 1 of a particle.
    pub fn jacobian_minus_one(&self, particle: &Particle<D>) -> f64 {
        self.law(particle).jacobian_minus_one(&particle.strain)
    }

    /// Sets or removes the pointer.
    pub fn set_pointer(&mut self, pointer: Option<Pointer>) {
        self.pointer = pointer;
    }

    /// Takes one substep of `dt` \[s\]. Its length is not checked.
    ///
    /// # Panics
    /// If a particle's position is not finite, or so far away that its nodes cannot be counted.
    pub fn substep(&mut self, dt: f64) {
        self.correct_volumes(dt);
        self.accelerate_particles(dt);
        self.gather_volumes();
        let momentum = self.particles_to_grid(dt);
        let velocity = self.update_grid(&momentum, dt);
        self.grid_to_particles(&velocity, dt);
        self.time += dt;
    }

    /// Lets the forces act that depend on where particles started: v_p += Δt a, before P2G.
    fn accelerate_particles(&mut self, dt: f64) {
        for p in &mut self.particles {
            let start = self.starts[p.id as usize];
            let mut a = [[0.0; D]];
            force::accelerations(
                &self.setup.forces,
                true,
                self.time,
                &[p.position.0],
                &[start],
                &mut [[0.0; D]],
                &mut a,
            );
            p.velocity += Vector(a[0]) * dt; // (11)
        }
    }

    /// Returns a particle's position in cells from node 0.
    fn in_cells(&self, particle: &Particle<D>) -> Vector<f64, D> {
        transfer::over(particle.position - self.origin, self.setup.dx)
    }

    /// Returns the law of a particle's material.
    fn law(&self, particle: &Particle<D>) -> &dyn Law<D> {
        law(&self.setup.materials[particle.material].model)
    }
}
