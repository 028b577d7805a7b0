//! Linear elasticity for small strains and rotations: `model = "linear_elastic"`.

use super::moduli::{ELASTIC, read_moduli};
use super::{Look, MATERIAL, Preset, Stiffness};
use crate::error::SceneError;
use crate::scene::key::Section;
use crate::scene::read::Reader;
use lahar::Model;
use lahar::material::LinearElastic;

pub(super) const LOOK: Look = Look::Solid;

pub(super) static SECTION: Section = Section {
    name: "material: linear_elastic",
    header: "[materials.NAME] with model = \"linear_elastic\"",
    keys: &[MATERIAL, ELASTIC],
};

/// There are none: the law is for comparing with exact solutions.
pub(super) const PRESETS: &[Preset] = &[];

pub(super) fn read(
    table: &Reader<'_>,
    dimension: usize,
) -> Result<(Model, Option<Stiffness>), SceneError> {
    let (lambda, mu) = read_moduli(table, dimension)?;
    Ok((Model::LinearElastic(LinearElastic { lambda, mu }), None))
}
