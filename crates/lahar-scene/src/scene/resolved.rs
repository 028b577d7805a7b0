//! The scene with every default filled in, as run.json keeps it, and back.

use super::checked::{Scene, read_scene};
use super::document::json_table;
use super::files::EmbeddedFiles;
use super::limits::Limits;
use crate::builtin;
use crate::error::SceneError;
use std::fmt;

impl Scene {
    /// Returns the scene with every default filled in, and values computed from it under "computed".
    pub fn resolved(&self) -> serde_json::Value {
        let mut value = json_table(&self.document.root);
        let materials: serde_json::Map<String, serde_json::Value> = self
            .materials
            .iter()
            .map(|material| {
                let computed = serde_json::json!({
                    "wave_speed": material.wave_speed,
                    "modulus": material.density * material.wave_speed * material.wave_speed,
                });
                (material.name.clone(), computed)
            })
            .collect();
        let bodies: serde_json::Map<String, serde_json::Value> = self
            .bodies
            .iter()
            .map(|body| {
                (
                    body.name.clone(),
                    serde_json::json!({ "expected_particles": body.expected_particles.round() }),
                )
            })
            .collect();
        if let Some(root) = value.as_object_mut() {
            let computed = serde_json::json!({
                "name": self.name,
                "frame_rate": self.frame_rate,
                "frames": self.frames(),
                "materials": materials,
                "bodies": bodies,
            });
            root.insert("computed".to_owned(), computed);
        }
        value
    }

    /// Reads the scene of a run back from its record, which [`Scene::resolved`] has made. `name` is the scene's.
    ///
    /// # Errors
    /// The fault of the scene, as in [`Scene::parse`]: a file that it names may be gone.
    pub fn recorded(
        resolved: &serde_json::Value,
        name: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, SceneError> {
        let wrong = |error: &dyn fmt::Display| {
            SceneError::of_file(name, format!("the scene in run.json: {error}"))
        };
        let mut scene = toml::Value::try_from(resolved).map_err(|error| wrong(&error))?;
        if let Some(root) = scene.as_table_mut() {
            root.remove("computed");
        }
        restore_infinities(&mut scene);
        let text = toml::to_string(&scene).map_err(|error| wrong(&error))?;
        let limits = Limits::default();
        match builtin::find(name) {
            Some(scene) => {
                let files = EmbeddedFiles(scene.files);
                read_scene(&text, name, overrides, &limits, &files)
            }
            None => Self::parse_within(&text, name, overrides, &limits),
        }
    }
}

/// Turns the words that stand for infinite numbers in JSON back into numbers.
fn restore_infinities(value: &mut toml::Value) {
    match value {
        toml::Value::String(word) if word == "inf" => *value = toml::Value::Float(f64::INFINITY),
        toml::Value::String(word) if word == "-inf" => {
            *value = toml::Value::Float(f64::NEG_INFINITY);
        }
        toml::Value::Array(values) => values.iter_mut().for_each(restore_infinities),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, v)| restore_infinities(v)),
        _ => {}
    }
}
