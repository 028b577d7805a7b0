//! Rubber: `model = "neo_hookean"`.

use super::moduli::{ELASTIC, read_moduli};
use super::{Look, MATERIAL, Preset, Stiffness};
use crate::error::SceneError;
use crate::scene::key::WhenAbsent::Value;
use crate::scene::key::{Bound, Kind, Section, key};
use crate::scene::read::Reader;
use lahar::Model;
use lahar::material::NeoHookean;

pub(super) const LOOK: Look = Look::Solid;

pub(super) static SECTION: Section = Section {
    name: "material: neo_hookean",
    header: "[materials.NAME] with model = \"neo_hookean\"",
    keys: &[
        MATERIAL,
        ELASTIC,
        &[key(
            "logarithm_ends",
            Kind::Number(Bound::Part),
            "",
            Value("0.1"),
            "The J below which ln J continues as a straight line, so that material that is pressed flat or turned inside out is pushed back; above 0.",
        )],
    ],
};

/// Presets of tough solids.
pub(super) const PRESETS: &[Preset] = &[Preset {
    name: "rubber",
    keys: "model = \"neo_hookean\"\ndensity = 930.0\nyoungs_modulus = 2.0e6\npoisson_ratio = 0.49\ncolor = \"#3b3f46\"",
    about: "Vulcanized natural rubber; ν = 0.49 rather than 0.4999.",
    source: "Ashby, Materials Selection in Mechanical Design",
}];

pub(super) fn read(
    table: &Reader<'_>,
    dimension: usize,
) -> Result<(Model, Option<Stiffness>), SceneError> {
    let (lambda, mu) = read_moduli(table, dimension)?;
    let logarithm_ends = table.number("logarithm_ends")?;
    if logarithm_ends == 0.0 {
        return Err(table.error_at("logarithm_ends", "\"logarithm_ends\" must be above 0"));
    }
    let law = NeoHookean {
        lambda,
        mu,
        logarithm_ends,
    };
    Ok((Model::NeoHookean(law), None))
}
