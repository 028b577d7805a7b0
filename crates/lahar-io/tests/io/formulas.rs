//! Expressions of scenes, as the simulation feels them.

use lahar::{Data, Field, Isa, Simulate};
use lahar_io::scene::Scene;

const DUST: &str = r#"
dx = 0.05
dt = 1.0e-3
precision = "f64"
gravity = [0.0, 0.0]
[materials.dust]
preset = "dust"
[[bodies]]
name = "cloud"
material = "dust"
shape = { box = { min = [0.5, 0.25], max = [1.0, 0.75] } }
"#;

fn with(overrides: &[(&str, &str)]) -> Box<dyn Simulate> {
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let scene = Scene::parse(DUST, "a.toml", &overrides).unwrap_or_else(|error| panic!("{error}"));
    let built = scene.build(Isa::Portable);
    built.unwrap_or_else(|error| panic!("{error}")).simulation
}

fn column(simulation: &dyn Simulate, field: Field) -> Vec<f64> {
    let snapshot = simulation.snapshot(&[field]);
    snapshot.get(field).map(Data::to_f64).unwrap_or_default()
}

#[test]
fn velocity_and_its_gradient_follow_the_expression() {
    let simulation = with(&[("bodies.cloud.velocity", "[\"x*y\", \"2*x - y\"]")]);
    let (x, v) = (
        column(&*simulation, Field::Position),
        column(&*simulation, Field::Velocity),
    );
    let c = column(&*simulation, Field::Affine);
    for i in 0..simulation.particle_count() {
        let (x, y) = (x[2 * i], x[2 * i + 1]);
        let wanted = [x * y, 2.0 * x - y];
        let gradient = [y, x, 2.0, -1.0];
        for k in 0..2 {
            assert!((v[2 * i + k] - wanted[k]).abs() < 1e-14);
        }
        for k in 0..4 {
            assert!((c[4 * i + k] - gradient[k]).abs() < 1e-12);
        }
    }
}

#[test]
fn a_velocity_by_numbers_is_that_by_text() {
    let numbers = with(&[("bodies.cloud.velocity", "[1.5, -2.0]")]);
    let text = with(&[("bodies.cloud.velocity", "[\"3/2\", \"-2\"]")]);
    assert_eq!(
        column(&*numbers, Field::Velocity),
        column(&*text, Field::Velocity)
    );
}

/// Dust in a field that is the same everywhere moves as a body.
#[test]
fn gravity_by_an_expression_in_time() {
    let mut simulation = with(&[("gravity", "[\"3*cos(20*t)\", -9.81]")]);
    assert_eq!(simulation.gravity(), [0.0, -9.81, 0.0]);
    let start = column(&*simulation, Field::Position);
    simulation.advance_to(0.2).expect("it runs");
    let (mut v, mut moved) = ([0.0, 0.0], [0.0, 0.0]);
    for n in 0..200 {
        let a = [3.0 * (20.0 * f64::from(n) * 1e-3).cos(), -9.81];
        for k in 0..2 {
            v[k] += 1e-3 * a[k];
            moved[k] += 1e-3 * v[k];
        }
    }
    let end = column(&*simulation, Field::Position);
    for (i, (end, start)) in end.iter().zip(start).enumerate() {
        assert!((end - start - moved[i % 2]).abs() < 1e-12);
    }
}

/// Each of these adds one momentum, known beforehand, to the cloud in a substep.
#[test]
fn forces_of_every_kind_push() {
    let mut mass = 0.0;
    let mut pushed = |force: &str| {
        let mut simulation = with(&[
            ("forces", &format!("[{{ {force} }}]")),
            ("bodies.cloud.velocity", "[1.0, 0.0]"),
        ]);
        mass = simulation.diagnostics().mass;
        simulation.advance_to(1e-3).expect("it runs");
        let p = simulation.diagnostics().momentum;
        [(p[0] / mass - 1.0) * 1e3, p[1] / mass * 1e3]
    };
    let close = |found: [f64; 2], wanted: [f64; 2], tolerance: f64| {
        let off = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
        assert!(off < tolerance, "{found:?} is not {wanted:?}");
    };
    close(pushed("acceleration = [2, \"-1\"]"), [2.0, -1.0], 1e-10);
    close(
        pushed("acceleration = [\"if(x < 9, 2, 0)\", \"t\"]"),
        [2.0, 0.0],
        1e-10,
    );
    close(
        pushed("acceleration = [\"X - x + 1\", 0]"),
        [1.0, 0.0],
        1e-10,
    );
    let keys = "acceleration = 3.0, distance = 0.5, power = -1.0";
    close(
        pushed(&format!("central = {{ center = [0.75, 0.0], {keys} }}")),
        [0.0, -3.0],
        0.02,
    );
    close(
        pushed(&format!("vortex = {{ center = [0.75, 0.0], {keys} }}")),
        [-3.0, 0.0],
        0.02,
    );
    let kept = 1.0 - (-2.0_f64 * 1e-3).exp();
    close(pushed("damping = 2.0"), [-kept * 1e3, 0.0], 1e-9);
    close(
        pushed("drag = { rate = 2.0, velocity = [3.0, 1.0] }"),
        [2.0 * kept * 1e3, kept * 1e3],
        1e-9,
    );
    assert!(mass > 0.0);
}

#[test]
fn forces_count_for_the_speed_of_sound() {
    let speed = |gravity: &str, forces: &str| {
        let text = DUST.replace("preset = \"dust\"", "preset = \"water\"");
        let overrides = [("gravity", gravity), ("forces", forces)]
            .map(|(key, value)| (key.to_owned(), value.to_owned()));
        let scene = Scene::parse(&text, "a.toml", &overrides);
        scene.unwrap_or_else(|error| panic!("{error}")).materials[0].wave_speed
    };
    let none = "[{ damping = 0 }]";
    let plain = speed("[0, -8]", none);
    assert!((plain / 10.0 / (2.0_f64 * 8.0 * 0.5).sqrt() - 1.0).abs() < 1e-12);
    assert_eq!(speed("[0, \"-8\"]", none), plain);
    let same = speed("[0, 0]", "[{ acceleration = [0, \"-8 + 0*x\"] }]");
    assert!((same / plain - 1.0).abs() < 1e-12);
    // ± 8 along x over half of the bodies' side.
    let swung = speed("[\"8*sin(100*t)\", 0]", none);
    assert!(
        (swung / 10.0 / (8.0_f64 * 0.5).sqrt() - 1.0).abs() < 0.05,
        "{swung}"
    );
}
