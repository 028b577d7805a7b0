//! `lahar schema`.

use std::process::ExitCode;

use crate::error::CliError;
use crate::terminal;

pub(crate) fn schema() -> Result<ExitCode, CliError> {
    terminal::print_json(&lahar_scene::scene::schema());
    Ok(ExitCode::SUCCESS)
}
