//! Water in scenes: a tank at rest stays at rest, and a tank that sloshes keeps its volume.

use crate::support::parse;
use lahar::{Command, Diagnostics, Field, Isa, Simulate};
use lahar_scene::scene::Scene;

const G: f64 = 9.81; // m/s²

/// Builds a tank 1 m wide, filled with water 0.5 m deep that moves sideways at `velocity` \[m/s\].
fn tank(extra_material: &str, extra_body: &str, velocity: f64) -> Box<dyn Simulate> {
    let scene = scene(extra_material, extra_body, velocity, &[]);
    scene.build(Isa::detect()).expect("it builds").simulation
}

fn scene(extra_material: &str, extra_body: &str, velocity: f64, changes: &[(&str, &str)]) -> Scene {
    let text = format!(
        r#"
        title = "Tank"
        dimension = 2
        duration = 10.0
        gravity = [0.0, -{G}]
        dx = 0.05
        cfl = 0.4
        [domain]
        min = [0.0, 0.0]
        max = [1.0, 1.0]
        walls = "separate"
        [materials.water]
        model = "fluid"
        density = 1000.0
        gamma = 1.0
        sound_speed = 30.0
        {extra_material}
        [[bodies]]
        name = "water"
        material = "water"
        shape = {{ box = {{ min = [0.0, 0.0], max = [1.0, 0.5] }} }}
        velocity = [{velocity}, 0.0]
        pressure = "hydrostatic"
        {extra_body}
        "#
    );
    parse(&text, changes)
}

/// Returns diagnostics every half second for `seconds`.
fn rows(mut simulation: Box<dyn Simulate>, seconds: f64) -> Vec<Diagnostics> {
    let mut rows = vec![simulation.diagnostics()];
    for frame in 1..=(2.0 * seconds) as usize {
        simulation
            .advance_to(0.5 * frame as f64)
            .expect("water does not blow up");
        rows.push(simulation.diagnostics());
    }
    rows
}

/// Returns the largest relative change of a total from its start.
fn drift(rows: &[Diagnostics], of: impl Fn(&Diagnostics) -> f64) -> f64 {
    let start = of(&rows[0]);
    rows.iter()
        .map(|row| (of(row) / start - 1.0).abs())
        .fold(0.0, f64::max)
}

#[test]
fn a_tank_at_rest_stays_at_rest() {
    let speed = (G * 0.5_f64).sqrt();
    let lattice = rows(tank("", "sampling = \"lattice\"", 0.0), 2.0);
    assert!(drift(&lattice, |row| row.potential_energy) < 1e-5);
    assert!(drift(&lattice, |row| row.volume) < 1e-4);
    assert!(lattice.iter().all(|row| row.max_speed < 1e-4 * speed));

    // Ten cells deep, jittered particles settle by a part of a cell.
    let jittered = rows(tank("", "", 0.0), 2.0);
    assert!(drift(&jittered, |row| row.potential_energy) < 2e-3);
    assert!(drift(&jittered, |row| row.volume) < 4e-3);
    let alike = rows(tank("", "volume = \"alike\"", 0.0), 2.0);
    let stirred = |rows: &[Diagnostics]| {
        let energies = rows.iter().map(|row| row.kinetic_energy);
        energies.fold(0.0, f64::max)
    };
    assert!(
        stirred(&alike) > 2.0 * stirred(&jittered),
        "measured volumes must make a difference: {} {}",
        stirred(&alike),
        stirred(&jittered)
    );
}

#[test]
fn a_slosh_keeps_its_volume_and_never_gains_energy() {
    let energy = |row: &Diagnostics| row.kinetic_energy + row.elastic_energy + row.potential_energy;
    let corrected = rows(tank("", "", 0.7), 10.0);
    let plain = rows(tank("volume = \"jacobian\"", "", 0.7), 10.0);
    let (kept, lost) = (
        drift(&corrected, |row| row.volume),
        drift(&plain, |row| row.volume),
    );
    assert!(kept < 0.01, "{kept}");
    assert!(lost > 2.0 * kept, "the plain rule must lose more: {lost}");
    for pair in corrected.windows(2) {
        assert!(energy(&pair[1]) <= energy(&pair[0]), "{}", pair[1].time);
    }
    let mass = corrected[0].mass;
    assert!(corrected.iter().all(|row| row.mass == mass));
}

/// When gravity grows during a run, water with the default speed of sound gets stiffer: pressures stay the same at that
/// moment, and the water is not compressed more than before.
#[test]
fn automatic_stiffness_follows_gravity() {
    let automatic = [
        ("materials.water.sound_speed", "\"auto\""),
        ("precision", "\"f64\""),
    ];
    let mut scene = scene("", "sampling = \"lattice\"", 0.0, &automatic);
    let speeds = scene.sound_speeds();
    let speed_of = |command: Command| match command {
        Command::SoundSpeed { material: 0, speed } => speed,
        other => panic!("{other:?}"),
    };
    let under = |gravity| {
        speeds
            .under(gravity)
            .into_iter()
            .map(speed_of)
            .collect::<Vec<_>>()
    };
    let close = |found: Vec<f64>, fall: f64| {
        let expected = 10.0 * (2.0 * fall).sqrt();
        assert!(
            found.len() == 1 && (found[0] / expected - 1.0).abs() < 1e-12,
            "{found:?}"
        );
    };
    close(under([0.0, -G, 0.0]), G * 0.5);
    close(under([0.0, -4.0 * G, 0.0]), 4.0 * G * 0.5);
    close(under([G, 0.0, 0.0]), G * 1.0); // through the whole tank
    close(under([0.0, G, 0.0]), G * 1.0);
    close(under([0.0, -0.1 * G, 0.0]), G * 0.5); // not softer than at the start

    // A state with a range of pressures.
    let start = |scene: &Scene| {
        let mut simulation = scene.build(Isa::detect()).expect("it builds").simulation;
        simulation.advance_to(0.2).expect("at rest");
        simulation
    };
    let pressures = |simulation: &dyn Simulate| {
        let snapshot = simulation.snapshot(&[Field::Pressure, Field::Jacobian]);
        [Field::Pressure, Field::Jacobian].map(|field| snapshot.get(field).expect("asked").to_f64())
    };
    let gravity = [0.0, -9.0 * G, 0.0];
    let mut follows = start(&scene);
    let [before, j_before] = pressures(&*follows);
    follows.command(Command::Gravity(gravity));
    for command in speeds.under(gravity) {
        follows.command(command);
    }
    let [after, j_after] = pressures(&*follows);
    let largest = before.iter().copied().fold(0.0, f64::max);
    assert!(largest > 0.8e3 * G * 0.5);
    for (before, after) in before.iter().zip(&after) {
        assert!((before - after).abs() < 1e-9 * largest, "{before} {after}");
    }
    let squeeze = |j: &[f64]| j.iter().map(|j| 1.0 - j).fold(0.0, f64::max);
    assert!((squeeze(&j_before) / squeeze(&j_after) / 9.0 - 1.0).abs() < 0.02);

    let mut stays = start(&scene);
    stays.command(Command::Gravity(gravity));
    let worst = |simulation: &mut dyn Simulate| {
        let mut worst = 0.0_f64;
        for step in 1..=20 {
            let time = 0.2 + 0.02 * f64::from(step);
            simulation.advance_to(time).expect("stable");
            worst = worst.max(squeeze(&pressures(simulation)[1]));
        }
        worst
    };
    let (followed, stayed) = (worst(&mut *follows), worst(&mut *stays));
    assert!(followed < 0.02, "{followed}");
    assert!(stayed > 3.0 * followed, "{stayed} {followed}");

    // A fixed dt is chosen for the speeds of sound at the start, so these stay.
    scene = self::scene("", "", 0.0, &[automatic[0], ("dt", "1e-4")]);
    assert_eq!(scene.sound_speeds().under(gravity), []);
}
