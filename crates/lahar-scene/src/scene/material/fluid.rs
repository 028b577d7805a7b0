//! Liquids: `model = "fluid"`.

use super::{Look, MATERIAL, Preset, Stiffness};
use crate::error::SceneError;
use crate::scene::key::WhenAbsent::{Value, Words};
use crate::scene::key::{Bound, Kind, Section, key, words};
use crate::scene::read::Reader;
use lahar::Model;
use lahar::material::rheology::CREEP_RATE;
use lahar::material::{
    Eos, Fluid, HerschelBulkley, JacobianUpdate, Rheology, ViscousStress, VolumeCorrection,
    VolumeRule,
};

pub(super) const LOOK: Look = Look::Liquid;

/// The equations of state; that of Tait with its usual exponent.
const EQUATIONS_OF_STATE: [(&str, Eos); 2] = [
    ("tait", Eos::Tait { gamma: 7.0 }),
    ("linear_j", Eos::LinearJ),
];

const JACOBIAN_UPDATES: [(&str, JacobianUpdate); 2] = [
    ("trace", JacobianUpdate::Trace),
    ("det", JacobianUpdate::Determinant),
];

/// The volume rules; that of correction with zero rates.
const VOLUMES: [(&str, VolumeRule); 3] = [
    (
        "corrected",
        VolumeRule::Corrected(VolumeCorrection {
            smoothing: 0.0,
            correction: 0.0,
        }),
    ),
    ("jacobian", VolumeRule::Jacobian),
    ("gathered", VolumeRule::Gathered),
];

const VISCOUS_STRESSES: [(&str, ViscousStress); 2] = [
    ("newtonian", ViscousStress::Newtonian),
    ("engineering", ViscousStress::Engineering),
];

/// The rheologies; that of Herschel and Bulkley with the defaults of its keys.
const RHEOLOGIES: [(&str, Rheology); 2] = [
    ("newtonian", Rheology::Newtonian),
    (
        "herschel-bulkley",
        Rheology::HerschelBulkley(HerschelBulkley {
            yield_stress: 0.0,
            consistency: 0.0,
            flow_index: 1.0,
            creep_rate: CREEP_RATE,
        }),
    ),
];

pub(super) static SECTION: Section = Section {
    name: "material: fluid",
    header: "[materials.NAME] with model = \"fluid\"",
    keys: &[
        MATERIAL,
        &[
            key(
                "eos",
                Kind::Word(&words(&EQUATIONS_OF_STATE)),
                "",
                Value("\"tait\""),
                "Equation of state: p = (K/γ)((ρ/ρ₀)^γ − 1), or p = K(1 − J).",
            ),
            key(
                "gamma",
                Kind::Number(Bound::Positive),
                "",
                Words("7.0, with `tait` only"),
                "Exponent γ of `tait`; 1: τ = K(J − 1), the mpm88 fluid.",
            ),
            key(
                "sound_speed",
                Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&["auto"])]),
                "m/s",
                Words("\"auto\", unless `bulk_modulus` is given"),
                "Speed of sound c; `\"auto\"`: ten times the largest speed expected, √(v² + 2gH), with the largest speed v of bodies and colliders and the height H of their highest point above the floor. With an automatic time step it follows when gravity is changed in the window.",
            ),
            key(
                "bulk_modulus",
                Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&["auto"])]),
                "Pa",
                Words("ρ₀c²"),
                "Stiffness K, instead of `sound_speed`.",
            ),
            key(
                "viscosity",
                Kind::Number(Bound::NotNegative),
                "Pa s",
                Value("0.0"),
                "Dynamic viscosity.",
            ),
            key(
                "bulk_viscosity",
                Kind::Number(Bound::NotNegative),
                "Pa s",
                Value("0.0"),
                "Viscosity against change of volume.",
            ),
            key(
                "tension",
                Kind::OneOf(&[Kind::Number(Bound::NotNegative), Kind::Word(&["unlimited"])]),
                "Pa",
                Value("0.0"),
                "Largest tension that the fluid bears before it tears.",
            ),
            key(
                "jacobian_update",
                Kind::Word(&words(&JACOBIAN_UPDATES)),
                "",
                Value("\"trace\""),
                "J ← J(1 + Δt tr C), or J ← J det(I + Δt C).",
            ),
            key(
                "volume",
                Kind::Word(&words(&VOLUMES)),
                "",
                Value("\"corrected\""),
                "Source of J. `\"corrected\"`: J follows the motion and, as the fluid deforms, is corrected by the volume that the grid measures. `\"jacobian\"`: J only follows the motion, and drifts. `\"gathered\"`: J is gathered from the grid before each substep; it does not drift, but fluid at a free surface, or at a wall on its plane, counts as expanded.",
            ),
            key(
                "volume_smoothing",
                Kind::Number(Bound::NotNegative),
                "",
                Words("5.0, with volume = `corrected` only"),
                "Part of the difference between J and its mean around a particle that vanishes while the fluid is sheared by 1.",
            ),
            key(
                "volume_correction",
                Kind::Number(Bound::NotNegative),
                "",
                Words("3.0, with volume = `corrected` only"),
                "Part of the difference between the volume of the particles and the space they have on the grid that goes into J while the fluid is sheared by 1.",
            ),
            key(
                "viscous_stress",
                Kind::Word(&words(&VISCOUS_STRESSES)),
                "",
                Value("\"newtonian\""),
                "Viscosity times ∇v + ∇vᵀ − (2/d) tr ∇v, or times the engineering strain rates, ∂v_x/∂x and ∂v_x/∂y + ∂v_y/∂x, which depend on the direction of the axes.",
            ),
            key(
                "rheology",
                Kind::Word(&words(&RHEOLOGIES)),
                "",
                Value("\"newtonian\""),
                "Dependence of the viscosity on the rate of shear γ̇: `\"herschel-bulkley\"` adds the stress `yield_stress` + `consistency` γ̇^`flow_index`. The keys below are for it.",
            ),
            key(
                "yield_stress",
                Kind::Number(Bound::NotNegative),
                "Pa",
                Words("0"),
                "Shear stress below which the fluid only creeps.",
            ),
            key(
                "consistency",
                Kind::Number(Bound::NotNegative),
                "Pa sⁿ",
                Words("0"),
                "Stress at γ̇ = 1/s beyond the yield stress; with `flow_index = 1` (Bingham) the plastic viscosity.",
            ),
            key(
                "flow_index",
                Kind::Number(Bound::Part),
                "",
                Words("1"),
                "n; below 1 the fluid thins as it is sheared. It cannot be above 1: a thickening fluid has no largest viscosity that would limit the time step.",
            ),
            key(
                "creep_rate",
                Kind::Number(Bound::Positive),
                "1/s",
                Words("0.1"),
                "Rate of shear at which the fluid creeps below its yield stress, and below which it does not thin. The lower it is, the firmer the fluid stands, and the shorter the time step.",
            ),
        ],
    ],
};

/// Presets of liquids.
pub(super) const PRESETS: &[Preset] = &[
    Preset {
        name: "water",
        keys: "model = \"fluid\"\ndensity = 998.2\nviscosity = 1.002e-3\ncolor = \"#3d9be9\"",
        about: "Fresh water at 20 °C.",
        source: "IAPWS; CRC Handbook of Chemistry and Physics",
    },
    Preset {
        name: "sea_water",
        keys: "model = \"fluid\"\ndensity = 1024.8\nviscosity = 1.072e-3\ncolor = \"#2f86b8\"",
        about: "Sea water at 20 °C with 35 g/kg of salt.",
        source: "UNESCO equation of state 1980; Landolt–Börnstein V/3a, 1986",
    },
    Preset {
        name: "honey",
        keys: "model = \"fluid\"\ndensity = 1420.0\nviscosity = 19.0\ncolor = \"#e3a02b\"",
        about: "Clover honey with 16 % of water near 20 °C.",
        source: "Munro 1943",
    },
    Preset {
        name: "mercury",
        keys: "model = \"fluid\"\ndensity = 13534.0\nviscosity = 1.526e-3\ncolor = \"#b9bec4\"",
        about: "Mercury at 25 °C.",
        source: "CRC Handbook of Chemistry and Physics",
    },
    Preset {
        name: "ketchup",
        keys: "model = \"fluid\"\ndensity = 1140.0\nrheology = \"herschel-bulkley\"\nyield_stress = 32.0\nconsistency = 18.7\nflow_index = 0.27\ncolor = \"#b3261e\"",
        about: "Tomato ketchup at 25 °C; its density is a choice.",
        source: "Steffe 1996, after Higgs and Norrington 1971",
    },
    Preset {
        name: "mud",
        keys: "model = \"fluid\"\ndensity = 1200.0\nrheology = \"herschel-bulkley\"\nyield_stress = 25.0\nconsistency = 0.07\ncolor = \"#8a5a44\"",
        about: "Water with 27.4 % of clay by volume.",
        source: "Komatina and Jovanović 1997",
    },
];

pub(super) fn read(table: &Reader<'_>, _: usize) -> Result<(Model, Option<Stiffness>), SceneError> {
    let eos = read_equation_of_state(table)?;
    let stiffness = read_stiffness(table)?;
    let fluid = Fluid {
        eos,
        bulk_modulus: 0.0, // follows from the stiffness when all bodies are known
        viscosity: table.number("viscosity")?,
        rheology: read_rheology(table)?,
        bulk_viscosity: table.number("bulk_viscosity")?,
        tension: table.opt_number("tension").unwrap_or(f64::INFINITY),
        jacobian_update: table.choice("jacobian_update", &JACOBIAN_UPDATES)?,
        volume: read_volume_rule(table)?,
        viscous_stress: table.choice("viscous_stress", &VISCOUS_STRESSES)?,
    };
    Ok((Model::Fluid(fluid), Some(stiffness)))
}

fn read_equation_of_state(table: &Reader<'_>) -> Result<Eos, SceneError> {
    match table.choice("eos", &EQUATIONS_OF_STATE)? {
        Eos::Tait { gamma } => Ok(Eos::Tait {
            gamma: table.opt_number("gamma").unwrap_or(gamma),
        }),
        Eos::LinearJ if table.has("gamma") => {
            Err(table.error_at_key("gamma", "\"gamma\" is for eos = \"tait\" only"))
        }
        Eos::LinearJ => Ok(Eos::LinearJ),
    }
}

fn read_stiffness(table: &Reader<'_>) -> Result<Stiffness, SceneError> {
    if table.has("sound_speed") && table.has("bulk_modulus") {
        return Err(table.error_at_key(
            "bulk_modulus",
            "\"sound_speed\" and \"bulk_modulus\" say the same; give one",
        ));
    }
    let (sound_speed, bulk_modulus) = (
        table.opt_number("sound_speed").map(Stiffness::SoundSpeed),
        table.opt_number("bulk_modulus").map(Stiffness::Bulk),
    );
    Ok(sound_speed.or(bulk_modulus).unwrap_or(Stiffness::Auto))
}

fn read_rheology(table: &Reader<'_>) -> Result<Rheology, SceneError> {
    let keys = ["yield_stress", "consistency", "flow_index", "creep_rate"];
    let usual = match table.choice("rheology", &RHEOLOGIES)? {
        Rheology::HerschelBulkley(law) => law,
        Rheology::Newtonian => {
            return match keys.into_iter().find(|key| table.has(key)) {
                Some(key) => Err(table
                    .error_at_key(
                        key,
                        format!("\"{key}\" is for rheology = \"herschel-bulkley\" only"),
                    )
                    .hint("add rheology = \"herschel-bulkley\" to the material")),
                None => Ok(Rheology::Newtonian),
            };
        }
    };
    let [yield_stress, consistency, flow_index, creep_rate] = keys.map(|key| table.opt_number(key));
    let law = HerschelBulkley {
        yield_stress: yield_stress.unwrap_or(usual.yield_stress),
        consistency: consistency.unwrap_or(usual.consistency),
        flow_index: flow_index.unwrap_or(usual.flow_index),
        creep_rate: creep_rate.unwrap_or(usual.creep_rate),
    };
    if law.yield_stress == 0.0 && law.consistency == 0.0 {
        let error = table.error_at_key(
            "rheology",
            "a Herschel-Bulkley fluid needs \"yield_stress\" or \"consistency\" or both",
        );
        return Err(error.hint("for mud, for instance, yield_stress = 25.0 and consistency = 0.07"));
    }
    Ok(Rheology::HerschelBulkley(law))
}

fn read_volume_rule(table: &Reader<'_>) -> Result<VolumeRule, SceneError> {
    let keys = ["volume_smoothing", "volume_correction"];
    let rule = table.choice("volume", &VOLUMES)?;
    match rule {
        VolumeRule::Corrected(_) => {
            let usual = VolumeCorrection::default();
            let [smoothing, correction] = keys.map(|key| table.opt_number(key));
            Ok(VolumeRule::Corrected(VolumeCorrection {
                smoothing: smoothing.unwrap_or(usual.smoothing),
                correction: correction.unwrap_or(usual.correction),
            }))
        }
        VolumeRule::Jacobian | VolumeRule::Gathered => {
            match keys.into_iter().find(|key| table.has(key)) {
                Some(key) => Err(table
                    .error_at_key(key, format!("\"{key}\" is for volume = \"corrected\" only"))),
                None => Ok(rule),
            }
        }
    }
}
