//! Reads materials.

use super::keys::MODULI;
use super::read::Reader;
use super::stiffness::Stiffness;
use crate::error::SceneError;
use lahar::material::{
    Corotated, Dust, Eos, Fluid, HardeningFrom, HerschelBulkley, JacobianUpdate, NeoHookean,
    Rheology, Snow, ViscousStress, VolumeCorrection, VolumeRule, lame, rheology::CREEP_RATE,
};
use lahar::{Material, Model};

pub(super) fn read_material<const D: usize>(
    name: &str,
    table: &Reader<'_>,
) -> Result<(Material, Stiffness), SceneError> {
    let mut stiffness = Stiffness::Auto;
    let model = match table.text("model")? {
        "none" => Model::Dust(Dust),
        "fluid" => {
            let (fluid, given) = read_fluid(table)?;
            stiffness = given;
            Model::Fluid(fluid)
        }
        "corotated" => {
            let (lambda, mu) = read_moduli::<D>(table)?;
            Model::Corotated(Corotated { lambda, mu })
        }
        "neo_hookean" => {
            let (lambda, mu) = read_moduli::<D>(table)?;
            let logarithm_ends = table.number("logarithm_ends")?;
            if logarithm_ends == 0.0 {
                return Err(table.error_at("logarithm_ends", "\"logarithm_ends\" must be above 0"));
            }
            Model::NeoHookean(NeoHookean {
                lambda,
                mu,
                logarithm_ends,
            })
        }
        _ => Model::Snow(read_snow::<D>(table)?),
    };
    Ok((
        Material {
            name: name.to_owned(),
            density: table.number("density")?,
            model,
        },
        stiffness,
    ))
}

fn read_fluid(table: &Reader<'_>) -> Result<(Fluid, Stiffness), SceneError> {
    let eos = match table.text("eos")? {
        "linear_j" if table.has("gamma") => {
            return Err(table.error_at_key("gamma", "\"gamma\" is for eos = \"tait\" only"));
        }
        "linear_j" => Eos::LinearJ,
        _ => Eos::Tait {
            gamma: table.opt_number("gamma").unwrap_or(7.0),
        },
    };
    let stiffness = match (
        table.opt_number("sound_speed"),
        table.opt_number("bulk_modulus"),
    ) {
        _ if table.has("sound_speed") && table.has("bulk_modulus") => {
            return Err(table.error_at_key(
                "bulk_modulus",
                "\"sound_speed\" and \"bulk_modulus\" say the same; give one",
            ));
        }
        (Some(c), _) => Stiffness::SoundSpeed(c),
        (_, Some(bulk)) => Stiffness::Bulk(bulk),
        _ => Stiffness::Auto,
    };
    let fluid = Fluid {
        eos,
        bulk_modulus: 0.0,
        viscosity: table.number("viscosity")?,
        rheology: read_rheology(table)?,
        bulk_viscosity: table.number("bulk_viscosity")?,
        tension: table.opt_number("tension").unwrap_or(f64::INFINITY),
        jacobian_update: if table.text("jacobian_update")? == "det" {
            JacobianUpdate::Determinant
        } else {
            JacobianUpdate::Trace
        },
        volume: read_volume_rule(table)?,
        viscous_stress: if table.text("viscous_stress")? == "engineering" {
            ViscousStress::Engineering
        } else {
            ViscousStress::Newtonian
        },
    };
    Ok((fluid, stiffness))
}

fn read_rheology(table: &Reader<'_>) -> Result<Rheology, SceneError> {
    let [yield_stress, consistency, flow_index, creep_rate] =
        ["yield_stress", "consistency", "flow_index", "creep_rate"];
    if table.text("rheology")? == "newtonian" {
        let given = [yield_stress, consistency, flow_index, creep_rate]
            .into_iter()
            .find(|key| table.has(key));
        return match given {
            Some(key) => Err(table
                .error_at_key(
                    key,
                    format!("\"{key}\" is for rheology = \"herschel-bulkley\" only"),
                )
                .hint("add rheology = \"herschel-bulkley\" to the material")),
            None => Ok(Rheology::Newtonian),
        };
    }
    let law = HerschelBulkley {
        yield_stress: table.opt_number(yield_stress).unwrap_or(0.0),
        consistency: table.opt_number(consistency).unwrap_or(0.0),
        flow_index: table.opt_number(flow_index).unwrap_or(1.0),
        creep_rate: table.opt_number(creep_rate).unwrap_or(CREEP_RATE),
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
    let rates = ["volume_smoothing", "volume_correction"];
    let rule = match table.text("volume")? {
        "corrected" => {
            let usual = VolumeCorrection::default();
            return Ok(VolumeRule::Corrected(VolumeCorrection {
                smoothing: table.opt_number(rates[0]).unwrap_or(usual.smoothing),
                correction: table.opt_number(rates[1]).unwrap_or(usual.correction),
            }));
        }
        "gathered" => VolumeRule::Gathered,
        _ => VolumeRule::Jacobian,
    };
    match rates.into_iter().find(|key| table.has(key)) {
        Some(key) => {
            Err(table.error_at_key(key, format!("\"{key}\" is for volume = \"corrected\" only")))
        }
        None => Ok(rule),
    }
}

fn read_snow<const D: usize>(table: &Reader<'_>) -> Result<Snow, SceneError> {
    let (lambda, mu) = read_moduli::<D>(table)?;
    Ok(Snow {
        lambda,
        mu,
        critical_compression: table.number("critical_compression")?,
        critical_stretch: table.number("critical_stretch")?,
        hardening: table.number("hardening")?,
        hardening_range: table.vector("hardening_range")?,
        plastic_jacobian_range: table.vector("plastic_jacobian_range")?,
        hardening_from: if table.text("hardening_from")? == "previous" {
            HardeningFrom::Previous
        } else {
            HardeningFrom::Updated
        },
    })
}

/// (λ, μ) from whichever pair is given.
fn read_moduli<const D: usize>(table: &Reader<'_>) -> Result<(f64, f64), SceneError> {
    let given: Vec<&str> = MODULI
        .as_flattened()
        .iter()
        .copied()
        .filter(|key| table.has(key))
        .collect();
    let pairs = || MODULI.map(|[a, b]| format!("{a} and {b}")).join("; or ");
    let Some(pair) = MODULI
        .iter()
        .find(|pair| given.first().is_some_and(|key| pair.contains(key)))
    else {
        return Err(table
            .error("this material has no moduli")
            .hint(format!("give {}", pairs())));
    };
    if let Some(other) = given.iter().find(|key| !pair.contains(key)) {
        return Err(table
            .error_at_key(
                other,
                format!("\"{other}\" does not go with \"{}\"", given[0]),
            )
            .hint(format!("give {}", pairs())));
    }
    if let Some(missing) = pair.iter().find(|key| !table.has(key)) {
        return Err(table.error_at_key(
            given[0],
            format!("\"{}\" needs \"{missing}\" beside it", given[0]),
        ));
    }
    let (a, b) = (table.number(pair[0])?, table.number(pair[1])?);
    let d = D as f64;
    let (lambda, mu) = match pair[0] {
        "youngs_modulus" => lame(a, b),
        "bulk_modulus" => (a - 2.0 * b / d, b),
        _ => (a, b),
    };
    if lambda + 2.0 * mu / d <= 0.0 {
        return Err(table.error_at(
            pair[0],
            format!(
                "these moduli have a bulk modulus of {:.4e} Pa; it must be above 0",
                lambda + 2.0 * mu / d
            ),
        ));
    }
    Ok((lambda, mu))
}
