//! The trait that every constitutive model implements.

use super::fluid::model::FluidModel;
use super::strain::Strain;
use crate::math::{Matrix, Real};

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
