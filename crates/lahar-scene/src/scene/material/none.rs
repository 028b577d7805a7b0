//! Dust: `model = "none"`.

use super::{Look, MATERIAL, Preset, Stiffness};
use crate::error::SceneError;
use crate::scene::key::Section;
use crate::scene::read::Reader;
use lahar::Model;
use lahar::material::Dust;

pub(super) const LOOK: Look = Look::Dust;

pub(super) static SECTION: Section = Section {
    name: "material: none",
    header: "[materials.NAME] with model = \"none\"",
    keys: &[MATERIAL],
};

/// Particles without stress.
pub(super) const PRESETS: &[Preset] = &[Preset {
    name: "dust",
    keys: "model = \"none\"\ndensity = 1.0",
    about: "Particles without stress.",
    source: "a choice",
}];

pub(super) fn read(_: &Reader<'_>, _: usize) -> Result<(Model, Option<Stiffness>), SceneError> {
    Ok((Model::Dust(Dust), None))
}
