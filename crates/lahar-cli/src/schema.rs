//! `lahar schema`.

use std::process::ExitCode;

use crate::error::CliError;
use crate::terminal;
pub(crate) fn schema() -> Result<ExitCode, CliError> {
    Err(CliError::Machine(
        "this version has no schema yet".to_owned(),
    ))
}
