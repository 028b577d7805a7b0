//! The errors that end a command, with their texts and exit codes.

use std::path::PathBuf;
use std::process::ExitCode;

use lahar_io::output::OutputError;
use lahar_lab::shell;
use lahar_scene::error::SceneError;
use serde_json::{Value, json};

use crate::terminal;

/// Exit code: the simulation or the machine failed, or a validation case misses its target.
pub(crate) const FAILED: u8 = 1;
/// Exit code: the command or the scene is wrong.
pub(crate) const USAGE: u8 = 2;
/// Exit code: Ctrl-C or SIGTERM stopped the command.
pub(crate) const INTERRUPTED: u8 = 130;

/// An error that ends a command.
#[derive(Debug)]
pub(crate) enum CliError {
    /// The scene is wrong.
    Scene(Box<SceneError>),
    /// The command is wrong.
    Usage(String),
    /// A file could not be written, or a folder is taken.
    Output(OutputError),
    /// The simulation failed. The frames before the failure are complete.
    Simulation {
        /// The description of the failure.
        message: String,
        /// The folder of the run.
        folder: PathBuf,
        /// The number of complete frames in it.
        frames: u64,
        /// The newest checkpoint in it.
        checkpoint: Option<PathBuf>,
    },
    /// A file of a run that was under way could not be written.
    RunOutput {
        /// The file and the reason.
        error: OutputError,
        /// The folder of the run.
        folder: PathBuf,
        /// The newest checkpoint in it.
        checkpoint: Option<PathBuf>,
    },
    /// This machine could not do something: start threads, write a file, open a window.
    Machine(String),
}

impl CliError {
    /// The exit code of the program.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Scene(_) | Self::Usage(_) => USAGE,
            Self::Output(error) if error.usage => USAGE,
            Self::Output(_)
            | Self::Simulation { .. }
            | Self::RunOutput { .. }
            | Self::Machine(_) => FAILED,
        })
    }

    /// The text for standard error.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Scene(error) => error.render(terminal::shows_colors()).trim_end().to_owned(),
            Self::Usage(message) | Self::Machine(message) => format!("error: {message}"),
            Self::Output(error) => format!("error: {error}"),
            Self::Simulation {
                message,
                folder,
                frames,
                checkpoint,
            } => format!(
                "error: the simulation failed: {message}\nthe {frames} frame(s) before that, run.json and diagnostics.csv are in {}; {}",
                folder.display(),
                match checkpoint {
                    Some(path) => format!("the last good checkpoint is {}", path.display()),
                    None => "there is no checkpoint".to_owned(),
                }
            ),
            Self::RunOutput {
                error,
                folder,
                checkpoint,
            } => format!(
                "error: {error}\n{}; once the file can be written, `lahar resume {}` continues",
                match checkpoint {
                    Some(path) => format!("the last good checkpoint is {}", path.display()),
                    None => "there is no checkpoint yet".to_owned(),
                },
                shell::quoted_path(folder)
            ),
        }
    }

    /// The document for standard output with `--json`.
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
            Self::Usage(message) | Self::Machine(message) => json!({ "error": message }),
            Self::Output(error) => json!({ "error": error.what, "file": error.path }),
            Self::Simulation {
                message,
                folder,
                frames,
                checkpoint,
            } => {
                json!({ "error": message, "folder": folder, "frames": frames, "checkpoint": checkpoint })
            }
            Self::RunOutput {
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
