//! What a simulation is made of, as plain data: checked once, by [`crate::Simulation::new`].

use crate::boundary::{Collider, Corners, Cushion, Domain};
use crate::forces::Force;
use crate::material::Material;
use crate::state::probe::Probe;

/// Everything but the particles. SI units; in 2D per metre of depth.
#[derive(Clone, Debug)]
pub struct Setup<const D: usize> {
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// The box of the scene and its walls; `None`: unbounded, nodes at multiples of `dx`.
    pub domain: Option<Domain<D>>,
    /// Particles that leave this box are put back on its sides; their velocities stay. Walls on their
    /// planes do that besides.
    pub clamp: Option<Corners<D>>,
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

/// Instruction sets. The same scene gives the same bits on one of them, and on
/// [`Isa::Portable`] on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// The compile target's baseline, without fused multiply-adds.
    Portable,
    /// AVX2 with FMA.
    Avx2,
    /// AVX-512 (Ice Lake and later).
    Avx512,
    /// AArch64's vectors.
    Neon,
}

impl Isa {
    /// The widest that this machine has.
    pub fn detect() -> Self {
        [Self::Avx512, Self::Avx2, Self::Neon]
            .into_iter()
            .find(|isa| isa.is_available())
            .unwrap_or(Self::Portable)
    }

    /// Whether this machine can run it.
    pub fn is_available(self) -> bool {
        crate::dispatch::level(self).is_some()
    }

    /// As written in scenes and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }

    /// All of them, whether this machine has them or not.
    pub const ALL: [Self; 4] = [Self::Portable, Self::Avx2, Self::Avx512, Self::Neon];
}

/// Particles to add, all of one material.
#[derive(Clone, Debug, Default)]
pub struct ParticleBatch<const D: usize> {
    /// Index into [`Setup::materials`].
    pub material: usize,
    /// The body they belong to; free for the caller to number.
    pub body: u32,
    /// Positions \[m\], one a particle.
    pub position: Vec<[f64; D]>,
    /// Velocities \[m/s\]: none (at rest), one for all, or one a particle.
    pub velocity: Vec<[f64; D]>,
    /// Rest volumes \[m³; m² in 2D\]: one for all, or one a particle.
    pub volume: Vec<f64>,
    /// Whether the volumes are measured at the start: each particle's V⁰ becomes its volume as given
    /// times the J of equation (7g), with the masses left as they are.
    pub measure_volume: bool,
    /// Masses \[kg\]: none (density × volume), one for all, or one a particle.
    pub mass: Vec<f64>,
    /// Affine matrices C \[1/s\], `c[i][j]` = ∂v_i/∂x_j: none (zero), or one a particle.
    pub affine: Vec<[[f64; D]; D]>,
    /// Deformation at the start.
    pub deformation: Deformation<D>,
    /// J_P of models with plastic flow: none (1), or one a particle. Other models do not read it.
    pub plastic_jacobian: Vec<f64>,
}

/// How particles are deformed at the start.
#[derive(Clone, Debug, Default)]
pub enum Deformation<const D: usize> {
    /// Not at all: F = I.
    #[default]
    Rest,
    /// Swollen or compressed: J, one a particle; F = J^(1/D) I.
    Jacobian(Vec<f64>),
    /// Deformation gradients `f[i][j]`, one a particle.
    Gradient(Vec<[[f64; D]; D]>),
}
