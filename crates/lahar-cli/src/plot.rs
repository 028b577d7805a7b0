//! `lahar plot`: draws the measurements of runs over time, as SVG.

use std::path::PathBuf;
use std::process::ExitCode;

use lahar_io::files::output_folder;
use lahar_lab::run_plots::save_plots;

use crate::error::CliError;
use crate::{args, terminal};

/// Draws the plots of `args.runs`.
pub(crate) fn plot(args: &args::Plot) -> Result<ExitCode, CliError> {
    let folder = match (&args.output, args.runs.as_slice()) {
        (Some(folder), _) => output_folder(Some(folder), PathBuf::new())?,
        (None, [run]) => output_folder(None, run.join("plots"))?,
        (None, _) => {
            return Err(CliError::Usage(
                "plots of several runs need a folder of their own: name it with -o DIR".into(),
            ));
        }
    };
    let named = |run: &PathBuf| {
        let name = run.file_name().unwrap_or(run.as_os_str());
        (name.to_string_lossy().into_owned(), run.clone())
    };
    let runs: Vec<_> = args.runs.iter().map(named).collect();
    for path in save_plots(&runs, &folder)? {
        terminal::print(&format!("  {}\n", path.display()));
    }
    Ok(ExitCode::SUCCESS)
}
