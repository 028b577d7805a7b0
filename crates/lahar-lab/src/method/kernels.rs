//! K1: moments of the kernels.

use lahar::kernel::{BSpline, Quadratic};
use lahar::math::Scalar;

use super::table::Table;

/// The names of the moments of [`moment_errors`].
pub const MOMENTS: [&str; 5] = ["Σw", "Σwr", "Σwrr", "Σg", "Σgr"];

/// Returns the largest errors over a cell of Σ w = 1, Σ w r = 0, Σ w r rᵀ = D, Σ ∇w = 0 and Σ r ∇wᵀ = I, in units of
/// dx and of the precision of `T`. Sums over the weights of `T` are taken in `f64`.
pub fn moment_errors<K: BSpline, T: Scalar>() -> [f64; 5] {
    let mut worst = [0.0_f64; 5];
    let cells = 10_000;
    let ends = [1e-300, 1e-30, 1e-9, 1e-5, 1.0 - T::EPSILON.to_f64() / 2.0];
    let inside = (0..cells).map(|i| f64::from(i) / f64::from(cells));
    for frac in inside.chain(ends).map(T::from_f64) {
        let s = frac.to_f64() + K::OFFSET;
        let (w, g) = (K::weights(frac), K::gradients(frac));
        let sum = |f: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
            (0..K::NODES)
                .map(|k| f(w[k].to_f64(), g[k].to_f64(), k as f64 - s))
                .sum()
        };
        let inertia = if K::INVERSE_INERTIA.is_finite() {
            1.0 / K::INVERSE_INERTIA
        } else {
            (1.0 - frac.to_f64()) * frac.to_f64()
        };
        let errors = [
            sum(&|w, _, _| w) - 1.0,
            sum(&|w, _, r| w * r),
            sum(&|w, _, r| w * r * r) - inertia,
            sum(&|_, g, _| g),
            sum(&|_, g, r| g * r) - 1.0,
        ];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error.abs() / T::EPSILON.to_f64());
        }
    }
    worst
}

/// Returns the largest error of the quadratic kernel against a table of weights, their gradients, and D⁻¹ w r, which takes
/// the gradients' place in MLS-MPM; in units of the precision of `f64`.
pub fn quadratic_table_error() -> f64 {
    let table = Table::parse(include_str!("../../data/kernel_mls_reference.csv"));
    let mut worst = 0.0_f64;
    for row in &table.rows {
        let frac = row[0] + 0.5; // the table's first column is the distance from the middle node
        let (w, g) = (Quadratic::weights(frac), Quadratic::gradients(frac));
        for k in 0..3 {
            let r = k as f64 - (frac + Quadratic::OFFSET);
            let mls = Quadratic::INVERSE_INERTIA * w[k] * r;
            for (ours, theirs) in [(w[k], row[1 + k]), (g[k], row[4 + k]), (mls, row[7 + k])] {
                worst = worst.max((ours - theirs).abs() / f64::EPSILON);
            }
        }
    }
    worst
}
