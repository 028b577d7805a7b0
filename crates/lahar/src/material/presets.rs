//! Named materials, with the sources of their numbers. Each model's file has its own presets.

/// A named material of the model `M`. Scene files offer the same ones: `preset = "water"`.
#[derive(Clone, Copy, Debug)]
pub struct Preset<M> {
    /// The name in scene files.
    pub name: &'static str,
    /// One sentence on the substance, with the source of the numbers.
    pub about: &'static str,
    /// Density at rest \[kg/m³\].
    pub density: f64,
    /// Makes the model. Fluids take the bulk modulus ρ₀c² of the sound speed c to simulate with
    /// \[m/s\]; solids do not read it.
    pub(super) model: fn(density: f64, sound_speed: f64) -> M,
}

/// Returns the preset called `name` as a density \[kg/m³\] and a model.
pub(super) fn find<M>(presets: &[Preset<M>], name: &str, sound_speed: f64) -> Option<(f64, M)> {
    let preset = presets.iter().find(|preset| preset.name == name)?;
    let model = (preset.model)(preset.density, sound_speed);
    Some((preset.density, model))
}
