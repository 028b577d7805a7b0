//! What users do to scenes and particle files, and what they are told: one error each, with its
//! place and advice. The texts are kept in tests/snapshots (`cargo insta review` after a change).

use lahar_io::error::SceneError;
use lahar_io::scene::{Limits, Scene};
use std::fmt::Write;

const GOOD: &str = r#"title = "Column"
dx = 0.05

[domain]
min = [0.0, 0.0]
max = [2.0, 1.0]

[materials.water]
model = "fluid"
density = 1000.0

[materials.jelly]
model = "corotated"
density = 1000.0
youngs_modulus = 1.0e4
poisson_ratio = 0.3

[[bodies]]
name = "column"
material = "water"
shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }
"#;

/// (what was done, text replaced, by what).
const BROKEN: &[(&str, &str, &str)] = &[
    ("a typo in a key", "title =", "titel ="),
    (
        "a typo in a key of a material",
        "poisson_ratio",
        "poison_ratio",
    ),
    (
        "a key in the wrong table",
        "density = 1000.0\n\n",
        "density = 1000.0\ngravity = [0.0, -9.81]\n\n",
    ),
    ("a key nobody knows", "title =", "zebra ="),
    ("a wrong type", "dx = 0.05", "dx = \"fine\""),
    ("a number in quotes", "dx = 0.05", "dx = \"0.05\""),
    ("a negative dx", "dx = 0.05", "dx = -0.05"),
    ("a dx of zero", "dx = 0.05", "dx = 0"),
    ("a dx that is no number", "dx = 0.05", "dx = nan"),
    ("an infinite density", "density = 1000.0", "density = inf"),
    ("no dx", "dx = 0.05\n", ""),
    (
        "a dx that does not fit the domain",
        "dx = 0.05",
        "dx = 0.03",
    ),
    (
        "no whole cells whatever dx",
        "max = [2.0, 1.0]",
        "max = [2.0, 1.41421356237]",
    ),
    (
        "a domain inside out",
        "max = [2.0, 1.0]",
        "max = [2.0, -1.0]",
    ),
    (
        "no material",
        "[materials.water]\nmodel = \"fluid\"\ndensity = 1000.0\n",
        "",
    ),
    (
        "a missing material",
        "material = \"water\"",
        "material = \"watr\"",
    ),
    ("no model", "model = \"fluid\"\n", ""),
    ("an unknown model", "\"corotated\"", "\"corrotated\""),
    (
        "an unknown preset",
        "model = \"fluid\"",
        "preset = \"watr\"",
    ),
    (
        "a key of another model",
        "model = \"fluid\"",
        "model = \"fluid\"\nyoungs_modulus = 1.0e4",
    ),
    ("half a pair of moduli", "poisson_ratio = 0.3\n", ""),
    (
        "mixed moduli",
        "poisson_ratio = 0.3",
        "shear_modulus = 1.0e4",
    ),
    (
        "a Poisson ratio of a half",
        "poisson_ratio = 0.3",
        "poisson_ratio = 0.5",
    ),
    (
        "a model's stiffness twice",
        "model = \"fluid\"",
        "model = \"fluid\"\nsound_speed = 10.0\nbulk_modulus = 1.0e5",
    ),
    (
        "nothing moves",
        "dx = 0.05",
        "dx = 0.05\ngravity = [0.0, 0.0]",
    ),
    (
        "a body outside the domain",
        "min = [0.0, 0.0], max = [0.5, 0.5]",
        "min = [5.0, 0.0], max = [5.5, 0.5]",
    ),
    ("a box inside out", "max = [0.5, 0.5]", "max = [-0.5, 0.5]"),
    (
        "a three-dimensional vector in 2D",
        "max = [0.5, 0.5]",
        "max = [0.5, 0.5, 0.5]",
    ),
    (
        "an expression where there can be none",
        "dx = 0.05",
        "dx = \"0.05*2\"",
    ),
    (
        "an expression for all components",
        "dx = 0.05",
        "dx = 0.05\ngravity = \"sin(t)\"",
    ),
    (
        "an unknown variable",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"sin(w)\", -9.81]",
    ),
    (
        "an unknown function",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"sine(t)\", -9.81]",
    ),
    (
        "a variable of 3D",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"sin(z)\", -9.81]",
    ),
    (
        "a parenthesis that is not closed",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"2*(1 + sin(t)\", -9.81]",
    ),
    (
        "a parenthesis too many",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"2*(1 + t))\", -9.81]",
    ),
    (
        "an empty expression",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"\", -9.81]",
    ),
    (
        "an expression cut short",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"3*t +\", -9.81]",
    ),
    (
        "a product without a sign",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"3t\", -9.81]",
    ),
    (
        "too few arguments",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"atan2(x)\", -9.81]",
    ),
    (
        "a comma for a decimal point",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"1,5*t\", -9.81]",
    ),
    (
        "an expression far too deep",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((t))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))\", -9.81]",
    ),
    (
        "a time in a start velocity",
        "material = \"water\"",
        "material = \"water\"\nvelocity = [\"sin(t)\", 0.0]",
    ),
    (
        "expressions for one dimension too many",
        "dx = 0.05",
        "dx = 0.05\ngravity = [\"t\", \"t\", \"t\"]",
    ),
    (
        "an expression in a box",
        "max = [0.5, 0.5]",
        "max = [\"0.5\", 0.5]",
    ),
    (
        "a force that does nothing",
        "[domain]",
        "[[forces]]\nname = \"wind\"\n\n[domain]",
    ),
    (
        "a force that is two",
        "[domain]",
        "[[forces]]\ndamping = 1.0\nacceleration = [1.0, 0.0]\n\n[domain]",
    ),
    (
        "a force without a centre",
        "[domain]",
        "[[forces]]\ncentral = { acceleration = 1.0 }\n\n[domain]",
    ),
    (
        "a negative drag",
        "[domain]",
        "[[forces]]\ndrag = { rate = -1.0 }\n\n[domain]",
    ),
    (
        "a typo in a force",
        "[domain]",
        "[[forces]]\nacelleration = [0.0, 1.0]\n\n[domain]",
    ),
    ("a shape that is none", "{ box =", "{ bx ="),
    ("a shape to come", "{ box =", "{ cylinder ="),
    (
        "two shapes",
        "} }\n",
        "}, ball = { center = [1.0, 0.5], radius = 0.2 } }\n",
    ),
    (
        "a body without a shape",
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n",
        "",
    ),
    (
        "a polygon that crosses itself",
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }",
        "polygon = { points = [[0.0, 0.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5]] }",
    ),
    ("one bracket", "[[bodies]]", "[bodies]"),
    (
        "a table to come",
        "title = \"Column\"\n",
        "title = \"Column\"\nprobes = []\n",
    ),
    ("10¹² particles", "dx = 0.05", "dx = 1.0e-6"),
    (
        "10¹² particles a cell",
        "material = \"water\"",
        "material = \"water\"\nparticles_per_cell = 1.0e10",
    ),
    (
        "no particle at all",
        "material = \"water\"",
        "material = \"water\"\nspacing = 10.0",
    ),
    (
        "amounts twice",
        "material = \"water\"",
        "material = \"water\"\nspacing = 0.01\nparticles_per_cell = 4",
    ),
    (
        "an unknown wall",
        "max = [2.0, 1.0]",
        "max = [2.0, 1.0]\nwalls = \"slipery\"",
    ),
    (
        "a wall at the end of a periodic axis",
        "max = [2.0, 1.0]",
        "max = [2.0, 1.0]\nwalls = { x = \"periodic\", left = \"slip\" }",
    ),
    (
        "a wall of 3D",
        "max = [2.0, 1.0]",
        "max = [2.0, 1.0]\nwalls = { front = \"slip\" }",
    ),
    (
        "friction on a sticky wall",
        "max = [2.0, 1.0]",
        "max = [2.0, 1.0]\nwalls = { left = { contact = \"sticky\", friction = 0.2 } }",
    ),
    (
        "a linear kernel",
        "dx = 0.05",
        "dx = 0.05\nkernel = \"linear\"",
    ),
    ("four dimensions", "dx = 0.05", "dx = 0.05\ndimension = 4"),
    (
        "substeps without dt",
        "dx = 0.05",
        "dx = 0.05\nsubsteps_per_frame = 50",
    ),
    (
        "frames that contradict",
        "dx = 0.05",
        "dx = 0.05\ndt = 1.0e-3\nsubsteps_per_frame = 50\nframe_rate = 60",
    ),
    (
        "an unfinished list",
        "min = [0.0, 0.0]\n",
        "min = [0.0, 0.0\n",
    ),
    ("a key twice", "dx = 0.05", "dx = 0.05\ndx = 0.06"),
    ("no value", "dx = 0.05", "dx ="),
    (
        "a particle list that is not there",
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }",
        "particles = \"nowhere.csv\"",
    ),
    (
        "a particle list of another kind",
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }",
        "particles = \"start.xlsx\"",
    ),
    (
        "an unknown colour",
        "density = 1000.0",
        "density = 1000.0\ncolor = \"blue\"",
    ),
    (
        "an unknown output field",
        "dx = 0.05",
        "dx = 0.05\noutput = { fields = [\"velocty\"] }",
    ),
];

fn failure(text: &str, overrides: &[(&str, &str)]) -> SceneError {
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    match Scene::parse(text, "column.toml", &overrides) {
        Err(error) => error,
        Ok(scene) => panic!(
            "this was taken for a scene: {text}\n{:?} {}",
            scene.overrides,
            scene.summary()
        ),
    }
}

#[test]
fn broken_scenes() {
    Scene::parse(GOOD, "column.toml", &[]).unwrap();
    let mut all = String::new();
    for (what, from, to) in BROKEN {
        assert!(GOOD.contains(from), "{what}: {from}");
        let error = failure(&GOOD.replacen(from, to, 1), &[]);
        assert!(error.line > 0, "{what} has no place: {error}");
        writeln!(all, "# {what}\n{error}\n").unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn broken_overrides() {
    let cases: &[(&str, &str)] = &[
        ("dx", "-1"),
        ("dx", "[0.1"),
        ("dy", "1"),
        ("bodies.colum.velocity", "[1,0]"),
        ("bodies.7.velocity", "[1,0]"),
        ("bodies.column.velocity", "[1,0,0]"),
        ("materials.water.viscosty", "1"),
        ("title.text", "1"),
        ("a b", "1"),
        ("", "1"),
        ("dx=1\nseed", "1"),
        ("materials", "3"),
    ];
    let mut all = String::new();
    for (key, value) in cases {
        let error = failure(GOOD, &[(key, value)]);
        assert_eq!(error.file, "--set", "{key}={value}: {error}");
        writeln!(all, "# --set {}={value}\n{error}\n", key.escape_debug()).unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn broken_files() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.display().to_string()
    };
    let list = |name: &str, bytes: &[u8]| {
        write(name, bytes);
        let shape = "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }";
        write(
            "scene.toml",
            GOOD.replace(shape, &format!("particles = \"{name}\""))
                .as_bytes(),
        )
    };
    let junk: Vec<u8> = (0..600_u32).map(|i| (i * 37 % 251) as u8).collect();
    let cases: &[(&str, &dyn Fn() -> String)] = &[
        ("an empty file", &|| write("empty.toml", b"")),
        ("only a comment", &|| write("comment.toml", b"# later\n")),
        ("a folder", &|| folder.path().display().to_string()),
        ("binary junk", &|| write("junk.toml", &junk)),
        ("junk that is text", &|| {
            write("text.toml", b"\x01\x02 hello \x00 world \x7f ~~~")
        }),
        ("no such file", &|| "dam-brake".to_owned()),
        ("no such file at all", &|| "no/such/file.toml".to_owned()),
        ("an empty list", &|| list("empty.csv", b"")),
        ("a list of nothing", &|| {
            list("nothing.csv", b"x,y,volume\n")
        }),
        ("a list without a header", &|| {
            list("header.csv", b"0.1,0.2\n0.2,0.2\n")
        }),
        ("a list cut short", &|| {
            list("cut.csv", b"x,y,volume\n0.1,0.2,0.01\n0.2,0.")
        }),
        ("a list with a word", &|| {
            list("word.csv", b"x,y,volume\n0.1,much,0.01\n")
        }),
        ("a list with nan", &|| {
            list("nan.csv", b"x,y,volume\n0.1,nan,0.01\n")
        }),
        ("a list with a negative volume", &|| {
            list("negative.csv", b"x,y,volume\n0.1,0.2,-0.01\n")
        }),
        ("a list with an unknown column", &|| {
            list("column.csv", b"x,y,vollume\n0.1,0.2,0.01\n")
        }),
        ("a list of 3D", &|| {
            list("three.csv", b"x,y,z\n0.1,0.2,0.3\n")
        }),
        ("a list without volumes", &|| {
            list("bare.csv", b"x,y\n0.1,0.2\n")
        }),
        ("a list outside the domain", &|| {
            list("outside.csv", b"x,y,volume\n0.1,0.2,0.01\n0.1,2.2,0.01\n")
        }),
        ("a list of junk", &|| list("junk.csv", &junk)),
        ("an npz of junk", &|| list("junk.npz", &junk)),
        ("an npz that is not there", &|| {
            write(
                "scene.toml",
                GOOD.replace(
                    "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }",
                    "particles = \"none.npz\"",
                )
                .as_bytes(),
            )
        }),
    ];
    let mut all = String::new();
    for (what, make) in cases {
        let error = match Scene::load(&make(), &[]) {
            Err(error) => error
                .to_string()
                .replace(&folder.path().display().to_string(), "DIR"),
            Ok(scene) => panic!("{what}: {}", scene.summary()),
        };
        writeln!(all, "# {what}\n{error}\n").unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn the_memory_limit_can_be_moved() {
    let small = Limits { memory: 10_000 };
    assert!(Scene::parse_within(GOOD, "a", &[], &small).is_err());
    assert!(Scene::parse_within(GOOD, "a", &[], &Limits { memory: 1_000_000 }).is_ok());
}

#[test]
fn colours_only_when_asked() {
    let error = failure("dx = 1\nzebra = 2", &[]);
    assert!(!error.to_string().contains('\u{1b}'));
    assert!(error.render(true).contains('\u{1b}'));
}
