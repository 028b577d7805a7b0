//! How far a run is: counters, seconds, and the lengths of its files.

use std::fs;
use std::path::Path;

use lahar::PhaseTimes;
use serde::{Deserialize, Serialize};

use crate::files::{Length, confined};

/// How far a run was when a checkpoint was taken.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Number of the last frame that was written.
    pub frame: u64,
    /// Sum over all substeps of the particle count.
    pub particle_steps: u64,
    /// Number of particle sorts.
    pub sorts: u64,
    /// Frames that were retried, one sentence per retry.
    pub retries: Vec<String>,
    /// Seconds before the first substep, summed over all starts of the program.
    pub startup_seconds: f64,
    /// Seconds in all.
    pub seconds: f64,
    /// Seconds by phase.
    pub phase_seconds: PhaseSeconds,
    /// State of the run's files.
    pub output: OutputState,
}

/// State of a run's files after a frame. A run that is resumed cuts its growing files back to it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OutputState {
    /// Counts of the files written.
    pub written: OutputCounts,
    /// Length of `diagnostics.csv`.
    pub diagnostics: Option<Length>,
    /// Lengths of `probes/NAME.csv`, in the order of the scene.
    pub probes: Vec<Length>,
    /// Length of the file that collects the film's pictures.
    pub film: Option<Length>,
    /// Length of `particles.pvd` without its end tags.
    pub series: Option<Length>,
    /// Files that do not grow: paths relative to the run's folder, and lengths in bytes.
    pub files: Vec<(String, u64)>,
}

impl OutputState {
    /// Checks that all tables still begin with the same bytes; `run` is the run's folder. The film is not checked: a
    /// run can go on without its pictures ([`OutputState::forget_lost_film`]).
    ///
    /// # Errors
    /// A sentence about the first file that is missing or altered.
    pub fn check(&self, run: &Path) -> Result<(), String> {
        (self.diagnostics.iter())
            .chain(&self.series)
            .chain(&self.probes)
            .try_for_each(|length| length.check(run))
    }

    /// Forgets the film's pictures if their file is missing or altered, and returns the reason.
    pub fn forget_lost_film(&mut self, run: &Path) -> Option<String> {
        let reason = self.film.as_ref()?.check(run).err()?;
        self.film = None;
        Some(reason)
    }

    /// Returns the files of frames that are missing or have another length.
    pub fn missing(&self, run: &Path) -> Vec<&str> {
        let is_whole = |(file, bytes): &&(String, u64)| {
            let path = confined(run, file).ok();
            path.and_then(|path| fs::metadata(path).ok())
                .is_some_and(|info| info.len() == *bytes)
        };
        let files = self.files.iter().filter(|file| !is_whole(file));
        files.map(|(file, _)| file.as_str()).collect()
    }
}

/// Counts of what a run has written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutputCounts {
    /// Frames, with or without files.
    pub frames: u64,
    /// Frames with files of particles.
    pub particles: u64,
    /// Pictures kept as PNG.
    pub images: u64,
    /// True if there is a film.
    pub film: bool,
}

/// Seconds by phase of the substep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseSeconds {
    /// Sorting particles into blocks.
    pub sort: f64,
    /// Correcting volumes by the density on the grid.
    #[serde(default)]
    pub volume: f64,
    /// Particles to grid (P2G).
    pub scatter: f64,
    /// Grid update and boundaries.
    pub grid: f64,
    /// Grid to particles (G2P).
    pub gather: f64,
    /// All other work of a frame: time steps, sums over boundaries, probes, and the copy from which a failed frame is
    /// retried.
    #[serde(default)]
    pub other: f64,
    /// Output as the simulation sees it: copying, and waiting for the writing thread.
    pub output: f64,
}

impl PhaseSeconds {
    /// Divides `seconds` of computing among the phases, and adds the seconds of output.
    pub fn new(phases: PhaseTimes, seconds: f64, output: f64) -> Self {
        let PhaseTimes {
            sort,
            volume,
            scatter,
            grid,
            gather,
            sorts: _,
        } = phases;
        Self {
            sort,
            volume,
            scatter,
            grid,
            gather,
            other: (seconds - (sort + volume + scatter + grid + gather)).max(0.0),
            output,
        }
    }

    /// Returns the seconds of all phases but output.
    pub fn solving(&self) -> f64 {
        self.sort + self.volume + self.scatter + self.grid + self.gather + self.other
    }
}

impl core::ops::Add for PhaseSeconds {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            sort: self.sort + other.sort,
            volume: self.volume + other.volume,
            scatter: self.scatter + other.scatter,
            grid: self.grid + other.grid,
            gather: self.gather + other.gather,
            other: self.other + other.other,
            output: self.output + other.output,
        }
    }
}
