//! `run.json`: what was run, and how it went.

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::checkpoint::PhaseSeconds;
use crate::files::{Durability, OutputError, write_whole};

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
        write_whole(path, Durability::Immediate, |mut writer| {
            serde_json::to_writer_pretty(&mut writer, self)?;
            writer.write_all(b"\n")?;
            Ok(writer)
        })
    }
}
