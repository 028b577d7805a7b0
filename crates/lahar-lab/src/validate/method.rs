//! K1–K4 and K6–K8: checks of the method, run on scenes. The tests of this crate run the same checks in more
//! combinations.

use lahar::Simulate;
use lahar::kernel::{BSpline, Cubic, Quadratic};

use super::Case;
use super::running::{CaseError, Session};
use crate::method::conservation::{affine_change, free_fall, momentum_change};
use crate::method::energy::excess;
use crate::method::engine::{OfScene, particles_of};
use crate::method::{kernels, mpm88};

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

/// Returns the largest error of Σ w, Σ w r and Σ w r² over a cell, in units of the precision.
fn largest_moment_error<K: BSpline>() -> f64 {
    let errors = kernels::moment_errors::<K, f64>();
    errors[..3].iter().copied().fold(0.0, f64::max)
}

fn k1(session: &mut Session<'_>) -> Result<(), CaseError> {
    let quadratic = largest_moment_error::<Quadratic>();
    let cubic = largest_moment_error::<Cubic>();
    session.at_most("quadratic, last places of 1", quadratic, 4.0);
    session.at_most("cubic, last places of 1", cubic, 4.0);
    Ok(())
}

fn k2(session: &mut Session<'_>) -> Result<(), CaseError> {
    for kernel in ["quadratic", "cubic"] {
        for (precision, target) in [("f64", 1e-13), ("f32", 1e-5)] {
            let set = [("kernel", kernel), ("precision", precision)];
            let set = set.map(|(key, word)| (key, format!("\"{word}\"")));
            let mut running = session.start(&set)?;
            let mut engine = OfScene(running.simulation_mut());
            let [velocities, affine] = affine_change::<_, 2>(&mut engine)?;
            session.at_most(
                &format!("v [m/s] and C [1/s], {kernel}, {precision}"),
                velocities.max(affine),
                target,
            );
        }
    }
    Ok(())
}

fn k3(session: &mut Session<'_>) -> Result<(), CaseError> {
    for transfer in ["apic", "flip", "pic"] {
        let mut running = session.start(&[("transfer", format!("\"{transfer}\""))])?;
        let mut engine = OfScene(running.simulation_mut());
        let change = momentum_change::<_, 2>(&mut engine, 2000)?;
        let quantity = format!("momentum, change a substep, {transfer}");
        session.at_most(&quantity, change.linear, 1e-12);
        if transfer == "apic" {
            let quantity = "angular momentum, change a substep, apic";
            session.at_most(quantity, change.angular, 1e-12);
        }
    }
    Ok(())
}

fn k4(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut last = None;
    for cfl in [0.4, 0.2, 0.1] {
        let set = [("dt", "\"auto\"".to_owned()), ("cfl", cfl.to_string())];
        let mut running = session.start(&set)?;
        let mut energies = Vec::new();
        while running.simulation().time() < 3.5 {
            let row = running.simulation_mut().diagnostics();
            energies.push(row.kinetic_energy + row.elastic_energy);
            running.simulation_mut().substep()?;
        }
        let highest = excess(&energies);
        let quantity = format!("largest energy above the start, cfl {cfl}");
        session.report(&quantity, 0.0, highest);
        if let Some(before) = last.replace(highest) {
            let ratio = if highest <= 1e-12 {
                0.0
            } else {
                highest / before
            };
            let quantity = format!("that over the one at cfl {}", 2.0 * cfl);
            session.at_most(&quantity, ratio, 0.6);
        }
    }
    Ok(())
}

fn k6(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut running = session.start(&[("dx", "0.0057150".into())])?;
    let rows = running.rows()?;
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    let (before, after) = (first.particles as f64, last.particles as f64);
    session.absolute("particles", before, after, 0.0);
    session.absolute("mass [kg/m]", first.mass, last.mass, 0.0);
    session.absolute("particles that escaped", 0.0, last.escaped as f64, 0.0);
    Ok(())
}

fn k7(session: &mut Session<'_>) -> Result<(), CaseError> {
    let reference = mpm88::published_moments();
    for (precision, target) in [("f64", 1e-8), ("f32", 1e-5)] {
        let mut running = session.start(&[("precision", format!("\"{precision}\""))])?;
        running.advance_to(0.1)?;
        let found = mpm88::moments(&particles_of(running.simulation()));
        for (power, (ours, published)) in (1..).zip(found.into_iter().zip(reference)) {
            let quantity = format!("moment {power}, {precision}");
            session.relative(&quantity, published, ours, target);
        }
    }
    Ok(())
}

fn k8(session: &mut Session<'_>) -> Result<(), CaseError> {
    for transfer in ["apic", "flip", "pic"] {
        let mut running = session.start(&[("transfer", format!("\"{transfer}\""))])?;
        let height = |simulation: &dyn Simulate| {
            let particles = particles_of::<2>(simulation);
            particles.iter().map(|p| p.position[1]).sum::<f64>() / particles.len() as f64
        };
        let start = height(running.simulation());
        running.advance_to(0.5)?;
        let substeps = running.simulation().substeps() as f64;
        let exact = start + free_fall(1.5, -9.81, 1e-3, substeps);
        let ours = height(running.simulation());
        session.absolute(&format!("mean height [m], {transfer}"), exact, ours, 1e-12);
    }
    Ok(())
}
