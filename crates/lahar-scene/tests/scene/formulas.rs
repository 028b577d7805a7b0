//! Expressions in scenes act on the simulation as their values say.

use crate::support::{build, column, parse};
use lahar::{Field, Simulate};

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
    build(&parse(DUST, overrides))
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
fn numbers_and_texts_give_the_same_velocity() {
    let numbers = with(&[("bodies.cloud.velocity", "[1.5, -2.0]")]);
    let text = with(&[("bodies.cloud.velocity", "[\"3/2\", \"-2\"]")]);
    assert_eq!(
        column(&*numbers, Field::Velocity),
        column(&*text, Field::Velocity)
    );
}

/// Dust in a uniform field moves as a rigid body.
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

/// Each force changes the momentum of the cloud by a known amount in one substep.
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
        parse(&text, &[("gravity", gravity), ("forces", forces)]).materials[0].wave_speed
    };
    let none = "[{ damping = 0 }]";
    let plain = speed("[0, -8]", none);
    assert!((plain / 10.0 / (2.0_f64 * 8.0 * 0.5).sqrt() - 1.0).abs() < 1e-12);
    assert_eq!(speed("[0, \"-8\"]", none), plain);
    let same = speed("[0, 0]", "[{ acceleration = [0, \"-8 + 0*x\"] }]");
    assert!((same / plain - 1.0).abs() < 1e-12);
    // The speed of a fall with 8 m/s² along x over half of the body's side.
    let swung = speed("[\"8*sin(100*t)\", 0]", none);
    assert!(
        (swung / 10.0 / (8.0_f64 * 0.5).sqrt() - 1.0).abs() < 0.05,
        "{swung}"
    );
}
