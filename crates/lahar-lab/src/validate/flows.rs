//! F3, F7–F9: channel flows, a drop, a turning square, a jet.

use lahar::Field;

use super::Case;
use super::measure::{at, mean, order, table};
use super::running::{CaseError, Series, Session, field};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "F3",
        title: "Poiseuille and Couette flow start",
        reference: "series; Morris, Fox & Zhu 1997",
        scene: "f3-poiseuille",
        long: false,
        run: f3,
    },
    Case {
        id: "F7",
        title: "Elliptic drop",
        reference: "ordinary differential equation; Monaghan 1994",
        scene: "f7-elliptic-drop",
        long: false,
        run: f7,
    },
    Case {
        id: "F8",
        title: "Square patch of fluid that turns",
        reference: "series of the incompressible start, -0.147343 rho omega² L²; L_z = rho omega L⁴/6",
        scene: "f8-rotating-square",
        long: false,
        run: f8,
    },
    Case {
        id: "F9",
        title: "Jet on a wall",
        reference: "exact: ½ rho U² at the stagnation point, rho U² h on the wall",
        scene: "f9-jet",
        long: false,
        run: f9,
    },
];

fn f3(session: &mut Session<'_>) -> Result<(), CaseError> {
    starts(session, "f3-poiseuille", "Poiseuille", 2)?;
    starts(session, "f3-couette", "Couette", 3)
}

/// Compares the start of a flow between plates with column number `column` of the table.
fn starts(
    session: &mut Session<'_>,
    scene: &'static str,
    name: &str,
    column: usize,
) -> Result<(), CaseError> {
    let reference = table(include_str!(
        "../../data/fluid_poiseuille_couette_startup.csv"
    ));
    let mut lines = Vec::new();
    for cells in [20.0, 40.0] {
        let dx = 1.0 / cells;
        let mut running = session.start_scene(scene, &[("dx", dx.to_string())])?;
        // The profile of the speed over y in each frame: means over layers of particles.
        let mut profiles: Vec<(f64, Series)> = Vec::new();
        running.frames(|simulation| {
            let (x, v) = (
                field(simulation, Field::Position),
                field(simulation, Field::Velocity),
            );
            profiles.push((simulation.time(), layers(&x, &v, 0.5 * dx)));
        })?;
        let mut worst = 0.0_f64;
        for row in 0..reference[0].len() {
            let (time, y, exact) = (reference[0][row], reference[1][row], reference[column][row]);
            let profile = profiles
                .iter()
                .find(|profile| (profile.0 - time).abs() < 1e-6);
            let ours = profile.map_or(f64::NAN, |profile| at(&profile.1, y));
            if time <= running.scene.duration {
                worst = if ours.is_nan() {
                    ours
                } else {
                    worst.max((ours - exact).abs())
                };
            }
        }
        let quantity = format!("{name}: largest error of the speed / U, {cells} cells");
        if cells == 40.0 {
            session.at_most(&quantity, worst, 5e-3);
        } else {
            session.report(&quantity, 0.0, worst);
        }
        if let Some((_, profile)) = profiles
            .iter()
            .find(|profile| (profile.0 - 0.1).abs() < 1e-6)
        {
            lines.push((format!("lahar, {cells} cells"), profile.clone()));
        }
    }
    let rows = (0..reference[0].len()).filter(|&row| reference[0][row] == 0.1);
    lines.insert(
        0,
        (
            "series".to_owned(),
            rows.map(|row| (reference[1][row], reference[column][row]))
                .collect(),
        ),
    );
    session.plot(
        &name.to_lowercase(),
        &format!("F3: speed across the channel at t = 0.1 L²/nu, {name}"),
        ["y/L", "u/U"],
        lines,
    );
    Ok(())
}

/// Returns the mean v_x of layers of the height `step`, over the mean y of their particles.
fn layers(x: &[f64], v: &[f64], step: f64) -> Series {
    let mut sums = std::collections::BTreeMap::<i64, [f64; 3]>::new();
    for (x, v) in x.chunks(2).zip(v.chunks(2)) {
        let sum = sums.entry((x[1] / step).floor() as i64).or_default();
        *sum = [sum[0] + x[1], sum[1] + v[0], sum[2] + 1.0];
    }
    sums.into_values().map(|[y, u, n]| (y / n, u / n)).collect()
}

fn f7(session: &mut Session<'_>) -> Result<(), CaseError> {
    let reference = table(include_str!(
        "../../data/fluid_elliptic_drop_monaghan1994.csv"
    ));
    let exact: Series = reference[0]
        .iter()
        .copied()
        .zip(reference[2].iter().copied())
        .collect();
    let mut lines = vec![("exact".to_owned(), exact)];
    let mut errors = Vec::new();
    for cells in session.resolutions(20.0, 40.0) {
        let mut running = session.start(&[("dx", (1.0 / cells).to_string())])?;
        let mut axis = Series::new();
        running.frames(|simulation| {
            // A homogeneous ellipse with the half axis b has the mean b²/4 of y².
            let (x, m) = (
                field(simulation, Field::Position),
                field(simulation, Field::Mass),
            );
            let second: f64 = x.chunks(2).zip(&m).map(|(x, m)| m * x[1] * x[1]).sum();
            axis.push((
                simulation.time(),
                2.0 * (second / m.iter().sum::<f64>()).sqrt(),
            ));
        })?;
        let mut worst = 0.0_f64;
        for (t, exact) in reference[0].iter().zip(&reference[2]) {
            let off = at(&axis, *t) / exact - 1.0;
            if off.abs() > worst.abs() {
                worst = off;
            }
        }
        session.at_most(
            &format!("worst relative error of the major axis, R/dx = {cells}"),
            worst,
            5e-3,
        );
        errors.push(worst);
        lines.push((format!("lahar, R/dx = {cells}"), axis));
    }
    if let [coarse, fine] = errors[..] {
        session.report("order of convergence", 2.0, order(coarse, fine, 2.0));
    }
    session.plot("axis", "F7: major half axis", ["time [s]", "[m]"], lines);
    Ok(())
}

fn f8(session: &mut Session<'_>) -> Result<(), CaseError> {
    // rho omega² L² = 1000 Pa; the slowest mode of a free square has the period sqrt(2) L/c.
    let (exact, acoustic) = (-147.343, core::f64::consts::SQRT_2 / 150.0);
    let mut lines = Vec::new();
    for cells in session.resolutions(40.0, 80.0) {
        let mut running = session.start(&[("dx", (1.0 / cells).to_string())])?;
        let rows = running.rows()?;
        let pressure = running.probe("middle", 0);
        let ours = mean(&pressure, 0.0, 10.0 * acoustic);
        session.relative(
            &format!("mean pressure over ten acoustic periods [Pa], {cells} cells"),
            exact,
            ours,
            0.05,
        );
        let turn = |row: &lahar::Diagnostics| row.angular_momentum[2];
        let drift = rows
            .iter()
            .map(|row| (turn(row) / turn(&rows[0]) - 1.0).abs())
            .fold(0.0, f64::max);
        session.at_most(
            &format!("drift of the angular momentum, {cells} cells"),
            drift,
            1e-10,
        );
        // Of point masses with the moments of the kernel, which are a little more than the body's.
        session.report(
            &format!("angular momentum at the start [kg m/s], {cells} cells"),
            1000.0 / 6.0,
            turn(&rows[0]),
        );
        lines.push((format!("lahar, {cells} cells"), pressure));
    }
    lines.insert(
        0,
        (
            "mean by the series".to_owned(),
            vec![(0.0, exact), (0.1, exact)],
        ),
    );
    session.plot(
        "pressure",
        "F8: pressure in the middle",
        ["time [s]", "[Pa]"],
        lines,
    );
    Ok(())
}

fn f9(session: &mut Session<'_>) -> Result<(), CaseError> {
    let mut lines = Vec::new();
    for cells in session.resolutions(10.0, 20.0) {
        let mut running = session.start(&[("dx", (0.1 / cells).to_string())])?;
        running.frames(|_| {})?;
        // From the end of the first sound waves to the end of most of the jet. The mean is long, since the pressure at one
        // point changes by percents with the positions of few particles.
        let (from, to) = (0.05, 0.5);
        let (pressure, force) = (running.probe("stagnation", 0), running.probe("wall", 0));
        session.relative(
            &format!("pressure at the stagnation point [Pa], h/dx = {cells}"),
            5e4,
            mean(&pressure, from, to),
            0.03,
        );
        session.relative(
            &format!("force on the wall [N/m], h/dx = {cells}"),
            -1e4,
            mean(&force, from, to),
            0.03,
        );
        lines.push((format!("lahar, h/dx = {cells}"), pressure));
    }
    lines.insert(0, ("½ rho U²".to_owned(), vec![(0.0, 5e4), (0.5, 5e4)]));
    session.plot(
        "pressure",
        "F9: pressure at the stagnation point",
        ["time [s]", "[Pa]"],
        lines,
    );
    Ok(())
}
