//! `lahar list`: lists the built-in scenes, each line beginning with the name.

use std::process::ExitCode;

use lahar_scene::builtin;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::terminal;

/// Prints the scenes, the default one first.
pub(crate) fn list(as_json: bool) -> Result<ExitCode, CliError> {
    let scenes = builtin::list();
    if as_json {
        let scenes: Vec<Value> = scenes
            .iter()
            .map(|scene| {
                json!({
                    "name": scene.name,
                    "title": scene.title,
                    "summary": scene.summary,
                    "dimension": scene.dimension,
                })
            })
            .collect();
        terminal::print_json(&Value::Array(scenes));
    } else {
        let width = scenes
            .iter()
            .map(|scene| scene.name.len())
            .max()
            .unwrap_or(0);
        for scene in scenes {
            terminal::print(&format!(
                "{:width$}  {}D  {}\n",
                scene.name, scene.dimension, scene.summary
            ));
        }
    }
    Ok(ExitCode::SUCCESS)
}
