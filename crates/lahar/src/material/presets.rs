//! Materials by name, with the sources of their numbers. Each model's file has its own presets.

use super::{Material, Model, PRESETS};

/// A named material. Scene files offer the same ones: `preset = "water"`.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// One sentence on the substance, with the source of the numbers.
    pub about: &'static str,
    /// Density at rest \[kg/m³\].
    pub density: f64,
    /// Makes the model. Fluids take the bulk modulus ρ₀c² of the sound speed c to simulate with
    /// \[m/s\]; solids do not read it.
    pub(super) model: fn(density: f64, sound_speed: f64) -> Model,
}

impl Preset {
    /// All presets, grouped by model.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        PRESETS.iter().copied().flatten()
    }
}

/// Returns the material of the preset called `name`, or `None` if there is no such preset; see
/// [`Preset::all`].
///
/// Fluids get the bulk modulus ρ₀c² of the `sound_speed` c to simulate with \[m/s\], for which ten
/// times the largest speed of the flow is usual. Solids have their own stiffness.
pub fn preset(name: &str, sound_speed: f64) -> Option<Material> {
    let preset = Preset::all().find(|preset| preset.name == name)?;
    Some(Material {
        name: name.to_owned(),
        density: preset.density,
        model: (preset.model)(preset.density, sound_speed),
    })
}
