//! Materials of scenes: a file per model with its keys, its reader, its presets and its look.
//!
//! The files are those of the simulator's table of models, [`lahar::models!`]: a model that is added
//! there needs a file of its name here, with `LOOK`, `SECTION`, `PRESETS` and `read`.

mod moduli;

pub(crate) use moduli::{ELASTIC, moduli};

use super::key::WhenAbsent::Words;
use super::key::{Bound, Key, Kind, Section, key};
use super::read::Reader;
use crate::error::SceneError;
use lahar::{Material, Model};

/// A model as scenes see it.
pub(crate) struct SceneModel {
    /// Its name, the word of the key `model`.
    pub(crate) name: &'static str,
    /// The keys of the model.
    pub(crate) section: &'static Section,
    /// Named sets of its keys.
    pub(crate) presets: &'static [Preset],
    /// The look of its materials.
    look: Look,
    /// The reader of its keys.
    read: ReadModel,
}

/// A function that reads a model from its checked table, in this number of dimensions, and a fluid's stiffness with it.
type ReadModel = fn(&Reader<'_>, usize) -> Result<(Model, Option<Stiffness>), SceneError>;

/// The look of a material in windows and pictures; a material may have a color of its own besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Grains that exert no stress.
    Dust,
    /// A liquid with a free surface.
    Liquid,
    /// A solid that keeps its shape.
    Solid,
    /// Grains of white snow.
    Snow,
}

impl Look {
    /// Returns the look of the model called `name`, or `None` if there is no such model.
    pub fn of_model(name: &str) -> Option<Self> {
        SceneModel::find(name).map(|model| model.look)
    }
}

/// The stiffness of a fluid, as its scene gives it.
#[derive(Clone, Copy)]
pub(crate) enum Stiffness {
    /// Ten times the largest speed that is expected, as speed of sound.
    Auto,
    /// The speed of sound \[m/s\].
    SoundSpeed(f64),
    /// The bulk modulus \[Pa\].
    Bulk(f64),
}

macro_rules! scene_models {
    ($($(#[$doc:meta])* $law:ident $name:literal $module:ident,)*) => {
        $(mod $module;)*

        /// All models, in the order of the documentation.
        pub(crate) static MODELS: &[SceneModel] = &[$(SceneModel {
            name: $name,
            section: &$module::SECTION,
            presets: $module::PRESETS,
            look: $module::LOOK,
            read: $module::read,
        }),*];

        /// The presets of each model.
        const PRESETS: &[&[Preset]] = &[$($module::PRESETS),*];
    };
}
lahar::models!([scene_models]);

impl SceneModel {
    /// Returns the model called `name`.
    pub(crate) fn find(name: &str) -> Option<&'static Self> {
        MODELS.iter().find(|model| model.name == name)
    }
}

/// A named set of material keys.
pub(crate) struct Preset {
    pub(crate) name: &'static str,
    /// The keys, in TOML.
    pub(crate) keys: &'static str,
    /// A sentence that describes the material.
    pub(crate) about: &'static str,
    /// The source of the numbers.
    pub(crate) source: &'static str,
}

impl Preset {
    /// All presets, in the order of the documentation.
    pub(crate) fn all() -> impl Iterator<Item = &'static Self> {
        MODELS.iter().flat_map(|model| model.presets)
    }

    /// Returns the preset called `name`, and the model that has it.
    pub(crate) fn find(name: &str) -> Option<(&'static Self, &'static SceneModel)> {
        MODELS.iter().find_map(|model| {
            let preset = model.presets.iter().find(|preset| preset.name == name)?;
            Some((preset, model))
        })
    }
}

/// The number of presets.
const PRESET_COUNT: usize = {
    let (mut count, mut i) = (0, 0);
    while i < PRESETS.len() {
        count += PRESETS[i].len();
        i += 1;
    }
    count
};

/// The names of all presets, the words of the key `preset`.
pub(crate) const PRESET_NAMES: &[&str] = &{
    let mut names = [""; PRESET_COUNT];
    let (mut count, mut i) = (0, 0);
    while i < PRESETS.len() {
        let mut k = 0;
        while k < PRESETS[i].len() {
            names[count] = PRESETS[i][k].name;
            count += 1;
            k += 1;
        }
        i += 1;
    }
    names
};

/// The keys of every material.
pub(crate) static MATERIAL: &[Key] = &[
    key(
        "model",
        Kind::Word(Model::NAMES),
        "",
        Words("the preset's, else required"),
        "The constitutive law.",
    ),
    key(
        "preset",
        Kind::Word(PRESET_NAMES),
        "",
        Words("none"),
        "Values to start from; keys that the material gives replace them.",
    ),
    key(
        "density",
        Kind::Number(Bound::Positive),
        "kg/m³",
        Words("the preset's, else required"),
        "Density at rest.",
    ),
    key(
        "color",
        Kind::Color,
        "",
        Words("the outlet's"),
        "Color of its particles in windows and pictures.",
    ),
];

/// Reads a material and, for a fluid, how its stiffness is given.
pub(super) fn read_material(
    name: &str,
    table: &Reader<'_>,
    dimension: usize,
) -> Result<(Material, Option<Stiffness>), SceneError> {
    let model = SceneModel::find(table.text("model")?)
        .ok_or_else(|| table.error_at("model", "there is no such model"))?;
    let (model, stiffness) = (model.read)(table, dimension)?;
    let material = Material {
        name: name.to_owned(),
        density: table.number("density")?,
        model,
    };
    Ok((material, stiffness))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The simulator has presets too, for those who write no scenes: same names, same numbers.
    #[test]
    fn numbers_are_those_of_the_simulator() {
        use lahar::Model;
        let own: Vec<&str> = PRESET_NAMES
            .iter()
            .copied()
            .filter(|name| *name != "dust")
            .collect();
        let simulators: Vec<&str> = lahar::material::presets().map(|(name, _)| name).collect();
        assert_eq!(own, simulators);
        for name in own {
            let text = format!(
                "dimension = 3\ndx = 0.1\n[materials.m]\npreset = \"{name}\"\n[[bodies]]\nmaterial = \"m\"\n\
                 shape = {{ ball = {{ center = [0, 0, 0], radius = 1 }} }}"
            );
            let material = crate::scene::Scene::parse(&text, "a", &[])
                .unwrap()
                .simulated_materials()[0]
                .clone();
            let theirs = lahar::material::preset(name, material.sound_speed()).unwrap();
            assert_eq!(material.density, theirs.density, "{name}");
            match (material.model, theirs.model) {
                (Model::Fluid(a), Model::Fluid(mut b)) => {
                    assert!((a.bulk_modulus / b.bulk_modulus - 1.0).abs() < 1e-12);
                    b.bulk_modulus = a.bulk_modulus;
                    assert_eq!(a, b, "{name}");
                }
                (a, b) => assert_eq!(a, b, "{name}"),
            }
        }
    }
}
