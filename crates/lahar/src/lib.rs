//! Fluids, jelly and snow by the Moving Least Squares Material Point Method, in 2D and 3D.

mod array;
pub mod boundary;
mod dispatch;
pub mod error;
mod float_mode;
pub mod forces;
pub mod geometry;
mod grid;
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

pub use boundary::{
    BoundaryImpulse, Collider, Contact, Cushion, Domain, Keyframe, Motion, Sides, WallStyle,
};
pub use error::{DtLimit, Failure, SetupError};
pub use forces::{AccelerationField, Force, Pull};
pub use geometry::{Bounds, Primitive, Shape};
pub use instance::Instance;
pub use material::{Material, Model};
pub use particles::{Data, Field, Snapshot};
pub use setup::{
    Command, Deformation, ForceForm, Gauge, Isa, Kernel, ParticleBatch, Plate, Pointer,
    PointerAction, Probe, ProbeSample, ProbeSamples, Setup, StartingValues, TimeStep, Transfer,
};
pub use simulate::{Advance, Memory, PhaseTimes, Simulate};
pub use simulation::Simulation;
pub use state::checkpoint::{self, Checkpoint, CheckpointError};
pub use state::diagnostics::{self, Diagnostics};
pub use state::retry::{Retry, frame};

/// The Rust blocks of the README of the repository and of this crate, compiled and run by the tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/README.md")]
#[doc = include_str!("../README.md")]
mod readme {}
