//! Setups as plain data, and their one checker.
//!
//! ```text
//! Setup, ParticleBatch ──check──▶ engine (simulation.rs), oracle (reference.rs)
//! ```

pub(crate) mod check;
mod collider;
mod command;
mod domain;
mod force;
mod isa;
mod particle_batch;
mod probe;
mod scheme;

pub use collider::{Collider, Keyframe, Motion};
pub use command::{Command, Pointer, PointerAction};
pub use domain::{Contact, Cushion, Domain, Sides, WallStyle};
pub use force::{AccelerationField, Force, Pull};
pub use isa::Isa;
pub use particle_batch::{Deformation, ParticleBatch, StartingValues};
pub use probe::{Gauge, Plate, Probe, ProbeSample, ProbeSamples};
pub(crate) use scheme::Scheme;

use crate::geometry::Bounds;
use crate::kernel::{self, BSpline};
use crate::material::Material;

/// Everything but the particles: the scene, the materials and the method. In SI units; 2D is per meter of depth.
/// [`Simulation::new`](crate::Simulation::new) checks it.
///
/// ```
/// use lahar::{
///     Collider, Contact, Domain, Force, ParticleBatch, Primitive, Setup, Sides, Simulate, Simulation,
///     WallStyle,
/// };
///
/// // Water at rest would get this speed of sound: ten times the fastest flow that is expected.
/// let water = lahar::material::preset("water", 20.0).ok_or("unknown")?;
/// let mut setup = Setup::<2>::new(0.05, vec![water]);
/// setup.gravity = [0.0, -9.81];
///
/// // A box with walls that the water can leave but not enter, without friction.
/// let wall = Contact::Separate { friction: 0.0 };
/// setup.domain = Some(Domain {
///     min: [0.0, 0.0],
///     max: [2.0, 1.0],
///     sides: [Sides::Walls { low: wall, high: wall }; 2],
///     style: WallStyle::Plane,
/// });
///
/// // A ball that stands in the way.
/// let ball = Primitive::Ball { center: [1.0, 0.1], radius: 0.1 };
/// setup.colliders.push(Collider::still("ball", vec![ball], Contact::Slip { friction: 0.1 }));
///
/// // Resistance of the air.
/// setup.forces.push(Force::Drag { rate: 0.1, velocity: [0.0, 0.0] });
///
/// let place = |i: usize| 0.025 * (i as f64 + 0.5);
/// let column = ParticleBatch {
///     position: (0..400).map(|i| [place(i / 20), place(i % 20)]).collect(),
///     volume: vec![0.025 * 0.025],
///     ..Default::default()
/// };
/// let mut simulation = Simulation::<f32, 2>::new(setup, &[column])?;
/// simulation.advance_to(0.1)?;
///
/// let bottom = &simulation.boundary_impulses()[2];
/// assert_eq!(bottom.name, "bottom");
/// assert!(bottom.impulse[1] < 0.0, "the water presses down on it");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Setup<const D: usize> {
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// The box of the scene and its walls; `None` for a scene without bounds, with nodes at multiples of `dx`.
    pub domain: Option<Domain<D>>,
    /// A box that particles are kept in: those that leave it are put back on its sides, with their velocities. Walls
    /// on their planes do that in any case.
    pub clamp: Option<Bounds<D>>,
    /// A zone that slows particles down before they reach the walls.
    pub cushion: Option<Cushion<D>>,
    /// Bodies that the material cannot enter. They act one after the other, after the walls.
    pub colliders: Vec<Collider<D>>,
    /// Acceleration of everything \[m/s²\].
    pub gravity: [f64; D],
    /// Forces besides gravity and stress.
    pub forces: Vec<Force<D>>,
    /// The weight function between particles and nodes.
    pub kernel: Kernel,
    /// The transfer scheme between particles and grid.
    pub transfer: Transfer,
    /// The way from stress to force.
    pub force: ForceForm,
    /// Length of a substep.
    pub time_step: TimeStep,
    /// The materials. Particles name them by their index here.
    pub materials: Vec<Material>,
    /// Measurements while the simulation runs.
    pub probes: Vec<Probe<D>>,
    /// The instruction set to run on; [`Isa::detect`] finds the widest of this machine.
    pub isa: Isa,
}

impl<const D: usize> Setup<D> {
    /// Creates a setup without bounds and gravity: quadratic APIC with the MLS force, an automatic time step, on the
    /// widest instruction set. `dx` is the distance between nodes \[m\].
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

/// The weight function between particles and nodes: a B-spline, by its degree.
///
/// ```
/// use lahar::{ForceForm, Kernel, Setup, Simulation};
///
/// let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// let mut setup = Setup::<2>::new(0.1, vec![jelly]);
/// setup.kernel = Kernel::Linear;
/// let error = Simulation::<f64, 2>::new(setup.clone(), &[]).err().ok_or("this must be refused")?;
/// assert_eq!(error.key, "kernel");
///
/// setup.force = ForceForm::Classic;
/// Simulation::<f64, 2>::new(setup, &[])?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// Two nodes per axis. It needs [`ForceForm::Classic`], since its inertia D is singular at nodes.
    Linear,
    /// Three nodes per axis, D = ¼dx² I.
    #[default]
    Quadratic,
    /// Four nodes per axis, D = ⅓dx² I.
    Cubic,
}

impl Kernel {
    /// Nodes that the kernel touches on an axis.
    pub(crate) fn nodes(self) -> usize {
        match self {
            Self::Linear => kernel::Linear::NODES,
            Self::Quadratic => kernel::Quadratic::NODES,
            Self::Cubic => kernel::Cubic::NODES,
        }
    }

    /// The kernel's [`BSpline::OFFSET`] \[cells\].
    pub(crate) fn offset(self) -> f64 {
        match self {
            Self::Linear => kernel::Linear::OFFSET,
            Self::Quadratic => kernel::Quadratic::OFFSET,
            Self::Cubic => kernel::Cubic::OFFSET,
        }
    }

    /// The kernel's [`BSpline::INVERSE_INERTIA`].
    pub(crate) fn inverse_inertia(self) -> f64 {
        match self {
            Self::Linear => kernel::Linear::INVERSE_INERTIA,
            Self::Quadratic => kernel::Quadratic::INVERSE_INERTIA,
            Self::Cubic => kernel::Cubic::INVERSE_INERTIA,
        }
    }
}

/// The transfer scheme: which part of a particle's motion goes to the grid, and how the particle takes the grid's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Transfer {
    /// The grid gets the velocity, and the particle takes the grid's velocity. Stable and very dissipative.
    Pic,
    /// The grid gets the velocity. The particle takes `blend` of its own velocity plus the grid's change, and
    /// `1 − blend` of the grid's velocity.
    Flip {
        /// The share of pure FLIP, from 0 (PIC) to 1 (FLIP); 0.99 is common.
        blend: f64,
    },
    /// The grid gets the velocity and the affine matrix C, and the particle takes both (Jiang et al. 2015). Conserves
    /// angular momentum.
    #[default]
    Apic,
}

/// The form of the force of stress on nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceForm {
    /// Moving least squares: the force is part of the affine momentum, equation (4).
    #[default]
    Mls,
    /// The original MPM, by gradients of the weights: f_i = −Σ V⁰ τ ∇w, F ← (I + Δt Σ v ∇wᵀ) F.
    Classic,
}

/// The length of a substep.
///
/// ```
/// use lahar::{DtLimit, Setup, Simulate, Simulation, TimeStep};
///
/// let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// let mut setup = Setup::<2>::new(0.1, vec![jelly]);
/// setup.time_step = TimeStep::Fixed(1e-4);
/// let mut simulation = Simulation::<f32, 2>::new(setup, &[])?;
/// assert_eq!(simulation.next_dt(), (1e-4, DtLimit::Fixed));
/// let advance = simulation.advance_to(0.01)?;
/// assert_eq!(advance.substeps, 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStep {
    /// Always this length \[s\].
    Fixed(f64),
    /// The longest that the state allows: sound, particles and colliders cross at most a part of a cell, and
    /// viscosity is stable.
    Automatic {
        /// The part of a cell that sound or a particle may cross in a substep, above 0 and at most 1.
        cfl: f64,
        /// An upper limit \[s\].
        longest: f64,
    },
}

impl Default for TimeStep {
    /// Automatic, with a cfl of 0.4 and without an upper limit.
    fn default() -> Self {
        Self::Automatic {
            cfl: 0.4,
            longest: f64::INFINITY,
        }
    }
}

/// How far sound travels, in cells, between two corrections of the fluids' volumes, (7h) and (7i).
pub(crate) const CORRECTION_INTERVAL: f64 = 5.0;

/// Fills a vector up with zeros to three components.
pub(crate) fn to_3d<const D: usize>(a: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|i| if i < D { a[i] } else { 0.0 })
}
