//! What ends a command early, and with which exit code.

use std::path::PathBuf;
use std::process::ExitCode;

use lahar_io::output::OutputError;
use lahar_scene::error::SceneError;
use serde_json::{Value, json};

use crate::terminal;

/// The exit codes: 0 is success.
pub(crate) const FAILED: u8 = 1;
/// The command or the scene is wrong.
pub(crate) const USAGE: u8 = 2;
/// After Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;

/// What ends a command early.
#[derive(Debug)]
pub(crate) enum CliError {
    /// The scene is wrong.
    Scene(Box<SceneError>),
    /// The command is wrong.
    Usage(String),
    /// A file could not be written, or a folder is taken.
    Output(OutputError),
    /// The simulation failed; what was written before is there.
    Simulation {
        /// The full description.
        what: String,
        /// The folder of the run.
        folder: PathBuf,
        /// Whole frames in it.
        frames: u64,
        /// The newest checkpoint in it.
        checkpoint: Option<PathBuf>,
    },
    /// A run could not be written any more.
    Broken {
        /// Why.
        error: OutputError,
        /// The folder of the run.
        folder: PathBuf,
        /// The newest checkpoint in it.
        checkpoint: Option<PathBuf>,
    },
    /// Something about this machine.
    Machine(String),
}

impl CliError {
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Scene(_) | Self::Usage(_) => USAGE,
            Self::Output(error) if error.usage => USAGE,
            Self::Output(_) | Self::Simulation { .. } | Self::Broken { .. } | Self::Machine(_) => {
                FAILED
            }
        })
    }

    /// For standard error.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Scene(error) => error.render(terminal::colours()).trim_end().to_owned(),
            Self::Usage(what) | Self::Machine(what) => format!("error: {what}"),
            Self::Output(error) => format!("error: {error}"),
            Self::Simulation {
                what,
                folder,
                frames,
                checkpoint,
            } => format!(
                "error: the simulation failed: {what}\n{} holds the {frames} frame(s) before that, run.json and diagnostics.csv; {}",
                folder.display(),
                match checkpoint {
                    Some(path) => format!("the last good checkpoint is {}", path.display()),
                    None => "there is no checkpoint".to_owned(),
                }
            ),
            Self::Broken {
                error,
                folder,
                checkpoint,
            } => format!(
                "error: {error}\n{}; when there is room again, `lahar resume {}` goes on",
                match checkpoint {
                    Some(path) => format!("the last good checkpoint is {}", path.display()),
                    None => "there is no checkpoint yet".to_owned(),
                },
                folder.display()
            ),
        }
    }

    /// For standard output, with `--json`.
    pub(crate) fn json(&self) -> Value {
        let mut value = json!({ "status": "failed" });
        let extra = match self {
            Self::Scene(error) => json!({
                "error": error.message,
                "file": error.file,
                "line": error.line,
                "column": error.column,
                "help": error.hint,
            }),
            Self::Usage(what) | Self::Machine(what) => json!({ "error": what }),
            Self::Output(error) => json!({ "error": error.what, "file": error.path }),
            Self::Simulation {
                what,
                folder,
                frames,
                checkpoint,
            } => {
                json!({ "error": what, "folder": folder, "frames": frames, "checkpoint": checkpoint })
            }
            Self::Broken {
                error,
                folder,
                checkpoint,
            } => {
                json!({ "error": error.what, "file": error.path, "folder": folder, "checkpoint": checkpoint })
            }
        };
        if let (Some(value), Value::Object(extra)) = (value.as_object_mut(), extra) {
            value.extend(extra);
        }
        value
    }
}

impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<OutputError> for CliError {
    fn from(error: OutputError) -> Self {
        Self::Output(error)
    }
}
