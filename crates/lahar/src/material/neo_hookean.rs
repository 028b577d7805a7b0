//! Neo-Hookean elasticity: rubber and other solids that are stretched far.
//!
//! ln J is defined for J > 0 only, but a simulated particle may be pressed past J = 0. Below
//! [`NeoHookean::logarithm_ends`] the energy continues ln J by its tangent, and the stress follows from
//! the energy. The law is thus defined for every F, and pushes back a particle that is turned inside
//! out.

use super::constitutive::ConstitutiveModel;
use super::moduli::lame;
use super::presets::Preset;
use super::strain::{DisplacementGradient, Strain, largest_squared_stretch, left_strain};
use crate::math::near_one::{ln_1p, minus_ln_1p};
use crate::math::{Matrix, Real};

/// The default of [`NeoHookean::logarithm_ends`].
pub const LOGARITHM_ENDS: f64 = 0.1;

/// τ = μ(FFᵀ−I) + λ ln J I; Φ = ½μ(|F|²−d) − μ ln J + ½λ ln²J (MPM course 2016).
///
/// For J < a = `logarithm_ends`, Φ has ln a + (J−a)/a in place of ln J, and τ = (∂Φ/∂F) Fᵀ.
/// Speed of pressure waves at rest: √((λ+2μ)/ρ₀).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// Lamé's first parameter λ \[Pa\].
    pub lambda: f64,
    /// Shear modulus μ \[Pa\].
    pub mu: f64,
    /// a, the J below which ln J continues as a straight line; above 0.
    pub logarithm_ends: f64,
}

/// The preset of a tough solid.
pub(super) const PRESETS: &[Preset<NeoHookean>] = &[Preset {
    name: "rubber",
    about: "Vulcanized natural rubber: 930 kg/m³, E = 2 MPa (M. F. Ashby, Materials Selection in \
            Mechanical Design, 1.5 to 2.5 MPa); ν = 0.49 rather than 0.4999 keeps the time step bearable.",
    density: 930.0,
    model: |_, _| NeoHookean::new(2e6, 0.49),
}];

impl NeoHookean {
    /// Creates the law of Young's modulus \[Pa\] and Poisson's ratio, −1 < ν < ½.
    pub fn new(youngs_modulus: f64, poisson_ratio: f64) -> Self {
        let (lambda, mu) = lame(youngs_modulus, poisson_ratio);
        Self::from_lame(lambda, mu)
    }

    /// Creates the law of Lamé's first parameter λ and the shear modulus μ \[Pa\].
    pub fn from_lame(lambda: f64, mu: f64) -> Self {
        Self {
            lambda,
            mu,
            logarithm_ends: LOGARITHM_ENDS,
        }
    }

    /// Splits J − 1 in two: the part down to a − 1, and (J−a)/a below a, 0 above.
    #[inline(always)]
    fn split<R: Real>(&self, jacobian_minus_one: R) -> (R, R) {
        let e = jacobian_minus_one;
        let end = e.lit(self.logarithm_ends - 1.0);
        let beyond = (e - end).min(e.zero()) * e.lit(1.0 / self.logarithm_ends);
        (e.max(end), beyond)
    }
}

impl<const D: usize> ConstitutiveModel<D> for NeoHookean {
    type Strain<R: Real> = DisplacementGradient<R, D>;

    #[inline(always)]
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: DisplacementGradient<R, D>,
        _: Matrix<R, D>,
    ) -> Matrix<R, D> {
        let (e, beyond) = self.split(strain.jacobian_minus_one());
        let ln_j = ln_1p(e) + beyond;
        let (lambda, mu) = (ln_j.lit(self.lambda), ln_j.lit(self.mu));
        let pressure = lambda * ln_j * (beyond + beyond.one()) - mu * beyond;
        left_strain(strain.h) * mu + Matrix::scaled_identity(pressure)
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
        let (e, beyond) = self.split(strain.jacobian_minus_one());
        let ln_j = ln_1p(e) + beyond;
        let half = e.lit(0.5);
        // ½(|F|² − d) − ln J = tr H + ½|H|² − ln J. Its terms of first order cancel: tr H is J − 1
        // minus the other invariants of H, and (tr H)² minus twice the second invariant is tr(H²).
        let symmetric = (h + h.transpose()) * half;
        let third = match D {
            3 => h.determinant(),
            _ => e.zero(),
        };
        let j_less_ln_j = minus_ln_1p(e) + beyond * e.lit(self.logarithm_ends - 1.0);
        let distortion =
            symmetric.squared_norm() - h.trace() * h.trace() * half - third + j_less_ln_j;
        distortion * e.lit(self.mu) + ln_j * ln_j * e.lit(0.5 * self.lambda)
    }

    /// μ|Fᵀn|² + μ + λ(1 − ln J), with n along the largest stretch. The last two terms are J² times
    /// the second derivative by J of the terms of Φ with ln J.
    #[inline(always)]
    fn wave_modulus<R: Real>(&self, strain: DisplacementGradient<R, D>) -> R {
        let (e, beyond) = self.split(strain.jacobian_minus_one());
        let ln_j = ln_1p(e) + beyond;
        let (one, lambda, mu) = (ln_j.one(), ln_j.lit(self.lambda), ln_j.lit(self.mu));
        // Beyond the end of the logarithm, λ(J/a)² ≤ λ(1 + ((J−a)/a)²).
        let volume = mu + lambda * (one - ln_j + beyond * beyond);
        let volume = volume.max(one.zero());
        largest_squared_stretch(strain.h) * mu + volume
    }
}
