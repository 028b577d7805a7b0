//! Fixed corotated elasticity (Stomakhin 2012): "jelly".
//!
//! The stress is written in terms of H = F − I, so that small strains are not lost in the rounding
//! of the 1. With V = (FFᵀ)^½ = F Rᵀ,
//!
//!   2(F−R)Fᵀ = 2(V² − V) = (V² − I) + (V − I)² = (FFᵀ − I) + (F−R)(F−R)ᵀ.
//!
//! The first term needs H alone. The second is of second order in the strain, so that the rounding
//! of R does no harm.

use super::constitutive::ConstitutiveModel;
use super::moduli::lame;
use super::presets::Preset;
use super::strain::{DisplacementGradient, largest_squared_stretch, left_strain};
use crate::math::{Matrix, Real, polar};

/// τ = 2μ(F−R)Fᵀ + λ(J−1)J I; Φ = μ|F−R|² + ½λ(J−1)².
///
/// The law is defined for every F. A particle that is turned inside out is pushed back: R is then
/// still the nearest rotation.
/// Speed of pressure waves at rest: √((λ+2μ)/ρ₀).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corotated {
    /// Lamé's first parameter λ \[Pa\].
    pub lambda: f64,
    /// Shear modulus μ \[Pa\].
    pub mu: f64,
}

/// The preset of a soft solid.
pub(super) const PRESETS: &[Preset<Corotated>] = &[Preset {
    name: "jelly",
    about: "Gelatin, one part to twenty of water: E = 4.3 kPa (J. E. Bonavia et al., arXiv:2512.20502); \
            ν = 0.45 rather than nearly ½, and 1010 kg/m³, are choices.",
    density: 1010.0,
    model: |_, _| Corotated::new(4.3e3, 0.45),
}];

impl Corotated {
    /// Creates the law of Young's modulus \[Pa\] and Poisson's ratio, −1 < ν < ½.
    pub fn new(youngs_modulus: f64, poisson_ratio: f64) -> Self {
        let (lambda, mu) = lame(youngs_modulus, poisson_ratio);
        Self { lambda, mu }
    }

    /// Returns τ \[Pa\] with both moduli multiplied by `hardening`.
    #[inline(always)]
    pub(super) fn hardened_stress<R: Real, const D: usize>(
        &self,
        h: Matrix<R, D>,
        hardening: R,
    ) -> Matrix<R, D> {
        let e = h.determinant_of_identity_plus_minus_one();
        let second_order = square(from_rotation(h));
        let volume = e * (e + e.one()) * (hardening * e.lit(self.lambda));
        (left_strain(h) + second_order) * (hardening * e.lit(self.mu))
            + Matrix::scaled_identity(volume)
    }

    /// Returns Φ \[Pa\].
    #[inline(always)]
    pub(super) fn stored<R: Real, const D: usize>(&self, h: Matrix<R, D>) -> R {
        let e = h.determinant_of_identity_plus_minus_one();
        // |F−R|² = |V−I|², and V − I = ½((FFᵀ − I) − (V−I)²).
        let twice_stretch = left_strain(h) - square(from_rotation(h));
        twice_stretch.squared_norm() * e.lit(0.25 * self.mu) + e * e * e.lit(0.5 * self.lambda)
    }

    /// Returns the wave modulus 2μ|Fᵀn|² + λJ² \[Pa\], with n along the largest stretch.
    #[inline(always)]
    pub(super) fn stiffness<R: Real, const D: usize>(&self, h: Matrix<R, D>) -> R {
        let j = h.determinant_of_identity_plus_minus_one() + h[(0, 0)].one();
        largest_squared_stretch(h) * j.lit(2.0 * self.mu) + j * j * j.lit(self.lambda.max(0.0))
    }
}

/// F − R, with the rotation R nearest to F = I + H.
#[inline(always)]
fn from_rotation<R: Real, const D: usize>(h: Matrix<R, D>) -> Matrix<R, D> {
    let identity = Matrix::identity(h[(0, 0)]);
    h - (polar(identity + h).rotation - identity)
}

/// Returns the product A Aᵀ.
#[inline(always)]
fn square<R: Real, const D: usize>(a: Matrix<R, D>) -> Matrix<R, D> {
    a * a.transpose()
}

impl<const D: usize> ConstitutiveModel<D> for Corotated {
    type Strain<R: Real> = DisplacementGradient<R, D>;

    #[inline(always)]
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: DisplacementGradient<R, D>,
        _: Matrix<R, D>,
    ) -> Matrix<R, D> {
        self.hardened_stress(strain.h, strain.h[(0, 0)].one())
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
        self.stored(strain.h)
    }

    #[inline(always)]
    fn wave_modulus<R: Real>(&self, strain: DisplacementGradient<R, D>) -> R {
        self.stiffness(strain.h)
    }
}
