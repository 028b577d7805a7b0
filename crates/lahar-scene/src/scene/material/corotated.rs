//! Jelly: `model = "corotated"`.

use super::moduli::{ELASTIC, read_moduli};
use super::{Look, MATERIAL, Preset, Stiffness};
use crate::error::SceneError;
use crate::scene::key::Section;
use crate::scene::read::Reader;
use lahar::Model;
use lahar::material::Corotated;

pub(super) const LOOK: Look = Look::Solid;

pub(super) static SECTION: Section = Section {
    name: "material: corotated",
    header: "[materials.NAME] with model = \"corotated\"",
    keys: &[MATERIAL, ELASTIC],
};

/// Presets of soft solids.
pub(super) const PRESETS: &[Preset] = &[Preset {
    name: "jelly",
    keys: "model = \"corotated\"\ndensity = 1010.0\nyoungs_modulus = 4.3e3\npoisson_ratio = 0.45\ncolor = \"#ed553b\"",
    about: "Gelatin, one part to twenty of water; ν = 0.45 rather than nearly ½.",
    source: "Bonavia et al., arXiv:2512.20502",
}];

pub(super) fn read(
    table: &Reader<'_>,
    dimension: usize,
) -> Result<(Model, Option<Stiffness>), SceneError> {
    let (lambda, mu) = read_moduli(table, dimension)?;
    Ok((Model::Corotated(Corotated { lambda, mu }), None))
}
