//! Shapes of bodies: their volumes and their centers.

use lahar::{Data, Field, Isa};
use lahar_scene::scene::Scene;
use std::f64::consts::PI;
use std::path::Path;

fn scene(dimension: usize, shape: &str, file: &Path) -> Scene {
    let text = format!(
        "dimension = {dimension}\ndx = 0.05\n[materials.jelly]\npreset = \"jelly\"\ndensity = 1.0\n\
         [[bodies]]\nmaterial = \"jelly\"\nsampling = \"lattice\"\nparticles_per_cell = {}\nshape = {{ {shape} }}\n",
        4_i32.pow(dimension as u32)
    );
    Scene::parse(&text, &file.display().to_string(), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the mass (of density 1, so the volume), the center of the particles and their bounds.
fn measure(dimension: usize, shape: &str) -> (f64, Vec<f64>, Vec<[f64; 2]>) {
    measure_at(dimension, shape, Path::new("a.toml"))
}

fn measure_at(dimension: usize, shape: &str, file: &Path) -> (f64, Vec<f64>, Vec<[f64; 2]>) {
    let built = scene(dimension, shape, file).build(Isa::Portable);
    let simulation = built.unwrap_or_else(|error| panic!("{error}")).simulation;
    let snapshot = simulation.snapshot(&[Field::Position]);
    let x = snapshot
        .get(Field::Position)
        .map(Data::to_f64)
        .expect("there are particles");
    let count = simulation.particle_count() as f64;
    let axis = |i: usize| x.iter().skip(i).step_by(dimension).copied();
    let center = (0..dimension)
        .map(|i| axis(i).sum::<f64>() / count)
        .collect();
    let bounds = (0..dimension)
        .map(|i| {
            [
                axis(i).fold(f64::INFINITY, f64::min),
                axis(i).fold(f64::NEG_INFINITY, f64::max),
            ]
        })
        .collect();
    (simulation.diagnostics().mass, center, bounds)
}

/// Checks the volume and the center of a shape.
#[track_caller]
fn check(dimension: usize, shape: &str, volume: f64, center: &[f64]) {
    let (found, found_center, _) = measure(dimension, shape);
    assert!(
        (found / volume - 1.0).abs() < 2e-3,
        "{shape}: {found}, {volume} wanted"
    );
    for (a, b) in found_center.iter().zip(center) {
        assert!(
            (a - b).abs() < 6e-3,
            "{shape}: {found_center:?}, {center:?} wanted"
        );
    }
}

const BALL: &str = "ball = { center = [0.0, 0.0], radius = 0.5 }";

#[test]
fn plane_shapes_have_the_volumes_of_formulas() {
    let strip = "capsule = { from = [0.0, 0.0], to = [0.3, 0.4], radius = 0.2 }";
    check(2, strip, 0.4 * 0.5 + PI * 0.04, &[0.15, 0.2]);
    let ring = format!("difference = [{{ {BALL} }}, {{ {BALL}, scale = 0.5 }}]");
    check(2, &ring, PI * (0.25 - 0.0625), &[0.0, 0.0]);
    let two = format!("union = [{{ {BALL} }}, {{ {BALL}, translate = [2.0, 0.0] }}]");
    check(2, &two, PI * 0.5, &[1.0, 0.0]);
    let half = "half_space = { point = [0.0, 0.0], normal = [0.0, -1.0] }";
    let upper = format!("intersection = [{{ {BALL} }}, {{ {half} }}]");
    check(2, &upper, PI / 8.0, &[0.0, 4.0 * 0.5 / (3.0 * PI)]);
}

#[test]
fn shapes_are_scaled_turned_moved_and_copied() {
    let slab = "box = { min = [0.0, 0.0], max = [1.0, 0.2] }";
    check(2, &format!("{slab}, scale = 2.0"), 0.8, &[0.5, 0.1]);
    check(
        2,
        &format!("{slab}, scale = [1.0, 2.0], about = [0.0, 0.0]"),
        0.4,
        &[0.5, 0.2],
    );
    check(2, &format!("{slab}, rotate = 90.0"), 0.2, &[0.5, 0.1]);
    let about = format!("{slab}, rotate = 90.0, about = [0.0, 0.0], translate = [0.0, 1.0]");
    check(2, &about, 0.2, &[-0.1, 1.5]);
    let (_, _, bounds) = measure(2, &about);
    assert!(bounds[0][0] > -0.2 && bounds[0][1] < 0.0 && bounds[1][0] > 1.0 && bounds[1][1] < 2.0);
    let rows = format!("{slab}, copies = {{ count = [2, 3], step = [1.5, 0.5] }}");
    check(2, &rows, 6.0 * 0.2, &[1.25, 0.6]);
}

#[test]
fn solid_shapes_have_the_volumes_of_formulas() {
    let rod = "from = [0.0, 0.0, 0.0], to = [0.0, 1.0, 0.0], radius = 0.3";
    check(
        3,
        &format!("cylinder = {{ {rod} }}"),
        PI * 0.09,
        &[0.0, 0.5, 0.0],
    );
    let capsule = PI * 0.09 + 4.0 / 3.0 * PI * 0.027;
    check(
        3,
        &format!("capsule = {{ {rod} }}, rotate = [0.0, 0.0, 90.0]"),
        capsule,
        &[0.0, 0.5, 0.0],
    );
    let ball = "ball = { center = [0.0, 0.0, 0.0], radius = 0.4 }";
    let bored = format!(
        "difference = [{{ {ball} }}, {{ cylinder = {{ from = [0, -1, 0], to = [0, 1, 0], radius = 0.2 }} }}]"
    );
    // A ball with a hole through its center has the volume 4/3 π h³, with h half of the hole's length.
    let left = 4.0 / 3.0 * PI * (0.16_f64 - 0.04).powf(1.5);
    let (found, _, _) = measure(3, &bored);
    assert!((found / left - 1.0).abs() < 0.01, "{found}, {left} wanted");
}

const GEM: &str = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 3\nv 0 0 -3\n\
    f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

#[test]
fn a_mesh_is_a_body() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    std::fs::write(folder.path().join("parts/gem.obj"), GEM).unwrap();
    let file = folder.path().join("scene.toml");
    let (mass, center, _) = measure_at(3, "mesh = \"parts/gem.obj\"", &file);
    // Two pyramids of height 3 on a square of area 2.
    assert!((mass / 4.0 - 1.0).abs() < 1e-6, "{mass}");
    assert!(center.iter().all(|x| x.abs() < 5e-3), "{center:?}");
    let keys = "file = \"parts/gem.obj\", up = \"z\", size = 1.2, center = [1.0, 2.0, 3.0]";
    let (mass, center, bounds) = measure_at(3, &format!("mesh = {{ {keys} }}"), &file);
    assert!((mass / (4.0 * 0.008) - 1.0).abs() < 1e-6, "{mass}");
    for (x, wanted) in center.iter().zip([1.0, 2.0, 3.0]) {
        assert!((x - wanted).abs() < 5e-3, "{center:?}");
    }
    // The long axis points up.
    assert!(
        bounds[1][1] - bounds[1][0] > 1.0 && bounds[0][1] - bounds[0][0] < 0.45,
        "{bounds:?}"
    );
}

/// The expected number of particles of a shape that the domain cuts off is that of its part inside.
#[test]
fn cut_shapes_are_counted() {
    let text = |shape: &str| {
        format!(
            "dx = 0.05\n[domain]\nmin = [0.0, 0.0]\nmax = [2.0, 2.0]\n[materials.jelly]\npreset = \"jelly\"\ndensity = 1.0\n\
             [[bodies]]\nmaterial = \"jelly\"\nshape = {{ {shape} }}\n"
        )
    };
    for (shape, volume) in [
        (
            "capsule = { from = [-1.0, 1.0], to = [1.0, 1.0], radius = 0.3 }",
            0.6 + PI * 0.045,
        ),
        (
            "half_space = { point = [1.0, 1.0], normal = [1.0, 0.0] }, rotate = 45.0, about = [1.0, 1.0]",
            2.0,
        ),
    ] {
        let scene = Scene::parse(&text(shape), "a", &[]).unwrap_or_else(|error| panic!("{error}"));
        let built = scene
            .build(Isa::Portable)
            .unwrap_or_else(|error| panic!("{error}"));
        let mass = built.simulation.diagnostics().mass;
        assert!(
            (mass / volume - 1.0).abs() < 3e-3,
            "{shape}: {mass}, {volume} wanted"
        );
    }
}

/// Turned shapes that fit into the domain cause no warning that they are cut off: their bounds are tight.
#[test]
fn turned_shapes_are_not_cut_off() {
    for (dimension, shape) in [
        (
            2,
            "ball = { center = [1.0, 1.0], radius = 0.95 }, rotate = 45.0",
        ),
        (
            2,
            "box = { min = [0.4, 0.4], max = [1.6, 1.6] }, rotate = 45.0",
        ),
        (
            2,
            "capsule = { from = [0.2, 1.0], to = [1.8, 1.0], radius = 0.15 }, rotate = 45.0",
        ),
        (
            3,
            "cylinder = { from = [1, 0.01, 1], to = [1, 1.99, 1], radius = 0.9 }",
        ),
        (
            3,
            "union = [{ ball = { center = [1, 1, 1], radius = 0.95 } }], rotate = [30, 40, 50]",
        ),
    ] {
        let corner = |x: f64| format!("{:?}", vec![x; dimension]);
        let text = format!(
            "dimension = {dimension}\ndx = 0.1\n[domain]\nmin = {}\nmax = {}\n[materials.jelly]\npreset = \"jelly\"\n\
             [[bodies]]\nmaterial = \"jelly\"\nshape = {{ {shape} }}\n",
            corner(0.0),
            corner(2.0)
        );
        let scene = Scene::parse(&text, "a", &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.warnings, [] as [&str; 0], "{shape}");
    }
}
