//! The scenes that ship with lahar, scene files, and finished runs.
//!
//! What the window shows of a scene comes from the scene with its defaults filled in, as JSON: a run
//! leaves the same in its run.json.

use std::path::Path;

use lahar::{Field, Isa};
use lahar_io::image::{Picture, Renderer, Scenery, Style, body_color};
use lahar_io::output::Recording;
use lahar_scene::builtin;
use lahar_scene::driver::Driver;
use lahar_scene::scene::{Controls, Scene, colliders_of};
use serde_json::Value;

use crate::color::{ColorBy, palette};
use crate::scenes::{
    Angle, Changes, MaterialKind, OpenedScene, SceneCard, SceneContent, SceneInfo, SceneSource,
    Setting, SettingValue, Swatch,
};

/// The scenes that ship with lahar, and scene files.
#[derive(Clone, Debug)]
pub struct SceneLibrary {
    /// The instruction set to run on.
    pub isa: Isa,
    /// Laid over every scene.
    pub overrides: Changes,
}

impl Default for SceneLibrary {
    /// The widest instruction set of this machine, scenes as they are.
    fn default() -> Self {
        Self {
            isa: Isa::detect(),
            overrides: vec![],
        }
    }
}

impl SceneSource for SceneLibrary {
    fn list(&self) -> Vec<SceneCard> {
        builtin::list()
            .iter()
            .map(|scene| SceneCard {
                name: scene.name.to_owned(),
                title: scene.title.to_owned(),
                sentence: scene.summary.to_owned(),
                dimension: scene.dimension,
            })
            .collect()
    }

    fn open(&self, name_or_path: &str, changes: &Changes) -> Result<OpenedScene, String> {
        let path = Path::new(name_or_path);
        if builtin::find(name_or_path).is_none() && (path.is_dir() || path.ends_with("run.json")) {
            return replay(path);
        }
        let changes = [self.overrides.as_slice(), changes].concat();
        let scene = Scene::load(name_or_path, &changes).map_err(|e| e.render(false))?;
        let built = scene.build(self.isa).map_err(|e| e.render(false))?;
        let simulation = built.simulation;
        let resolved = scene.resolved();
        let (swatches, body_swatches) = swatches(&resolved);
        let info = SceneInfo {
            card: SceneCard {
                name: name_or_path.to_owned(),
                title: title(&resolved, &scene.name),
                sentence: builtin::find(name_or_path)
                    .map(|scene| scene.summary.to_owned())
                    .unwrap_or_default(),
                dimension: scene.dimension,
            },
            dimension: scene.dimension,
            dx: simulation.dx(),
            domain: simulation.domain(),
            colliders: scene.colliders.clone(),
            gravity: simulation.gravity(),
            frame_rate: scene.frame_rate,
            frames: None,
            swatches,
            body_swatches,
            bodies: bodies(&resolved),
            angle: angle(&resolved),
            controls: scene.controls,
            settings: settings(&resolved),
            numbers: format!("{}, {}", simulation.precision(), simulation.isa().name()),
            warnings: built.warnings,
        };
        Ok(OpenedScene {
            info,
            content: SceneContent::Simulation(Box::new(Driver::of_scene(&scene, simulation))),
        })
    }

    fn thumbnail(&self, name: &str, [width, height]: [u32; 2]) -> Option<Picture> {
        let OpenedScene { info, content } = self.open(name, &vec![]).ok()?;
        let SceneContent::Simulation(driver) = content else {
            return None;
        };
        let simulation = driver.simulation();
        let mut scenery = Scenery::of(simulation, &[]).with_colliders(&info.colliders);
        scenery.colors = palette(&info.swatches)
            .iter()
            .map(|color| [color.r(), color.g(), color.b()])
            .collect();
        scenery.background = (info.angle.background).unwrap_or(scenery.background);
        let style = Style {
            width,
            height,
            ..Style::default()
        };
        let fields = [
            Field::Position,
            Field::Velocity,
            Field::Material,
            Field::Body,
            Field::Volume0,
        ];
        Some(Renderer::new(scenery, style).render(&simulation.snapshot(&fields)))
    }
}

/// A finished run, from its first frame.
fn replay(folder: &Path) -> Result<OpenedScene, String> {
    let recording = Recording::open(folder).map_err(|error| error.to_string())?;
    let info = recorded(&recording, &recording.record().scene);
    Ok(OpenedScene {
        info,
        content: SceneContent::Recording(Box::new(recording)),
    })
}

/// What stays the same in a run, `scene` being its scene with its defaults filled in.
pub(crate) fn recorded(recording: &Recording, scene: &Value) -> SceneInfo {
    let record = recording.record();
    let folder = recording.folder();
    let (swatches, body_swatches) = swatches(scene);
    let corner = |end: &str| vector(&scene["domain"][end]);
    SceneInfo {
        card: SceneCard {
            name: folder.display().to_string(),
            title: title(scene, &record.scene_name),
            sentence: format!("The run in {}.", folder.display()),
            dimension: record.dimension,
        },
        dimension: record.dimension,
        dx: scene["dx"].as_f64().unwrap_or_default(),
        domain: corner("min").zip(corner("max")),
        colliders: colliders_of(scene),
        gravity: vector(&scene["gravity"]).unwrap_or_default(),
        frame_rate: (scene["computed"]["frame_rate"].as_f64()).unwrap_or(DEFAULT_FRAME_RATE),
        frames: Some(recording.len()),
        swatches,
        body_swatches,
        bodies: bodies(scene),
        angle: angle(scene),
        controls: Controls {
            speed: scene["controls"]["speed"].as_f64().unwrap_or(1.0),
            ..Controls::default()
        },
        settings: vec![],
        numbers: format!("{}, {}", record.precision, record.isa),
        warnings: record.warnings.clone(),
    }
}

/// Of runs whose record does not say \[1/s\].
const DEFAULT_FRAME_RATE: f64 = 60.0;

fn title(scene: &Value, name: &str) -> String {
    match scene["title"].as_str() {
        Some(title) if !title.is_empty() => title.to_owned(),
        _ => name.to_owned(),
    }
}

/// Two or three numbers, the third 0 in 2D.
fn vector(value: &Value) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
    match numbers?[..] {
        [x, y] => Some([x, y, 0.0]),
        [x, y, z] => Some([x, y, z]),
        _ => None,
    }
}

fn color(value: &Value) -> Option<[u8; 3]> {
    let digits = value.as_str()?.strip_prefix('#')?;
    let [_, r, g, b] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some([r, g, b])
}

/// What the scene says of the camera; what it leaves open stays open.
fn angle(scene: &Value) -> Angle {
    let camera = &scene["camera"];
    Angle {
        center: vector(&camera["center"]),
        height: camera["height"].as_f64(),
        direction: vector(&camera["direction"]),
        field_of_view: camera["field_of_view"].as_f64(),
        particle_radius: camera["particle_radius"].as_f64(),
        background: color(&camera["background"]),
        color_by: match camera["color_by"].as_str() {
            Some("body") => ColorBy::Body,
            Some("speed") => ColorBy::Speed,
            Some("pressure") => ColorBy::Pressure,
            Some("density") => ColorBy::Density,
            Some("J") => ColorBy::Jacobian,
            _ => ColorBy::Material,
        },
    }
}

/// What of a scene is worth turning while one watches.
fn settings(scene: &Value) -> Vec<Setting> {
    const WORDS: [(&str, &[&str]); 3] = [
        ("transfer", &["apic", "pic", "flip"]),
        ("force", &["mls", "classic"]),
        ("kernel", &["quadratic", "cubic", "linear"]),
    ];
    let mut settings = vec![];
    let mut offer = |group: &str, path: &str, name: &str, value: Option<&Value>| {
        let words = WORDS.iter().find(|(key, _)| *key == name);
        let value = match (value, words) {
            (Some(Value::Number(number)), None) => number.as_f64().map(SettingValue::Number),
            (Some(Value::String(word)), Some((_, words))) => {
                Some(SettingValue::Word(word.clone(), words))
            }
            _ => None,
        };
        settings.extend(value.map(|value| Setting {
            key: format!("{path}{name}"),
            group: group.to_owned(),
            name: name.to_owned(),
            value,
        }));
    };
    for name in ["dx", "transfer", "flip_blend", "force", "kernel", "cfl"] {
        offer("scene", "", name, scene.get(name));
    }
    for (material, table) in scene["materials"].as_object().into_iter().flatten() {
        for (name, value) in table.as_object().into_iter().flatten() {
            offer(
                material,
                &format!("materials.{material}."),
                name,
                Some(value),
            );
        }
    }
    for table in scene["bodies"].as_array().into_iter().flatten() {
        if let Some(body) = table["name"].as_str() {
            let name = "particles_per_cell";
            offer(body, &format!("bodies.{body}."), name, table.get(name));
        }
    }
    settings
}

/// The bodies, by number.
fn bodies(scene: &Value) -> Vec<(String, [u8; 3])> {
    let tables = scene["bodies"].as_array().into_iter().flatten();
    tables
        .enumerate()
        .map(|(number, table)| {
            let own = color(&table["color"]);
            (
                body_name(table, number),
                own.unwrap_or_else(|| body_color(number)),
            )
        })
        .collect()
}

fn body_name(table: &Value, number: usize) -> String {
    (table["name"].as_str()).map_or_else(|| format!("body-{number}"), str::to_owned)
}

/// The materials, then the bodies that have colors of their own; and which is whose.
fn swatches(scene: &Value) -> (Vec<Swatch>, Vec<usize>) {
    let empty = serde_json::Map::new();
    let materials = scene["materials"].as_object().unwrap_or(&empty);
    let look = |material: &str| match scene["materials"][material]["model"].as_str() {
        Some("fluid") => MaterialKind::Liquid,
        Some("corotated" | "neo_hookean") => MaterialKind::Jelly,
        Some("snow") => MaterialKind::Snow,
        Some("none") => MaterialKind::Dust,
        _ => MaterialKind::Other,
    };
    let mut swatches: Vec<Swatch> = (materials.iter())
        .map(|(name, table)| Swatch {
            name: name.clone(),
            look: look(name),
            color: color(&table["color"]),
        })
        .collect();
    let mut of_body = vec![];
    for (number, body) in (scene["bodies"].as_array().into_iter().flatten()).enumerate() {
        let material = body["material"].as_str().unwrap_or_default();
        of_body.push(match color(&body["color"]) {
            None => (materials.keys())
                .position(|name| name == material)
                .unwrap_or(0),
            Some(color) => {
                swatches.push(Swatch {
                    name: body_name(body, number),
                    look: look(material),
                    color: Some(color),
                });
                swatches.len() - 1
            }
        });
    }
    // What no particle has needs no place in the legend.
    let used: Vec<usize> = (0..swatches.len())
        .filter(|i| of_body.contains(i))
        .collect();
    let place = |i: &usize| used.iter().position(|u| u == i).unwrap_or(0);
    let of_body = of_body.iter().map(place).collect();
    (used.iter().map(|&i| swatches[i].clone()).collect(), of_body)
}
