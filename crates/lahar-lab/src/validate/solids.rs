//! E1–E4: elastic bodies.

use lahar::{Field, Simulate};

use super::Case;
use super::measure::{at, order, period, points, table};
use super::running::{CaseError, Series, Session, field};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "E1",
        title: "Bar that swings along itself",
        reference: "T = 4 L/c = 10 s; v_cm = 0.2/pi cos(2 pi t/T) m/s",
        scene: "e1-bar",
        long: false,
        run: e1,
    },
    Case {
        id: "E2",
        title: "Plate that swings, clamped at one end",
        reference: "Timoshenko's beam, first mode: 0.25647 s",
        scene: "e2-plate",
        long: false,
        run: e2,
    },
    Case {
        id: "E3",
        title: "Cantilevers under their weight",
        reference: "finite elements (Sadeghirad, Brannon & Burghardt 2011, digitized), and the inextensible elastica",
        scene: "e3-cantilever",
        long: false,
        run: e3,
    },
    Case {
        id: "E4",
        title: "Two discs meet and part",
        reference: "momentum and energy are kept; Sulsky, Chen & Schreyer 1994",
        scene: "e4-discs",
        long: false,
        run: e4,
    },
];

fn e1(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut errors = Vec::new();
    for dx in session.resolutions(0.5, 0.25) {
        let mut running = session.start(&[("dx", dx.to_string())])?;
        let rows = running.rows()?;
        let speed: Series = rows
            .iter()
            .map(|row| (row.time, row.momentum[0] / row.mass))
            .collect();
        let ours = period(&speed);
        session.relative(
            &format!("period [s], dx = L/{}", 25.0 / dx),
            10.0,
            ours,
            3e-3,
        );
        errors.push(ours - 10.0);
        let exact =
            |t: f64| 0.2 / core::f64::consts::PI * (core::f64::consts::TAU * t / 10.0).cos();
        if errors.len() == 1 {
            let exact = speed.iter().map(|p| (p.0, exact(p.0))).collect();
            session.plot(
                "speed",
                "E1: mean speed of the bar",
                ["time [s]", "[m/s]"],
                vec![
                    ("exact".into(), exact),
                    (format!("lahar, dx = {dx} m"), speed),
                ],
            );
        }
    }
    report_order(session, "period", &errors);
    Ok(())
}

/// Adds the order of convergence if there are two resolutions, one twice as fine.
fn report_order(session: &mut Session<'_>, of: &str, errors: &[f64]) {
    if let [coarse, fine] = errors {
        session.report(
            &format!("order of convergence, {of}"),
            2.0,
            order(*coarse, *fine, 2.0),
        );
    }
}

/// Period of the first mode (Timoshenko, both corrections) \[s\].
const PLATE_PERIOD: f64 = 0.25647;

fn e2(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut errors = Vec::new();
    for cells in session.resolutions(5.0, 10.0) {
        let mut running = session.start(&[("dx", (0.02 / cells).to_string())])?;
        let rows = running.rows()?;
        let speed: Series = rows
            .iter()
            .map(|row| (row.time, row.momentum[1] / row.mass))
            .collect();
        let ours = period(&speed);
        // The target is for ten cells through the plate.
        if cells == 10.0 {
            session.relative("period [s], H/dx = 10", PLATE_PERIOD, ours, 0.015);
        } else {
            session.report(&format!("period [s], H/dx = {cells}"), PLATE_PERIOD, ours);
        }
        errors.push(ours - PLATE_PERIOD);
        session.plot(
            &format!("speed-{cells}"),
            &format!("E2: mean speed of the plate, H/dx = {cells}"),
            ["time [s]", "[m/s]"],
            vec![("lahar".into(), speed)],
        );
    }
    report_order(session, "period", &errors);
    Ok(())
}

fn e3(session: &mut Session<'_>) -> Result<(), CaseError> {
    let reference = points(include_str!("../../data/solid_cantilever_large_FEM.csv"));
    let deepest = |series: &Series| series.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let mut lines = vec![("finite elements".to_owned(), reference.clone())];
    for (cells, target) in [(8.0, 0.02), (16.0, 0.01)] {
        let dx: f64 = 1.0 / cells;
        let mut running = session.start(&[("dx", dx.to_string())])?;
        let corner = nearest(running.simulation(), [4.0, 0.0]);
        let mut series = Series::new();
        let mut start = None;
        running.frames(|simulation| {
            let x = field(simulation, Field::Position);
            // The particle is missing if the beam has broken.
            if let Some(&y) = x.get(2 * corner + 1) {
                series.push((simulation.time(), y - *start.get_or_insert(y)));
            }
        })?;
        let quantity = format!("deepest displacement of the corner [m], H/dx = {cells}");
        session.relative(&quantity, deepest(&reference), deepest(&series), target);
        // The time at which the corner has come up half way again.
        let half = |series: &Series| {
            let bottom = deepest(series);
            let lowest = series.iter().position(|p| p.1 == bottom).unwrap_or(0);
            let up = series[lowest..].iter().find(|p| p.1 > 0.5 * bottom);
            up.map_or(f64::NAN, |p| p.0)
        };
        let quantity = format!("time at which it is half way up again [s], H/dx = {cells}");
        session.relative(&quantity, half(&reference), half(&series), target);
        lines.push((format!("lahar, H/dx = {cells}"), series));
    }
    session.plot(
        "corner",
        "E3: lower corner of the soft cantilever",
        ["time [s]", "displacement [m]"],
        lines,
    );
    if session.quick() {
        return Ok(());
    }
    elastica(session)
}

/// The second part of E3: a slender cantilever at rest.
fn elastica(session: &mut Session<'_>) -> Result<(), CaseError> {
    let elastica = table(include_str!(
        "../../data/solid_cantilever_selfweight_elastica.csv"
    ));
    let row = elastica[0]
        .iter()
        .position(|alpha| *alpha == 4.0)
        .unwrap_or(0);
    let mut running = session.start_scene("e3-elastica", &[])?;
    let start = field(running.simulation(), Field::Position);
    running.frames(|_| {})?;
    let end = field(running.simulation(), Field::Position);
    // The means over the last two rows of particles, half a cell apart, are extrapolated to the end of the beam.
    let dx = 0.00625;
    let column = |from: f64, to: f64, axis: usize| {
        let inside = start
            .chunks(2)
            .zip(end.chunks(2))
            .filter(|(x, _)| x[0] > from && x[0] < to);
        let values: Vec<f64> = inside.map(|(_, x)| x[axis]).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    let tip = |axis: usize| {
        let (last, before) = (
            column(1.0 - 0.5 * dx, 1.0, axis),
            column(1.0 - dx, 1.0 - 0.5 * dx, axis),
        );
        last + 0.5 * (last - before)
    };
    session.relative(
        "tip's x at rest / L, slender beam, H/dx = 8",
        elastica[1][row],
        tip(0),
        0.02,
    );
    session.relative(
        "tip's drop at rest / L, slender beam, H/dx = 8",
        elastica[2][row],
        0.025 - tip(1),
        0.02,
    );
    Ok(())
}

/// Returns the index (by id) of the particle nearest to a point.
fn nearest(simulation: &dyn Simulate, place: [f64; 2]) -> usize {
    let x = field(simulation, Field::Position);
    let distance = |x: &[f64]| (x[0] - place[0]).hypot(x[1] - place[1]);
    let places = x.chunks(2).enumerate();
    let near = places.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    near.map_or(0, |(index, _)| index)
}

fn e4(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut lines = Vec::new();
    let mut runs = vec![
        ("FLIP, dt = 1e-3 s", "e4-discs", Vec::new()),
        ("APIC, dt = 1e-3 s", "k3-discs", Vec::new()),
    ];
    let at_cfl = |dx: &str| {
        let set = [("dt", "\"auto\""), ("cfl", "0.4"), ("dx", dx)];
        set.map(|(key, value)| (key, value.to_owned())).to_vec()
    };
    runs.push(("APIC, cfl 0.4, 20 cells", "k3-discs", at_cfl("0.05")));
    if !session.quick() {
        runs.push(("APIC, cfl 0.4, 40 cells", "k3-discs", at_cfl("0.025")));
    }
    let mut lost = Vec::new();
    for (name, scene, set) in runs {
        let mut running = session.start_scene(scene, &set)?;
        let rows = running.rows()?;
        let energy: Series = rows
            .iter()
            .map(|row| (row.time, row.kinetic_energy + row.elastic_energy))
            .collect();
        let kept = at(&energy, 3.5) / energy[0].1;
        if name.starts_with("FLIP") {
            session.relative(
                "kinetic energy at the start [J/m]",
                2.51327,
                rows[0].kinetic_energy,
                1e-3,
            );
            let sum: f64 = rows[0].mass * 0.1 * core::f64::consts::SQRT_2;
            let momentum = |row: &lahar::Diagnostics| row.momentum[0].hypot(row.momentum[1]) / sum;
            let worst = rows.iter().map(momentum).fold(0.0, f64::max);
            session.at_most("momentum, of the sum of m |v|", worst, 1e-12);
            session.at_least("energy kept at 3.5 s, FLIP", 0.95, kept);
        } else {
            session.report(&format!("energy kept at 3.5 s, {name}"), 1.0, kept);
            if name.contains("cfl") {
                lost.push(1.0 - kept);
            }
        }
        lines.push((name.to_owned(), energy));
    }
    if let [coarse, fine] = lost[..] {
        session.at_most(
            "APIC's loss at 40 cells over that at 20, cfl 0.4",
            fine / coarse,
            1.0,
        );
    }
    session.plot(
        "energy",
        "E4: energy of the two discs",
        ["time [s]", "[J/m]"],
        lines,
    );
    Ok(())
}
