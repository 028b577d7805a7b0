//! The strains that models share: how much of a deformation each of them remembers.

use super::variables::{DEFORMATION_GRADIENT, JACOBIAN, Rest, Variable, Variables};
use crate::math::near_one::power_minus_one;
use crate::math::{Matrix, Real};
use crate::variables;

/// The internal variables of a model, with what they say of the deformation.
pub trait Strain<R: Real, const D: usize>: Variables<R, D> {
    /// Returns the strain of the deformation gradient I + `h`, other variables at rest. A strain that
    /// stores only part of a deformation drops the remainder.
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self;
    /// Sets hidden variables from the others, for a particle that starts with given values.
    #[inline(always)]
    fn with_hidden_variables(self) -> Self {
        self
    }
    /// Returns H = F − I. A strain that stores only J returns (J^(1/D) − 1) I, and −I for J < 0.
    fn displacement_gradient(&self) -> Matrix<R, D>;
    /// Returns J − 1, of the elastic part for plastic models.
    fn jacobian_minus_one(&self) -> R;
    /// Returns J_P − 1, zero for models without plastic flow.
    #[inline(always)]
    fn plastic_jacobian_minus_one(&self) -> R {
        self.jacobian_minus_one().zero()
    }
}

/// J_P, the determinant of the plastic part of the deformation gradient.
pub const PLASTIC_JACOBIAN: Variable = Variable::scalar("plastic_J", "1", Rest::One);

/// J_P as hardening reads it.
const HARDENING_JACOBIAN: Variable = Variable::scalar("hardening_J", "1", Rest::One).hidden();

variables! {
    /// The relative change of volume.
    pub struct Dilatation<R> {
        /// The Jacobian less one, J − 1.
        jacobian_minus_one: R = JACOBIAN,
    }
}

variables! {
    /// The whole deformation.
    pub struct DisplacementGradient<R, const D: usize> {
        /// H = F − I.
        h: Matrix<R, D> = DEFORMATION_GRADIENT,
    }
}

variables! {
    /// The elastic deformation and the plastic change of volume.
    pub struct PlasticGradient<R, const D: usize> {
        /// H = F_E − I.
        h: Matrix<R, D> = DEFORMATION_GRADIENT,
        /// J_P − 1, J_P the determinant of the plastic deformation gradient.
        plastic_jacobian_minus_one: R = PLASTIC_JACOBIAN,
        /// J_P − 1 as hardening reads it; see [`HardeningFrom`](super::HardeningFrom).
        hardening_jacobian_minus_one: R = HARDENING_JACOBIAN,
    }
}

impl<R: Real, const D: usize> DisplacementGradient<R, D> {
    /// F ← (I + A) F, A = Δt ∂v/∂x: equation (7) before any return mapping.
    #[inline(always)]
    pub fn moved(self, increment: Matrix<R, D>) -> Self {
        Self {
            h: self.h + (increment + increment * self.h), // (7)
        }
    }
}

/// FFᵀ − I, from H.
#[inline(always)]
pub(super) fn left_strain<R: Real, const D: usize>(h: Matrix<R, D>) -> Matrix<R, D> {
    (h + h.transpose()) + h * h.transpose()
}

/// A bound on the largest eigenvalue of FFᵀ; exact in 2D and at rest.
///
/// The mean of the eigenvalues plus √(D−1) of their standard deviations (H. Wolkowicz & G. Styan,
/// "Bounds for eigenvalues using traces", Linear Algebra Appl. 29, 1980).
#[inline(always)]
pub(super) fn largest_squared_stretch<R: Real, const D: usize>(h: Matrix<R, D>) -> R {
    let strain = left_strain(h);
    let mean = strain.trace() * h[(0, 0)].lit(1.0 / D as f64);
    let deviator = strain - Matrix::scaled_identity(mean);
    let spread = deviator.squared_norm() * mean.lit((D as f64 - 1.0) / D as f64);
    mean.one() + mean + spread.sqrt()
}

impl<R: Real, const D: usize> Strain<R, D> for Dilatation<R> {
    #[inline(always)]
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self {
        Self {
            jacobian_minus_one: h.determinant_of_identity_plus_minus_one(),
        }
    }
    #[inline(always)]
    fn displacement_gradient(&self) -> Matrix<R, D> {
        let e = self.jacobian_minus_one;
        Matrix::scaled_identity(power_minus_one(e.max(-e.one()), 1.0 / D as f64))
    }
    #[inline(always)]
    fn jacobian_minus_one(&self) -> R {
        self.jacobian_minus_one
    }
}

impl<R: Real, const D: usize> Strain<R, D> for DisplacementGradient<R, D> {
    #[inline(always)]
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self {
        Self { h }
    }
    #[inline(always)]
    fn displacement_gradient(&self) -> Matrix<R, D> {
        self.h
    }
    #[inline(always)]
    fn jacobian_minus_one(&self) -> R {
        self.h.determinant_of_identity_plus_minus_one()
    }
}

impl<R: Real, const D: usize> Strain<R, D> for PlasticGradient<R, D> {
    #[inline(always)]
    fn from_displacement_gradient(h: Matrix<R, D>) -> Self {
        let zero = h[(0, 0)].zero();
        Self {
            h,
            plastic_jacobian_minus_one: zero,
            hardening_jacobian_minus_one: zero,
        }
    }
    #[inline(always)]
    fn with_hidden_variables(self) -> Self {
        Self {
            hardening_jacobian_minus_one: self.plastic_jacobian_minus_one,
            ..self
        }
    }
    #[inline(always)]
    fn displacement_gradient(&self) -> Matrix<R, D> {
        self.h
    }
    #[inline(always)]
    fn jacobian_minus_one(&self) -> R {
        self.h.determinant_of_identity_plus_minus_one()
    }
    #[inline(always)]
    fn plastic_jacobian_minus_one(&self) -> R {
        self.plastic_jacobian_minus_one
    }
}
