//! Viscosity that depends on the rate of shear.

use crate::math::{Matrix, Real};

/// The dependence of viscosity on the rate of shear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Rheology {
    /// A constant viscosity.
    #[default]
    Newtonian,
    /// A yield stress and a power law are added.
    HerschelBulkley(HerschelBulkley),
}

/// Shear stress τ_y + K γ̇ⁿ at the rate of shear γ̇ (Herschel and Bulkley 1926). Without yield stress the
/// fluid follows a power law; with n = 1 it is a Bingham fluid; with both it is Newtonian.
///
/// The law is regularized (Papanastasiou 1987): below its yield stress the fluid creeps, with the
/// viscosity that it has at the creep rate γ̇₀. The viscosity is
/// K (γ̇² + γ̇₀²)^((n−1)/2) + τ_y (1 − e^(−γ̇/γ̇₀))/γ̇.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HerschelBulkley {
    /// Yield stress τ_y \[Pa\].
    pub yield_stress: f64,
    /// Consistency K \[Pa sⁿ\].
    pub consistency: f64,
    /// Flow index n, at most 1: an explicit time step needs a bound on viscosity, and a viscosity that
    /// grows with the rate has none.
    pub flow_index: f64,
    /// Creep rate γ̇₀ \[1/s\]. The lower it is, the firmer a plug stands, and the shorter the time step.
    pub creep_rate: f64,
}

/// The default creep rate \[1/s\]: mud at rest on a slope flows by a tenth of its depth per second.
pub const CREEP_RATE: f64 = 0.1;

/// The x below which (1 − e^−x)/x is summed as a series.
const SMALL: f64 = 0.1;

impl HerschelBulkley {
    /// Returns the viscosity \[Pa s\] at the rate of shear γ̇ \[1/s\].
    #[inline(always)]
    pub fn viscosity<R: Real>(&self, rate: R) -> R {
        let creep = self.creep_rate;
        let x = rate / rate.lit(creep);
        let bounded = (x * x + x.one()).power(0.5 * (self.flow_index - 1.0));
        let thinning = bounded * x.lit(self.consistency * libm::pow(creep, self.flow_index - 1.0));
        thinning + yielding(x) * x.lit(self.yield_stress / creep) // (17)
    }

    /// Returns the largest viscosity \[Pa s\], that of fluid at rest.
    pub fn largest_viscosity(&self) -> f64 {
        self.viscosity(0.0)
    }
}

/// (1 − e^−x)/x for x ≥ 0.
#[inline(always)]
fn yielding<R: Real>(x: R) -> R {
    let mut series = x.one();
    for k in [6.0, 5.0, 4.0, 3.0, 2.0] {
        series = x.one() - series * x * x.lit(1.0 / k);
    }
    let large = x.max(x.lit(SMALL));
    let closed = (x.one() - (-large).exp()) / large;
    R::select(x.lt(x.lit(SMALL)), series, closed)
}

/// Returns the rate of shear γ̇ = √(2 D:D) \[1/s\], with the deviatoric rate of deformation
/// D = ½(L + Lᵀ) − (tr L/d) I of the velocity gradient L \[1/s\].
#[inline(always)]
pub fn shear_rate<R: Real, const D: usize>(velocity_gradient: Matrix<R, D>) -> R {
    let l = velocity_gradient;
    let mean = l.trace();
    let mean = mean * mean.lit(1.0 / D as f64);
    let mut squared = mean.zero();
    for i in 0..D {
        let stretch = l[(i, i)] - mean;
        squared += stretch * stretch + stretch * stretch;
        for j in 0..i {
            let shear = l[(i, j)] + l[(j, i)];
            squared += shear * shear;
        }
    }
    squared.sqrt()
}
