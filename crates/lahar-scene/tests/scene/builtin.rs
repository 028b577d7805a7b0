//! Every built-in scene can be read and built and agrees with its table; generated files are up to date.

use lahar::Isa;
use lahar_scene::builtin;
use lahar_scene::scene::Scene;
use std::fmt::Write;
use std::path::Path;

#[test]
fn every_scene_can_be_read_and_built() {
    for builtin in builtin::list().iter().chain(builtin::validation()) {
        let scene = Scene::load(builtin.name, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.dimension, builtin.dimension, "{}", builtin.name);
        assert_eq!(scene.title, builtin.title, "{}", builtin.name);
        let built = scene
            .build(Isa::Portable)
            .unwrap_or_else(|error| panic!("{error}"));
        // Programs that scenes repeat with the same numbers have fluids that are too soft for their speed of fall, and
        // particles far apart. The scenes warn of both.
        let follows = builtin.text.contains("same numbers") || builtin.name.starts_with("k7");
        let expected = |warning: &String| {
            warning.contains("visibly compressed") || warning.contains("fall apart into grains")
        };
        // An experiment had a wet bed that could not be drained.
        let wet = |warning: &String| warning.starts_with("body \"layer\" is 0.0100 m thin");
        let sound = match builtin.name {
            "d6-column" => built.warnings.iter().all(wet),
            _ => follows && built.warnings.iter().all(expected),
        };
        if !sound {
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
        // The largest version of Taichi's mpm3d is the largest scene.
        let most = if builtin.name == "mpm3d-128" {
            525_000.0
        } else {
            110_000.0
        };
        assert!(count < most, "{}: {count}", builtin.name);
    }
}

#[test]
fn the_starter_is_a_scene() {
    let scene = Scene::parse(builtin::starter(), "my.toml", &[]);
    let built = scene
        .unwrap_or_else(|error| panic!("{error}"))
        .build(Isa::Portable);
    let built = built.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(built.warnings, [] as [&str; 0]);
    // Each line that is commented out is sound as well.
    let mut tried = 0;
    for line in builtin::starter().lines() {
        let Some(key) = line.strip_prefix("# ").filter(|line| line.contains(" = ")) else {
            continue;
        };
        let name = key.split(" = ").next().unwrap_or_default();
        let mut text = builtin::starter().replacen(line, key, 1);
        match name {
            "drag" => text = text.replace("# [[forces]]", "[[forces]]"),
            "shape" => text = text.replace("\nshape = { ball", "\n# shape = { ball"),
            _ => {}
        }
        Scene::parse(&text, "my.toml", &[]).unwrap_or_else(|error| panic!("{key}: {error}"));
        tried += 1;
    }
    assert!(tried >= 7, "{tried}");
}

#[test]
fn the_default_scene_comes_first() {
    assert_eq!(builtin::list()[0].name, "dam-break");
    let scene = Scene::load("dam-break", &[]).unwrap();
    assert!((10_000.0..40_000.0).contains(&scene.expected_particles()));
}

#[test]
fn mass_is_density_times_volume() {
    // Compressed by its own weight, the pool would have a little more mass.
    let at_rest = ("bodies.pool.pressure".into(), "none".into());
    let built = Scene::load("water-jelly-snow", &[at_rest])
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
    let built = scene.build(Isa::Portable).unwrap();
    assert_eq!(built.simulation.particle_count(), 8192);
    assert!((built.simulation.diagnostics().mass / (8192.0 / 256.0 / 256.0) - 1.0).abs() < 1e-6);
}

/// The particle list of case K7 follows the formula of the Taichi project's test. With `LAHAR_UPDATE=1` in the environment
/// the test writes the file.
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

/// Returns a tube of radius 0.6 around the trefoil knot (sin t + 2 sin 2t, cos t − 2 cos 2t, −sin 3t) as an OBJ file.
fn trefoil() -> String {
    const ALONG: u32 = 96;
    const AROUND: u32 = 12;
    let tau = core::f64::consts::TAU;
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let unit = |a: [f64; 3]| {
        let length = libm::sqrt(a.iter().map(|x| x * x).sum());
        a.map(|x| x / length)
    };
    let (sin, cos) = (libm::sin, libm::cos);
    let mut text = "# A trefoil knot: written by crates/lahar-io/tests/builtin.rs.\n".to_owned();
    for i in 0..ALONG {
        let t = tau * f64::from(i) / f64::from(ALONG);
        let middle = [
            sin(t) + 2.0 * sin(2.0 * t),
            cos(t) - 2.0 * cos(2.0 * t),
            -sin(3.0 * t),
        ];
        let along = [
            cos(t) + 4.0 * cos(2.0 * t),
            -sin(t) + 4.0 * sin(2.0 * t),
            -3.0 * cos(3.0 * t),
        ];
        // Across the tube: a direction away from the knot's axis, and one normal to it and to the tube.
        let outwards = [sin(2.0 * t), -cos(2.0 * t), 0.0];
        let side = unit(cross(along, outwards));
        let up = unit(cross(side, along));
        for j in 0..AROUND {
            let angle = tau * f64::from(j) / f64::from(AROUND);
            let p: [f64; 3] = core::array::from_fn(|k| {
                middle[k] + 0.6 * (cos(angle) * side[k] + sin(angle) * up[k])
            });
            writeln!(text, "v {:.4} {:.4} {:.4}", p[0], p[1], p[2]).unwrap();
        }
    }
    for i in 0..ALONG {
        for j in 0..AROUND {
            let at = |i: u32, j: u32| i % ALONG * AROUND + j % AROUND + 1;
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            writeln!(text, "f {} {} {} {}", quad[0], quad[1], quad[2], quad[3]).unwrap();
        }
    }
    text
}

/// The mesh follows its formula. With `LAHAR_UPDATE=1` in the environment the test writes the file.
#[test]
fn the_mesh_of_the_knot_is_its_formula() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/knot-3d.obj");
    if std::env::var_os("LAHAR_UPDATE").is_some() {
        std::fs::write(&path, trefoil()).unwrap();
    }
    assert!(std::fs::read_to_string(path).unwrap() == trefoil());
}

#[test]
fn a_recorded_scene_is_the_scene() {
    for builtin in builtin::list().iter().chain(builtin::validation()) {
        let scene = Scene::load(builtin.name, &[]).unwrap();
        let resolved = scene.resolved();
        let again =
            Scene::recorded(&resolved, builtin.name, &[]).unwrap_or_else(|error| panic!("{error}"));
        let materials = |scene: &Scene| -> Vec<String> {
            scene.materials.iter().map(|m| m.name.clone()).collect()
        };
        assert_eq!(again.resolved(), resolved, "{}", builtin.name);
        // Particles refer to materials by number, so their order matters.
        assert_eq!(materials(&again), materials(&scene), "{}", builtin.name);
    }
}
