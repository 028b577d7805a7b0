//! Weakly compressible fluid: pressure from J, viscosity, and a volume that is kept.
//!
//! The pressure is computed from e = J − 1, which is what storage holds. In a fluid at rest
//! |e| ≈ 10⁻⁵, and J^−γ − 1 computed from J would have lost half the digits of an `f32`.
//!
//! | file | |
//! |---|---|
//! | `mod.rs` | equation of state, stress, presets |
//! | `rheology.rs` | viscosity that depends on the rate of shear |
//! | `model.rs` | the trait of fluids |
//! | `volume_rule.rs` | the source of J |
//! | `storage.rs` | operations of the engine on the columns of fluids |

pub(super) mod model;
pub mod rheology;
mod storage;
mod volume_rule;

pub use model::FluidModel;
pub use volume_rule::{VolumeCorrection, VolumeRule};

use super::constitutive::ConstitutiveModel;
use super::presets::Preset;
use super::strain::Dilatation;
use crate::math::near_one::{minus_ln_1p, power_minus_one};
use crate::math::{Matrix, Real};
use rheology::{CREEP_RATE, HerschelBulkley, Rheology, shear_rate};

/// The smallest J of a fluid particle.
///
/// No weakly compressible flow comes near it: at a tenth of its volume, water (γ = 7) has a pressure
/// of 10⁶ times its bulk modulus. The limit keeps 1/J finite when a substep is too long, or data from
/// outside has a smaller J. Without it, a particle that J (1 + Δt tr C) < 0 has turned inside out
/// would never come back.
pub const SMALLEST_JACOBIAN: f64 = 0.1;

/// The largest J of a fluid particle, as a multiple of the J at which its tension is cut off.
///
/// Fluid that has expanded further is in free flight, and its further expansion is forgotten. A lone
/// drop keeps its velocity gradient, so that its J would grow exponentially until no number could
/// represent it (seen: 10⁶ within 0.1 s of a splash), and the drop would come back to the pool as if
/// it had no volume. A fluid without tension stores no energy beyond the cut-off, so that forgetting
/// the expansion creates none.
pub const TORN: f64 = 1.1;

/// Tait's exponent for water. As a constant, its powers become multiplications.
const WATER: f64 = 7.0;

/// Pressure p(J), cut off where the tension would exceed `tension`, plus viscosity:
/// τ = −J p I + J (μ (∇v + ∇vᵀ − (2/d) tr ∇v I) + κ tr ∇v I).
///
/// Speed of sound at rest: √(K/ρ₀). Energy per rest volume: −∫ p dJ from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Pressure from J.
    pub eos: Eos,
    /// Bulk modulus at rest K = ρ₀c² \[Pa\].
    pub bulk_modulus: f64,
    /// Dynamic (shear) viscosity μ \[Pa s\]; `rheology` adds to it.
    pub viscosity: f64,
    /// How viscosity depends on the rate of shear.
    pub rheology: Rheology,
    /// Bulk viscosity κ \[Pa s\].
    pub bulk_viscosity: f64,
    /// The largest tension that the fluid bears \[Pa\]. 0 allows none; infinity leaves the equation of
    /// state as it is.
    pub tension: f64,
    /// How J follows the motion, unless `volume` gathers it.
    pub jacobian_update: JacobianUpdate,
    /// The source of J.
    pub volume: VolumeRule,
    /// The velocity gradients that viscosity resists.
    pub viscous_stress: ViscousStress,
}

/// Equation of state, with the bulk modulus K.
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

/// The velocity gradients that viscosity resists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ViscousStress {
    /// μ (∇v + ∇vᵀ − (2/d) tr ∇v I).
    #[default]
    Newtonian,
    /// μ times the engineering strain rates: ∂v_i/∂x_i on the diagonal, ∂v_i/∂x_j + ∂v_j/∂x_i off it.
    /// The resistance depends on the direction of the flow relative to the axes. It is offered because
    /// the fluid of incremental_mpm has it.
    Engineering,
}

/// The presets of liquids.
pub(super) const PRESETS: &[Preset<Fluid>] = &[
    Preset {
        name: "water",
        about: "Fresh water at 20 °C: 998.2 kg/m³, 1.002 mPa s (IAPWS; CRC Handbook of Chemistry and Physics).",
        density: 998.2,
        model: |density, c| newtonian(density, c, 1.002e-3),
    },
    Preset {
        name: "sea_water",
        about: "Sea water at 20 °C with 35 g/kg of salt: 1024.8 kg/m³ (UNESCO equation of state 1980), \
                1.072 mPa s (Landolt–Börnstein V/3a, 1986).",
        density: 1024.8,
        model: |density, c| newtonian(density, c, 1.072e-3),
    },
    Preset {
        name: "honey",
        about: "Clover honey with 16 % of water near 20 °C: 19 Pa s (J. A. Munro, J. Econ. Entomol. 36, \
                1943), 1420 kg/m³.",
        density: 1420.0,
        model: |density, c| newtonian(density, c, 19.0),
    },
    Preset {
        name: "mercury",
        about: "Mercury at 25 °C: 13 534 kg/m³, 1.526 mPa s (CRC Handbook of Chemistry and Physics).",
        density: 13_534.0,
        model: |density, c| newtonian(density, c, 1.526e-3),
    },
    Preset {
        name: "ketchup",
        about: "Tomato ketchup at 25 °C: 32 Pa + 18.7 Pa sⁿ, n = 0.27 (J. F. Steffe, Rheological Methods in Food \
                Process Engineering, 1996, after Higgs and Norrington 1971); 1140 kg/m³ is a choice.",
        density: 1140.0,
        model: |density, c| yielding(density, c, (32.0, 18.7, 0.27)),
    },
    Preset {
        name: "mud",
        about: "Water with 27.4 % of clay by volume: 1200 kg/m³, 25 Pa, 0.07 Pa s, a Bingham fluid (D. Komatina and M. \
                Jovanović, J. Hydraulic Res. 35, 1997).",
        density: 1200.0,
        model: |density, c| yielding(density, c, (25.0, 0.07, 1.0)),
    },
];

/// A liquid of constant viscosity \[Pa s\].
fn newtonian(density: f64, sound_speed: f64, viscosity: f64) -> Fluid {
    Fluid {
        viscosity,
        ..Fluid::water_like(density, sound_speed)
    }
}

/// A liquid with a yield stress \[Pa\], a consistency \[Pa sⁿ\] and a flow index.
fn yielding(
    density: f64,
    sound_speed: f64,
    (yield_stress, consistency, flow_index): (f64, f64, f64),
) -> Fluid {
    Fluid {
        viscosity: 0.0,
        rheology: Rheology::HerschelBulkley(HerschelBulkley {
            yield_stress,
            consistency,
            flow_index,
            creep_rate: CREEP_RATE,
        }),
        ..Fluid::water_like(density, sound_speed)
    }
}

impl Fluid {
    /// Creates a fluid with water's equation of state (Tait, γ = 7) and viscosity (1.002 mPa s at
    /// 20 °C), no tension, and corrected volume.
    ///
    /// `density` is in kg/m³. `sound_speed` \[m/s\] is the one to simulate with: ten times the largest
    /// speed of the flow keeps the change of density near 1 % (Monaghan 1994). Real water's 1480 m/s
    /// only makes the time step short.
    pub fn water_like(density: f64, sound_speed: f64) -> Self {
        Self {
            eos: Eos::Tait { gamma: WATER },
            viscosity: 1.002e-3,
            volume: VolumeRule::Corrected(VolumeCorrection::default()),
            ..Self::inviscid(density * sound_speed * sound_speed)
        }
    }

    /// Creates a fluid with p = K(1/J − 1), the bulk modulus K in Pa, without viscosity or tension.
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

    /// Returns J − 1 at the pressure p \[Pa\], by the equation of state without its cut-off. Infinite if
    /// no expansion brings the pressure so low.
    pub fn jacobian_minus_one_at(&self, pressure: f64) -> f64 {
        let p = pressure / self.bulk_modulus;
        match self.eos {
            Eos::Tait { gamma } if gamma * p > -1.0 => libm::expm1(-libm::log1p(gamma * p) / gamma),
            Eos::Tait { .. } => f64::INFINITY,
            Eos::LinearJ => -p,
        }
    }

    /// Returns J − 1 in a fluid at rest under gravity, where ∫ dp/ρ = `potential`, which is g × depth
    /// below the surface \[m²/s²\]. `density` \[kg/m³\] is the one at zero pressure.
    pub fn jacobian_minus_one_below(&self, potential: f64, density: f64) -> f64 {
        let w = potential * density / self.bulk_modulus;
        match self.eos {
            Eos::Tait { gamma: 1.0 } => libm::expm1(-w),
            Eos::Tait { gamma } => libm::expm1(-libm::log1p((gamma - 1.0) * w) / (gamma - 1.0)),
            Eos::LinearJ => (1.0 - 2.0 * w).max(SMALLEST_JACOBIAN).sqrt() - 1.0,
        }
    }

    /// J − 1 at which the tension reaches `tension`; infinite if it never does.
    fn cut_off(&self) -> f64 {
        if self.tension == 0.0 {
            0.0
        } else {
            self.jacobian_minus_one_at(-self.tension)
        }
    }

    /// The largest J − 1: [`TORN`] times the J at the cut-off, minus 1.
    fn largest_dilatation(&self) -> f64 {
        (1.0 + self.cut_off()) * TORN - 1.0
    }

    /// Returns the pressure \[Pa\] (compression positive) at J = 1 + `jacobian_minus_one`.
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
}

/// J − 1, with J clamped to at least [`SMALLEST_JACOBIAN`].
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
        let cut_off = strain.jacobian_minus_one.lit(self.cut_off());
        let e = floored(strain.jacobian_minus_one).min(cut_off);
        let k = self.bulk_modulus;
        let stored = match self.eos {
            Eos::Tait { gamma: 1.0 } => minus_ln_1p(e) * e.lit(k),
            Eos::Tait { gamma } => e.minus_power_by_number(1.0 - gamma) * e.lit(k / gamma),
            Eos::LinearJ => e.lit(k * 0.5) * e * e,
        };
        let beyond = strain.jacobian_minus_one - cut_off;
        R::select(
            beyond.gt(e.zero()),
            stored + beyond * e.lit(self.tension),
            stored,
        )
    }

    /// −J² ∂p/∂J; beyond the cut-off, its value at the cut-off.
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

    /// The larger of the viscosities that damp a longitudinal wave, κ + 2μ(1 − 1/d), and a shear
    /// wave, μ.
    fn viscosity(&self) -> f64 {
        let mu = self.viscosity
            + match self.rheology {
                Rheology::Newtonian => 0.0,
                Rheology::HerschelBulkley(law) => law.largest_viscosity(),
            };
        let longitudinal = self.bulk_viscosity + 2.0 * mu * (1.0 - 1.0 / D as f64);
        longitudinal.max(mu)
    }
    fn fluid(&self) -> Option<&dyn FluidModel> {
        Some(self)
    }

    fn fluid_mut(&mut self) -> Option<&mut dyn FluidModel> {
        Some(self)
    }
}

impl FluidModel for Fluid {
    fn volume_rule(&self) -> VolumeRule {
        self.volume
    }

    fn bulk_modulus(&self) -> f64 {
        self.bulk_modulus
    }

    fn set_bulk_modulus(&mut self, bulk_modulus: f64) {
        self.bulk_modulus = bulk_modulus;
    }

    /// Beyond the cut-off, where the pressure does not depend on J, J keeps its ratio to the J at the
    /// cut-off.
    fn at_same_pressure(&self, jacobian_minus_one: f64, before: f64) -> f64 {
        let before = Self {
            bulk_modulus: before,
            ..*self
        };
        let e = floored(jacobian_minus_one);
        let (cut_off, now) = (before.cut_off(), self.cut_off());
        if e < cut_off {
            self.jacobian_minus_one_at(before.pressure(e))
        } else {
            e + (1.0 + e) / (1.0 + cut_off) * (now - cut_off)
        }
    }
}
