//! K5: constitutive models against tables.

use super::Case;
use super::running::{CaseError, Session};
use crate::method::laws::{SolidErrors, eos_errors, solid_errors};

pub(super) const CASES: &[Case] = &[Case {
    id: "K5",
    title: "Constitutive laws",
    reference: "tables computed apart, ten digits: E = 10⁴ Pa, nu = 0.3; finite differences are in the library's own tests",
    scene: "k3-discs",
    long: false,
    run: k5,
}];

fn k5(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut report = |dimension: usize, errors: SolidErrors| {
        for (name, error) in errors.stress {
            session.at_most(&format!("stress, {name}, {dimension}D"), error, 1e-8);
        }
    };
    report(2, solid_errors::<2>());
    report(3, solid_errors::<3>());
    for (name, error) in eos_errors() {
        session.at_most(&format!("pressure / (rho c²), {name}"), error, 1e-8);
    }
    Ok(())
}
