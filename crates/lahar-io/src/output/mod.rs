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
mod growing;
mod meshes;
mod probes;
mod record;
mod recording;
mod table;
mod writer;

use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use diagnostics::DiagnosticsFile;
pub use folder::RunFolder;
pub use frames::{frame_name, write_frame};
pub use growing::Length;
pub use meshes::MeshFiles;
pub use record::{PhaseSeconds, Record, Status};
pub use recording::{Recording, RecordingError, read_record};
pub use table::Table;
pub use writer::{Film, Pace, Pictures, Plan, Writer, Written, film_pace};

/// A run's files after a frame, for whoever goes on from there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OutputState {
    /// What was written.
    pub written: Written,
    /// `diagnostics.csv`.
    pub diagnostics: Option<Length>,
    /// `probes/NAME.csv`, in the order of the scene.
    pub probes: Vec<Length>,
    /// The film's pictures so far.
    pub film: Option<Length>,
    /// `particles.pvd`, without its end tags.
    pub series: Option<Length>,
    /// Files that do not grow, from the run's folder, and their lengths.
    pub files: Vec<(String, u64)>,
}

impl OutputState {
    /// Whether what grew is there as it was; `run` is the run's folder.
    ///
    /// # Errors
    /// What is missing or altered.
    pub fn check(&self, run: &Path) -> Result<(), String> {
        let single = self
            .diagnostics
            .iter()
            .chain(&self.film)
            .chain(&self.series);
        single
            .chain(&self.probes)
            .try_for_each(|was| was.check(run))
    }

    /// The files of frames that are no longer there as they were.
    pub fn missing(&self, run: &Path) -> Vec<&str> {
        let is_whole = |(file, bytes): &&(String, u64)| {
            fs::metadata(run.join(file)).is_ok_and(|info| info.len() == *bytes)
        };
        let files = self.files.iter().filter(|file| !is_whole(file));
        files.map(|(file, _)| file.as_str()).collect()
    }
}

/// A file or folder that could not be made or written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputError {
    /// Which.
    pub path: PathBuf,
    /// What is wrong and, where there is something to do, what.
    pub what: String,
    /// Whether it is the command that is wrong (a folder that is taken), not the disk.
    pub usage: bool,
}

impl OutputError {
    pub(crate) fn at(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        move |error| Self {
            path: path.to_owned(),
            what: format!("cannot write: {error}"),
            usage: false,
        }
    }

    pub(crate) fn usage(path: &Path, what: impl Into<String>) -> Self {
        Self {
            path: path.to_owned(),
            what: what.into(),
            usage: true,
        }
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.what)
    }
}

impl std::error::Error for OutputError {}

/// Ending of the temporary name of a file that is being written.
pub(crate) const PARTIAL: &str = "partial";

/// Writes `path` whole or not at all: into a temporary file beside it, which then takes its name.
pub(crate) fn write_whole(
    path: &Path,
    sync: bool,
    write: impl FnOnce(BufWriter<File>) -> io::Result<BufWriter<File>>,
) -> Result<(), OutputError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(PARTIAL);
    let partial = path.with_file_name(name);
    let result = File::create(&partial)
        .and_then(|file| write(BufWriter::with_capacity(1 << 18, file)))
        .and_then(|writer| writer.into_inner().map_err(io::IntoInnerError::into_error))
        .and_then(|file| if sync { file.sync_all() } else { Ok(()) })
        .and_then(|()| fs::rename(&partial, path));
    result.map_err(|error| {
        // What could not be finished (a full disk) is not left lying about.
        drop(fs::remove_file(&partial));
        OutputError::at(path)(error)
    })
}

/// What was renamed in `folder` is on the disk when this returns. Windows has no way to ask for that.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), OutputError> {
    if cfg!(unix) {
        File::open(folder)
            .and_then(|folder| folder.sync_all())
            .map_err(OutputError::at(folder))?;
    }
    Ok(())
}
