//! What can be asked of a model or material whose type is known at run time only.

use super::{ConstitutiveModel, Material, Model, Strain, for_model};
use crate::particles::Field;

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

    /// Whether `field` says something of particles of this model that others do not: F of what remembers J only is
    /// J^(1/D) I, and J_P of what does not yield is 1.
    pub fn informs(&self, field: Field) -> bool {
        fn remembers<M: ConstitutiveModel<3>>(_: &M, field: Field) -> bool {
            match field {
                Field::DeformationGradient => {
                    <M::Strain<f64> as Strain<f64, 3>>::JACOBIAN_COLUMN.is_none()
                }
                Field::PlasticJacobian => <M::Strain<f64> as Strain<f64, 3>>::IS_PLASTIC,
                _ => true,
            }
        }
        for_model!(self, law => remembers(law, field))
    }
}

impl Material {
    /// Speed of pressure waves at rest \[m/s\].
    pub fn sound_speed(&self) -> f64 {
        (self.model.rest_wave_modulus() / self.density).sqrt()
    }
}
