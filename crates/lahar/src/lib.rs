//! Fluids and the solids they meet, by the Moving Least Squares Material Point Method (MLS-MPM), in 2D and 3D.
//!
//! The crate simulates and does nothing else: it reads no files, opens no window, prints nothing and asks for no time.
//! The crate `lahar-scene` reads scenes, `lahar-io` writes the results of runs.
//!
//! # Quick start
//!
//! A column of water that collapses in a box:
//!
//! ```
//! use lahar::{Contact, Domain, Field, ParticleBatch, Setup, Sides, Simulate, Simulation, WallStyle};
//!
//! // Materials: a preset, with the speed of sound to simulate [m/s]; ten times the fastest flow is usual.
//! let water = lahar::material::preset("water", 30.0).ok_or("there is no such preset")?;
//!
//! // The scene, with 5 cm between nodes.
//! let mut setup = Setup::<2>::new(0.05, vec![water]);
//! setup.gravity = [0.0, -9.81];
//! let wall = Contact::Separate { friction: 0.0 };
//! setup.domain = Some(Domain {
//!     min: [0.0, 0.0],
//!     max: [2.0, 1.0],
//!     sides: [Sides::Walls { low: wall, high: wall }; 2],
//!     style: WallStyle::Plane,
//! });
//!
//! // Particles: 0.5 m × 0.5 m, four per cell.
//! let spacing = 0.025;
//! let place = |i: usize| spacing * (i as f64 + 0.5);
//! let column = ParticleBatch {
//!     position: (0..400).map(|i| [place(i / 20), place(i % 20)]).collect(),
//!     volume: vec![spacing * spacing],
//!     ..Default::default()
//! };
//!
//! // A quarter of a second, in single precision. The time step is chosen automatically.
//! let mut simulation = Simulation::<f32, 2>::new(setup, &[column])?;
//! simulation.advance_to(0.25)?;
//!
//! let snapshot = simulation.snapshot(&[Field::Position]);
//! let position = snapshot.get(Field::Position).ok_or("it was asked for")?.to_f64();
//! let front = position.chunks(2).map(|x| x[0]).fold(0.0, f64::max);
//! assert!(front > 0.7, "the water runs to the right: {front} m");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A tour
//!
//! | to do this | use |
//! |---|---|
//! | describe a scene: domain, walls, colliders, forces, method | [`Setup`] |
//! | make shapes, and fill them with points | [`geometry`] |
//! | add particles, at the start or later | [`ParticleBatch`], [`Simulation::add`] |
//! | choose materials or write one | [`material::preset`], [`Model`], [`material::law`] |
//! | take substeps, in any dimension and precision | [`Simulation`], [`Simulate`] |
//! | compute frames that are tried again with a shorter time step if they fail | [`frame`] |
//! | turn gravity, stir, make a fluid stiffer | [`Command`] |
//! | look at particles and totals | [`Simulate::snapshot`], [`Simulate::diagnostics`] |
//! | measure pressure, heights, fronts and forces | [`Probe`], [`Simulate::boundary_impulses`] |
//! | save the state and go on with the same bits | [`Simulate::checkpoint`], [`Simulate::resume`] |
//! | check a result against the plain equations | [`mod@reference`] |
//!
//! Units are SI; 2D is per meter of depth. Pressures count compression as positive. [`equations`] is the page of all
//! equations: a line of code that is one of them ends with its number.
//!
//! # Bits
//!
//! A scene gives the same bits on any number of threads, and after any checkpoint, on one instruction set.
//! [`Isa::Portable`] gives the same bits on every machine.
//!
//! # Features
//!
//! - `threads` (default): computes on all threads of the current rayon pool. Without it the crate has no threads, and
//!   the same bits.

mod array;
pub mod boundary;
mod dispatch;
/// The equations of the method with their numbers. Formulas are in LaTeX.
///
#[doc = include_str!("../docs/equations.md")]
pub mod equations {}
pub mod error;
mod float_mode;
mod force;
pub mod geometry;
pub mod grid;
mod instance;
pub mod kernel;
pub mod material;
pub mod math;
mod parallel;
pub mod particles;
mod prefetch;
pub mod reference;
pub mod setup;
pub mod simulate;
pub mod simulation;
mod state;
mod step;
mod transfer;
mod volume;

pub use boundary::BoundaryImpulse;
pub use error::{DtLimit, Failure, SetupError};
pub use geometry::{Bounds, Primitive, Shape};
pub use instance::Instance;
pub use material::{Material, Model};
pub use particles::{Data, Field, Snapshot};
pub use setup::{
    AccelerationField, Collider, Command, Contact, Cushion, Deformation, Domain, Force, ForceForm,
    Gauge, Isa, Kernel, Keyframe, Motion, ParticleBatch, Plate, Pointer, PointerAction, Probe,
    ProbeSample, ProbeSamples, Pull, Setup, Sides, StartingValues, TimeStep, Transfer, WallStyle,
};
pub use simulate::{Advance, Backend, Memory, Simulate, frame};
pub use simulation::Simulation;
pub use state::checkpoint::{self, Checkpoint, CheckpointError};
pub use state::diagnostics::{self, Diagnostics};
pub use state::retry::Retry;
pub use step::PhaseTimes;

/// The Rust blocks of the README of the repository and of this crate, compiled and run by the tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/README.md")]
#[doc = include_str!("../README.md")]
mod readme {}
