//! The program `lahar`: its command line, and the window's start.
//!
//! ```text
//! arguments ─▶ args.rs ─▶ run_plan.rs ─▶ run.rs ─▶ frame_loop.rs ─▶ DIR/
//!              parsed     checked        folder,    driver and
//!                                        record     writing thread
//! ```
//! Each command has a file of its name. Only this crate prints: results on standard output, everything else on
//! standard error (terminal.rs). Exit codes are in error.rs.

mod appearance;
mod args;
mod bench;
mod clock;
mod compare;
mod completions;
mod error;
mod frame_loop;
mod interrupt;
mod list;
#[cfg(feature = "mesh")]
mod mesh;
mod new;
mod painter;
mod plot;
mod progress;
mod recorded_frames;
mod render;
mod report;
mod resume;
mod run;
mod run_plan;
mod schema;
mod show;
mod summary;
mod terminal;
mod threads;
mod validate;
mod window;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};
use error::CliError;

fn main() -> ExitCode {
    clock::start();
    let args = match Args::try_parse() {
        Ok(args) => args,
        // Help and version are such errors, too, with exit code 0.
        Err(error) => {
            drop(error.print());
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let json = args.wants_json();
    match execute(args) {
        Ok(code) => code,
        Err(error) => {
            terminal::note(&error.text());
            if json {
                terminal::print_json(&error.json());
            }
            error.exit_code()
        }
    }
}

fn execute(args: Args) -> Result<ExitCode, CliError> {
    match args.command {
        None => window::open_or_run(),
        Some(Command::View(view)) => window::open(view),
        Some(Command::Run(run)) => match &run.compare {
            Some(comparison) => compare::compare(&run, comparison),
            None => run::run(run_plan::RunPlan::from_args(&run)?, run.json),
        },
        Some(Command::Resume(args)) => resume::resume(&args),
        Some(Command::List(list)) => list::list(list.json),
        Some(Command::Show(show)) => show::show(&show),
        Some(Command::New(args)) => new::new(&args),
        #[cfg(feature = "mesh")]
        Some(Command::Mesh(args)) => mesh::mesh(&args),
        Some(Command::Render(args)) => render::render(&args),
        Some(Command::Report(args)) => report::report(&args),
        Some(Command::Plot(plot)) => plot::plot(&plot),
        Some(Command::Bench(args)) => bench::bench(&args),
        Some(Command::Validate(args)) => validate::validate(&args),
        Some(Command::Schema) => schema::schema(),
        Some(Command::Completions(completions)) => completions::completions(completions.shell),
    }
}
