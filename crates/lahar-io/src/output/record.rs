//! `run.json`: the scene of a run and its outcome.

use std::io::Write;
use std::path::Path;

use lahar_scene::scene::SceneView;
use serde::{Deserialize, Serialize};

use crate::checkpoint::PhaseSeconds;
use crate::files::{Durability, OutputError, write_whole};

/// State of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Running, or killed.
    Running,
    /// All frames are written.
    Done,
    /// Stopped by Ctrl-C.
    Interrupted,
    /// Stopped by an error, which `failure` describes.
    Failed,
}

/// The contents of `run.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the program.
    pub version: String,
    /// State of the run.
    pub status: Status,
    /// Description of the error, if the run failed.
    pub failure: Option<String>,
    /// Name of the scene: of a built-in scene, or of its file.
    pub scene_name: String,
    /// The scene with all defaults and overrides.
    pub scene: serde_json::Value,
    /// Seed of the scene's random numbers.
    pub seed: u64,
    /// Dimension: 2 or 3.
    pub dimension: usize,
    /// Precision: "f32" or "f64".
    pub precision: String,
    /// Instruction set that computed.
    pub isa: String,
    /// Number of threads that computed.
    pub threads: usize,
    /// Number of frames written, with the one at the start.
    pub frames: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// Number of substeps taken.
    pub substeps: u64,
    /// Number of particles at the end.
    pub particles: u64,
    /// Sum over all substeps of the particle count.
    pub particle_steps: u64,
    /// `particle_steps` per second from the first substep to the end, without output.
    pub particle_steps_per_second: f64,
    /// Seconds from the program's start to its first substep, without the output of frame 0.
    #[serde(default)]
    pub startup_seconds: f64,
    /// Seconds from the program's start to the end.
    pub seconds: f64,
    /// Seconds by phase.
    pub phase_seconds: PhaseSeconds,
    /// Number of particle sorts.
    pub sorts: u64,
    /// Warnings about the scene.
    pub warnings: Vec<String>,
    /// Frames that were retried with a shorter time step, one sentence per retry.
    pub retries: Vec<String>,
}

impl Record {
    /// Returns the view of the scene that was run.
    pub fn view(&self) -> SceneView {
        SceneView::recorded(&self.scene)
    }

    /// Writes the file, whole or not at all.
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
