//! `lahar schema`: prints the JSON schema of scene files.

use std::process::ExitCode;

use crate::error::CliError;
use crate::terminal;

/// Prints the schema.
pub(crate) fn schema() -> Result<ExitCode, CliError> {
    terminal::print_json(&lahar_scene::scene::schema());
    Ok(ExitCode::SUCCESS)
}
