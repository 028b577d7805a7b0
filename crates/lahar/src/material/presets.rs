//! Named materials with the sources of their numbers, so that a scene can say `preset = "water"`.

use super::rheology::CREEP_RATE;
use super::{Corotated, Fluid, HerschelBulkley, Material, Model, NeoHookean, Rheology, Snow};

/// The presets: name, and one sentence with the source.
pub const PRESETS: &[(&str, &str)] = &[
    (
        "water",
        "Fresh water at 20 °C: 998.2 kg/m³, 1.002 mPa s (IAPWS; CRC Handbook of Chemistry and Physics).",
    ),
    (
        "sea_water",
        "Sea water at 20 °C with 35 g/kg of salt: 1024.8 kg/m³ (UNESCO equation of state 1980), \
         1.072 mPa s (Landolt–Börnstein V/3a, 1986).",
    ),
    (
        "honey",
        "Clover honey with 16 % of water near 20 °C: 19 Pa s (J. A. Munro, J. Econ. Entomol. 36, \
         1943), 1420 kg/m³.",
    ),
    (
        "mercury",
        "Mercury at 25 °C: 13 534 kg/m³, 1.526 mPa s (CRC Handbook of Chemistry and Physics).",
    ),
    (
        "ketchup",
        "Tomato ketchup at 25 °C: 32 Pa + 18.7 Pa sⁿ, n = 0.27 (J. F. Steffe, Rheological Methods in Food \
         Process Engineering, 1996, after Higgs and Norrington 1971); 1140 kg/m³ is a choice.",
    ),
    (
        "mud",
        "Water with 27.4 % of clay by volume: 1200 kg/m³, 25 Pa, 0.07 Pa s, a Bingham fluid (D. Komatina and M. \
         Jovanović, J. Hydraulic Res. 35, 1997).",
    ),
    (
        "jelly",
        "Gelatin, one part to twenty of water: E = 4.3 kPa (J. E. Bonavia et al., arXiv:2512.20502); \
         ν = 0.45 rather than nearly ½, and 1010 kg/m³, are choices.",
    ),
    (
        "rubber",
        "Vulcanised natural rubber: 930 kg/m³, E = 2 MPa (M. F. Ashby, Materials Selection in \
         Mechanical Design, 1.5 to 2.5 MPa); ν = 0.49 rather than 0.4999 keeps the time step bearable.",
    ),
    (
        "snow",
        "The snow of Stomakhin et al. 2013: 400 kg/m³, E = 140 kPa, ν = 0.2, θc = 2.5 %, θs = 0.75 %, ξ = 10.",
    ),
];

/// The preset called `name`, if there is one; see [`PRESETS`].
///
/// Fluids get the bulk modulus ρ₀c² of the `sound_speed` c to simulate with \[m/s\], ten times the
/// largest speed of the flow being usual; solids have their own, and leave it unread.
pub fn preset(name: &str, sound_speed: f64) -> Option<Material> {
    let fluid = |density: f64, viscosity: f64| {
        let law = Fluid {
            viscosity,
            ..Fluid::water_like(density, sound_speed)
        };
        (density, Model::Fluid(law))
    };
    let yielding = |density: f64, yield_stress, consistency, flow_index| {
        let law = Fluid {
            viscosity: 0.0,
            rheology: Rheology::HerschelBulkley(HerschelBulkley {
                yield_stress,
                consistency,
                flow_index,
                creep_rate: CREEP_RATE,
            }),
            ..Fluid::water_like(density, sound_speed)
        };
        (density, Model::Fluid(law))
    };
    let (density, model) = match name {
        "water" => fluid(998.2, 1.002e-3),
        "sea_water" => fluid(1024.8, 1.072e-3),
        "honey" => fluid(1420.0, 19.0),
        "mercury" => fluid(13_534.0, 1.526e-3),
        "ketchup" => yielding(1140.0, 32.0, 18.7, 0.27),
        "mud" => yielding(1200.0, 25.0, 0.07, 1.0),
        "jelly" => (1010.0, Model::Corotated(Corotated::new(4.3e3, 0.45))),
        "rubber" => (930.0, Model::NeoHookean(NeoHookean::new(2e6, 0.49))),
        "snow" => (400.0, Model::Snow(Snow::default())),
        _ => return None,
    };
    Some(Material {
        name: name.to_owned(),
        density,
        model,
    })
}
