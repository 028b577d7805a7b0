//! Fluids: equations of state, tension, viscosity, and yield stress.

use crate::materials::{Matrices, Norm, energy, identity};
use lahar::material::{
    ConstitutiveModel, Dilatation, Eos, Fluid, HerschelBulkley, JacobianUpdate, Rheology,
    SMALLEST_JACOBIAN, law,
};
use lahar::math::{Matrix, Vector};
use lahar_lab::method::random::Random;

/// The case of HydraxMPM's tests/test_newtonfluid_mat.py: p = B((m/V)⁷ − 1) with B = 2 MPa, m/V = 1400/1390, a viscosity
/// of 1 mPa s and the velocity gradient I.
#[test]
fn newtonian_fluid_agrees_with_hydrax_mpm() {
    let law = Fluid {
        eos: Eos::Tait { gamma: 7.0 },
        viscosity: 1e-3,
        ..Fluid::inviscid(7.0 * 2e6)
    };
    let jacobian: f64 = 1390.0 / 1400.0;
    let strain = Dilatation {
        jacobian_minus_one: jacobian - 1.0,
    };
    let tau: Matrix<f64, 3> = law.kirchhoff_stress(strain, identity());
    let cauchy = tau * (1.0 / jacobian);
    let error = cauchy - identity() * -102_920.05;
    assert!(error.norm() <= 1e-5 * cauchy.norm(), "{cauchy:?}");
}

#[test]
fn pressure_near_rest_keeps_its_digits_in_single_precision() {
    for eos in [1.0, 1.4, 4.0, 7.0]
        .map(|gamma| Eos::Tait { gamma })
        .into_iter()
        .chain([Eos::LinearJ])
    {
        let law = Fluid {
            eos,
            tension: f64::INFINITY,
            ..Fluid::inviscid(1e5)
        };
        for e in [1e-5f32, -1e-5, 3.3e-6, -2.1e-7, 1e-9, -1e-12, 4e-3] {
            let exact = law.pressure(f64::from(e));
            let error = (f64::from(law.pressure(e)) - exact) / exact;
            assert!(error.abs() <= 3e-7, "{eos:?} at {e}: {error}");
        }
    }
}

#[test]
fn mpm88_and_mpm99_liquids_are_exact() {
    let zero = Matrix::<f64, 2>::scaled_identity(0.0);
    let whole = |eos| Fluid {
        eos,
        tension: f64::INFINITY,
        ..Fluid::inviscid(400.0)
    };
    for e in [-0.3, 0.01, 0.7] {
        let strain = Dilatation {
            jacobian_minus_one: e,
        };
        let mpm88 = whole(Eos::Tait { gamma: 1.0 }).kirchhoff_stress(strain, zero);
        assert_eq!(mpm88[(0, 0)], 400.0 * e);
        let mpm99 = whole(Eos::LinearJ).kirchhoff_stress(strain, zero);
        assert!((mpm99[(1, 1)] - 400.0 * (1.0 + e) * e).abs() < 1e-12);
    }
}

#[test]
fn a_fluid_pulls_no_harder_than_its_tension() {
    for eos in [1.0, 1.4, 7.0]
        .map(|gamma| Eos::Tait { gamma })
        .into_iter()
        .chain([Eos::LinearJ])
    {
        for tension in [0.0, 3.0, 50.0, f64::INFINITY] {
            let law = Fluid {
                eos,
                tension,
                ..Fluid::inviscid(100.0)
            };
            let mut last = 0.0;
            for step in 0..4000 {
                let e = 1e-3 * f64::from(step);
                assert!(law.pressure(e) >= -tension);
                // The energy grows by the work of the tension.
                let stored = energy(&law, Matrix::<f64, 2>::from_diagonal(Vector([e, 0.0])));
                let rise = stored - last;
                assert!(
                    (0.0..=1e-3 * tension.min(400.0) + 1e-12).contains(&rise),
                    "{rise}"
                );
                last = stored;
            }
        }
    }
}

#[test]
fn the_equation_of_state_is_inverted() {
    for eos in [1.0, 1.4, 7.0]
        .map(|gamma| Eos::Tait { gamma })
        .into_iter()
        .chain([Eos::LinearJ])
    {
        let law = Fluid {
            eos,
            tension: f64::INFINITY,
            ..Fluid::inviscid(100.0)
        };
        for p in [0.0, 1e-6, 3.0, 60.0, -5.0] {
            let again = law.pressure(law.jacobian_minus_one_at(p));
            assert!(
                (again - p).abs() <= 1e-14 * p.abs(),
                "{eos:?}: {again} for {p}"
            );
        }
    }
    let law = Fluid::water_like(1000.0, 10.0);
    assert_eq!(law.jacobian_minus_one_at(-1e6), f64::INFINITY);
}

/// A yield-stress fluid.
pub(crate) const PASTE: HerschelBulkley = HerschelBulkley {
    yield_stress: 3.0,
    consistency: 2.0,
    flow_index: 0.5,
    creep_rate: 0.1,
};

/// Equation (17) against independently computed numbers: above the yield stress, below it and at rest; a Bingham fluid and
/// a power law.
#[test]
fn viscosity_is_herschels_and_bulkleys() {
    let bingham = HerschelBulkley {
        yield_stress: 25.0,
        consistency: 0.07,
        flow_index: 1.0,
        ..PASTE
    };
    let ketchup = HerschelBulkley {
        yield_stress: 0.0,
        consistency: 18.7,
        flow_index: 0.27,
        ..PASTE
    };
    for (law, rate, expected) in [
        (PASTE, 4.0, 1.749_843_811_006_560_4),
        (PASTE, 0.005, 35.582_953_937_599_55),
        (PASTE, 0.0, 36.324_555_320_336_756),
        (bingham, 10.0, 2.57),
        (ketchup, 0.02, 98.997_547_930_122_41),
    ] {
        let found: f64 = law.viscosity(rate);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{found}, not {expected}"
        );
        let single = f64::from(law.viscosity(rate as f32));
        assert!(
            (single / expected - 1.0).abs() < 2e-6,
            "{single}, not {expected}"
        );
        assert!(found <= law.largest_viscosity());
    }
}

/// Checks that the yielding stress vanishes for a rotation, has no trace, turns with the axes, always dissipates energy, and
/// grows with the shear rate from the yield stress on.
fn yielding_stress_is_sound<const D: usize>() {
    let law = Fluid {
        rheology: Rheology::HerschelBulkley(PASTE),
        ..Fluid::inviscid(1.0)
    };
    let rest = Dilatation {
        jacobian_minus_one: 0.0,
    };
    let mut random = Random(1);
    for _ in 0..50 {
        let scale = 10.0_f64.powf(3.0 * random.signed());
        let l: Matrix<f64, D> = random.matrix(scale);
        let tau = law.kirchhoff_stress(rest, l);
        let dissipated: f64 = (0..D).map(|j| tau.0[j].dot(l.0[j])).sum();
        assert!(dissipated > 0.0, "{dissipated}");
        assert!(tau.trace().abs() < 1e-13 * tau.norm());
        let turn = random.rotation();
        let turned = law.kirchhoff_stress(rest, turn * l * turn.transpose());
        let difference = turned - turn * tau * turn.transpose();
        assert!(difference.norm() < 1e-12 * tau.norm());
        let spin = l - l.transpose();
        assert_eq!(law.kirchhoff_stress(rest, spin).norm(), 0.0);
    }
    let mut before = 0.0;
    for rate in [0.01, 0.1, 1.0, 10.0, 100.0] {
        let shear = Matrix::<f64, D>::from_fn(|i, j| if (i, j) == (0, 1) { rate } else { 0.0 });
        let stress = law.kirchhoff_stress(rest, shear)[(0, 1)];
        assert!(stress > before);
        before = stress;
        if rate >= 1.0 {
            let expected = 3.0 + 2.0 * rate.sqrt();
            assert!(
                (stress / expected - 1.0).abs() < 2e-3,
                "{stress}, not {expected}"
            );
        }
    }
    // The time step is limited by a longitudinal wave in the fluid at rest.
    let longitudinal = 2.0 * (1.0 - 1.0 / D as f64) * 36.324_555_320_336_756;
    let found = ConstitutiveModel::<D>::viscosity(&law);
    assert!((found / longitudinal - 1.0).abs() < 1e-12);
}

#[test]
fn yielding_stress_is_sound_2d() {
    yielding_stress_is_sound::<2>();
}

#[test]
fn yielding_stress_is_sound_3d() {
    yielding_stress_is_sound::<3>();
}

#[test]
fn viscous_stress_is_newtons() {
    let law = Fluid {
        viscosity: 0.3,
        bulk_viscosity: 0.7,
        ..Fluid::inviscid(1.0)
    };
    let rest = Dilatation {
        jacobian_minus_one: 0.0,
    };
    // A simple shear of 2/s.
    let shear = Matrix::<f64, 3>::from_fn(|i, j| if (i, j) == (0, 1) { 2.0 } else { 0.0 });
    let tau = law.kirchhoff_stress(rest, shear);
    assert_eq!((tau[(0, 1)], tau[(1, 0)]), (0.6, 0.6));
    assert_eq!(tau.trace(), 0.0);
    // Only the bulk viscosity resists an expansion, and a rotation causes no stress.
    let tau = law.kirchhoff_stress(rest, Matrix::<f64, 3>::identity(1.0));
    assert!((tau - identity() * (3.0 * 0.7)).norm() < 1e-15);
    let spin = shear - shear.transpose();
    assert_eq!(law.kirchhoff_stress(rest, spin).norm(), 0.0);
    // A longitudinal wave is damped by κ + 2μ(1 − 1/d).
    assert!((ConstitutiveModel::<3>::viscosity(&law) - (0.7 + 0.4)).abs() < 1e-15);
    assert!((ConstitutiveModel::<2>::viscosity(&law) - (0.7 + 0.3)).abs() < 1e-15);
}

#[test]
fn a_fluid_turned_inside_out_stays_finite_and_comes_back() {
    for update in [JacobianUpdate::Trace, JacobianUpdate::Determinant] {
        let law = Fluid {
            jacobian_update: update,
            ..Fluid::water_like(1000.0, 10.0)
        };
        let crushed = law.advance(
            Dilatation {
                jacobian_minus_one: 0.0f32,
            },
            Matrix::<f32, 3>::scaled_identity(-3.0),
        );
        assert_eq!(crushed.jacobian_minus_one, (SMALLEST_JACOBIAN - 1.0) as f32);
        let zero = Matrix::<f32, 3>::scaled_identity(0.0);
        for strain in [
            crushed,
            Dilatation {
                jacobian_minus_one: -7.0,
            },
        ] {
            let tau = law.kirchhoff_stress(strain, zero);
            assert!(tau[(0, 0)].is_finite() && tau[(0, 0)] < 0.0);
            assert!(ConstitutiveModel::<3>::wave_modulus(&law, strain).is_finite());
            assert!(ConstitutiveModel::<3>::energy_density(&law, strain).is_finite());
        }
        let back = law.advance(crushed, Matrix::<f32, 3>::scaled_identity(1.0));
        assert!(back.jacobian_minus_one > crushed.jacobian_minus_one);
    }
}

/// A change of the bulk modulus keeps the pressure of every particle, and how far torn particles are beyond the tension
/// cut-off.
#[test]
fn another_bulk_modulus_at_the_same_pressure() {
    let eos = [
        Eos::Tait { gamma: 7.0 },
        Eos::Tait { gamma: 1.0 },
        Eos::LinearJ,
    ];
    for (eos, tension) in eos
        .into_iter()
        .flat_map(|eos| [0.0, 300.0, f64::INFINITY].map(|t| (eos, t)))
    {
        let before = Fluid {
            eos,
            tension,
            ..Fluid::inviscid(1e5)
        };
        for factor in [0.25, 9.0] {
            let law = law::<f64, 2, Fluid>(before).with_bulk_modulus(factor * 1e5);
            let fluid = law.fluid().unwrap();
            assert_eq!(fluid.bulk_modulus(), factor * 1e5);
            let after = Fluid {
                bulk_modulus: factor * 1e5,
                ..before
            };
            let start = [-0.02_f64, -1e-3, -1e-7, 0.0, 1e-4, 1e-3, 0.01];
            let moved = start.map(|e| fluid.at_same_pressure(e, 1e5));
            for (&old, &new) in start.iter().zip(&moved) {
                let (p, q) = (before.pressure(old), after.pressure(new));
                assert!((p - q).abs() <= 1e-12 * 1e5, "{before:?} {old}: {p} {q}");
            }
            let cut = |fluid: &Fluid| match tension {
                0.0 => 0.0,
                pull => fluid.jacobian_minus_one_at(-pull),
            };
            if tension.is_finite() && start[6] > cut(&before) {
                let beyond = |e: f64, fluid: &Fluid| (1.0 + e) / (1.0 + cut(fluid));
                let (p, q) = (beyond(start[6], &before), beyond(moved[6], &after));
                assert!((p - q).abs() < 1e-14, "{p} {q}");
            }
        }
    }
}
