//! Snow (Stomakhin 2013): corotated, yielding outside a band of stretch, hardening as it packs.
//!
//! ```text
//!   F = F_E F_P        (I + Δt C) F_E = U diag(σ) Vᵀ
//!
//!            1−θc   1   1+θs
//!   ───────────┼────┼────┼───────────► σ
//!    yields,    elastic    yields,
//!    packs: J_P falls      loosens: J_P grows
//!    and h grows           and h falls
//! ```

use super::constitutive::ConstitutiveModel;
use super::corotated::Corotated;
use super::moduli::lame;
use super::presets::Preset;
use super::strain::{DisplacementGradient, PlasticGradient};
use crate::math::{Matrix, Real, svd};

/// Corotated with moduli h λ, h μ; singular values of F_E clamped to [1−θc, 1+θs];
/// h = exp(ξ(1−J_P)).
///
/// Φ = h (μ|F_E−R|² + ½λ(J_E−1)²), at fixed J_P. Speed of pressure waves at rest: √(h(λ+2μ)/ρ₀).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snow {
    /// Lamé's first parameter λ at J_P = 1 \[Pa\].
    pub lambda: f64,
    /// Shear modulus μ at J_P = 1 \[Pa\].
    pub mu: f64,
    /// Critical compression θc: snow yields below a stretch of 1 − θc.
    pub critical_compression: f64,
    /// Critical stretch θs: snow yields above a stretch of 1 + θs.
    pub critical_stretch: f64,
    /// Hardening ξ: at J_P, the moduli are exp(ξ(1−J_P)) times those at J_P = 1.
    pub hardening: f64,
    /// The interval that h is clamped to.
    pub hardening_range: [f64; 2],
    /// The interval that J_P is clamped to.
    pub plastic_jacobian_range: [f64; 2],
    /// The J_P that hardening follows.
    pub hardening_from: HardeningFrom,
}

/// Singular values outside the band by less than this many ε count as inside it. Otherwise snow at
/// rest on the edge of the band would yield by the rounding of σ in every substep, always in the same
/// direction.
const ROUNDING: f64 = 16.0;

/// The preset of the paper.
pub(super) const PRESETS: &[Preset<Snow>] = &[Preset {
    name: "snow",
    about: "The snow of Stomakhin et al. 2013: 400 kg/m³, E = 140 kPa, ν = 0.2, θc = 2.5 %, θs = 0.75 %, ξ = 10.",
    density: 400.0,
    model: |_, _| Snow::default(),
}];

impl Snow {
    /// Creates snow of Young's modulus at J_P = 1 \[Pa\] and Poisson's ratio, 1.4e5 and 0.2 in
    /// Stomakhin 2013. θc, θs and ξ are those of its table 2. J_P stays within [0.6, 20], as in the
    /// MLS-MPM authors' mls-mpm88.cpp; the paper sets no limit.
    pub fn new(youngs_modulus: f64, poisson_ratio: f64) -> Self {
        let (lambda, mu) = lame(youngs_modulus, poisson_ratio);
        Self {
            lambda,
            mu,
            critical_compression: 2.5e-2,
            critical_stretch: 7.5e-3,
            hardening: 10.0,
            hardening_range: [0.0, f64::INFINITY],
            plastic_jacobian_range: [0.6, 20.0],
            hardening_from: HardeningFrom::Updated,
        }
    }

    /// The elastic law at h = 1.
    #[inline(always)]
    fn elastic(&self) -> Corotated {
        Corotated {
            lambda: self.lambda,
            mu: self.mu,
        }
    }

    /// Returns h = exp(ξ(1−J_P)), within its interval.
    #[inline(always)]
    pub fn hardening<R: Real, const D: usize>(&self, strain: PlasticGradient<R, D>) -> R {
        let e = strain.hardening_jacobian_minus_one;
        let [low, high] = self.hardening_range;
        (e * e.lit(-self.hardening))
            .exp()
            .max(e.lit(low))
            .min(e.lit(high))
    }
}

impl Default for Snow {
    /// The snow of Stomakhin 2013: E = 1.4e5 Pa, ν = 0.2.
    fn default() -> Self {
        Self::new(1.4e5, 0.2)
    }
}

impl<const D: usize> ConstitutiveModel<D> for Snow {
    type Strain<R: Real> = PlasticGradient<R, D>;

    #[inline(always)]
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: PlasticGradient<R, D>,
        _: Matrix<R, D>,
    ) -> Matrix<R, D> {
        self.elastic()
            .hardened_stress(strain.h, self.hardening(strain))
    }

    #[inline(always)]
    fn advance<R: Real>(
        &self,
        strain: PlasticGradient<R, D>,
        increment: Matrix<R, D>,
    ) -> PlasticGradient<R, D> {
        let DisplacementGradient { h } = DisplacementGradient { h: strain.h }.moved(increment);
        let trial = svd(Matrix::identity(h[(0, 0)]) + h);

        let old = strain.plastic_jacobian_minus_one;
        let low = old.lit(1.0 - self.critical_compression);
        let high = old.lit(1.0 + self.critical_stretch);
        let rounding = old.lit(ROUNDING * R::EPSILON);
        // The excess of each σ over the band, and J_P ← J_P Π σ/σ_clamped. Where nothing yields,
        // nothing is added, so that there is no rounding either.
        let mut flow = trial;
        let mut plastic = old;
        for i in 0..D {
            let sigma = trial.sigma[i];
            let excess = sigma - sigma.max(low).min(high);
            let excess = R::select(excess.abs().gt(rounding), excess, excess.zero());
            flow.sigma[i] = -excess;
            plastic += excess / (sigma - excess) * (plastic + plastic.one());
        }
        let [smallest, largest] = self.plastic_jacobian_range;
        let plastic = plastic
            .max(old.lit(smallest - 1.0))
            .min(old.lit(largest - 1.0));
        PlasticGradient {
            h: h + flow.compose(),
            plastic_jacobian_minus_one: plastic,
            hardening_jacobian_minus_one: match self.hardening_from {
                HardeningFrom::Updated => plastic,
                HardeningFrom::Previous => old,
            },
        }
    }

    #[inline(always)]
    fn energy_density<R: Real>(&self, strain: PlasticGradient<R, D>) -> R {
        self.elastic().stored(strain.h) * self.hardening(strain)
    }

    #[inline(always)]
    fn wave_modulus<R: Real>(&self, strain: PlasticGradient<R, D>) -> R {
        self.elastic().stiffness(strain.h) * self.hardening(strain)
    }
}

/// The J_P that hardening follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HardeningFrom {
    /// The one after this substep's clamping.
    #[default]
    Updated,
    /// The one before it, as in mpm99 and mpm128.
    Previous,
}
