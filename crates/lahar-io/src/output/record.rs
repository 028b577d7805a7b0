//! `run.json`: what was run, and how it went.

use std::io::Write;
use std::path::Path;

use lahar::PhaseTimes;
use serde::{Deserialize, Serialize};

use super::{OutputError, write_whole};

/// How a run stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Going on, or killed without a word.
    Running,
    /// All frames are there.
    Done,
    /// Stopped by Ctrl-C.
    Interrupted,
    /// Stopped by an error, told in `failure`.
    Failed,
}

/// Seconds by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseSeconds {
    /// Moving particles to their blocks.
    pub sort: f64,
    /// Setting volumes right by how full the grid is.
    #[serde(default)]
    pub volume: f64,
    /// Particles to grid.
    pub scatter: f64,
    /// Grid update.
    pub grid: f64,
    /// Grid to particles.
    pub gather: f64,
    /// What else a frame takes: time steps, boundaries' accounts, probes, the copy that a frame that fails
    /// begins again from.
    #[serde(default)]
    pub other: f64,
    /// What the solver spent on output: copying, and waiting for the writing thread.
    pub output: f64,
}

impl PhaseSeconds {
    /// `seconds` of solving, divided by the solver's phases, and the seconds of output.
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

    /// Seconds of everything but output.
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

/// The contents of `run.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the program.
    pub version: String,
    /// How the run stands.
    pub status: Status,
    /// What went wrong, if it failed.
    pub failure: Option<String>,
    /// Name of the scene: a built-in's, or its file's.
    pub scene_name: String,
    /// The scene with every default and override in it.
    pub scene: serde_json::Value,
    /// Seed of everything random in it.
    pub seed: u64,
    /// 2 or 3.
    pub dimension: usize,
    /// "f32" or "f64".
    pub precision: String,
    /// The instruction set in use.
    pub isa: String,
    /// Threads that computed.
    pub threads: usize,
    /// Frames written, the one at the start included.
    pub frames: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// Substeps taken.
    pub substeps: u64,
    /// Particles at the end.
    pub particles: u64,
    /// Σ over substeps of particles.
    pub particle_steps: u64,
    /// `particle_steps` over the seconds from the first substep to the end, of everything but output.
    pub particle_steps_per_second: f64,
    /// Seconds from the program's start to its first substep, the output of frame 0 not counted.
    #[serde(default)]
    pub startup_seconds: f64,
    /// Seconds from the program's start to the end: start-up and all phases.
    pub seconds: f64,
    /// Seconds by phase.
    pub phase_seconds: PhaseSeconds,
    /// How often particles were sorted.
    pub sorts: u64,
    /// What looked suspicious about the scene.
    pub warnings: Vec<String>,
    /// Frames that were tried again with a shorter time step.
    pub retries: Vec<String>,
}

impl Record {
    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// If it cannot be written; a record that was there before stays.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_whole(path, true, |mut writer| {
            serde_json::to_writer_pretty(&mut writer, self)?;
            writer.write_all(b"\n")?;
            Ok(writer)
        })
    }
}
