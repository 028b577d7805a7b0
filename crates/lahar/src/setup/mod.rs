//! What a simulation is made of, as plain data: checked once, by [`crate::Simulation::new`].

mod command;
mod isa;
mod particle_batch;
mod probe;

pub use command::{Command, Pointer, PointerAction};
pub use isa::Isa;
pub use particle_batch::{Deformation, ParticleBatch, StartingValues};
pub use probe::{Gauge, Plate, Probe, ProbeSample, ProbeSamples};

use crate::boundary::{Collider, Cushion, Domain};
use crate::forces::Force;
use crate::geometry::Bounds;
use crate::material::Material;

/// Everything but the particles. SI units; in 2D per metre of depth.
#[derive(Clone, Debug)]
pub struct Setup<const D: usize> {
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// The box of the scene and its walls; `None`: unbounded, nodes at multiples of `dx`.
    pub domain: Option<Domain<D>>,
    /// Particles that leave this box are put back on its sides; their velocities stay. Walls on their
    /// planes do that besides.
    pub clamp: Option<Bounds<D>>,
    /// Slows particles down before they reach the walls.
    pub cushion: Option<Cushion<D>>,
    /// Bodies that the material cannot enter; they act one after the other, after the walls.
    pub colliders: Vec<Collider<D>>,
    /// Acceleration of everything \[m/s²\].
    pub gravity: [f64; D],
    /// Forces besides gravity and stress.
    pub forces: Vec<Force<D>>,
    /// The weight function between particles and nodes.
    pub kernel: Kernel,
    /// What particles and grid exchange.
    pub transfer: Transfer,
    /// How stress becomes force.
    pub force: ForceForm,
    /// How long a substep is.
    pub time_step: TimeStep,
    /// The materials; particles name them by their index here.
    pub materials: Vec<Material>,
    /// What is measured on the way.
    pub probes: Vec<Probe<D>>,
    /// The instruction set to run on; [`Isa::detect`] is the widest this machine has.
    pub isa: Isa,
}

impl<const D: usize> Setup<D> {
    /// Unbounded, no gravity, quadratic APIC with the MLS force, automatic time step, the widest
    /// instruction set.
    pub fn new(dx: f64, materials: Vec<Material>) -> Self {
        Self {
            dx,
            domain: None,
            clamp: None,
            cushion: None,
            colliders: Vec::new(),
            gravity: [0.0; D],
            forces: Vec::new(),
            kernel: Kernel::default(),
            transfer: Transfer::default(),
            force: ForceForm::default(),
            time_step: TimeStep::default(),
            materials,
            probes: Vec::new(),
            isa: Isa::detect(),
        }
    }
}

/// B-spline by its degree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// Two nodes an axis; with [`ForceForm::Classic`] only, since its inertia D is singular at nodes.
    Linear,
    /// Three nodes an axis, D = ¼dx² I.
    #[default]
    Quadratic,
    /// Four nodes an axis, D = ⅓dx² I.
    Cubic,
}

/// What of a particle's motion the grid is told, and what the particle takes back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Transfer {
    /// Velocity only; the particle takes the grid's: stable, very dissipative.
    Pic,
    /// Velocity only; the particle takes `blend` of its own velocity plus the grid's change, and
    /// `1 − blend` of the grid's velocity.
    Flip {
        /// 1: pure FLIP; 0: PIC; .99 is common.
        blend: f64,
    },
    /// Velocity and the affine matrix C (Jiang 2015): keeps angular momentum.
    #[default]
    Apic,
}

/// Where the gradient of the weights comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceForm {
    /// Moving least squares: the force is fused into the affine momentum, equation (4).
    #[default]
    Mls,
    /// The original MPM: f_i = −Σ V⁰ τ ∇w, F ← (I + Δt Σ v ∇wᵀ) F.
    Classic,
}

/// How the length of a substep is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStep {
    /// Always this \[s\].
    Fixed(f64),
    /// From the state: sound, particle speed, viscosity, one cell a substep.
    Automatic {
        /// The part of a cell that sound or a particle may cross in a substep.
        cfl: f64,
        /// Never longer than this \[s\].
        longest: f64,
    },
}

impl Default for TimeStep {
    fn default() -> Self {
        Self::Automatic {
            cfl: 0.4,
            longest: f64::INFINITY,
        }
    }
}
