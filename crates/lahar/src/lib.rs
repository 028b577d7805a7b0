//! Fluids, jelly and snow by the Moving Least Squares Material Point Method, in 2D and 3D.

pub mod boundary;
mod dispatch;
pub mod error;
mod float_mode;
pub mod forces;
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
pub mod simulation;
mod state;
mod step;
mod transfer;

pub use boundary::{
    BoundaryImpulse, Collider, Contact, Corners, Cushion, Domain, Keyframe, Motion, Sides, Solid,
    WallStyle,
};
pub use error::{DtLimit, Failure, SetupError};
pub use forces::{AccelerationField, Force, Pull};
pub use instance::Instance;
pub use material::{Material, Model};
pub use particles::{Data, Field, Snapshot};
pub use setup::{Deformation, ForceForm, Isa, Kernel, ParticleBatch, Setup, TimeStep, Transfer};
pub use simulation::{
    Advance, Command, Memory, PhaseTimes, Pointer, PointerAction, Simulate, Simulation,
};
pub use state::checkpoint::{self, Checkpoint, CheckpointError};
pub use state::diagnostics::{self, Diagnostics};
pub use state::probe::{self, Gauge, Plate, Probe, ProbeSample, ProbeSamples};
pub use state::retry::{Retry, frame};
