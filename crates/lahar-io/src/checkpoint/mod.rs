//! Checkpoints on disk: everything a run needs to be resumed after any end, in `DIR/checkpoints/`.
//!
//! ```text
//! checkpoints/start.json          start of the run: scene, its files, instruction set, outputs         start
//! checkpoints/files/0.csv         copies of files that the scene names
//! checkpoints/000120.checkpoint   the state after frame 120; the newest two are kept                    format, store
//! checkpoints/lock                locked by the process that writes here                               files::lock
//! checkpoints/film                pictures of the film so far                                           output
//! ```
//! A checkpoint records the length of each growing file. A resumed run cuts the files back to these lengths and writes
//! the rest again, with the same bytes.

mod format;
mod progress;
mod start;
mod store;

pub(crate) use format::{Checksums, LENGTH_AT, read_with};
pub use format::{Header, read, write};
pub use progress::{OutputCounts, OutputState, PhaseSeconds, Progress};
pub use start::{Start, StartError};
pub use store::{Newest, Store};
