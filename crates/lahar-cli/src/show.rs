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
    let mut text = format!(
        "{}: {} ({}D, {})\n",
        plain(&value["name"]),
        plain(&value["title"]),
        value["dimension"],
        plain(&value["precision"])
    );
    for (name, line) in parts(value).into_iter().chain(costs(value)) {
        text += &format!("  {name:<12}{line}\n");
    }
    for warning in list(&value["warnings"]) {
        text += &format!("warning: {}\n", plain(warning));
    }
    text
}

/// The lines about domain, bodies, colliders and materials, each with its name.
fn parts(value: &Value) -> Vec<(&'static str, String)> {
    let domain = match &value["domain"] {
        Value::Null => "unbounded".to_owned(),
        domain => format!("{} to {} m", vector(&domain["min"]), vector(&domain["max"])),
    };
    let mut lines = vec![
        ("domain", domain),
        ("dx", format!("{} m", value["dx"])),
        ("particles", value["particles"].to_string()),
    ];
    for body in list(&value["bodies"]) {
        let left_out = match body["left_out"].as_u64() {
            None | Some(0) => String::new(),
            Some(count) => format!(", {count} left out inside colliders"),
        };
        let (name, material) = (plain(&body["name"]), plain(&body["material"]));
        let particles = &body["particles"];
        lines.push(("", format!("{name}: {particles} of {material}{left_out}")));
    }
    for collider in list(&value["colliders"]) {
        let (name, what) = (plain(&collider["name"]), plain(&collider["what"]));
        lines.push(("collider", format!("{name}: {what}")));
    }
    for material in list(&value["materials"]) {
        let line = format!(
            "{}: {}, {} kg/m³, sound at {:.4} m/s",
            plain(&material["name"]),
            plain(&material["model"]),
            material["density"],
            number(&material["sound_speed"]),
        );
        lines.push(("material", line));
    }
    lines
}

/// The lines about nodes, memory and time, each with its name.
fn costs(value: &Value) -> Vec<(&'static str, String)> {
    let bytes = |key: &str| with_prefix(number(&value[key]));
    let particle_steps = number(&value["substeps_estimate"]) * number(&value["particles"]);
    let memory = format!(
        "{}B ({}B particles, {}B grid, {}B copy for retries)",
        bytes("memory_bytes"),
        bytes("particle_bytes"),
        bytes("grid_bytes"),
        bytes("retry_bytes"),
    );
    let run = format!(
        "{} s in {} frames, about {} substeps, {} particle-steps",
        value["duration"],
        value["frames"],
        value["substeps_estimate"],
        with_prefix(particle_steps),
    );
    let limit = plain(&value["dt_limit"]);
    let nodes = format!("{} in {} blocks", value["nodes"], value["blocks"]);
    let dt = format!("{:.4e} s, limited by {limit}", number(&value["dt"]));
    vec![
        ("nodes", nodes),
        ("memory", memory),
        ("dt", dt),
        ("run", run),
        ("computed by", plain(&value["isa"])),
    ]
}

/// The entries of a JSON list.
fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

/// A JSON list of numbers as a vector.
fn vector(value: &Value) -> String {
    let numbers: Vec<String> = list(value).map(ToString::to_string).collect();
    format!("({})", numbers.join(", "))
}

/// A JSON number.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// The text of a JSON string.
fn plain(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}
