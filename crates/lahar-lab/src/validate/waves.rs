//! F1, F2, F5, F6: vortices, shear waves, gravity waves, sound.

use core::f64::consts::{PI, TAU};

use lahar::Field;

use super::Case;
use super::measure::{line, order, period};
use super::running::{CaseError, Series, Session, field, mode};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "F1",
        title: "Taylor-Green whirls at Re = 100",
        reference: "kinetic energy ¼ exp(2 b t) with b = -8 pi²/Re; Taylor & Green 1937",
        scene: "f1-taylor-green",
        long: false,
        run: f1,
    },
    Case {
        id: "F2",
        title: "Shear wave without viscosity",
        reference: "exact: it stays; what is lost is numerical viscosity",
        scene: "f2-shear-wave",
        long: false,
        run: f2,
    },
    Case {
        id: "F5",
        title: "Standing gravity wave",
        reference: "linear theory, omega² = g k tanh(k d)",
        scene: "f5-standing-wave",
        long: false,
        run: f5,
    },
    Case {
        id: "F6",
        title: "Acoustic mode of a closed box",
        reference: "exact: T = 2 L/c",
        scene: "f6-acoustic-mode",
        long: false,
        run: f6,
    },
];

fn f1(session: &mut Session<'_>) -> Result<(), CaseError> {
    let b = -8.0 * PI * PI / 100.0;
    let mut lines = Vec::new();
    let mut errors = Vec::new();
    for (cells, target) in session.resolutions((50.0, 0.04), (100.0, 0.01)) {
        let mut running = session.start(&[("dx", (1.0 / cells).to_string())])?;
        let rows = running.rows()?;
        let energy: Series = rows
            .iter()
            .map(|row| (row.time, row.kinetic_energy))
            .collect();
        let logarithms: Series = energy.iter().map(|p| (p.0, p.1.ln())).collect();
        let rate = line(&logarithms).0;
        session.relative(
            &format!("decay rate of the energy [1/s], {cells}²"),
            2.0 * b,
            rate,
            target,
        );
        errors.push(rate - 2.0 * b);
        let simulation = running.simulation();
        let decay = (b * simulation.time()).exp();
        let (x, v) = (
            field(simulation, Field::Position),
            field(simulation, Field::Velocity),
        );
        let (mut off, mut sum) = (0.0, 0.0);
        for (x, v) in x.chunks(2).zip(v.chunks(2)) {
            let exact = decay
                * ((TAU * x[0]).cos() * (TAU * x[1]).sin())
                    .hypot((TAU * x[0]).sin() * (TAU * x[1]).cos());
            off += (v[0].hypot(v[1]) - exact).abs();
            sum += exact;
        }
        session.at_most(
            &format!("L1 error of the speed at 1 s, {cells}²"),
            off / sum,
            0.03,
        );
        if lines.is_empty() {
            let exact = energy
                .iter()
                .map(|p| (p.0, 0.25 * (2.0 * b * p.0).exp()))
                .collect();
            lines.push(("exact".to_owned(), exact));
        }
        lines.push((format!("lahar, {cells}²"), energy));
    }
    if let [coarse, fine] = errors[..] {
        session.report(
            "order of convergence of the decay rate",
            2.0,
            order(coarse, fine, 2.0),
        );
    }
    session.plot(
        "energy",
        "F1: kinetic energy of the whirls",
        ["time [s]", "[J/m]"],
        lines,
    );
    Ok(())
}

fn f2(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut found = Vec::new();
    let mut lines = Vec::new();
    for dx in session.resolutions(0.025, 0.0125) {
        let mut running = session.start(&[("dx", dx.to_string())])?;
        let mut amplitude = Series::new();
        running.frames(|simulation| {
            let part = mode(simulation, 0, |x| (TAU * x[1]).sin());
            amplitude.push((simulation.time(), part));
        })?;
        let logarithms: Series = amplitude.iter().map(|p| (p.0, p.1.abs().ln())).collect();
        let viscosity = -line(&logarithms).0 / (TAU * TAU);
        session.at_most(
            &format!("numerical viscosity / (U dx), {} cells a wave", 1.0 / dx),
            viscosity / dx,
            0.02,
        );
        found.push(viscosity);
        lines.push((format!("lahar, {} cells a wave", 1.0 / dx), amplitude));
    }
    if let [coarse, fine] = found[..] {
        session.at_least(
            "order of the numerical viscosity",
            1.8,
            order(coarse, fine, 2.0),
        );
    }
    session.plot(
        "amplitude",
        "F2: what is left of the shear wave",
        ["time [s]", "amplitude [m/s]"],
        lines,
    );
    Ok(())
}

fn f5(session: &mut Session<'_>) -> Result<(), CaseError> {
    let k = PI;
    let exact = TAU / (9.81 * k * k.tanh()).sqrt();
    let mut lines = Vec::new();
    let mut errors = Vec::new();
    let samplings = if session.quick() {
        vec!["jittered"]
    } else {
        vec!["jittered", "lattice"]
    };
    for cells in session.resolutions(14.0, 28.0) {
        for sampling in &samplings {
            let mut running = session.start(&[
                ("dx", (1.0 / cells).to_string()),
                ("bodies.water.sampling", format!("\"{sampling}\"")),
            ])?;
            running.frames(|_| {})?;
            // Half the difference, in which vertical motion of the whole tank cancels.
            let (left, middle) = (running.probe("left", 0), running.probe("middle", 0));
            let wave: Series = left
                .iter()
                .zip(&middle)
                .map(|(a, b)| (a.0, 0.5 * (a.1 - b.1)))
                .collect();
            let ours = period(&smooth(&wave, 0.05));
            let quantity = format!("period [s], d/dx = {cells}, {sampling}");
            if cells == 28.0 {
                session.relative(&quantity, exact, ours, 0.01);
            } else {
                session.report(&quantity, exact, ours);
            }
            if *sampling == "jittered" {
                errors.push(ours - exact);
            }
            lines.push((format!("lahar, d/dx = {cells}, {sampling}"), wave));
        }
    }
    if let Some((_, wave)) = lines.first() {
        let theory = wave
            .iter()
            .map(|p| (p.0, 0.02 * (TAU * p.0 / exact).sin()))
            .collect();
        lines.insert(0, ("linear theory".to_owned(), theory));
    }
    if let [coarse, fine] = errors[..] {
        session.report(
            "order of convergence of the period",
            2.0,
            order(coarse, fine, 2.0),
        );
    }
    session.plot(
        "height",
        "F5: half the difference of heights at the wall and in the middle",
        ["time [s]", "[m]"],
        lines,
    );
    Ok(())
}

/// Smooths a series by means over ± `width` \[s\].
fn smooth(series: &[(f64, f64)], width: f64) -> Series {
    let mean = |t: f64| {
        let near = series.iter().filter(|p| (p.0 - t).abs() <= width);
        let (sum, count) = near.fold((0.0, 0.0), |(sum, count), p| (sum + p.1, count + 1.0));
        sum / count
    };
    series.iter().map(|p| (p.0, mean(p.0))).collect()
}

fn f6(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut errors = Vec::new();
    let cells_and_targets = if session.quick() {
        vec![40.0]
    } else {
        vec![20.0, 40.0]
    };
    for cells in cells_and_targets {
        for (transfer, kept_at_least) in [("apic", 0.995), ("flip", 0.999)] {
            let dx: f64 = 1.0 / cells;
            let mut set = vec![
                ("dx", dx.to_string()),
                ("transfer", format!("\"{transfer}\"")),
                ("domain.max", format!("[1.0, {}]", 4.0 * dx)),
                (
                    "bodies.fluid.shape",
                    format!(
                        "{{ box = {{ min = [0.0, 0.0], max = [1.0, {}] }} }}",
                        4.0 * dx
                    ),
                ),
            ];
            if transfer == "flip" {
                set.push(("flip_blend", "1.0".into()));
            }
            let mut running = session.start(&set)?;
            let mut wave = Series::new();
            running.frames(|simulation| {
                let part = mode(simulation, 0, |x| (PI * x[0]).sin());
                wave.push((simulation.time(), part));
            })?;
            let ours = period(&wave);
            // The amplitude is the largest value within a period.
            let highest = |from: f64| {
                let inside = wave.iter().filter(|p| p.0 >= from && p.0 <= from + 0.2);
                inside.map(|p| p.1.abs()).fold(0.0, f64::max)
            };
            let kept = highest(1.8) / highest(0.0);
            if cells == 40.0 {
                session.relative(
                    &format!("period [s], {transfer}, 40 cells"),
                    0.2,
                    ours,
                    2e-3,
                );
                session.at_least(
                    &format!("amplitude kept over 9 periods, {transfer}, 40 cells"),
                    kept_at_least,
                    kept,
                );
            } else {
                session.report(&format!("period [s], {transfer}, {cells} cells"), 0.2, ours);
                session.report(
                    &format!("amplitude kept over 9 periods, {transfer}, {cells} cells"),
                    1.0,
                    kept,
                );
            }
            if transfer == "apic" {
                errors.push(ours - 0.2);
            }
        }
    }
    if let [coarse, fine] = errors[..] {
        session.report(
            "order of convergence of the period, apic",
            2.0,
            order(coarse, fine, 2.0),
        );
    }
    Ok(())
}
