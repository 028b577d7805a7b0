//! What a run leaves behind, and the thread that writes it.
//!
//! ```text
//! DIR/run.json          what was run, and how it went            record
//! DIR/diagnostics.csv   totals, a row a frame                     diagnostics
//! DIR/probes/NAME.csv   what probes have read, a row a reading  probes
//! DIR/frames/000000.npz particles                                 frames
//! DIR/checkpoints/      what a run goes on from                  crate::checkpoint
//! DIR/images/000000.png pictures, and DIR/video.gif               crate::image
//! ```
//! Every file but the growing csv is written under a temporary name and renamed, so that a run killed at any moment
//! leaves whole files only. A frame's row is written after its files: what the csv lists is there.

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
