//! The window where there is one, and what happens where there is none.

use std::process::ExitCode;

use crate::error::CliError;
use crate::plan::Plan;
use crate::{run, terminal};

/// The scene that opens first.
const DEFAULT_SCENE: &str = "dam-break";

/// Without a display the default scene stops after so many seconds: it is to end within a minute, film included.
const DEADLINE: f64 = 45.0;

/// `lahar`: the window, or the same scene without.
pub(crate) fn open_or_run(scene: Option<&str>) -> Result<ExitCode, CliError> {
    match open_window(scene) {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(why) => {
            let scene = scene.unwrap_or(DEFAULT_SCENE);
            terminal::note(&format!(
                "no window ({why}): running the scene \"{scene}\" without one, in under a minute, into out/"
            ));
            run::run(Plan::demonstration(scene, DEADLINE)?, false)
        }
    }
}

/// `lahar view`.
pub(crate) fn open(what: Option<&str>) -> Result<ExitCode, CliError> {
    match open_window(what) {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(why) => Err(CliError::Machine(format!(
            "no window: {why}; `lahar run` needs none"
        ))),
    }
}

/// Opens the window and returns when it is closed, or says why there is none.
#[cfg(feature = "window")]
fn open_window(scene: Option<&str>) -> Result<(), String> {
    let options = lahar_app::Options {
        scene: scene.map(str::to_owned),
        ..lahar_app::Options::default()
    };
    if lahar_app::check_display().is_ok() {
        terminal::note(&lahar_app::key_help());
    }
    lahar_app::run(options).map_err(|error| error.to_string())
}

/// Says why there is no window.
#[cfg(not(feature = "window"))]
fn open_window(_scene: Option<&str>) -> Result<(), String> {
    Err("this program was built without".to_owned())
}
