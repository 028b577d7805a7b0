//! Linear elasticity, the law of textbooks: exact solutions for small strains are solutions of it.
//!
//! The strain is e = sym(F − I), which takes a rotation for a deformation: turned by the angle θ, an
//! undeformed particle has the strain (cos θ − 1) I in the plane of rotation. The law is therefore
//! frame indifferent only to first order in the rotation. Bodies that turn need
//! [`Corotated`](super::Corotated), which has the same limit for small strains.

use super::constitutive::ConstitutiveModel;
use super::moduli::lame;
use super::presets::Preset;
use super::strain::{DisplacementGradient, largest_squared_stretch};
use crate::math::{Matrix, Real};

/// σ = λ tr(e) I + 2μ e with e = ½(H + Hᵀ), H = F − I; Φ = μ|e|² + ½λ tr²(e).
///
/// P = ∂Φ/∂F = σ(e) is the first Piola–Kirchhoff stress, and τ = P Fᵀ. All three stresses agree to
/// first order. τ is symmetric to first order only, so that angular momentum is conserved to that
/// order. Speed of pressure waves at rest: √((λ+2μ)/ρ₀).
///
/// ```
/// use lahar::material::{ConstitutiveModel, DisplacementGradient, LinearElastic};
/// use lahar::math::{Matrix, Vector};
///
/// let law = LinearElastic::new(1e4, 0.25); // λ = μ = 4 kPa
/// let strain = DisplacementGradient { h: Matrix::from_diagonal(Vector([1e-3_f64, 0.0, 0.0])) };
/// let stress = law.kirchhoff_stress(strain, Matrix::scaled_identity(0.0));
/// assert!((stress[(1, 1)] - 4.0).abs() < 1e-12); // λ e
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic {
    /// Lamé's first parameter λ \[Pa\].
    pub lambda: f64,
    /// Shear modulus μ \[Pa\].
    pub mu: f64,
}

/// There are none: substances are described by laws that may turn.
pub(super) const PRESETS: &[Preset<LinearElastic>] = &[];

impl LinearElastic {
    /// Creates the law of Young's modulus \[Pa\] and Poisson's ratio, −1 < ν < ½.
    pub fn new(youngs_modulus: f64, poisson_ratio: f64) -> Self {
        let (lambda, mu) = lame(youngs_modulus, poisson_ratio);
        Self { lambda, mu }
    }
}

/// The small strain e = sym H.
#[inline(always)]
fn small_strain<R: Real, const D: usize>(h: Matrix<R, D>) -> Matrix<R, D> {
    (h + h.transpose()) * h[(0, 0)].lit(0.5)
}

impl<const D: usize> ConstitutiveModel<D> for LinearElastic {
    type Strain<R: Real> = DisplacementGradient<R, D>;

    #[inline(always)]
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: DisplacementGradient<R, D>,
        _: Matrix<R, D>,
    ) -> Matrix<R, D> {
        let h = strain.h;
        let mean = h.trace() * h[(0, 0)].lit(self.lambda);
        let two_mu = mean.lit(2.0 * self.mu);
        let first_piola = Matrix::scaled_identity(mean) + small_strain(h) * two_mu;
        first_piola + first_piola * h.transpose() // P Fᵀ
    }

    #[inline(always)]
    fn advance<R: Real>(
        &self,
        strain: DisplacementGradient<R, D>,
        increment: Matrix<R, D>,
    ) -> DisplacementGradient<R, D> {
        strain.moved(increment)
    }

    #[inline(always)]
    fn energy_density<R: Real>(&self, strain: DisplacementGradient<R, D>) -> R {
        let h = strain.h;
        let trace = h.trace();
        small_strain(h).squared_norm() * trace.lit(self.mu)
            + trace * trace * trace.lit(0.5 * self.lambda)
    }

    /// (λ + 2μ)|Fᵀn|² with n along the largest stretch: the largest stiffness λ + 2μ in the reference
    /// configuration, in the current one.
    #[inline(always)]
    fn wave_modulus<R: Real>(&self, strain: DisplacementGradient<R, D>) -> R {
        let modulus = (self.lambda + 2.0 * self.mu).max(self.mu);
        largest_squared_stretch(strain.h) * strain.h[(0, 0)].lit(modulus)
    }
}
