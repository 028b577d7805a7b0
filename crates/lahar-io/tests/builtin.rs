//! Every built-in scene reads, builds and says what its table says; generated files are up to date.

use lahar::Isa;
use lahar_io::builtin;
use lahar_io::scene::Scene;
use std::fmt::Write;
use std::path::Path;

#[test]
fn every_scene_reads_and_builds() {
    for builtin in builtin::list().iter().chain(builtin::validation()) {
        let scene = Scene::load(builtin.name, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.dimension, builtin.dimension, "{}", builtin.name);
        assert_eq!(scene.title, builtin.title, "{}", builtin.name);
        let built = scene
            .build(Isa::Portable)
            .unwrap_or_else(|error| panic!("{error}"));
        // Programs that scenes follow number by number have fluids too soft for how fast they fall,
        // and particles far apart; their scenes say so.
        let follows = builtin.text.contains("number by number") || builtin.name.starts_with("k7");
        let expected = |warning: &String| {
            warning.contains("visibly compressed") || warning.contains("fall apart into grains")
        };
        if !follows || !built.warnings.iter().all(expected) {
            assert_eq!(built.warnings, [] as [&str; 0], "{}", builtin.name);
        }
        assert_eq!(
            built.simulation.particle_count(),
            built.body_particles.iter().sum::<usize>()
        );
        let expected = scene.expected_particles();
        let count = built.simulation.particle_count() as f64;
        assert!(
            (count - expected).abs() <= 0.01 * expected,
            "{}: {count} of {expected}",
            builtin.name
        );
        // The largest of the mpm3d that Taichi offers is the largest of all.
        let most = if builtin.name == "mpm3d-128" {
            525_000.0
        } else {
            110_000.0
        };
        assert!(count < most, "{}: {count}", builtin.name);
    }
}

#[test]
fn the_default_scene_comes_first() {
    assert_eq!(builtin::list()[0].name, "dam-break");
    let scene = Scene::load("dam-break", &[]).unwrap();
    assert!((10_000.0..40_000.0).contains(&scene.expected_particles()));
}

#[test]
fn mass_is_density_times_volume() {
    let mut built = Scene::load("water-jelly-snow", &[])
        .unwrap()
        .build(Isa::Portable)
        .unwrap();
    let volume = 1000.0 * (1.6 * 0.2 + 0.3 * 0.3)
        + 900.0 * 0.3 * 0.3
        + 400.0 * core::f64::consts::PI * 0.16 * 0.16;
    let mass = built.simulation.diagnostics().mass;
    assert!(
        (mass / volume - 1.0).abs() < 1e-6,
        "{mass} kg, {volume} kg wanted"
    );
}

#[test]
fn mpm88_has_the_numbers_of_mpm88() {
    let scene = Scene::load("mpm88", &[]).unwrap();
    assert_eq!(scene.frame_rate, 100.0);
    assert_eq!(scene.substeps_per_frame, Some(50));
    let mut built = scene.build(Isa::Portable).unwrap();
    assert_eq!(built.simulation.particle_count(), 8192);
    assert!((built.simulation.diagnostics().mass / (8192.0 / 256.0 / 256.0) - 1.0).abs() < 1e-6);
}

/// The particle list of K7, from the formula that the Taichi project's test uses. With
/// `LAHAR_UPDATE=1` in the environment the file is written.
#[test]
fn the_list_of_the_mpm88_regression_is_its_formula() {
    let volume = (0.5 / 128.0) * (0.5 / 128.0);
    let mut list = "x,y,vx,vy,volume,mass\n".to_owned();
    for i in 0..4096 {
        let x = f64::from(i % 64) / 64.0 * 0.4 + 0.2;
        let y = f64::from(i) / 4096.0 * 0.4 + 0.05;
        writeln!(list, "{x},{y},0,-3,{volume},{volume}").unwrap();
    }
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/validation/k7-mpm88-regression.csv");
    if std::env::var_os("LAHAR_UPDATE").is_some() {
        std::fs::write(&path, &list).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), list);
}

/// The published regression (taichi-dev/taichi, tests/python/test_mpm88.py, run in f64): means of
/// the powers of x and 2y after 500 substeps.
#[test]
fn the_mpm88_regression_of_the_taichi_project_holds() {
    let mut built = Scene::load("k7-mpm88-regression", &[])
        .unwrap()
        .build(Isa::Portable)
        .unwrap();
    built.simulation.advance_to(0.1).unwrap();
    assert_eq!(built.simulation.substeps(), 500);
    let snapshot = built.simulation.snapshot(&[lahar::Field::Position]);
    let x = snapshot
        .get(lahar::Field::Position)
        .map(lahar::Data::to_f64)
        .unwrap();
    for (power, wanted) in [0.317227613, 0.158267514, 0.102240077, 0.0781082624]
        .into_iter()
        .enumerate()
    {
        let power = power as i32 + 1;
        let sum: f64 = x
            .chunks(2)
            .map(|x| x[0].powi(power) + (2.0 * x[1]).powi(power))
            .sum();
        let moment = sum / x.len() as f64;
        assert!(
            (moment / wanted - 1.0).abs() < 1e-8,
            "moment {power} is {moment}, {wanted} is published"
        );
    }
}
