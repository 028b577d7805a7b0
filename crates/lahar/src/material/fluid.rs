//! Weakly compressible fluid: pressure from J, viscosity.
//!
//! The pressure is computed from e = J − 1, which is what is stored. A fluid at rest lives at
//! |e| ≈ 10⁻⁵, where J^−γ − 1 formed from J has lost half the digits of an `f32`.

use super::rheology::{Rheology, shear_rate};
use super::{ConstitutiveModel, Dilatation, VolumeCorrection, VolumeRule};
use crate::math::near_one::{minus_ln_1p, power_minus_one};
use crate::math::{Matrix, Real, Scalar};

/// The smallest J that a fluid particle is let shrink to, and that its law is evaluated at.
///
/// No weakly compressible flow comes near it: at a tenth of the volume water (γ = 7) pushes with
/// 10⁶ times its bulk modulus. It keeps 1/J finite when a substep that is too long, or data from
/// outside, asks for less; a particle that was turned inside out by J (1 + Δt tr C) < 0 would
/// otherwise never come back.
pub const SMALLEST_JACOBIAN: f64 = 0.1;

/// Fluid that has expanded this many times beyond where its tension is cut off is in free flight:
/// what it expands by further is forgotten. A lone drop keeps its velocity gradient, so its J would
/// grow like an exponential until no number can hold it (seen: 10⁶ within 0.1 s of a splash), and it
/// would come back to the pool as if it had no volume. Nothing is stored beyond the cut-off of a
/// fluid without tension, so that forgetting creates no energy.
pub const TORN: f64 = 1.1;

/// Tait's exponent for water: powers of it are multiplied out when compiled.
const WATER: f64 = 7.0;

/// p(J), cut off where it would pull harder than `tension`, plus viscosity:
/// τ = −J p I + J (μ (∇v + ∇vᵀ − (2/d) tr ∇v I) + κ tr ∇v I).
///
/// Speed of sound at rest: √(K/ρ₀). Energy per rest volume: −∫ p dJ from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Pressure from J.
    pub eos: Eos,
    /// Bulk modulus at rest K = ρ₀c² \[Pa\].
    pub bulk_modulus: f64,
    /// Dynamic (shear) viscosity μ \[Pa s\]; what `rheology` says is added.
    pub viscosity: f64,
    /// How viscosity depends on the rate of shear.
    pub rheology: Rheology,
    /// Bulk viscosity κ \[Pa s\].
    pub bulk_viscosity: f64,
    /// The largest tension that it bears \[Pa\]; 0: none; infinite: as the equation of state says.
    pub tension: f64,
    /// How J follows the motion, if it does.
    pub jacobian_update: JacobianUpdate,
    /// Where J comes from.
    pub volume: VolumeRule,
    /// Which velocity gradients viscosity resists.
    pub viscous_stress: ViscousStress,
}

/// Equation of state, K the bulk modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eos {
    /// p = (K/γ)((ρ/ρ₀)^γ − 1) (Monaghan 1994).
    Tait {
        /// 7 for water; 1: p = K(1/J − 1), the mpm88 fluid.
        gamma: f64,
    },
    /// p = K(1 − J), the mpm99 liquid.
    LinearJ,
}

/// How J follows the motion over a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JacobianUpdate {
    /// J ← J (1 + Δt tr C), as in mpm88.
    #[default]
    Trace,
    /// J ← J det(I + Δt C), as in mpm99.
    Determinant,
}

/// Which velocity gradients viscosity resists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ViscousStress {
    /// μ (∇v + ∇vᵀ − (2/d) tr ∇v I).
    #[default]
    Newtonian,
    /// μ times the engineering strain rates: ∂v_i/∂x_i on the diagonal, ∂v_i/∂x_j + ∂v_j/∂x_i off it.
    /// It depends on how the axes lie: a turned flow is resisted otherwise. Kept because the fluid of
    /// incremental_mpm has it.
    Engineering,
}

impl Fluid {
    /// Water's equation of state (Tait, γ = 7) and viscosity (1.002 mPa s at 20 °C), no tension,
    /// corrected volume.
    ///
    /// `density` \[kg/m³\] and the `sound_speed` to simulate with \[m/s\]: ten times the largest
    /// speed of the flow keeps the change of density near 1 % (Monaghan 1994); real water's
    /// 1480 m/s only makes the time step short.
    pub fn water_like(density: f64, sound_speed: f64) -> Self {
        Self {
            eos: Eos::Tait { gamma: WATER },
            viscosity: 1.002e-3,
            volume: VolumeRule::Corrected(VolumeCorrection::default()),
            ..Self::inviscid(density * sound_speed * sound_speed)
        }
    }

    /// p = K(1/J − 1) with the bulk modulus K \[Pa\]: no viscosity, no tension.
    pub fn inviscid(bulk_modulus: f64) -> Self {
        Self {
            eos: Eos::Tait { gamma: 1.0 },
            bulk_modulus,
            viscosity: 0.0,
            rheology: Rheology::Newtonian,
            bulk_viscosity: 0.0,
            tension: 0.0,
            jacobian_update: JacobianUpdate::Trace,
            volume: VolumeRule::Jacobian,
            viscous_stress: ViscousStress::Newtonian,
        }
    }

    /// J − 1 at the pressure p \[Pa\], by the equation of state without its cut-off: what a body at
    /// rest starts from. Infinite where no expansion brings the pressure so low.
    pub fn jacobian_minus_one_at(&self, pressure: f64) -> f64 {
        let p = pressure / self.bulk_modulus;
        match self.eos {
            Eos::Tait { gamma } if gamma * p > -1.0 => libm::expm1(-libm::log1p(gamma * p) / gamma),
            Eos::Tait { .. } => f64::INFINITY,
            Eos::LinearJ => -p,
        }
    }

    /// J − 1 in a fluid at rest, of this `density` at no pressure \[kg/m³\], where its weight has done the
    /// work `potential` = g × depth below the surface \[m²/s²\]: ∫ dp/ρ = g × depth.
    pub fn jacobian_minus_one_below(&self, potential: f64, density: f64) -> f64 {
        let w = potential * density / self.bulk_modulus;
        match self.eos {
            Eos::Tait { gamma: 1.0 } => libm::expm1(-w),
            Eos::Tait { gamma } => libm::expm1(-libm::log1p((gamma - 1.0) * w) / (gamma - 1.0)),
            Eos::LinearJ => (1.0 - 2.0 * w).max(SMALLEST_JACOBIAN).sqrt() - 1.0,
        }
    }

    /// J − 1 where the fluid pulls with `tension`; infinite if it never pulls so hard.
    fn cut_off(&self) -> f64 {
        if self.tension == 0.0 {
            0.0
        } else {
            self.jacobian_minus_one_at(-self.tension)
        }
    }

    /// The largest J − 1 that is remembered: [`TORN`] times the J at the cut-off.
    fn largest_dilatation(&self) -> f64 {
        (1.0 + self.cut_off()) * TORN - 1.0
    }

    /// Pressure \[Pa\] (compression positive) at J = 1 + `jacobian_minus_one`.
    #[inline(always)]
    pub fn pressure<R: Real>(&self, jacobian_minus_one: R) -> R {
        let e = floored(jacobian_minus_one);
        let k = self.bulk_modulus;
        let pressure = match self.eos {
            Eos::Tait { gamma: WATER } => power_minus_one(e, -WATER) * e.lit(k / WATER),
            Eos::Tait { gamma } => power_minus_one(e, -gamma) * e.lit(k / gamma),
            Eos::LinearJ => -e * e.lit(k),
        };
        pressure.max(e.lit(-self.tension))
    }

    /// Energy per rest volume \[Pa\]. In f64, since it is a difference of much larger numbers.
    fn energy(&self, jacobian_minus_one: f64) -> f64 {
        let cut_off = self.cut_off();
        let e = floored(jacobian_minus_one).min(cut_off);
        let k = self.bulk_modulus;
        let stored = match self.eos {
            Eos::Tait { gamma: 1.0 } => k * minus_ln_1p(e),
            Eos::Tait { gamma } => {
                k / gamma * (e - power_minus_one(e, 1.0 - gamma) / (1.0 - gamma))
            }
            Eos::LinearJ => k * 0.5 * e * e,
        };
        if jacobian_minus_one > cut_off {
            stored + self.tension * (jacobian_minus_one - cut_off)
        } else {
            stored
        }
    }
}

/// J − 1 with J no smaller than [`SMALLEST_JACOBIAN`].
#[inline(always)]
fn floored<R: Real>(jacobian_minus_one: R) -> R {
    jacobian_minus_one.max(jacobian_minus_one.lit(SMALLEST_JACOBIAN - 1.0))
}

impl<const D: usize> ConstitutiveModel<D> for Fluid {
    type Strain<R: Real> = Dilatation<R>;

    #[inline(always)]
    fn kirchhoff_stress<R: Real>(
        &self,
        strain: Dilatation<R>,
        velocity_gradient: Matrix<R, D>,
    ) -> Matrix<R, D> {
        let e = floored(strain.jacobian_minus_one);
        let j = e + e.one();
        let tau = match self.eos {
            // J p = K(1 − J): no division.
            Eos::Tait { gamma: 1.0 } => (e * e.lit(self.bulk_modulus)).min(j * e.lit(self.tension)),
            _ => -j * self.pressure(e),
        };
        let (newtonian, kappa) = (self.viscosity, self.bulk_viscosity);
        let l = velocity_gradient;
        let d = D as f64;
        let (mu, mean) = match self.rheology {
            Rheology::Newtonian if newtonian == 0.0 && kappa == 0.0 => {
                return Matrix::scaled_identity(tau);
            }
            Rheology::Newtonian => (e.lit(newtonian), e.lit(kappa - 2.0 * newtonian / d)),
            Rheology::HerschelBulkley(law) => {
                let mu = law.viscosity(shear_rate(l)) + e.lit(newtonian);
                (mu, e.lit(kappa) - mu * e.lit(2.0 / d))
            }
        };
        let mut shear = (l + l.transpose()) * mu;
        let mean = match self.viscous_stress {
            ViscousStress::Newtonian => mean,
            ViscousStress::Engineering => {
                for i in 0..D {
                    shear[(i, i)] = l[(i, i)] * mu;
                }
                e.lit(kappa)
            }
        };
        let mean = l.trace() * mean;
        (shear + Matrix::scaled_identity(mean)) * j + Matrix::scaled_identity(tau)
    }

    #[inline(always)]
    fn advance<R: Real>(&self, strain: Dilatation<R>, increment: Matrix<R, D>) -> Dilatation<R> {
        if self.volume == VolumeRule::Gathered {
            return strain;
        }
        let e = strain.jacobian_minus_one;
        let change = match self.jacobian_update {
            JacobianUpdate::Trace => increment.trace(),
            JacobianUpdate::Determinant => increment.determinant_of_identity_plus_minus_one(),
        };
        Dilatation {
            jacobian_minus_one: floored(e + change + e * change) // (7)
                .min(e.lit(self.largest_dilatation())),
        }
    }

    #[inline(always)]
    fn energy_density<R: Real>(&self, strain: Dilatation<R>) -> R {
        strain
            .jacobian_minus_one
            .map(|e| R::Scalar::from_f64(self.energy(e.to_f64())))
    }

    /// −J² ∂p/∂J, the fluid being no stiffer beyond the cut-off than at it.
    #[inline(always)]
    fn wave_modulus<R: Real>(&self, strain: Dilatation<R>) -> R {
        let e = floored(strain.jacobian_minus_one);
        let j = e.min(e.lit(self.cut_off())) + e.one();
        let stiffening = match self.eos {
            Eos::Tait { gamma: WATER } => j.power(1.0 - WATER),
            Eos::Tait { gamma } => j.power(1.0 - gamma),
            Eos::LinearJ => j * j,
        };
        stiffening * e.lit(self.bulk_modulus)
    }

    fn volume_rule(&self) -> VolumeRule {
        self.volume
    }

    fn bulk_modulus(&self) -> Option<f64> {
        Some(self.bulk_modulus)
    }

    fn with_bulk_modulus(self, bulk_modulus: f64) -> Self {
        Self {
            bulk_modulus,
            ..self
        }
    }

    /// Beyond the cut-off, where pressure says nothing of J, it stays as far beyond.
    fn at_same_pressure(&self, strain: Dilatation<f64>, before: &Self) -> Dilatation<f64> {
        let e = floored(strain.jacobian_minus_one);
        let (cut_off, now) = (before.cut_off(), self.cut_off());
        let jacobian_minus_one = if e < cut_off {
            self.jacobian_minus_one_at(before.pressure(e))
        } else {
            e + (1.0 + e) / (1.0 + cut_off) * (now - cut_off)
        };
        Dilatation { jacobian_minus_one }
    }

    /// What damps a longitudinal wave, κ + 2μ(1 − 1/d), or a shear wave, μ: the larger.
    fn viscosity(&self) -> f64 {
        let mu = self.viscosity
            + match self.rheology {
                Rheology::Newtonian => 0.0,
                Rheology::HerschelBulkley(law) => law.largest_viscosity(),
            };
        let longitudinal = self.bulk_viscosity + 2.0 * mu * (1.0 - 1.0 / D as f64);
        longitudinal.max(mu)
    }
}
