//! K1–K8: what holds to rounding. The library's own tests ask for more, in more combinations; here is what can be
//! asked of scenes.

use lahar::kernel::{BSpline, Cubic, Quadratic};
use lahar::{Field, Simulate};

use super::Case;
use super::running::{CaseError, Session, field};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "K1",
        title: "Moments of the kernels",
        reference: "exact: sums of w, w r, w r² anywhere in a cell",
        scene: "k2-affine-dust",
        long: false,
        run: k1,
    },
    Case {
        id: "K2",
        title: "An affine motion through the grid and back",
        reference: "exact",
        scene: "k2-affine-dust",
        long: false,
        run: k2,
    },
    Case {
        id: "K3",
        title: "Momentum and angular momentum of free bodies that meet",
        reference: "exact",
        scene: "k3-discs",
        long: false,
        run: k3,
    },
    Case {
        id: "K4",
        title: "Energy of a free elastic body: what is above the start halves with dt",
        reference: "symplectic Euler",
        scene: "k3-discs",
        long: false,
        run: k4,
    },
    Case {
        id: "K6",
        title: "Mass and number of particles in a splash",
        reference: "exact",
        scene: "d1-martin-moyce",
        long: false,
        run: k6,
    },
    Case {
        id: "K7",
        title: "mpm88, the regression of the Taichi project",
        reference: "means of powers of x and 2y at substep 500, from Taichi's own kernels in f64",
        scene: "k7-mpm88-regression",
        long: false,
        run: k7,
    },
    Case {
        id: "K8",
        title: "Free fall of an elastic ball",
        reference: "y0 + v0 n dt − g dt² n (n + 1)/2",
        scene: "k8-free-fall",
        long: false,
        run: k8,
    },
];

/// The largest errors of the three moments over places in a cell, in units of the last place of 1.
fn moments<K: BSpline>() -> f64 {
    let mut worst = 0.0_f64;
    for place in 0..1000 {
        let frac = f64::from(place) / 1000.0;
        let weights = K::weights(frac);
        let moment = |power: i32| -> f64 {
            (0..K::NODES)
                .map(|node| weights[node] * (node as f64 - frac - K::OFFSET).powi(power))
                .sum()
        };
        let exact = [1.0, 0.0, 1.0 / K::INVERSE_INERTIA];
        for (power, exact) in (0..).zip(exact) {
            worst = worst.max((moment(power) - exact).abs() / f64::EPSILON);
        }
    }
    worst
}

fn k1(session: &mut Session<'_>) -> Result<(), CaseError> {
    session.at_most("quadratic, last places of 1", moments::<Quadratic>(), 4.0);
    session.at_most("cubic, last places of 1", moments::<Cubic>(), 4.0);
    Ok(())
}

fn k2(session: &mut Session<'_>) -> Result<(), CaseError> {
    for kernel in ["quadratic", "cubic"] {
        for (precision, target) in [("f64", 1e-13), ("f32", 1e-5)] {
            let set = [("kernel", kernel), ("precision", precision)];
            let set = set.map(|(key, word)| (key, format!("\"{word}\"")));
            let mut running = session.start(&set)?;
            let simulation = running.simulation_mut();
            let before = [Field::Velocity, Field::Affine].map(|name| field(simulation, name));
            simulation.substep()?;
            let after = [Field::Velocity, Field::Affine].map(|name| field(simulation, name));
            let pairs = before.iter().flatten().zip(after.iter().flatten());
            let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            session.at_most(
                &format!("v [m/s] and C [1/s], {kernel}, {precision}"),
                worst,
                target,
            );
        }
    }
    Ok(())
}

fn k3(session: &mut Session<'_>) -> Result<(), CaseError> {
    for transfer in ["apic", "flip", "pic"] {
        let mut running = session.start(&[("transfer", format!("\"{transfer}\""))])?;
        let (mut momentum, mut angular) = (0.0_f64, 0.0_f64);
        let scale = scales(running.simulation());
        let mut last = running.simulation_mut().diagnostics();
        for _ in 0..2000 {
            running.simulation_mut().substep()?;
            let now = running.simulation_mut().diagnostics();
            for axis in 0..2 {
                momentum =
                    momentum.max((now.momentum[axis] - last.momentum[axis]).abs() / scale[0]);
            }
            angular =
                angular.max((now.angular_momentum[2] - last.angular_momentum[2]).abs() / scale[1]);
            last = now;
        }
        session.at_most(
            &format!("momentum, change a substep, {transfer}"),
            momentum,
            1e-12,
        );
        if transfer == "apic" {
            session.at_most("angular momentum, change a substep, apic", angular, 1e-12);
        }
    }
    Ok(())
}

/// Σ m |v| and Σ m |x| |v|.
fn scales(simulation: &dyn Simulate) -> [f64; 2] {
    let [x, v, m] =
        [Field::Position, Field::Velocity, Field::Mass].map(|name| field(simulation, name));
    let rows = x.chunks(2).zip(v.chunks(2)).zip(m);
    rows.fold([0.0; 2], |[p, l], ((x, v), m)| {
        let (far, fast) = (x[0].hypot(x[1]), v[0].hypot(v[1]));
        [p + m * fast, l + m * far * fast]
    })
}

fn k4(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut last = None;
    for cfl in [0.4, 0.2, 0.1] {
        let set = [("dt", "\"auto\"".to_owned()), ("cfl", cfl.to_string())];
        let mut running = session.start(&set)?;
        let mut highest = f64::NEG_INFINITY;
        let mut start = None;
        while running.simulation().time() < 3.5 {
            let row = running.simulation_mut().diagnostics();
            let energy = row.kinetic_energy + row.elastic_energy;
            let start = *start.get_or_insert(energy);
            highest = highest.max(energy / start - 1.0);
            running.simulation_mut().substep()?;
        }
        session.report(
            &format!("largest energy above the start, cfl {cfl}"),
            0.0,
            highest,
        );
        if let Some(before) = last.replace(highest) {
            let ratio = if highest <= 1e-12 {
                0.0
            } else {
                highest / before
            };
            session.at_most(
                &format!("that over the one at cfl {}", 2.0 * cfl),
                ratio,
                0.6,
            );
        }
    }
    Ok(())
}

fn k6(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut running = session.start(&[("dx", "0.0057150".into())])?;
    let rows = running.rows()?;
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    session.absolute(
        "particles",
        first.particles as f64,
        last.particles as f64,
        0.0,
    );
    session.absolute("mass [kg/m]", first.mass, last.mass, 0.0);
    session.absolute("particles that escaped", 0.0, last.escaped as f64, 0.0);
    Ok(())
}

/// Means of the powers 1 to 4 of x and 2y at substep 500, from Taichi's kernels in f64 (Apache-2.0,
/// taichi-dev/taichi, tests/python/test_mpm88.py, which publishes eight digits of them).
const MPM88_MOMENTS: [f64; 4] = [0.317227613, 0.158267514, 0.102240077, 0.0781082624];

fn k7(session: &mut Session<'_>) -> Result<(), CaseError> {
    for (precision, target) in [("f64", 1e-8), ("f32", 1e-5)] {
        let mut running = session.start(&[("precision", format!("\"{precision}\""))])?;
        running.advance_to(0.1)?;
        let x = field(running.simulation(), Field::Position);
        for (power, wanted) in (1..).zip(MPM88_MOMENTS) {
            let sum: f64 = x
                .chunks(2)
                .map(|x| x[0].powi(power) + (2.0 * x[1]).powi(power))
                .sum();
            let moment = sum / x.len() as f64;
            session.relative(
                &format!("moment {power}, {precision}"),
                wanted,
                moment,
                target,
            );
        }
    }
    Ok(())
}

fn k8(session: &mut Session<'_>) -> Result<(), CaseError> {
    for transfer in ["apic", "flip", "pic"] {
        let mut running = session.start(&[("transfer", format!("\"{transfer}\""))])?;
        let height = |simulation: &dyn Simulate| {
            let y = field(simulation, Field::Position);
            let count = (y.len() / 2) as f64;
            y.iter().skip(1).step_by(2).sum::<f64>() / count
        };
        let start = height(running.simulation());
        running.advance_to(0.5)?;
        let (n, dt) = (running.simulation().substeps() as f64, 1e-3);
        let exact = start + 1.5 * n * dt - 9.81 * dt * dt * n * (n + 1.0) / 2.0;
        let ours = height(running.simulation());
        session.absolute(&format!("mean height [m], {transfer}"), exact, ours, 1e-12);
    }
    Ok(())
}
