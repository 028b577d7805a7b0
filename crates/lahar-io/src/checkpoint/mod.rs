//! What a run keeps so that it can go on after anything: `DIR/checkpoints/`.
//!
//! ```text
//! checkpoints/start.json          what the run began with: scene, its files, instruction set, outputs   start
//! checkpoints/files/0.csv         copies of files that the scene names
//! checkpoints/000120.checkpoint   the state after frame 120; the newest two are kept                    format, store
//! checkpoints/lock                held by the run that writes here                                      lock
//! ```
//! A checkpoint says how long each growing file was when it was written, so that whoever goes on from it cuts
//! them back and writes what follows again: the same bytes.

mod format;
mod lock;
mod start;
mod store;

pub use format::{Header, read, write};
pub(crate) use format::{LENGTH_AT, Sums, read_with};
pub use lock::Lock;
pub use start::{Start, Unusable};
pub use store::{Newest, Store};

use serde::{Deserialize, Serialize};

use crate::output::{OutputState, PhaseSeconds};

/// How far a run was.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// The last frame that was written.
    pub frame: u64,
    /// Σ over substeps of particles.
    pub particle_steps: u64,
    /// How often particles were sorted.
    pub sorts: u64,
    /// Frames that were tried again, in words.
    pub retries: Vec<String>,
    /// Seconds before first substeps so far.
    pub startup_seconds: f64,
    /// Seconds so far.
    pub seconds: f64,
    /// Seconds by phase so far.
    pub phase_seconds: PhaseSeconds,
    /// The run's files.
    pub output: OutputState,
}
