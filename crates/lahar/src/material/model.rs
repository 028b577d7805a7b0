//! What can be asked of a model or material whose type is known at run time only.

use super::{ConstitutiveModel, Material, Model, Strain, for_model};

impl Model {
    /// The names of all models, as scene files spell them.
    pub const NAMES: [&str; 5] = ["none", "fluid", "corotated", "neo_hookean", "snow"];

    /// As scene files spell it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Dust(_) => "none",
            Self::Fluid(_) => "fluid",
            Self::Corotated(_) => "corotated",
            Self::NeoHookean(_) => "neo_hookean",
            Self::Snow(_) => "snow",
        }
    }

    /// (Speed of pressure waves)² × density, at rest \[Pa\]; the same in 2D and 3D.
    pub fn rest_wave_modulus(&self) -> f64 {
        fn at_rest<M: ConstitutiveModel<3>>(law: &M) -> f64 {
            law.wave_modulus(<M::Strain<f64> as Strain<f64, 3>>::rest(0.0))
        }
        for_model!(self, law => at_rest(law))
    }
}

impl Material {
    /// Speed of pressure waves at rest \[m/s\].
    pub fn sound_speed(&self) -> f64 {
        (self.model.rest_wave_modulus() / self.density).sqrt()
    }
}
