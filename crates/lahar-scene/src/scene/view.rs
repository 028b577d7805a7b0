//! The view of a scene: everything about it that windows and pictures show, typed.
//!
//! ```text
//!   scene file ──▶ Scene ──────────────view()──────────────▶ SceneView
//!                    └─ resolved() ─▶ run.json ─▶ recorded() ───▲
//! ```
//!
//! A run keeps its scene in run.json, with every default filled in. The view of a scene and the view that is read back
//! from its run are the same.

use super::colliders::{ColliderInfo, colliders_of};
use super::color_by::ColorBy;
use super::controls::{Controls, read_controls};
use super::document::{Sources, Span, Value, from_json};
use super::key::Kind;
use super::keys;
use super::material::Look;
use super::read::Reader;
use super::space::vector_in_3d;

/// A scene as windows and pictures show it. Vectors have three components; 2D ignores the third.
///
/// ```
/// use lahar_scene::scene::{Scene, SceneView};
///
/// let scene = Scene::load("dam-break", &[])?;
/// let view = scene.view();
/// assert_eq!(view.materials[0].name, "water");
/// assert_eq!(SceneView::recorded(&scene.resolved()), view);
/// # Ok::<(), lahar_scene::error::SceneError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneView {
    /// The title; may be empty.
    pub title: String,
    /// Number of dimensions, 2 or 3.
    pub dimension: usize,
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// Lower and upper corner of the domain \[m\]; `None` if it is unbounded.
    pub domain: Option<([f64; 3], [f64; 3])>,
    /// Gravity \[m/s²\]; components that the scene gives as formulas are 0.
    pub gravity: [f64; 3],
    /// Frames per simulated second \[1/s\].
    pub frame_rate: f64,
    /// The materials, in the order of the scene.
    pub materials: Vec<MaterialView>,
    /// The bodies, by number.
    pub bodies: Vec<BodyView>,
    /// The colliders, in the order of the scene.
    pub colliders: Vec<ColliderInfo>,
    /// The camera that the scene asks for.
    pub camera: Camera,
    /// The controls of keys and mouse.
    pub controls: Controls,
    /// The settings that a person may want to vary.
    pub settings: Vec<Setting>,
}

/// A material as windows and pictures show it.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialView {
    /// Its name in the scene.
    pub name: String,
    /// The word of its constitutive model.
    pub model: String,
    /// Its color, if the scene or its preset gives one.
    pub color: Option<[u8; 3]>,
}

impl MaterialView {
    /// The look of the material; `None` if its model is unknown, as in runs of other versions.
    pub fn look(&self) -> Option<Look> {
        Look::of_model(&self.model)
    }
}

/// A body as windows and pictures show it.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyView {
    /// Its name, or "body-" and its number.
    pub name: String,
    /// The name of its material.
    pub material: String,
    /// Its color, if the scene gives one. Otherwise it has its material's.
    pub color: Option<[u8; 3]>,
}

/// The camera that a scene asks for. The outlet chooses what the scene leaves open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Camera {
    /// The point in the middle of the picture \[m\].
    pub center: Option<[f64; 3]>,
    /// Height of the scene that the picture shows at its center \[m\].
    pub height: Option<f64>,
    /// Direction from the center to the camera, of any length; 3D only.
    pub direction: Option<[f64; 3]>,
    /// Angle between the lower and the upper edge of the picture \[degrees\]; 3D only.
    pub field_of_view: Option<f64>,
    /// The background color.
    pub background: Option<[u8; 3]>,
    /// Radius of a particle as drawn \[m\].
    pub particle_radius: Option<f64>,
    /// The quantity that particles are colored by.
    pub color_by: ColorBy,
}

/// A key of a scene whose value a person may want to vary.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The key, dotted as `--set` takes it.
    pub key: String,
    /// The heading that the setting belongs under: "scene", a material or a body.
    pub group: String,
    /// Its name under the heading.
    pub name: String,
    /// Its value in the scene.
    pub value: SettingValue,
}

/// The value of a setting.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingValue {
    /// A number, in the key's unit.
    Number(f64),
    /// One of the words that the key allows, and all of these.
    Word(String, &'static [&'static str]),
}

impl SettingValue {
    /// The value as a scene file has it.
    pub fn to_toml(&self) -> String {
        match self {
            Self::Number(number) => format!("{number:?}"),
            Self::Word(word, _) => format!("\"{word}\""),
        }
    }
}

/// Frames per simulated second of a run whose record does not say \[1/s\].
const DEFAULT_FRAME_RATE: f64 = 60.0;

/// The settings of the scene itself that are worth varying.
const SCENE_SETTINGS: [&str; 6] = ["dx", "transfer", "flip_blend", "force", "kernel", "cfl"];

/// The setting of a body that is worth varying.
const BODY_SETTING: &str = "particles_per_cell";

impl SceneView {
    /// Reads the view back from the scene that run.json keeps, which [`super::Scene::resolved`] has made. Parts that
    /// cannot be understood are left out, so that runs of other versions can still be shown.
    pub fn recorded(resolved: &serde_json::Value) -> Self {
        let Some(Value::Table(root)) = from_json(resolved).map(|node| node.value) else {
            return Self::default();
        };
        let sources = Sources::default();
        let scene = Reader::new(&sources, &root, Span::default());
        let computed = scene.opt_table("computed");
        let frame_rate = computed.and_then(|computed| computed.opt_number("frame_rate"));
        Self::read(
            &scene,
            frame_rate.unwrap_or(DEFAULT_FRAME_RATE),
            colliders_of(resolved),
        )
    }

    /// Reads the view of a scene with every default filled in.
    pub(super) fn read(scene: &Reader<'_>, frame_rate: f64, colliders: Vec<ColliderInfo>) -> Self {
        let domain = scene.opt_table("domain");
        let corner = |key| domain.and_then(|domain| vector(&domain, key));
        Self {
            title: scene.opt_text("title").unwrap_or_default().to_owned(),
            dimension: match scene.opt_integer("dimension") {
                Some(3) => 3,
                _ => 2,
            },
            dx: scene.opt_number("dx").unwrap_or_default(),
            domain: corner("min").zip(corner("max")),
            gravity: gravity(scene),
            frame_rate,
            materials: (scene.tables("materials").into_iter())
                .map(|(name, table)| MaterialView {
                    name: name.to_owned(),
                    model: table.opt_text("model").unwrap_or_default().to_owned(),
                    color: table.opt_color("color"),
                })
                .collect(),
            bodies: (scene.tables("bodies").into_iter().enumerate())
                .map(|(number, (_, table))| BodyView {
                    name: body_name(&table, number),
                    material: table.opt_text("material").unwrap_or_default().to_owned(),
                    color: table.opt_color("color"),
                })
                .collect(),
            colliders,
            camera: scene
                .opt_table("camera")
                .map_or_else(Camera::default, |table| read_camera(&table)),
            controls: read_controls(scene).unwrap_or_default(),
            settings: settings(scene),
        }
    }
}

/// Two or three numbers; the third is 0 in 2D.
fn vector(table: &Reader<'_>, key: &str) -> Option<[f64; 3]> {
    let in_3d = table.opt_vector::<3>(key);
    in_3d.or_else(|| table.opt_vector::<2>(key).map(vector_in_3d))
}

fn gravity(scene: &Reader<'_>) -> [f64; 3] {
    let components = scene.opt_components("gravity").unwrap_or_default();
    let component = |axis: usize| components.get(axis).copied().flatten();
    core::array::from_fn(|axis| component(axis).unwrap_or_default())
}

fn body_name(table: &Reader<'_>, number: usize) -> String {
    let name = table.opt_text("name");
    name.map_or_else(|| format!("body-{number}"), str::to_owned)
}

pub(super) fn read_camera(table: &Reader<'_>) -> Camera {
    Camera {
        center: vector(table, "center"),
        height: table.opt_number("height"),
        direction: vector(table, "direction"),
        field_of_view: table.opt_number("field_of_view"),
        background: table.opt_color("background"),
        particle_radius: table.opt_number("particle_radius"),
        color_by: (table.opt_text("color_by"))
            .and_then(ColorBy::from_word)
            .unwrap_or_default(),
    }
}

fn settings(scene: &Reader<'_>) -> Vec<Setting> {
    let setting = |group: &str, path: &str, name: &str, value| Setting {
        key: format!("{path}{name}"),
        group: group.to_owned(),
        name: name.to_owned(),
        value,
    };
    let mut settings: Vec<Setting> = (SCENE_SETTINGS.iter())
        .filter_map(|name| Some(setting("scene", "", name, scene_setting(scene, name)?)))
        .collect();
    for (material, table) in scene.tables("materials") {
        let path = format!("materials.{material}.");
        let numbers = table.numbers();
        settings
            .extend(numbers.map(|(name, number)| {
                setting(material, &path, name, SettingValue::Number(number))
            }));
    }
    for (_, table) in scene.tables("bodies") {
        let body = table.opt_text("name").zip(table.opt_number(BODY_SETTING));
        settings.extend(body.map(|(body, number)| {
            let path = format!("bodies.{body}.");
            setting(body, &path, BODY_SETTING, SettingValue::Number(number))
        }));
    }
    settings
}

/// A number, or a word with all the words that its key allows.
fn scene_setting(scene: &Reader<'_>, name: &str) -> Option<SettingValue> {
    if let Some(number) = scene.opt_number(name) {
        return Some(SettingValue::Number(number));
    }
    match keys::SCENE.key(name)?.kind {
        Kind::Word(words) => Some(SettingValue::Word(scene.opt_text(name)?.to_owned(), words)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::scene::Scene;

    #[test]
    fn the_view_of_each_built_in_scene_comes_back_from_its_record() {
        for card in builtin::list() {
            let scene = Scene::load(card.name, &[]).expect(card.name);
            let view = scene.view();
            assert_eq!(
                SceneView::recorded(&scene.resolved()),
                view,
                "{}",
                card.name
            );
            assert_eq!(view.dimension, card.dimension, "{}", card.name);
            assert_eq!(view.materials.len(), scene.materials.len(), "{}", card.name);
            assert_eq!(view.bodies.len(), scene.bodies.len(), "{}", card.name);
            assert!(
                view.settings.len() > 4,
                "{}: {:?}",
                card.name,
                view.settings
            );
        }
    }

    #[test]
    fn a_record_that_says_little_is_still_a_view() {
        let record = serde_json::json!({ "dx": 0.1, "gravity": ["sin(t)", -9.81], "bodies": [{}] });
        let view = SceneView::recorded(&record);
        assert_eq!((view.dimension, view.dx, view.frame_rate), (2, 0.1, 60.0));
        assert_eq!(view.gravity, [0.0, -9.81, 0.0]);
        assert_eq!(view.bodies[0].name, "body-0");
        assert_eq!(view.camera, Camera::default());
        assert_eq!(
            SceneView::recorded(&serde_json::Value::Null),
            SceneView::default()
        );
    }
}
