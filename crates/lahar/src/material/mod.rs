//! Constitutive models: from deformation to stress, and what a substep does to the deformation.
//!
//! A model is one file with a type that implements [`ConstitutiveModel`], once for every kind of
//! number and dimension. The table [`models!`](crate::models) lists the models that scene files can
//! name. To add one, write its file, and add its module and its line of the table here.
//!
//! | file | |
//! |---|---|
//! | `none.rs`, `corotated.rs`, ... | one model each: law, parameters, presets |
//! | `fluid/` | the fluid, and all that concerns fluids only |
//! | `variables.rs`, `strain.rs` | declared tables of internal variables |
//! | `law.rs` | a model on columns of storage, as the engine calls it |

mod corotated;
pub mod fluid;
mod law;
mod linear_elastic;
mod neo_hookean;
mod none;
mod presets;
mod snow;
mod strain;
mod variables;

/// Passes the table of built-in models to a macro: for each model its documentation, its type, its
/// name in scene files, and its module.
///
/// The enum [`Model`](crate::Model), its names, static dispatch, presets, and the readers of scene
/// files all follow from this table.
#[doc(hidden)]
#[macro_export]
macro_rules! models {
    ([$($callback:tt)+] $($arguments:tt)*) => {
        $($callback)+! {
            $($arguments)*
            /// No stress: dust.
            Dust "none" none,
            /// Weakly compressible fluid.
            Fluid "fluid" fluid,
            /// Fixed corotated elasticity: jelly.
            Corotated "corotated" corotated,
            /// Neo-Hookean elasticity: rubber.
            NeoHookean "neo_hookean" neo_hookean,
            /// Elastoplastic snow.
            Snow "snow" snow,
            /// Linear elasticity for small strains and rotations.
            LinearElastic "linear_elastic" linear_elastic,
        }
    };
}

pub use fluid::{
    Eos, FluidModel, JacobianUpdate, SMALLEST_JACOBIAN, TORN, ViscousStress, VolumeCorrection,
    VolumeRule,
    rheology::{self, HerschelBulkley, Rheology},
};
pub use law::{IsaToken, Law, ParticleEnergy, ParticleState, law};
pub(crate) use law::{built_in, load_matrix, load_vector, start};
pub use neo_hookean::LOGARITHM_ENDS;
pub use presets::{Preset, preset};
pub use snow::HardeningFrom;
pub use strain::{Dilatation, DisplacementGradient, PLASTIC_JACOBIAN, PlasticGradient, Strain};
#[doc(hidden)]
pub use variables::Entries;
pub use variables::{DEFORMATION_GRADIENT, JACOBIAN, Rest, Variable, Variables};
pub(crate) use variables::{find, values};

use crate::math::{Matrix, Real};
use strain::{largest_squared_stretch, left_strain};

/// A law: stress and energy from strain, and how strain follows the motion.
///
/// Formulas are generic over [`Real`]: they run on one scalar or on a register of particles. They
/// branch by [`Real::select`], not by `if`.
pub trait ConstitutiveModel<const D: usize>: Copy + Send + Sync {
    /// The internal variables, what the model remembers of a particle.
    type Strain<R: Real>: Strain<R, D>;

    /// Returns the Kirchhoff stress τ = (∂Φ/∂F) Fᵀ = J σ \[Pa\], plus the viscous stress of the
    /// velocity gradient (`velocity_gradient[(i, j)]` = ∂v_i/∂x_j \[1/s\]).
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: Self::Strain<R>,
        velocity_gradient: Matrix<R, D>,
    ) -> Matrix<R, D>;

    /// Returns the strain after a substep: (7), then the return mapping. `increment` is Δt ∂v/∂x.
    fn advance<R: Real>(&self, strain: Self::Strain<R>, increment: Matrix<R, D>)
    -> Self::Strain<R>;

    /// Returns the energy Φ per rest volume \[Pa\].
    fn energy_density<R: Real>(&self, strain: Self::Strain<R>) -> R;

    /// Returns an upper bound on (speed of elastic waves)² × density at rest \[Pa\]: the largest
    /// stiffness ∂²Φ/∂F² in this state, in the current configuration.
    fn wave_modulus<R: Real>(&self, strain: Self::Strain<R>) -> R;

    /// Returns the largest dynamic viscosity of the law \[Pa s\], for shear or for longitudinal
    /// waves. It limits the time step.
    fn viscosity(&self) -> f64 {
        0.0
    }

    /// Returns the model as a fluid, or `None` if it is not one.
    fn fluid(&self) -> Option<&dyn FluidModel> {
        None
    }

    /// Returns the model as a fluid that can be changed, or `None` if it is not one.
    fn fluid_mut(&mut self) -> Option<&mut dyn FluidModel> {
        None
    }
}

/// A scene's named choice of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in scenes and outputs.
    pub name: String,
    /// Density at rest \[kg/m³; kg/m² in 2D per meter of depth\].
    pub density: f64,
    /// The law.
    pub model: Model,
}

impl Material {
    /// Returns the speed of pressure waves at rest \[m/s\].
    pub fn sound_speed(&self) -> f64 {
        (self.model.rest_wave_modulus() / self.density).sqrt()
    }
}

macro_rules! declare_models {
    ($($(#[$doc:meta])* $law:ident $name:literal $module:ident,)*) => {
        $(pub use $module::$law;)*

        /// The models that scene files can name.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Model {
            $($(#[$doc])* $law($law),)*
        }

        impl Model {
            /// The names of all models in scene files.
            pub const NAMES: &'static [&'static str] = &[$($name),*];

            /// Returns the name of this model in scene files.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$law(_) => $name,)*
                }
            }
        }

        /// The presets of each model.
        pub(super) const PRESETS: &[&[Preset]] = &[$($module::PRESETS),*];

        /// The internal variables of each model.
        const TABLES: &[&[Variable]] =
            &[$(<<$law as ConstitutiveModel<3>>::Strain<f64> as Variables<f64, 3>>::TABLE),*];
    };
}
crate::models!([declare_models]);

/// Evaluates `$body` with `$law` bound to the law inside the [`Model`] `$model`, compiled once for
/// each type of law. This is the one place where a choice of a law at run time becomes static
/// dispatch.
///
/// ```text
/// for_model!(material.model, law => self.scatter_with(&law))
/// ```
macro_rules! for_model {
    ($model:expr, $law:ident => $body:expr) => {
        $crate::models!([$crate::material::match_model] ($model, $law => $body))
    };
}
pub(crate) use for_model;

macro_rules! match_model {
    (
        ($model:expr, $law:ident => $body:expr)
        $($(#[$doc:meta])* $variant:ident $name:literal $module:ident,)*
    ) => {
        match $model {
            $($crate::material::Model::$variant($law) => $body,)*
        }
    };
}
pub(crate) use match_model;

/// The most variables that all models together have.
const MOST_VARIABLES: usize = 64;

const SHOWN: ([Variable; MOST_VARIABLES], usize) = variables::shown(TABLES);

/// The internal variables of the built-in models that snapshots show besides J and F.
pub(crate) const SHOWN_VARIABLES: &[Variable] = SHOWN.0.split_at(SHOWN.1).0;

impl Model {
    /// Returns the internal variables that the model stores.
    pub fn variables(&self) -> &'static [Variable] {
        fn of<M: ConstitutiveModel<3>>(_: &M) -> &'static [Variable] {
            <M::Strain<f64> as Variables<f64, 3>>::TABLE
        }
        for_model!(self, law => of(law))
    }

    /// Returns (speed of pressure waves)² × density at rest \[Pa\]; the same in 2D and 3D.
    pub fn rest_wave_modulus(&self) -> f64 {
        fn at_rest<M: ConstitutiveModel<3>>(law: &M) -> f64 {
            law.wave_modulus(<M::Strain<f64> as Variables<f64, 3>>::rest(0.0))
        }
        for_model!(self, law => at_rest(law))
    }
}

/// Returns Lamé's parameters (λ, μ) \[Pa\] of Young's modulus \[Pa\] and Poisson's ratio. In 2D they
/// are those of plane strain.
pub fn lame(youngs_modulus: f64, poisson_ratio: f64) -> (f64, f64) {
    let (e, nu) = (youngs_modulus, poisson_ratio);
    (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    )
}

/// Returns Lamé's parameters (K − ⅔G, G) \[Pa\] of the bulk modulus K and the shear modulus G.
pub fn lame_from_bulk_and_shear(bulk_modulus: f64, shear_modulus: f64) -> (f64, f64) {
    (bulk_modulus - shear_modulus * 2.0 / 3.0, shear_modulus)
}
