//! `lahar view`, and `lahar` without a command: opens the window. `lahar` runs the default scene where none can open.

use std::path::Path;
use std::process::ExitCode;

use lahar_io::output::Recording;
use lahar_scene::builtin;
use lahar_scene::scene::{Comparison, Scene};

use crate::args::View;
use crate::error::CliError;
use crate::run_plan::RunPlan;
use crate::{run, terminal};

/// The scene that opens first.
const DEFAULT_SCENE: &str = "dam-break";

/// Without a display, the default scene stops after this time \[s\], so that it ends within a minute, film included.
const DEADLINE: f64 = 45.0;

/// `lahar` without a command: opens the window on the default scene, or runs that scene without one.
pub(crate) fn open_or_run() -> Result<ExitCode, CliError> {
    match open_window(None) {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(why) => {
            terminal::note(&format!(
                "no window ({why}): running the scene \"{DEFAULT_SCENE}\" without one, in under a minute, into out/"
            ));
            run::run(RunPlan::demonstration(DEFAULT_SCENE, DEADLINE)?, false)
        }
    }
}

/// `lahar view`: opens the window on a scene or a finished run.
pub(crate) fn open(view: View) -> Result<ExitCode, CliError> {
    check(&view)?;
    match open_window(Some(view)) {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(why) => Err(CliError::Machine(format!(
            "no window: {why}; `lahar run` needs none"
        ))),
    }
}

/// Checks the scene or the run before anything opens.
fn check(view: &View) -> Result<(), CliError> {
    let path = Path::new(&view.scene_or_run);
    if builtin::find(&view.scene_or_run).is_none() && (path.is_dir() || path.ends_with("run.json"))
    {
        if view.compare.is_some() || !view.set.is_empty() {
            return Err(CliError::Usage(format!(
                "{} is a finished run, which --set and --compare cannot change; give its scene instead",
                path.display()
            )));
        }
        let recording =
            Recording::open(path).map_err(|error| CliError::Usage(error.to_string()))?;
        return (recording.frame(0).map(drop)).map_err(|error| CliError::Usage(error.to_string()));
    }
    let Some(comparison) = &view.compare else {
        return Ok(Scene::load(&view.scene_or_run, &view.set).map(drop)?);
    };
    if comparison.values.len() > Comparison::MOST {
        return Err(CliError::Usage(format!(
            "--compare {comparison}: at most {} fit side by side",
            Comparison::MOST
        )));
    }
    for overrides in comparison.overrides(&view.set) {
        Scene::load(&view.scene_or_run, &overrides)?;
    }
    Ok(())
}

/// Opens the window, and returns when it is closed.
///
/// # Errors
/// The reason why there is no window.
#[cfg(feature = "window")]
fn open_window(view: Option<View>) -> Result<(), String> {
    let mut options = lahar_app::Options::default();
    if let Some(view) = view {
        options.scene = Some(view.scene_or_run);
        options.overrides = view.set;
        options.comparison = view.compare;
        options.isa = view.isa.unwrap_or(options.isa);
        options.threads = view.threads.map_or(options.threads, usize::from);
        options.trace = view.trace.then_some(terminal::note);
    }
    if lahar_app::check_display().is_ok() {
        terminal::note(&lahar_app::key_help());
    }
    lahar_app::run(options).map_err(|error| error.to_string())
}

/// Returns the reason why there is no window.
#[cfg(not(feature = "window"))]
fn open_window(_view: Option<View>) -> Result<(), String> {
    Err("lahar was built without the feature `window`".to_owned())
}
