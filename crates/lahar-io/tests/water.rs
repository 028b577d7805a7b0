//! Water as scenes make it: a tank at rest stays as it is, and a tank that sloshes keeps its volume.

use lahar::{Diagnostics, Isa, Simulate};
use lahar_io::scene::Scene;

const G: f64 = 9.81; // m/s²

/// A tank 1 m wide, filled with water .5 m deep that moves sideways at `velocity` \[m/s\].
fn tank(extra_material: &str, extra_body: &str, velocity: f64) -> Box<dyn Simulate> {
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
    let scene = Scene::parse(&text, "tank.toml", &[]).expect("a good scene");
    scene.build(Isa::detect()).expect("it builds").simulation
}

/// Rows of diagnostics every half second for `seconds`.
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

/// Largest change of `of` from the start, relative.
fn drift(rows: &[Diagnostics], of: impl Fn(&Diagnostics) -> f64) -> f64 {
    let start = of(&rows[0]);
    rows.iter()
        .map(|row| (of(row) / start - 1.0).abs())
        .fold(0.0, f64::max)
}

#[test]
fn a_tank_at_rest_stays_as_it_is() {
    let speed = (G * 0.5_f64).sqrt();
    let lattice = rows(tank("", "sampling = \"lattice\"", 0.0), 2.0);
    assert!(drift(&lattice, |row| row.potential_energy) < 1e-5);
    assert!(drift(&lattice, |row| row.volume) < 1e-4);
    assert!(lattice.iter().all(|row| row.max_speed < 1e-4 * speed));

    // Ten cells deep: particles put down at random settle by a part of a cell.
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
        "even volumes must tell: {} {}",
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
