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
//! | `constitutive.rs` | the trait of all models |
//! | `variables.rs`, `strain.rs` | declared tables of internal variables |
//! | `law.rs` | a model on columns of storage, as the engine calls it |

mod constitutive;
mod corotated;
pub mod fluid;
mod law;
mod linear_elastic;
mod moduli;
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
            /// Elastoplastic snow that hardens.
            Snow "snow" snow,
            /// Linear elasticity for small strains and rotations.
            LinearElastic "linear_elastic" linear_elastic,
        }
    };
}

pub use constitutive::ConstitutiveModel;
pub use fluid::{
    Eos, FluidModel, JacobianUpdate, SMALLEST_JACOBIAN, TORN, ViscousStress, VolumeCorrection,
    VolumeRule,
    rheology::{self, HerschelBulkley, Rheology},
};
pub use law::{IsaToken, Law, ParticleEnergy, ParticleState, law};
pub(crate) use law::{built_in, load_matrix, load_vector, start};
pub use moduli::{lame, lame_from_bulk_and_shear};
pub use neo_hookean::LOGARITHM_ENDS;
pub use presets::Preset;
pub use snow::HardeningFrom;
pub use strain::{Dilatation, DisplacementGradient, PLASTIC_JACOBIAN, PlasticGradient, Strain};
#[doc(hidden)]
pub use variables::Entries;
pub use variables::{DEFORMATION_GRADIENT, JACOBIAN, Rest, Variable, Variables};
pub(crate) use variables::{find, values};

/// A scene's named choice of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in scenes and outputs.
    pub name: String,
    /// Density at rest \[kg/m³; kg/m² in 2D per meter of depth\].
    pub density: f64,
    /// The constitutive model.
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

        /// Returns the names of all presets, grouped by model, each with a sentence on the substance
        /// and the source of its numbers.
        ///
        /// ```
        /// let (name, about) = lahar::material::presets().next().unwrap();
        /// assert_eq!(name, "water");
        /// assert!(about.contains("998.2 kg/m³"));
        /// ```
        pub fn presets() -> impl Iterator<Item = (&'static str, &'static str)> {
            core::iter::empty()
                $(.chain($module::PRESETS.iter().map(|preset| (preset.name, preset.about))))*
        }

        /// Returns the model and the density \[kg/m³\] of the preset called `name`.
        fn find_preset(name: &str, sound_speed: f64) -> Option<(f64, Model)> {
            None$(.or_else(|| {
                let (density, law) = presets::find($module::PRESETS, name, sound_speed)?;
                Some((density, Model::$law(law)))
            }))*
        }

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

/// Returns the material of the preset called `name`, or `None` if there is no such preset; see
/// [`presets`].
///
/// Fluids get the bulk modulus ρ₀c² of the `sound_speed` c to simulate with \[m/s\], for which ten
/// times the largest speed of the flow is usual. Solids have their own stiffness.
///
/// ```
/// let water = lahar::material::preset("water", 20.0).unwrap();
/// assert_eq!(water.density, 998.2);
/// assert!((water.sound_speed() - 20.0).abs() < 1e-12);
/// ```
pub fn preset(name: &str, sound_speed: f64) -> Option<Material> {
    let (density, model) = find_preset(name, sound_speed)?;
    Some(Material {
        name: name.to_owned(),
        density,
        model,
    })
}

/// The most variables that all models together have.
const MOST_VARIABLES: usize = 64;

const SHOWN: ([Variable; MOST_VARIABLES], usize) = variables::shown(TABLES);

/// The internal variables of the built-in models that snapshots show besides J and F.
pub(crate) const SHOWN_VARIABLES: &[Variable] = SHOWN.0.split_at(SHOWN.1).0;

impl Model {
    /// Returns the internal variables that the model stores.
    ///
    /// ```
    /// use lahar::Model;
    /// use lahar::material::{PLASTIC_JACOBIAN, Snow};
    ///
    /// assert!(Model::Snow(Snow::default()).variables().contains(&PLASTIC_JACOBIAN));
    /// ```
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
