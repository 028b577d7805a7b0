//! Constitutive models: from deformation to stress, and what a substep does to deformation.
//!
//! A model is one file that implements [`ConstitutiveModel`], once, for every kind of number and
//! dimension. Scene files name models by the closed enum [`Model`].

mod corotated;
mod fluid;
mod law;
mod model;
mod neo_hookean;
mod none;
pub mod presets;
pub mod rheology;
mod snow;
mod strain;

pub use corotated::Corotated;
pub use fluid::{Eos, Fluid, JacobianUpdate, SMALLEST_JACOBIAN, TORN, ViscousStress};
pub use law::{IsaToken, Law, ParticleEnergy, ParticleState, law};
pub(crate) use law::{built_in, load_matrix, load_vector};
pub use neo_hookean::{LOGARITHM_ENDS, NeoHookean};
pub use none::Dust;
pub use presets::{PRESETS, preset};
pub use rheology::{HerschelBulkley, Rheology};
pub use snow::{HardeningFrom, Snow};
pub use strain::{Dilatation, DisplacementGradient, PlasticGradient, Strain};

use crate::math::{Matrix, Real};
use strain::{largest_squared_stretch, left_strain};

/// A law: stress and energy from strain, and how strain follows the motion.
///
/// Formulas are generic over [`Real`]: they run on one scalar or on a register of particles.
/// Branch by [`Real::select`], not by `if`.
pub trait ConstitutiveModel<const D: usize>: Copy + Send + Sync {
    /// What the model remembers of a particle's deformation.
    type Strain<R: Real>: Strain<R, D>;

    /// Kirchhoff stress τ = (∂Φ/∂F) Fᵀ = J σ \[Pa\], plus viscous stress of the velocity gradient
    /// (`velocity_gradient[(i, j)]` = ∂v_i/∂x_j \[1/s\]).
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: Self::Strain<R>,
        velocity_gradient: Matrix<R, D>,
    ) -> Matrix<R, D>;

    /// The strain after a substep: (7), then the return mapping. `increment` is Δt ∂v/∂x.
    fn advance<R: Real>(&self, strain: Self::Strain<R>, increment: Matrix<R, D>)
    -> Self::Strain<R>;

    /// Energy Φ per rest volume \[Pa\].
    fn energy_density<R: Real>(&self, strain: Self::Strain<R>) -> R;

    /// An upper bound on (speed of elastic waves)² × density at rest \[Pa\]: the largest
    /// stiffness ∂²Φ/∂F² in this state, in the current configuration.
    fn wave_modulus<R: Real>(&self, strain: Self::Strain<R>) -> R;

    /// Where J comes from. For models whose strain is a [`Dilatation`]; others are not asked.
    fn volume_rule(&self) -> VolumeRule {
        VolumeRule::Jacobian
    }

    /// Bulk modulus at rest \[Pa\], of a law that can be made stiffer while it runs.
    fn bulk_modulus(&self) -> Option<f64> {
        None
    }

    /// The same law with another bulk modulus \[Pa\].
    fn with_bulk_modulus(self, _: f64) -> Self {
        self
    }

    /// The strain at which this law has the pressure that `before` has at `strain`.
    fn at_same_pressure(&self, strain: Self::Strain<f64>, _before: &Self) -> Self::Strain<f64> {
        strain
    }

    /// Dynamic viscosity \[Pa s\], the largest of the law's (of shear or of longitudinal waves),
    /// for the time step.
    fn viscosity(&self) -> f64 {
        0.0
    }
}

/// Where the J of a fluid comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum VolumeRule {
    /// It follows the motion of the particle, (7).
    #[default]
    Jacobian,
    /// It follows the motion, and now and then is set right by what the grid says, (7h) and (7i).
    Corrected(VolumeCorrection),
    /// It is gathered from the grid before each substep, (7g): no memory, and so no drift; but a free
    /// surface, where the grid is half empty, counts as expanded.
    Gathered,
}

/// How fast J is set right: per shear of the fluid, ∫ γ̇ dt. A fluid that does not deform is left alone: at
/// rest the unevenness of its particles is balanced by that of their J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeCorrection {
    /// J goes to the mean around the particle, (7h).
    pub smoothing: f64,
    /// J goes to where particles fill the grid as at rest, (7i).
    pub correction: f64,
}

impl Default for VolumeCorrection {
    /// Up to twenty times the smoothing and three times the correction keep a slosh's volume as well
    /// (docs/water.md).
    fn default() -> Self {
        Self {
            smoothing: 5.0,
            correction: 3.0,
        }
    }
}

/// A scene's named choice of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// As scenes and outputs call it.
    pub name: String,
    /// Density at rest \[kg/m³; kg/m² in 2D per metre of depth\].
    pub density: f64,
    /// The law.
    pub model: Model,
}

/// The models that scene files can name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// No stress at all.
    Dust(Dust),
    /// Weakly compressible fluid.
    Fluid(Fluid),
    /// Fixed corotated elasticity ("jelly").
    Corotated(Corotated),
    /// Neo-Hookean elasticity.
    NeoHookean(NeoHookean),
    /// Elastoplastic snow.
    Snow(Snow),
}

/// Runs `$body` with `$law` bound to the law inside the [`Model`] `$model`, compiled once for each
/// type of law: the one place where a run-time choice of a law becomes static dispatch.
///
/// ```text
/// for_model!(material.model, law => self.scatter_with(&law))
/// ```
macro_rules! for_model {
    ($model:expr, $law:ident => $body:expr) => {
        match $model {
            $crate::material::Model::Dust($law) => $body,
            $crate::material::Model::Fluid($law) => $body,
            $crate::material::Model::Corotated($law) => $body,
            $crate::material::Model::NeoHookean($law) => $body,
            $crate::material::Model::Snow($law) => $body,
        }
    };
}
pub(crate) use for_model;

/// Lamé's parameters from Young's modulus \[Pa\] and Poisson's ratio: (λ, μ) \[Pa\]. In 2D these
/// are those of plane strain.
pub fn lame(youngs_modulus: f64, poisson_ratio: f64) -> (f64, f64) {
    let (e, nu) = (youngs_modulus, poisson_ratio);
    (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    )
}

/// Lamé's parameters from the bulk modulus K and the shear modulus G: (K − ⅔G, G) \[Pa\].
pub fn lame_from_bulk_and_shear(bulk_modulus: f64, shear_modulus: f64) -> (f64, f64) {
    (bulk_modulus - shear_modulus * 2.0 / 3.0, shear_modulus)
}
