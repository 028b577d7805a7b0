//! `lahar new`.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

use lahar_io::builtin;

use crate::error::CliError;
use crate::terminal;

/// Writes the starter scene to a file that is not there yet.
pub(crate) fn new(path: &Path) -> Result<ExitCode, CliError> {
    let shown = path.display();
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .and_then(|mut file| file.write_all(builtin::starter().as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            CliError::Usage(format!("{shown} is there already; it was left as it is"))
        }
        ErrorKind::NotFound => CliError::Usage(format!("there is no folder for {shown}")),
        _ => CliError::Usage(format!("{shown} cannot be written: {error}")),
    })?;
    terminal::note(&format!(
        "wrote {shown}: a scene to start from\nlook at it with: lahar view {shown}\nrun it with:     lahar run {shown}"
    ));
    Ok(ExitCode::SUCCESS)
}
