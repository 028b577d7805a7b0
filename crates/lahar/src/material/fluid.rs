//! Weakly compressible fluid: pressure from J, Newtonian viscosity.

use super::{ConstitutiveModel, Dilatation};
use crate::math::{Matrix, Real};

/// p(J), cut off where it would pull harder than `tension`, plus viscosity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Pressure from J.
    pub eos: Eos,
    /// Bulk modulus at rest ρ₀c² \[Pa\].
    pub bulk_modulus: f64,
    /// Dynamic (shear) viscosity μ \[Pa s\].
    pub viscosity: f64,
    /// Bulk viscosity κ \[Pa s\].
    pub bulk_viscosity: f64,
    /// The largest tension that it bears \[Pa\]; 0: none; infinite: as the equation of state says.
    pub tension: f64,
    /// How J follows the motion.
    pub jacobian_update: JacobianUpdate,
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
