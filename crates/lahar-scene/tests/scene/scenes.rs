//! Scenes, parsed and built: overrides, particles, motion, warnings, and that no text makes them panic.

use crate::support::{build, column, overrides, parse};
use lahar::{Field, Isa};
use lahar_scene::npz::{Compression, NpzWriter};
use lahar_scene::scene::{Limits, Precision, Scene};
use proptest::prelude::*;

const COLUMN: &str = r#"
dx = 0.05
gravity = [0.0, -10.0]
[domain]
min = [0.0, 0.0]
max = [2.0, 1.0]
[materials.water]
preset = "water"
[[bodies]]
name = "column"
material = "water"
shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }
"#;

fn with(overrides: &[(&str, &str)]) -> Scene {
    parse(COLUMN, overrides)
}

/// A particle list on the command line replaces the shape and the keys that belong to it, and its path is relative to the
/// current folder; a shape replaces a list.
#[test]
fn a_start_is_replaced_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("start.csv");
    std::fs::write(&path, "x,y\n0.5,0.25\n1.5,0.75\n").unwrap();
    let path = path.to_str().unwrap();
    let list = ("bodies.square.particles", path);
    let load = |pairs: &[(&str, &str)]| {
        Scene::load("mpm88", &overrides(pairs)).unwrap_or_else(|error| panic!("{error}"))
    };
    // `particle_volume` does not belong to the shape, so it stays.
    let domain = ("domain.max", "[2.0, 1.0]");
    let replaced = build(&load(&[domain, list]));
    assert_eq!(column(&*replaced, Field::Position), [0.5, 0.25, 1.5, 0.75]);
    let mass = replaced.diagnostics().mass;
    assert!((mass / (2.0 / 256.0 / 256.0) - 1.0).abs() < 1e-6, "{mass}");
    let shape = "{ ball = { center = [0.5, 0.5], radius = 0.2 } }";
    let back = load(&[domain, list, ("bodies.square.shape", shape)]);
    assert!(back.expected_particles() > 2000.0);
}

/// Without start pressure: the weight of a body on the floor compresses it, so its shape contains more mass.
const WITHOUT_PRESSURE: (&str, &str) = ("bodies.column.pressure", "none");

/// A body that stands on the floor starts compressed by its weight; one that moves or floats does not.
#[test]
fn a_body_on_the_floor_starts_under_pressure() {
    let smallest = |overrides: &[(&str, &str)]| {
        let jacobian = column(&*build(&with(overrides)), Field::Jacobian);
        jacobian.into_iter().fold(1.0_f64, f64::min)
    };
    assert!(smallest(&[]) < 1.0 - 1e-3);
    assert_eq!(smallest(&[WITHOUT_PRESSURE]), 1.0);
    assert_eq!(smallest(&[("bodies.column.velocity", "[1, 0]")]), 1.0);
    let floating = "{ box = { min = [0.2, 0.3], max = [0.5, 0.8] } }";
    assert_eq!(smallest(&[("bodies.column.shape", floating)]), 1.0);
    assert_eq!(smallest(&[("domain.walls", "\"open\"")]), 1.0);
    assert_eq!(smallest(&[("materials.water.volume", "\"jacobian\"")]), 1.0);
    // The floor is where gravity points.
    let leaning = "{ box = { min = [0.0, 0.3], max = [0.2, 0.8] } }";
    let sideways = [("bodies.column.shape", leaning), ("gravity", "[-10, 0]")];
    assert!(smallest(&sideways) < 1.0 - 1e-4);
    let asked = ("bodies.column.pressure", "hydrostatic");
    assert!(smallest(&[("bodies.column.shape", floating), asked]) < 1.0 - 1e-4);
}

/// Measured volumes are larger at the surface and as given inside a lattice; masses stay.
#[test]
fn volumes_are_measured() {
    let lattice = ("bodies.column.sampling", "lattice");
    let measured = ("bodies.column.volume", "measured");
    let plain = build(&with(&[lattice, WITHOUT_PRESSURE]));
    let body = build(&with(&[lattice, measured, WITHOUT_PRESSURE]));
    let given = column(&*plain, Field::Volume0);
    let found = column(&*body, Field::Volume0);
    let (least, most) = found.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), v| {
        (a.min(v / given[0]), b.max(v / given[0]))
    });
    assert!((least - 1.0).abs() < 1e-5, "{least}");
    assert!(most > 2.0, "{most}");
    assert_eq!(body.diagnostics().mass, plain.diagnostics().mass);
}

/// A spread changes velocities only, uniformly up to its size.
#[test]
fn velocities_are_spread() {
    let plain = build(&with(&[]));
    let spread = build(&with(&[
        ("bodies.column.velocity", "[0.0, 1.0]"),
        ("bodies.column.velocity_spread", "[0.25, 0.5]"),
    ]));
    assert_eq!(
        column(&*plain, Field::Position),
        column(&*spread, Field::Position)
    );
    let v = column(&*spread, Field::Velocity);
    for (axis, middle, most) in [(0, 0.0, 0.25), (1, 1.0, 0.5)] {
        let away = |p: &[f64]| (p[axis] - middle) / most;
        let largest = v.chunks(2).map(|p| away(p).abs()).fold(0.0, f64::max);
        let mean = v.chunks(2).map(away).sum::<f64>() / (v.len() / 2) as f64;
        assert!(largest > 0.95 && largest <= 1.0 + 1e-6, "{largest}");
        assert!(mean.abs() < 0.15, "{mean}");
    }
}

#[test]
fn overrides_replace_and_add() {
    let scene = with(&[
        ("dx", "0.1"),
        ("precision", "f64"),
        ("title", "Two words"),
        ("output.checkpoint_every", "5"),
        ("bodies.column.velocity", "[1, 0]"),
        ("bodies.0.sampling", "poisson"),
        ("materials.water.viscosity", "0.5"),
        ("domain.walls", "{ left = \"sticky\" }"),
    ]);
    assert_eq!(scene.precision, Precision::F64);
    assert_eq!(scene.title, "Two words");
    assert_eq!(scene.output.checkpoint_every, 5);
    let resolved = scene.resolved();
    assert_eq!(resolved["bodies"][0]["velocity"][0], 1);
    assert_eq!(resolved["bodies"][0]["sampling"], "poisson");
    assert_eq!(resolved["materials"]["water"]["viscosity"], 0.5);
    assert_eq!(resolved["domain"]["walls"]["left"], "sticky");
    let simulation = build(&scene);
    assert_eq!(
        (
            simulation.precision(),
            simulation.dx(),
            simulation.particle_count()
        ),
        ("f64", 0.1, 100)
    );
}

#[test]
fn automatic_sound_speed_is_ten_times_the_fastest_fall() {
    let c = |overrides: &[(&str, &str)]| with(overrides).materials[0].wave_speed;
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} is not {b}");
    close(c(&[]), 10.0 * 10.0_f64.sqrt());
    close(
        c(&[("bodies.column.velocity", "[3, 4]")]),
        10.0 * 35.0_f64.sqrt(),
    );
    close(
        c(&[("gravity", "[0, 0]"), ("bodies.column.velocity", "[3, 4]")]),
        50.0,
    );
    // Gravity to the right: the floor is the right wall, 2 m from the column's far side.
    close(c(&[("gravity", "[10, 0]")]), 10.0 * 40.0_f64.sqrt());
    close(c(&[("materials.water.sound_speed", "12")]), 12.0);
}

#[test]
fn spin_turns_about_the_center_of_mass() {
    let scene = with(&[
        ("bodies.column.spin", "2"),
        ("bodies.column.velocity", "[1, 3]"),
        ("precision", "f64"),
        ("bodies.column.sampling", "random"),
        ("bodies.column.volume", "alike"),
    ]);
    let simulation = build(&scene);
    let (x, v) = (
        column(&*simulation, Field::Position),
        column(&*simulation, Field::Velocity),
    );
    let count = (x.len() / 2) as f64;
    let mean = |a: &[f64], i: usize| a.iter().skip(i).step_by(2).sum::<f64>() / count;
    assert!((mean(&v, 0) - 1.0).abs() < 1e-12 && (mean(&v, 1) - 3.0).abs() < 1e-12);
    let center = [mean(&x, 0), mean(&x, 1)];
    for (x, v) in x.chunks(2).zip(v.chunks(2)) {
        assert!((v[0] - (1.0 - 2.0 * (x[1] - center[1]))).abs() < 1e-12);
        assert!((v[1] - (3.0 + 2.0 * (x[0] - center[0]))).abs() < 1e-12);
    }
}

#[test]
fn volumes_follow_the_shape_or_the_scene() {
    let total = |overrides: &[(&str, &str)]| {
        let overrides = [overrides, &[WITHOUT_PRESSURE]].concat();
        column(&*build(&with(&overrides)), Field::Volume0)
            .iter()
            .sum::<f64>()
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6 * b, "{a} is not {b}");
    for sampling in ["lattice", "jittered", "random", "poisson"] {
        close(total(&[("bodies.column.sampling", sampling)]), 0.25);
        close(
            total(&[
                ("bodies.column.sampling", sampling),
                (
                    "bodies.column.shape",
                    "{ ball = { center = [0, 0], radius = 0.4 } }",
                ),
            ]),
            core::f64::consts::PI * 0.04,
        );
    }
    close(total(&[("bodies.column.volume", "0.3")]), 0.3);
    close(total(&[("bodies.column.particle_volume", "0.001")]), 0.4);
}

#[test]
fn the_seed_decides() {
    let positions = |seed: &str| column(&*build(&with(&[("seed", seed)])), Field::Position);
    assert_eq!(positions("1"), positions("1"));
    assert_ne!(positions("1"), positions("2"));
}

#[test]
fn the_resolved_scene_reads_as_a_scene() {
    // Compares a material key in both forms.
    let scene = with(&[("materials.water.tension", "unlimited")]);
    let resolved = scene.resolved();
    assert_eq!(resolved["materials"]["water"]["tension"], "unlimited");
    assert_eq!(resolved["computed"]["frames"], 60);
    assert_eq!(
        resolved["computed"]["bodies"]["column"]["expected_particles"],
        400.0
    );
    assert!(
        scene
            .summary()
            .contains("column: about 400 particles of water")
    );
}

#[test]
fn a_frame_serves_as_a_particle_list() {
    let folder = tempfile::tempdir().unwrap();
    let mut simulation = build(&with(&[("precision", "f64"), ("bodies.column.spin", "1")]));
    simulation.advance_to(0.01).unwrap();
    let fields = [
        Field::Position,
        Field::Velocity,
        Field::Affine,
        Field::Jacobian,
        Field::Mass,
        Field::Volume0,
    ];
    let snapshot = simulation.snapshot(&fields);
    let mut npz = NpzWriter::create(folder.path().join("start.npz"), Compression::Stored).unwrap();
    for (field, data) in &snapshot.columns {
        let shape: &[usize] = match field {
            Field::Position | Field::Velocity => &[400, 2],
            Field::Affine => &[400, 2, 2],
            _ => &[400],
        };
        npz.add(field.info().name, shape, data).unwrap();
    }
    npz.finish().unwrap();
    let text = COLUMN.replace(
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }",
        "particles = \"start.npz\"",
    );
    let name = folder.path().join("a.toml").display().to_string();
    let overrides = [("precision".to_owned(), "f64".to_owned())];
    let scene = Scene::parse(&text, &name, &overrides).unwrap_or_else(|error| panic!("{error}"));
    let again = build(&scene);
    for field in [Field::Velocity, Field::Mass, Field::Volume0, Field::Affine] {
        assert_eq!(
            column(&*again, field),
            column(&*simulation, field),
            "{field:?}"
        );
    }
    let (a, b) = (
        column(&*again, Field::Position),
        column(&*simulation, Field::Position),
    );
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-15));
}

#[test]
fn suspicious_scenes_run_with_warnings() {
    let warned = |text: &str, overrides: &[(&str, &str)], wanted: &str| {
        let warnings = parse(text, overrides)
            .build(Isa::Portable)
            .unwrap_or_else(|error| panic!("{error}"))
            .warnings;
        assert!(
            warnings.iter().any(|warning| warning.contains(wanted)),
            "{wanted}: {warnings:?}"
        );
    };
    warned(
        COLUMN,
        &[("bodies.column.particles_per_cell", "1")],
        "particles per cell",
    );
    warned(
        COLUMN,
        &[(
            "bodies.column.shape",
            "{ box = { min = [0, 0], max = [1, 0.06] } }",
        )],
        "thin",
    );
    warned(
        COLUMN,
        &[(
            "bodies.column.shape",
            "{ box = { min = [-1, 0], max = [1, 0.5] } }",
        )],
        "cut off",
    );
    warned(
        COLUMN,
        &[("materials.water.sound_speed", "5")],
        "speed of sound",
    );
    warned(COLUMN, &[("dt", "0.1")], "blow up");
    warned(COLUMN, &[("materials.idle.preset", "jelly")], "not used");
    let twice = format!(
        "{COLUMN}[[bodies]]\nname = \"second\"\nmaterial = \"water\"\nshape = {{ ball = {{ center = [0.5, 0.5], radius = 0.2 }} }}\n"
    );
    warned(&twice, &[], "overlap");
}

#[test]
fn three_dimensions() {
    let scene = parse(
        r#"
        dimension = 3
        dx = 0.1
        [domain]
        min = [0.0, 0.0, 0.0]
        max = [1.0, 1.0, 1.0]
        walls = { contact = "slip", z = "periodic" }
        [materials.water]
        preset = "water"
        [[bodies]]
        material = "water"
        shape = { half_space = { point = [0.0, 0.5, 0.0], normal = [0.0, 2.0, 0.0] } }
        sampling = "lattice"
        "#,
        &[],
    );
    let simulation = build(&scene);
    assert_eq!(
        (simulation.dimension(), simulation.particle_count()),
        (3, 4000)
    );
    assert_eq!(scene.bodies[0].name, "body-0");
}

#[test]
fn elastic_pairs_agree() {
    let speed = |keys: &str| {
        let model = format!("model = \"corotated\"\ndensity = 1000.0\n{keys}");
        parse(&COLUMN.replace("preset = \"water\"", &model), &[]).materials[0].wave_speed
    };
    // E = 26, nu = 0.3: lambda = 15, mu = 10; in 2D K = lambda + mu.
    let wanted = speed("lame_lambda = 15.0\nlame_mu = 10.0");
    assert!((speed("youngs_modulus = 26.0\npoisson_ratio = 0.3") - wanted).abs() < 1e-12);
    assert!((speed("bulk_modulus = 25.0\nshear_modulus = 10.0") - wanted).abs() < 1e-12);
}

#[test]
fn keys_replace_those_of_the_preset() {
    let jelly = |keys: &str| {
        let preset = format!("preset = \"jelly\"\n{keys}");
        parse(&COLUMN.replace("preset = \"water\"", &preset), &[]).resolved()["materials"]["water"]
            .clone()
    };
    assert_eq!(jelly("youngs_modulus = 5.0")["poisson_ratio"], 0.45);
    let other = jelly("lame_lambda = 1.0\nlame_mu = 1.0");
    assert!(other.get("youngs_modulus").is_none() && other.get("poisson_ratio").is_none());
}

/// Pieces of text that mutations insert.
const PIECES: &[&str] = &[
    "nan",
    "-1",
    "0",
    "1e300",
    "\"",
    "[",
    "]",
    "{",
    "}",
    "=",
    "\n",
    "[[bodies]]",
    "dx = 1e-9",
    "dimension = 3",
    "\"poisson\"",
    "particles = \"x.npz\"",
    "1e-320",
    "99999999999999999999",
    "'''",
    "\u{0}",
    "ß",
    "inf",
    "walls = {}",
    "count = 4294967295",
    "radius = 0",
    "true",
    "1979-05-27",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn random_text_never_panics(text in "\\PC{0,200}") {
        if let Err(error) = Scene::parse(&text, "a.toml", &[]) {
            error.render(true);
        }
    }

    #[test]
    fn mutated_scenes_never_panic(cuts in prop::collection::vec((any::<prop::sample::Index>(), 0_usize..12, prop::sample::select(PIECES)), 1..4), which in any::<prop::sample::Index>()) {
        let all = lahar_scene::builtin::list();
        let mut text = all[which.index(all.len())].text.to_owned();
        for (at, length, piece) in cuts {
            let mut start = at.index(text.len());
            while !text.is_char_boundary(start) { start -= 1; }
            let mut end = (start + length).min(text.len());
            while !text.is_char_boundary(end) { end += 1; }
            text.replace_range(start..end, piece);
        }
        // The limit is so small that a mutation that still is a scene is built quickly.
        match Scene::parse_within(&text, "a.toml", &[], &Limits { memory: 25_000_000 }) {
            Err(error) => { error.render(false); }
            Ok(scene) => {
                let resolved = scene.resolved().to_string();
                prop_assert!(!resolved.is_empty() && !scene.summary().is_empty());
                if let Err(error) = scene.build(Isa::Portable) {
                    error.render(false);
                }
            }
        }
    }

    #[test]
    fn overrides_never_panic(key in "[a-z.\\[\\]\"=# ]{0,20}", value in "[0-9a-z.\\[\\]{}\", =\n-]{0,20}") {
        if let Err(error) = Scene::parse(COLUMN, "a.toml", &[(key, value)]) {
            error.render(false);
        }
    }

    #[test]
    fn particle_lists_never_panic(text in "[xyvJFC0-9,.\n\r -]{0,120}") {
        let read = lahar_scene::particle_list::parse_csv::<2>;
        let _ = read(&text, "a.csv");
        if let Ok(list) = read(&format!("x,y,vx,vy,J\n{text}"), "a.csv") {
            prop_assert_eq!(list.position.len(), list.velocity.len());
            prop_assert_eq!(list.position.len(), list.jacobian.len());
        }
    }
}

const IN_THE_WAY: &str = r#"
dx = 0.05
gravity = [0.0, 0.0]
[domain]
min = [0.0, 0.0]
max = [2.0, 1.0]
[materials.water]
preset = "water"
sound_speed = 20.0
[[bodies]]
name = "pool"
material = "water"
shape = { box = { min = [0.0, 0.0], max = [2.0, 0.5] } }
sampling = "lattice"
[[colliders]]
name = "block"
shape = { box = { min = [0.5, 0.0], max = [1.0, 0.25] } }
"#;

/// No particle starts inside a collider, and the others keep their mass.
#[test]
fn particles_inside_a_collider_are_left_out() {
    let scene = Scene::parse(IN_THE_WAY, "pool.toml", &[]).unwrap();
    let built = scene.build(Isa::Portable).unwrap();
    assert_eq!(built.left_out, [200]);
    assert_eq!(built.body_particles, [1400]);
    assert_eq!(built.warnings, [] as [&str; 0]);
    let mass = built.simulation.diagnostics().mass;
    assert!((mass - 0.875 * 998.2).abs() < 1e-3, "{mass}");
    assert_eq!(scene.colliders[0].words(), "box, separate, standing");
    let around = [(
        "colliders.block.shape".to_owned(),
        "{ box = { min = [-1, -1], max = [3, 0.6] } }".to_owned(),
    )];
    let scene = Scene::parse(IN_THE_WAY, "pool.toml", &around).unwrap();
    let error = scene.build(Isa::Portable).err().unwrap().to_string();
    assert!(error.contains("comes to no particle"), "{error}");
}

/// Replays read the colliders of a scene from the record of a run.
#[test]
fn colliders_are_read_back_from_a_record() {
    for name in ["beach", "mixer", "square-obstacle", "box-obstacle-3d"] {
        let scene = Scene::load(name, &[]).unwrap();
        assert!(!scene.colliders.is_empty());
        let text = scene.resolved().to_string();
        let resolved = serde_json::from_str(&text).unwrap();
        assert_eq!(lahar_scene::scene::colliders_of(&resolved), scene.colliders);
    }
}
