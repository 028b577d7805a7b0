//! K5: constitutive laws against tables.

use lahar::material::{
    ConstitutiveModel, Corotated, Eos, Fluid, NeoHookean, PlasticGradient, Snow, Strain,
};
use lahar::math::Matrix;

use super::Case;
use super::running::{CaseError, Session};

pub(super) const CASES: &[Case] = &[Case {
    id: "K5",
    title: "Constitutive laws",
    reference: "tables computed apart, ten digits: E = 10⁴ Pa, nu = 0.3; finite differences are in the library's own tests",
    scene: "k3-discs",
    long: false,
    run: k5,
}];

/// Rows of a table, their numbers found by name.
struct Table<'a> {
    names: Vec<&'a str>,
    rows: Vec<Vec<f64>>,
}

impl<'a> Table<'a> {
    fn parse(text: &'a str) -> Self {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let names = lines.next().unwrap_or_default().split(',').collect();
        let number = |word: &str| word.parse().unwrap_or(f64::NAN);
        Self {
            names,
            rows: lines
                .map(|line| line.split(',').map(number).collect())
                .collect(),
        }
    }

    fn get(&self, row: &[f64], name: &str) -> f64 {
        let column = self.names.iter().position(|known| *known == name);
        column.map_or(f64::NAN, |column| row[column])
    }

    /// The matrix of columns NAME11, NAME12, ..; a symmetric one has those above the diagonal only.
    fn matrix<const D: usize>(&self, row: &[f64], name: &str, symmetric: bool) -> Matrix<f64, D> {
        Matrix::from_fn(|i, j| {
            let (i, j) = if symmetric {
                (i.min(j), i.max(j))
            } else {
                (i, j)
            };
            self.get(row, &format!("{name}{}{}", i + 1, j + 1))
        })
    }
}

/// |a − b|/|b|; not a number if any is.
fn error<const D: usize>(a: Matrix<f64, D>, b: Matrix<f64, D>) -> f64 {
    ((a - b).squared_norm() / b.squared_norm()).sqrt()
}

/// The larger; not a number wins.
fn worse(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// τ of a model whose strain is that of the displacement gradient `h`.
fn stress<M: ConstitutiveModel<D>, const D: usize>(model: &M, h: Matrix<f64, D>) -> Matrix<f64, D> {
    let strain = M::Strain::<f64>::from_displacement_gradient(h);
    model.kirchhoff_stress(strain, Matrix::scaled_identity(0.0))
}

fn solids<const D: usize>(session: &mut Session<'_>, text: &str) {
    let table = Table::parse(text);
    let mut worst = [0.0_f64; 3];
    for row in &table.rows {
        let f: Matrix<f64, D> = table.matrix(row, "F", false);
        let h = f - Matrix::scaled_identity(1.0);
        let snow = Snow::new(1e4, 0.3);
        let still = Matrix::scaled_identity(0.0);
        let yielded = snow.advance(PlasticGradient::from_displacement_gradient(h), still);
        let found = [
            ("fcr_tau", stress(&Corotated::new(1e4, 0.3), h)),
            ("nh_tau", stress(&NeoHookean::new(1e4, 0.3), h)),
            ("snow_tau", snow.kirchhoff_stress(yielded, still)),
        ];
        for (worst, (name, ours)) in worst.iter_mut().zip(found) {
            *worst = worse(*worst, error(ours, table.matrix(row, name, true)));
        }
    }
    for (name, worst) in ["corotated", "neo-Hookean", "snow"].into_iter().zip(worst) {
        session.at_most(&format!("stress, {name}, {D}D"), worst, 1e-8);
    }
}

fn k5(session: &mut Session<'_>) -> Result<(), CaseError> {
    solids::<2>(
        session,
        include_str!("../../data/constitutive_reference_2d.csv"),
    );
    solids::<3>(
        session,
        include_str!("../../data/constitutive_reference_3d.csv"),
    );
    let table = Table::parse(include_str!("../../data/eos_reference.csv"));
    let columns = [
        ("linear", Eos::Tait { gamma: 1.0 }),
        ("linearJ", Eos::LinearJ),
        ("tait7", Eos::Tait { gamma: 7.0 }),
    ];
    for (name, eos) in columns {
        let law = Fluid {
            eos,
            tension: f64::INFINITY,
            ..Fluid::inviscid(1.0)
        };
        let off = table.rows.iter().map(|row| {
            let e = 1.0 / table.get(row, "r") - 1.0;
            (law.pressure(e) - table.get(row, name)).abs()
        });
        let worst = off.fold(0.0, worse);
        session.at_most(&format!("pressure / (rho c²), {name}"), worst, 1e-8);
    }
    Ok(())
}
