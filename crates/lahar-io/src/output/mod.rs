//! The files of a run, and the thread that writes them.
//!
//! ```text
//! DIR/run.json            the scene and the outcome                  record
//! DIR/diagnostics.csv     totals, one row per frame                  diagnostics
//! DIR/probes/NAME.csv     readings of probes, one row per reading    probes
//! DIR/frames/000000.npz   particles                                  frames
//! DIR/checkpoints/        states from which a run is resumed         crate::checkpoint
//! DIR/images/000000.png   pictures, and DIR/video.gif                crate::image
//! ```
//! [`RunFolder`] is the folder, [`Writer`] writes into it, and [`Recording`] reads it back.
//!
//! Every file but the growing csv is written under a temporary name and renamed, so that a run that is killed at any
//! moment leaves whole files only. The row of a frame is written after its files, so that all files of a listed frame
//! exist.

mod diagnostics;
mod folder;
mod frames;
mod meshes;
mod probes;
mod record;
mod recording;
mod table;
mod writer;

pub use diagnostics::DiagnosticsFile;
pub use folder::{PLOTS, PROBE_PLOT, RunFolder};
pub use frames::{frame_name, write_frame};
pub use meshes::MeshFiles;
pub use record::{Record, Status};
pub use recording::{Recording, RecordingError, read_record};
pub use table::Table;
pub use writer::{FilmPace, FilmPlan, OutputPlan, PicturePlan, Writer, film_pace};

pub use crate::checkpoint::{OutputCounts, OutputState, PhaseSeconds};
pub use crate::files::OutputError;
