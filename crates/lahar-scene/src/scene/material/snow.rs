//! Snow: `model = "snow"`.

use super::moduli::{ELASTIC, read_moduli};
use super::{Look, MATERIAL, Preset, Stiffness};
use crate::error::SceneError;
use crate::scene::key::WhenAbsent::Value;
use crate::scene::key::{Bound, Kind, Section, key, words};
use crate::scene::read::Reader;
use lahar::Model;
use lahar::material::{HardeningFrom, Snow};

pub(super) const LOOK: Look = Look::Snow;

const HARDENING_FROM: [(&str, HardeningFrom); 2] = [
    ("updated", HardeningFrom::Updated),
    ("previous", HardeningFrom::Previous),
];

pub(super) static SECTION: Section = Section {
    name: "material: snow",
    header: "[materials.NAME] with model = \"snow\"",
    keys: &[
        MATERIAL,
        ELASTIC,
        &[
            key(
                "critical_compression",
                Kind::Number(Bound::Part),
                "",
                Value("2.5e-2"),
                "θc: singular values of F stay above 1 − θc.",
            ),
            key(
                "critical_stretch",
                Kind::Number(Bound::NotNegative),
                "",
                Value("7.5e-3"),
                "θs: singular values of F stay below 1 + θs.",
            ),
            key(
                "hardening",
                Kind::Number(Bound::NotNegative),
                "",
                Value("10.0"),
                "ξ: moduli grow by h = exp(ξ(1 − Jp)) as snow packs.",
            ),
            key(
                "hardening_range",
                Kind::Interval,
                "",
                Value("[0.0, inf]"),
                "h is clamped to it.",
            ),
            key(
                "plastic_jacobian_range",
                Kind::Interval,
                "",
                Value("[0.6, 20.0]"),
                "Jp is clamped to it.",
            ),
            key(
                "hardening_from",
                Kind::Word(&words(&HARDENING_FROM)),
                "",
                Value("\"updated\""),
                "The Jp that h follows: the one after this substep's clamping, or the one before it as in mpm99 and mpm128.",
            ),
        ],
    ],
};

/// Presets of snow.
pub(super) const PRESETS: &[Preset] = &[Preset {
    name: "snow",
    keys: "model = \"snow\"\ndensity = 400.0\nyoungs_modulus = 1.4e5\npoisson_ratio = 0.2\ncritical_compression = 2.5e-2\ncritical_stretch = 7.5e-3\nhardening = 10.0\ncolor = \"#eeeef0\"",
    about: "The snow of the paper.",
    source: "Stomakhin 2013",
}];

pub(super) fn read(
    table: &Reader<'_>,
    dimension: usize,
) -> Result<(Model, Option<Stiffness>), SceneError> {
    let (lambda, mu) = read_moduli(table, dimension)?;
    let law = Snow {
        lambda,
        mu,
        critical_compression: table.number("critical_compression")?,
        critical_stretch: table.number("critical_stretch")?,
        hardening: table.number("hardening")?,
        hardening_range: table.vector("hardening_range")?,
        plastic_jacobian_range: table.vector("plastic_jacobian_range")?,
        hardening_from: table.choice("hardening_from", &HARDENING_FROM)?,
    };
    Ok((Model::Snow(law), None))
}
