//! F4: water at rest.

use lahar::{Field, Simulate};

use super::Case;
use super::measure::{mean, percentile, spread_a_cell, to_nearest};
use super::running::{CaseError, RunningScene, Session, field};

pub(super) const CASES: &[Case] = &[Case {
    id: "F4",
    title: "Tank of water at rest",
    reference: "exact: p = rho c² (exp(g (H - y)/c²) - 1); the floor bears the weight",
    scene: "f4-tank",
    long: false,
    run: f4,
}];

/// Depth of the water \[m\].
const DEPTH: f64 = 1.0;

/// Acceleration of gravity \[m/s²\].
const GRAVITY: f64 = 9.81;

/// Substeps of the full case.
const SUBSTEPS: u64 = 100_000;

/// Substeps of the quick case.
const QUICK_SUBSTEPS: u64 = 10_000;

fn f4(session: &mut Session<'_>) -> Result<(), CaseError> {
    for sampling in ["lattice", "jittered"] {
        let set = [("bodies.water.sampling", format!("\"{sampling}\""))];
        let running = session.start(&set)?;
        at_rest(session, running, &format!("2D, {sampling}"))?;
    }
    if session.quick() {
        return Ok(());
    }
    for sampling in ["lattice", "jittered"] {
        let set = [("bodies.water.sampling", format!("\"{sampling}\""))];
        let running = session.start_scene("f4-tank-3d", &set)?;
        at_rest(session, running, &format!("3D, {sampling}"))?;
    }
    // The first wave of the tank, half a wave long, 0.06 m high.
    let wave = "[\"-0.5*cosh(2*pi*y)/sinh(2*pi)*sin(2*pi*x)\", \"0.5*sinh(2*pi*y)/sinh(2*pi)*cos(2*pi*x)\"]";
    let mut running = session.start(&[("bodies.water.velocity", wave.to_owned())])?;
    let before = evenness(&running);
    let first = running.simulation_mut().diagnostics();
    let energy =
        |row: &lahar::Diagnostics| row.kinetic_energy + row.elastic_energy + row.potential_energy;
    let mut highest = energy(&first);
    let start = highest;
    running.frames(|simulation| highest = highest.max(energy(&simulation.diagnostics())))?;
    let last = running.simulation_mut().diagnostics();
    session.relative(
        "volume after 12 s of sloshing [m²], 2D, jittered",
        first.volume,
        last.volume,
        0.01,
    );
    session.at_most(
        "energy above its start, of the kinetic at the start, sloshing",
        (highest - start) / first.kinetic_energy,
        1e-3,
    );
    clumping(
        session,
        before,
        evenness(&running),
        "2D, jittered, after sloshing",
    );
    Ok(())
}

/// Measures forces, pressures, speeds and volumes of a tank at rest.
fn at_rest(
    session: &mut Session<'_>,
    mut running: RunningScene,
    what: &str,
) -> Result<(), CaseError> {
    let substeps = if session.quick() {
        QUICK_SUBSTEPS
    } else {
        SUBSTEPS
    };
    let before = evenness(&running);
    let first = running.simulation_mut().diagnostics();
    let mut fastest = 0.0_f64;
    while running.simulation().substeps() < substeps {
        running.frame()?;
        fastest = fastest.max(running.simulation_mut().diagnostics().max_speed);
    }
    let last = running.simulation_mut().diagnostics();
    let weight = first.mass * GRAVITY;
    let c = running.scene.materials[0].wave_speed;
    let base = 1000.0 * c * c * (GRAVITY * DEPTH / (c * c)).exp_m1();
    let end = running.simulation().time();
    // Each reading is the mean force since the one before, so that their mean covers the whole time.
    let force = running.probe("floor", 1);
    let readings = force.iter().filter(|p| p.0 > 0.1 * end);
    let force = readings.clone().map(|p| -p.1).sum::<f64>() / readings.count() as f64;
    session.relative(
        &format!("mean force on the floor [N; N/m in 2D], {what}"),
        weight,
        force,
        1e-3,
    );
    let pressure = mean(&running.probe("base", 0), 0.1 * end, end);
    session.relative(
        &format!("mean pressure at the base [Pa], {what}"),
        base,
        pressure,
        5e-3,
    );
    let fastest = fastest / (GRAVITY * DEPTH).sqrt();
    if what.ends_with("lattice") {
        session.at_most(&format!("largest speed / sqrt(g H), {what}"), fastest, 1e-3);
    } else {
        session.report(&format!("largest speed / sqrt(g H), {what}"), 0.0, fastest);
    }
    session.relative(
        &format!("filled volume at the end [m³; m² in 2D], {what}"),
        first.volume,
        last.volume,
        1e-3,
    );
    let surface = running.probe("column", 0);
    if let (Some(first), Some(last)) = (surface.first(), surface.last()) {
        session.relative(
            &format!("height of the surface in the middle at the end [m], {what}"),
            first.1,
            last.1,
            1e-3,
        );
    }
    clumping(session, before, evenness(&running), what);
    Ok(())
}

/// Returns two measures of how evenly particles are spread: the first percentile of the distance to the nearest neighbor
/// \[cells\], and the standard deviation of the number of particles per cell in the lower nine tenths.
fn evenness(running: &RunningScene) -> [f64; 2] {
    let simulation: &dyn Simulate = running.simulation();
    let (d, dx) = (simulation.dimension(), simulation.dx());
    let x: Vec<f64> = field(simulation, Field::Position)
        .iter()
        .map(|x| x / dx)
        .collect();
    // Particles are seeded in halves of cells. Shifted cells cut across those, and so show the spread inside them.
    let across: Vec<f64> = x.iter().map(|x| x + 0.2).collect();
    let spread = spread_a_cell(&across, d, 0.9 * DEPTH / dx);
    [percentile(to_nearest(&x, d), 0.01), spread]
}

/// Changes that rounding of positions and compression of the water cause \[cells; particles per cell\].
const UNCHANGED: f64 = 1e-3;

/// Compares the measures of evenness before and after.
fn clumping(session: &mut Session<'_>, before: [f64; 2], after: [f64; 2], what: &str) {
    session.at_least(
        &format!("nearest neighbors, first percentile / dx, {what}"),
        before[0] - UNCHANGED,
        after[0],
    );
    session.at_most(
        &format!("spread of the particles in a cell, above the start's, {what}"),
        (after[1] - before[1]).max(0.0),
        UNCHANGED,
    );
}
