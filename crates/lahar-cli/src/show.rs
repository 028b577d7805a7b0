//! `lahar show`: the size and cost of a scene, found by building its simulation; or the scene's text.

use std::process::ExitCode;

use lahar::Isa;
use lahar_scene::builtin;
use lahar_scene::scene::Scene;
use serde_json::{Value, json};

use crate::args;
use crate::error::CliError;
use crate::terminal;
use lahar_lab::numbers::with_prefix;

/// Prints the description of a scene, or its text.
pub(crate) fn show(args: &args::Show) -> Result<ExitCode, CliError> {
    if args.toml {
        return print_toml(&args.scene.scene);
    }
    let scene = Scene::load(&args.scene.scene, &args.scene.set)?;
    let value = describe(&scene, args.scene.isa.unwrap_or_else(Isa::detect))?;
    if args.json {
        terminal::print_json(&value);
    } else {
        terminal::print(&text(&value));
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints the text of a built-in scene or of a scene file.
fn print_toml(scene: &str) -> Result<ExitCode, CliError> {
    match builtin::find(scene) {
        Some(scene) => terminal::print(scene.text),
        None => terminal::print(&Scene::load(scene, &[])?.text),
    }
    Ok(ExitCode::SUCCESS)
}

/// Describes the scene and the simulation that it makes, as the JSON document of `lahar show --json`.
pub(crate) fn describe(scene: &Scene, isa: Isa) -> Result<Value, CliError> {
    let built = scene.build(isa)?;
    let mut simulation = built.simulation;
    simulation.begin_frame(); // a run also needs the copy that a failed frame begins again from
    let (dt, limit) = simulation.next_dt();
    let memory = simulation.memory();
    let bodies: Vec<Value> = scene
        .bodies
        .iter()
        .zip(&built.body_particles)
        .zip(&built.left_out)
        .map(|((body, particles), left_out)| {
            json!({
                "name": body.name,
                "material": scene.materials.get(body.material).map(|material| &material.name),
                "particles": particles,
                "left_out": left_out,
            })
        })
        .collect();
    let colliders: Vec<Value> = scene
        .colliders
        .iter()
        .map(|info| json!({ "name": info.name, "what": info.words() }))
        .collect();
    let materials: Vec<Value> = scene
        .materials
        .iter()
        .map(|material| {
            json!({
                "name": material.name,
                "model": material.model,
                "density": material.density,
                "sound_speed": material.wave_speed,
            })
        })
        .collect();
    let fastest = scene
        .materials
        .iter()
        .map(|material| material.wave_speed)
        .fold(0.0, f64::max);
    Ok(json!({
        "name": scene.name,
        "title": scene.title,
        "dimension": scene.dimension,
        "precision": simulation.precision(),
        "isa": simulation.backend().instruction_set,
        "domain": simulation.domain().map(|(min, max)| json!({
            "min": &min[..scene.dimension],
            "max": &max[..scene.dimension],
        })),
        "dx": simulation.dx(),
        "particles": simulation.particle_count(),
        "bodies": bodies,
        "colliders": colliders,
        "materials": materials,
        "blocks": memory.blocks,
        "nodes": memory.nodes,
        "memory_bytes": memory.grid_bytes + memory.particle_bytes + memory.retry_bytes,
        "grid_bytes": memory.grid_bytes,
        "particle_bytes": memory.particle_bytes,
        "retry_bytes": memory.retry_bytes,
        "sound_speed": fastest,
        "dt": dt,
        "dt_limit": limit.name(),
        "duration": scene.duration,
        "frame_rate": scene.frame_rate,
        "frames": scene.frames(),
        "substeps_estimate": (scene.duration / dt.min(1.0 / scene.frame_rate)).ceil() as u64,
        "warnings": built.warnings,
    }))
}

/// Formats the description for people.
pub(crate) fn text(value: &Value) -> String {
    let number = |key: &str| value[key].as_f64().unwrap_or(f64::NAN);
    let word = |key: &str| value[key].as_str().unwrap_or_default().to_owned();
    let mut lines = vec![format!(
        "{}: {} ({}D, {})",
        word("name"),
        word("title"),
        value["dimension"],
        word("precision")
    )];
    let mut line = |name: &str, text: String| lines.push(format!("  {name:<12}{text}"));
    let list = |value: &Value| {
        let parts: Vec<String> = value
            .as_array()
            .into_iter()
            .flatten()
            .map(ToString::to_string)
            .collect();
        format!("({})", parts.join(", "))
    };
    line(
        "domain",
        match &value["domain"] {
            Value::Null => "unbounded".to_owned(),
            domain => format!("{} to {} m", list(&domain["min"]), list(&domain["max"])),
        },
    );
    line("dx", format!("{} m", value["dx"]));
    line("particles", value["particles"].to_string());
    for body in value["bodies"].as_array().into_iter().flatten() {
        line(
            "",
            format!(
                "{}: {} of {}{}",
                plain(&body["name"]),
                body["particles"],
                plain(&body["material"]),
                match body["left_out"].as_u64() {
                    None | Some(0) => String::new(),
                    Some(count) => format!(", {count} left out inside colliders"),
                }
            ),
        );
    }
    for collider in value["colliders"].as_array().into_iter().flatten() {
        let (name, what) = (plain(&collider["name"]), plain(&collider["what"]));
        line("collider", format!("{name}: {what}"));
    }
    for material in value["materials"].as_array().into_iter().flatten() {
        line(
            "material",
            format!(
                "{}: {}, {} kg/m³, sound at {:.4} m/s",
                plain(&material["name"]),
                plain(&material["model"]),
                material["density"],
                material["sound_speed"].as_f64().unwrap_or(f64::NAN),
            ),
        );
    }
    line(
        "nodes",
        format!("{} in {} blocks", value["nodes"], value["blocks"]),
    );
    line(
        "memory",
        format!(
            "{}B ({}B particles, {}B grid, {}B copy for retries)",
            with_prefix(number("memory_bytes")),
            with_prefix(number("particle_bytes")),
            with_prefix(number("grid_bytes")),
            with_prefix(number("retry_bytes")),
        ),
    );
    line(
        "dt",
        format!("{:.4e} s, limited by {}", number("dt"), word("dt_limit")),
    );
    line(
        "run",
        format!(
            "{} s in {} frames, about {} substeps, {} particle-steps",
            value["duration"],
            value["frames"],
            value["substeps_estimate"],
            with_prefix(number("substeps_estimate") * number("particles")),
        ),
    );
    line("computed by", word("isa"));
    for warning in value["warnings"].as_array().into_iter().flatten() {
        lines.push(format!("warning: {}", plain(warning)));
    }
    lines.join("\n") + "\n"
}

/// The text of a JSON string.
fn plain(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}
