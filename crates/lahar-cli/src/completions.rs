//! `lahar completions SHELL`: prints a script that completes commands in a shell.

use std::process::ExitCode;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::args::Args;
use crate::error::CliError;
use crate::terminal;

/// Prints the script for `shell`.
pub(crate) fn completions(shell: Shell) -> Result<ExitCode, CliError> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Args::command(), "lahar", &mut text);
    terminal::print(&String::from_utf8_lossy(&text));
    Ok(ExitCode::SUCCESS)
}
