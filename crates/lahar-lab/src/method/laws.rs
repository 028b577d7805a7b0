//! K5: constitutive models against tables that were computed independently, to ten digits.

use lahar::material::{
    ConstitutiveModel, Corotated, Eos, Fluid, NeoHookean, PlasticGradient, Snow, Strain,
};
use lahar::math::{Matrix, svd};

use super::table::Table;

/// Errors of the solids against a table, for E = 10⁴ Pa and ν = 0.3.
#[derive(Clone, Copy, Debug)]
pub struct SolidErrors {
    /// Relative error of the stress, by model.
    pub stress: [(&'static str, f64); 3],
    /// Relative error of what snow keeps after it has yielded: singular values of F_E, J_P and the hardening factor.
    pub yielded_snow: f64,
}

/// Returns the largest errors of the solids in 2D or 3D.
pub fn solid_errors<const D: usize>() -> SolidErrors {
    let table = Table::parse(match D {
        2 => include_str!("../../data/constitutive_reference_2d.csv"),
        _ => include_str!("../../data/constitutive_reference_3d.csv"),
    });
    let still = Matrix::scaled_identity(0.0);
    let mut stress_errors = [0.0_f64; 3];
    let mut yielded_snow = 0.0_f64;
    for row in &table.rows {
        let f: Matrix<f64, D> = table.matrix(row, "F");
        let h = f - Matrix::scaled_identity(1.0);
        let snow = Snow::new(1e4, 0.3);
        let yielded = snow.advance(PlasticGradient::from_displacement_gradient(h), still);
        let stresses = [
            ("fcr_tau", stress(&Corotated::new(1e4, 0.3), h)),
            ("nh_tau", stress(&NeoHookean::new(1e4, 0.3), h)),
            ("snow_tau", snow.kirchhoff_stress(yielded, still)),
        ];
        for (worst, (name, ours)) in stress_errors.iter_mut().zip(stresses) {
            *worst = worse(*worst, error(ours, table.symmetric(row, name)));
        }
        let sigma = svd(yielded.h + Matrix::scaled_identity(1.0)).sigma;
        let known = |name: &str| table.get(row, &format!("snow_{name}"));
        let singular_values = (0..D).map(|i| (sigma[i], known(&format!("sig{}", i + 1))));
        let scalars = [
            (1.0 + yielded.plastic_jacobian_minus_one, known("Jp")),
            (snow.hardening(yielded), known("h")),
        ];
        for (ours, known) in singular_values.chain(scalars) {
            yielded_snow = worse(yielded_snow, ((ours - known) / known).abs());
        }
    }
    let [corotated, neo_hookean, snow] = stress_errors;
    SolidErrors {
        stress: [
            ("corotated", corotated),
            ("neo-Hookean", neo_hookean),
            ("snow", snow),
        ],
        yielded_snow,
    }
}

/// Returns the largest errors of the equations of state, of p / (ρ₀ c²).
pub fn eos_errors() -> [(&'static str, f64); 3] {
    let table = Table::parse(include_str!("../../data/eos_reference.csv"));
    [
        ("linear", Eos::Tait { gamma: 1.0 }),
        ("linearJ", Eos::LinearJ),
        ("tait7", Eos::Tait { gamma: 7.0 }),
    ]
    .map(|(name, eos)| {
        let law = Fluid {
            eos,
            tension: f64::INFINITY,
            ..Fluid::inviscid(1.0)
        };
        let errors = table.rows.iter().map(|row| {
            let e = 1.0 / table.get(row, "r") - 1.0;
            (law.pressure(e) - table.get(row, name)).abs()
        });
        (name, errors.fold(0.0, worse))
    })
}

/// Returns τ of a model with the displacement gradient `h`, at rest.
fn stress<M: ConstitutiveModel<D>, const D: usize>(model: &M, h: Matrix<f64, D>) -> Matrix<f64, D> {
    let strain = M::Strain::<f64>::from_displacement_gradient(h);
    model.kirchhoff_stress(strain, Matrix::scaled_identity(0.0))
}

/// Returns |a − b|/|b|; NaN if an entry is.
fn error<const D: usize>(a: Matrix<f64, D>, b: Matrix<f64, D>) -> f64 {
    ((a - b).squared_norm() / b.squared_norm()).sqrt()
}

/// Returns the larger number, or NaN if `b` is.
fn worse(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}
