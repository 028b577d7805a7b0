//! What a run keeps so that it can go on after anything: `DIR/checkpoints/`.
//!
//! ```text
//! checkpoints/start.json          what the run began with: scene, its files, instruction set, outputs   start
//! checkpoints/files/0.csv         copies of files that the scene names
//! checkpoints/000120.checkpoint   the state after frame 120; the newest two are kept                    format, store
//! checkpoints/lock                held by the run that writes here                                      files::lock
//! ```
//! A checkpoint says how long each growing file was when it was written, so that whoever goes on from it cuts
//! them back and writes what follows again: the same bytes.

mod format;
mod progress;
mod start;
mod store;

pub(crate) use format::{Checksums, LENGTH_AT, read_with};
pub use format::{Header, read, write};
pub use progress::{OutputCounts, OutputState, PhaseSeconds, Progress};
pub use start::{Start, StartError};
pub use store::{Newest, Store};
