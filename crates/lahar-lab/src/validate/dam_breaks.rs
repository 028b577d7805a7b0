//! D1–D6: dam breaks against experiments.

use super::Case;
use super::measure::{at, line, mean, points, root_mean_square, shifted};
use super::running::{CaseError, Series, Session};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "D1",
        title: "Dam break of Martin and Moyce, n² = 2",
        reference: "experiment: Martin & Moyce 1952, tables 2 and 6, doi:10.1098/rsta.1952.0006",
        scene: "d1-martin-moyce",
        long: false,
        run: d1,
    },
    Case {
        id: "D2",
        title: "Dam break of Koshizuka and Oka",
        reference: "experiment: Koshizuka & Oka 1996, doi:10.13182/NSE96-A24205",
        scene: "d2-koshizuka-oka",
        long: false,
        run: d2,
    },
    Case {
        id: "D3",
        title: "Pressure on the wall that a dam break runs into",
        reference: "experiment: Lobovský et al. 2014, H = 0.3 m, doi:10.1016/j.jfluidstructs.2014.03.009",
        scene: "d3-wall-impact",
        long: false,
        run: d3,
    },
    Case {
        id: "D4",
        title: "The same against a computation",
        reference: "simulation: De Courcy et al. 2024, δ-SPH, doi:10.1016/j.cma.2023.116700",
        scene: "d3-wall-impact",
        long: false,
        run: d4,
    },
    Case {
        id: "D5",
        title: "The same against Buchner's gauge",
        reference: "experiment: Buchner 2002",
        scene: "d3-wall-impact",
        long: false,
        run: d5,
    },
    Case {
        id: "D6",
        title: "Bore that hits a square column",
        reference: "experiment: Yeh & Petroff, in Raad & Bidoae 2005, doi:10.1016/j.jcp.2004.09.013",
        scene: "d6-column",
        long: true,
        run: d6,
    },
];

/// Multiplies the times and the values of a series by constants.
fn scaled(series: &[(f64, f64)], time: f64, value: f64) -> Series {
    series.iter().map(|p| (p.0 * time, p.1 * value)).collect()
}

/// Largest shift of time that is fitted, in the time unit of the table.
const SHIFT: f64 = 0.3;

fn d1(session: &mut Session<'_>) -> Result<(), CaseError> {
    let front = points(include_str!(
        "../../data/dambreak_martin_moyce_n2_2_front_table2.csv"
    ));
    let height = points(include_str!(
        "../../data/dambreak_martin_moyce_n2_2_height_table6.csv"
    ));
    let (a, g) = (0.05715, 9.81_f64);
    let mut fronts = vec![("experiment".to_owned(), front.clone())];
    let mut heights = vec![("experiment".to_owned(), height.clone())];
    let early: Series = height.iter().copied().filter(|p| p.0 <= 3.4).collect();
    for cells in session.resolutions(20.0, 40.0) {
        let mut running = session.start(&[("dx", (a / cells).to_string())])?;
        running.frames(|_| {})?;
        let ours = scaled(&running.probe("front", 0), (2.0 * g / a).sqrt(), 1.0 / a);
        let (shift, left) = shifted(&ours, &front, SHIFT);
        let largest = front.iter().map(|p| p.1).fold(0.0, f64::max);
        let inside: Series = ours
            .iter()
            .copied()
            .filter(|p| p.0 - shift >= 2.0 && p.0 - shift <= 3.0)
            .collect();
        let high = scaled(&running.probe("height", 0), (g / a).sqrt(), 0.5 / a);
        let off = root_mean_square(&high, &early, 0.0);
        let at = |what: &str| format!("{what}, a/dx = {cells}");
        // The targets are for forty cells across the column.
        if cells == 40.0 {
            session.at_most(&at("front: shift that was fitted, |dT|"), shift, SHIFT);
            session.at_most(
                &at("front: root mean square after it, of the largest Z"),
                left / largest,
                0.015,
            );
            session.relative(
                &at("front: dZ/dT for T in 2 to 3"),
                1.388,
                line(&inside).0,
                0.03,
            );
            session.at_most(
                &at("height: root mean square, of 2a, tau up to 3.4"),
                off,
                0.010,
            );
        } else {
            session.report(&at("front: shift that was fitted, |dT|"), 0.0, shift);
            session.report(
                &at("front: root mean square after it, of the largest Z"),
                0.0,
                left / largest,
            );
            session.report(&at("front: dZ/dT for T in 2 to 3"), 1.388, line(&inside).0);
            session.report(
                &at("height: root mean square, of 2a, tau up to 3.4"),
                0.0,
                off,
            );
        }
        fronts.push((
            format!("lahar, a/dx = {cells}, shifted by {shift:.3}"),
            ours.iter().map(|p| (p.0 - shift, p.1)).collect(),
        ));
        heights.push((format!("lahar, a/dx = {cells}"), high));
    }
    session.plot(
        "front",
        "D1: front",
        ["T = t sqrt(2g/a)", "Z = x/a"],
        fronts,
    );
    session.plot(
        "height",
        "D1: height at the back wall",
        ["tau = t sqrt(g/a)", "h/(2a)"],
        heights,
    );
    Ok(())
}

fn d2(session: &mut Session<'_>) -> Result<(), CaseError> {
    let front = points(include_str!(
        "../../data/dambreak_koshizuka_oka_1996_front.csv"
    ));
    let (l, g) = (0.146, 9.81_f64);
    let mut lines = vec![("experiment".to_owned(), front.clone())];
    for cells in session.resolutions(20.0, 40.0) {
        let mut running = session.start(&[("dx", (l / cells).to_string())])?;
        running.frames(|_| {})?;
        let ours = scaled(&running.probe("front", 0), (2.0 * g / l).sqrt(), 1.0 / l);
        let (shift, left) = shifted(&ours, &front, SHIFT);
        let largest = front.iter().map(|p| p.1).fold(0.0, f64::max);
        session.at_most(
            &format!("front: root mean square after one shift, of the largest Z, L/dx = {cells}"),
            left / largest,
            0.04,
        );
        session.report(
            &format!("front: shift that was fitted, dT, L/dx = {cells}"),
            0.0,
            shift,
        );
        lines.push((
            format!("lahar, L/dx = {cells}, shifted by {shift:.3}"),
            ours.iter().map(|p| (p.0 - shift, p.1)).collect(),
        ));
    }
    session.plot("front", "D2: front", ["T = t sqrt(2g/L)", "Z = x/L"], lines);
    Ok(())
}

/// Height of the water in d3-wall-impact \[m\].
const H: f64 = 0.6;

/// Returns the readings of gauges, in t sqrt(g/H) and p/(rho g H), for each resolution that is wanted.
fn impacts(
    session: &mut Session<'_>,
    names: &[&str],
) -> Result<Vec<(f64, Vec<Series>)>, CaseError> {
    let mut all = Vec::new();
    for cells in session.resolutions(30.0, 60.0) {
        let mut running = session.start(&[("dx", (H / cells).to_string())])?;
        running.frames(|_| {})?;
        let read = |name: &&str| {
            scaled(
                &running.probe(name, 0),
                (9.81 / H).sqrt(),
                1.0 / (1000.0 * 9.81 * H),
            )
        };
        all.push((cells, names.iter().map(read).collect()));
    }
    Ok(all)
}

/// Returns the time at which a pressure first exceeds a tenth of its mean over the plateau.
fn arrival(series: &[(f64, f64)]) -> f64 {
    let threshold = 0.1 * mean(series, 3.0, 6.0);
    series
        .iter()
        .find(|p| p.1 > threshold && p.0 > 1.0)
        .map_or(f64::NAN, |p| p.0)
}

fn d3(session: &mut Session<'_>) -> Result<(), CaseError> {
    let tables = [
        (
            "P1",
            points(include_str!("../../data/dambreak_lobovsky2014_H300_P1.csv")),
        ),
        (
            "P3",
            points(include_str!("../../data/dambreak_lobovsky2014_H300_P3.csv")),
        ),
        (
            "P4",
            points(include_str!("../../data/dambreak_lobovsky2014_H300_P4.csv")),
        ),
    ];
    let mut plots: Vec<Vec<(String, Series)>> = tables
        .iter()
        .map(|table| vec![("experiment".to_owned(), table.1.clone())])
        .collect();
    for (cells, gauges) in impacts(session, &["L1", "L3", "L4"])? {
        // All gauges have one shift, since the gate takes time to open.
        let shift = arrival(&gauges[0]) - arrival(&tables[0].1);
        session.report(
            &format!("shift, of t sqrt(g/H), H/dx = {cells}"),
            0.0,
            shift,
        );
        for (((name, table), ours), plot) in tables.iter().zip(&gauges).zip(&mut plots) {
            let ours: Series = ours.iter().map(|p| (p.0 - shift, p.1)).collect();
            let end = table.iter().map(|p| p.0).fold(0.0, f64::max).min(6.0);
            if *name != "P1" {
                session.relative(
                    &format!("{name}: arrival, H/dx = {cells}"),
                    arrival(table),
                    arrival(&ours),
                    0.02,
                );
            }
            session.relative(
                &format!("{name}: mean pressure from 3 to {end:.1}, H/dx = {cells}"),
                mean(table, 3.0, end),
                mean(&ours, 3.0, end),
                0.05,
            );
            plot.push((
                format!("lahar, H/dx = {cells}, shifted by {shift:.3}"),
                ours,
            ));
        }
    }
    for ((name, _), plot) in tables.iter().zip(plots) {
        session.plot(
            &name.to_lowercase(),
            &format!("D3: pressure at {name}"),
            ["t sqrt(g/H)", "p/(rho g H)"],
            plot,
        );
    }
    Ok(())
}

fn d4(session: &mut Session<'_>) -> Result<(), CaseError> {
    let tables = [
        (
            "P1",
            points(include_str!("../../data/dambreak_decourcy2024_sim_P1.csv")),
        ),
        (
            "P2",
            points(include_str!("../../data/dambreak_decourcy2024_sim_P2.csv")),
        ),
        (
            "P3",
            points(include_str!("../../data/dambreak_decourcy2024_sim_P3.csv")),
        ),
        (
            "P4",
            points(include_str!("../../data/dambreak_decourcy2024_sim_P4.csv")),
        ),
    ];
    let mut plots: Vec<Vec<(String, Series)>> = tables
        .iter()
        .map(|table| vec![("δ-SPH".to_owned(), table.1.clone())])
        .collect();
    for (cells, gauges) in impacts(session, &["C1", "C2", "C3", "C4"])? {
        for (((name, table), ours), plot) in tables.iter().zip(&gauges).zip(&mut plots) {
            let end = table.iter().map(|p| p.0).fold(0.0, f64::max).min(6.0);
            session.relative(
                &format!("{name}: mean pressure from 3 to {end:.1}, H/dx = {cells}"),
                mean(table, 3.0, end),
                mean(ours, 3.0, end),
                0.04,
            );
            plot.push((format!("lahar, H/dx = {cells}"), ours.clone()));
        }
    }
    for ((name, _), plot) in tables.iter().zip(plots) {
        session.plot(
            &name.to_lowercase(),
            &format!("D4: pressure at {name}"),
            ["t sqrt(g/H)", "p/(rho g H)"],
            plot,
        );
    }
    Ok(())
}

fn d5(session: &mut Session<'_>) -> Result<(), CaseError> {
    let table = points(include_str!("../../data/dambreak_buchner2002_pressure.csv"));
    let mut plot = vec![("experiment".to_owned(), table.clone())];
    for (cells, gauges) in impacts(session, &["B"])? {
        let end = table.iter().map(|p| p.0).fold(0.0, f64::max).min(6.5);
        let begin = arrival(&table);
        let inside: Series = table
            .iter()
            .copied()
            .filter(|p| p.0 >= begin && p.0 <= end)
            .collect();
        let theirs = inside.iter().map(|p| p.1).sum::<f64>() / inside.len() as f64;
        let ours = inside.iter().map(|p| at(&gauges[0], p.0)).sum::<f64>() / inside.len() as f64;
        session.relative(
            &format!("mean pressure at its moments from {begin:.2} to {end:.1}, H/dx = {cells}"),
            theirs,
            ours,
            0.08,
        );
        plot.push((format!("lahar, H/dx = {cells}"), gauges[0].clone()));
    }
    session.plot(
        "pressure",
        "D5: pressure at 0.2 H",
        ["t sqrt(g/H)", "p/(rho g H)"],
        plot,
    );
    Ok(())
}

/// Shifts the time of a series so that 0 is the moment at which it reaches `threshold`.
fn since(series: &[(f64, f64)], threshold: f64) -> Series {
    let first = series.iter().find(|p| p.1 >= threshold);
    let start = first.map_or(f64::NAN, |p| p.0);
    series.iter().map(|p| (p.0 - start, p.1)).collect()
}

/// Force \[N\] and velocity \[m/s\] at which the bore has arrived: a third of the largest values measured.
const BORE: [f64; 2] = [11.0, 0.7];

/// Passage of the bore: from a little before its arrival until the force turns \[s\].
const PASSAGE: [f64; 2] = [-0.05, 0.97];

/// Time over which the velocity was measured without a gap \[s\].
const GAUGED: [f64; 2] = [0.01, 0.6];

fn d6(session: &mut Session<'_>) -> Result<(), CaseError> {
    let force = since(
        &points(include_str!("../../data/dambreak_yeh_petroff_force.csv")),
        BORE[0],
    );
    // The clock of this table begins at the bore's arrival.
    let velocity = points(include_str!("../../data/dambreak_yeh_petroff_velocity.csv"));
    let impulse =
        |series: &[(f64, f64)]| mean(series, PASSAGE[0], PASSAGE[1]) * (PASSAGE[1] - PASSAGE[0]);
    let most = |series: &[(f64, f64)]| series.iter().map(|p| p.1).fold(0.0, f64::max);
    let gauged: Series = velocity
        .iter()
        .copied()
        .filter(|p| p.0 >= GAUGED[0] && p.0 <= GAUGED[1])
        .collect();
    let mut forces = vec![("experiment".to_owned(), force.clone())];
    let mut velocities = vec![("experiment".to_owned(), velocity.clone())];
    // The finer tank is narrower; bodies are cut off at its side.
    let coarse: &[(&str, &str)] = &[];
    let fine: &[_] = &[("dx", "0.0125"), ("domain.max", "[1.6,0.75,0.6125]")];
    for set in session.resolutions(coarse, fine) {
        let owned: Vec<_> = set
            .iter()
            .map(|(key, to)| (*key, (*to).to_owned()))
            .collect();
        let mut running = session.start(&owned)?;
        running.frames(|_| {})?;
        let dx = running.simulation().dx();
        let pushed = since(&running.probe("force", 0), BORE[0]);
        let flows = since(&running.probe("velocity", 0), BORE[1]);
        session.relative(
            &format!("impulse of the bore's passage [N s], dx = {dx} m"),
            impulse(&force),
            impulse(&pushed),
            0.10,
        );
        session.report(
            &format!("largest force [N], dx = {dx} m"),
            most(&force),
            most(&pushed),
        );
        session.report(
            &format!("mean velocity for 0.6 s [m/s], dx = {dx} m"),
            mean(&velocity, GAUGED[0], GAUGED[1]),
            mean(&flows, GAUGED[0], GAUGED[1]),
        );
        session.report(
            &format!("velocity: root mean square of the difference [m/s], dx = {dx} m"),
            0.0,
            root_mean_square(&flows, &gauged, 0.0),
        );
        forces.push((format!("lahar, dx = {dx} m"), pushed));
        velocities.push((format!("lahar, dx = {dx} m"), flows));
    }
    session.plot(
        "force",
        "D6: force on the column",
        ["t since the bore has come [s]", "force [N]"],
        forces,
    );
    session.plot(
        "velocity",
        "D6: velocity before the column",
        ["t since the bore has come [s]", "velocity [m/s]"],
        velocities,
    );
    Ok(())
}
