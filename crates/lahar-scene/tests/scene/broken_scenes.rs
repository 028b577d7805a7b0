//! Errors in scenes and particle files: each gives one message with its place and advice.
//!
//! The messages are recorded in the folder snapshots (`cargo insta review` after a change).

use crate::support::overrides;
use lahar_scene::error::SceneError;
use lahar_scene::scene::{Limits, Scene};
use std::fmt::Write;
use tempfile::TempDir;

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

/// The shape of the good scene's body.
const SHAPE: &str = "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }";

/// The box of this shape.
const BOX: &str = "box = { min = [0.0, 0.0], max = [0.5, 0.5] }";

/// Faults of a scene: (name, text of the good scene, its replacement).
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
        "a force without a center",
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
    (
        "a cylinder in 2D",
        BOX,
        "cylinder = { from = [0.0, 0.0], to = [0.5, 0.5], radius = 0.1 }",
    ),
    ("a mesh in 2D", BOX, "mesh = \"ball.stl\""),
    ("an empty union", BOX, "union = []"),
    ("a union of numbers", BOX, "union = [1, 2]"),
    (
        "a typo in a part of a union",
        BOX,
        "union = [{ ball = { center = [0.2, 0.2], radus = 0.1 } }]",
    ),
    (
        "a difference that leaves nothing",
        BOX,
        "difference = [{ box = { min = [0.0, 0.0], max = [0.5, 0.5] } }, { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }]",
    ),
    (
        "a union too deep",
        "{ box = { min = [0.0, 0.0], max = [0.5, 0.5] } }",
        "{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ box = { min = [0.0, 0.0], max = [0.5, 0.5] } }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }",
    ),
    (
        "a union far too deep",
        "{ box = { min = [0.0, 0.0], max = [0.5, 0.5] } }",
        "{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ union = [{ box = { min = [0.0, 0.0], max = [0.5, 0.5] } }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }] }",
    ),
    (
        "a scale of zero",
        BOX,
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }, scale = 0.0",
    ),
    (
        "a negative scale",
        BOX,
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }, scale = [1.0, -1.0]",
    ),
    (
        "about without a turn",
        BOX,
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }, about = [0.0, 0.0]",
    ),
    (
        "half a copy",
        BOX,
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }, copies = { count = [1.5, 1], step = [0.1, 0.1] }",
    ),
    (
        "copies in one place",
        BOX,
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }, copies = { count = [3, 1], step = [0.0, 0.1] }",
    ),
    (
        "a million copies",
        BOX,
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }, copies = { count = [1000, 1000], step = [0.001, 0.001] }",
    ),
    (
        "a turn as in 3D",
        BOX,
        "box = { min = [0.0, 0.0], max = [0.5, 0.5] }, rotate = [0.0, 0.0, 30.0]",
    ),
    (
        "a negative radius",
        BOX,
        "ball = { center = [0.2, 0.2], radius = -0.1 }",
    ),
    (
        "a polygon in a line",
        BOX,
        "polygon = { points = [[0.0, 0.0], [0.5, 0.5], [0.2, 0.2]] }",
    ),
    (
        "a capsule without an end",
        BOX,
        "capsule = { from = [0.0, 0.0], radius = 0.1 }",
    ),
    (
        "a normal without a direction",
        BOX,
        "half_space = { point = [0.0, 0.2], normal = [0, 0] }",
    ),
    (
        "two bodies of one name",
        "[[bodies]]\nname = \"column\"\n",
        "[[bodies]]\nname = \"column\"\nmaterial = \"jelly\"\nshape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[bodies]]\nname = \"column\"\n",
    ),
    (
        "numbers beyond all bounds",
        "max = [2.0, 1.0]",
        "max = [2.0e300, 1.0e300]",
    ),
    ("a body at infinity", "max = [0.5, 0.5]", "max = [inf, 0.5]"),
    (
        "a number that is too large for one",
        "dx = 0.05",
        "dx = 1e999",
    ),
    (
        "a whole number that is too large",
        "dx = 0.05",
        "dx = 0.05\nseed = 99999999999999999999",
    ),
    ("a date", "dx = 0.05", "dx = 0.05\nduration = 2024-01-01"),
    (
        "a negative duration",
        "dx = 0.05",
        "dx = 0.05\nduration = -1",
    ),
    (
        "a body that is a number",
        "[[bodies]]\nname = \"column\"\nmaterial = \"water\"\nshape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n",
        "",
    ),
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
        BOX,
        "polygon = { points = [[0.0, 0.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5]] }",
    ),
    ("one bracket", "[[bodies]]", "[bodies]"),
    (
        "a table to come",
        "title = \"Column\"\n",
        "title = \"Column\"\nemitters = []\n",
    ),
    (
        "a probe without a name",
        "title = \"Column\"\n",
        "probes = [{ height = {} }]\n",
    ),
    (
        "a probe whose name is a path",
        "title = \"Column\"\n",
        "probes = [{ name = \"../p\", height = {} }]\n",
    ),
    (
        "a probe of nothing",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\" }]\n",
    ),
    (
        "a probe of two things",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\", height = {}, front = { depth = 0.1 } }]\n",
    ),
    (
        "two probes of one name",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\", height = {} }, { name = \"P\", height = {} }]\n",
    ),
    (
        "a pressure nowhere",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\", pressure = { radius = 0.1 } }]\n",
    ),
    (
        "a velocity without a place",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\", velocity = {} }]\n",
    ),
    (
        "a plate without a width",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\", pressure = { at = [0.1, 0.1], normal = [1.0, 0.0] } }]\n",
    ),
    (
        "a front along an axis that is not there",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\", front = { along = \"z\", depth = 0.1 } }]\n",
    ),
    (
        "a front upwards",
        "title = \"Column\"\n",
        "probes = [{ name = \"p\", front = { along = \"y\", depth = 0.1 } }]\n",
    ),
    ("10¹² particles", "dx = 0.05", "dx = 1.0e-6"),
    (
        "10¹² particles per cell",
        "material = \"water\"",
        "material = \"water\"\nparticles_per_cell = 1.0e10",
    ),
    (
        "a thread across an empty domain",
        SHAPE,
        "spacing = 3.0e-5\nshape = { capsule = { from = [0.0, 0.0], to = [2.0, 1.0], radius = 1.0e-4 } }",
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
    (
        "a formula as spin",
        "material = \"water\"",
        "material = \"water\"\nspin = \"2*x\"",
    ),
    (
        "a formula as spin in 3D",
        "dx = 0.05\n\n[domain]\nmin = [0.0, 0.0]\nmax = [2.0, 1.0]\n",
        "dx = 0.05\ndimension = 3\n[domain]\nmin = [0.0, 0.0, 0.0]\nmax = [2.0, 1.0, 1.0]\n[[bodies]]\nspin = [0.0, \"x\", 1.0]\n",
    ),
    (
        "formulas as a velocity gradient",
        "material = \"water\"",
        "material = \"water\"\nvelocity_gradient = [[0.0, \"sin(x)\"], [0.0, 0.0]]",
    ),
    (
        "a yield stress of water",
        "model = \"fluid\"\n",
        "model = \"fluid\"\nyield_stress = 10.0\n",
    ),
    (
        "a rheology without numbers",
        "model = \"fluid\"\n",
        "model = \"fluid\"\nrheology = \"herschel-bulkley\"\n",
    ),
    (
        "a fluid that thickens",
        "model = \"fluid\"\n",
        "model = \"fluid\"\nrheology = \"herschel-bulkley\"\nconsistency = 1.0\nflow_index = 1.5\n",
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
        SHAPE,
        "particles = \"nowhere.csv\"",
    ),
    (
        "a particle list of another kind",
        SHAPE,
        "particles = \"start.xlsx\"",
    ),
    (
        "an unknown color",
        "density = 1000.0",
        "density = 1000.0\ncolor = \"blue\"",
    ),
    (
        "an unknown output field",
        "dx = 0.05",
        "dx = 0.05\noutput = { fields = [\"velocty\"] }",
    ),
    (
        "a collider without a shape",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nname = \"gate\"",
    ),
    (
        "a collider of a shape that is not possible",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nshape = { difference = [{ ball = { center = [1.0, 0.5], radius = 0.2 } }, { ball = { center = [1.0, 0.5], radius = 0.1 } }] }",
    ),
    (
        "a stretched collider",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 }, scale = [1.0, 2.0] }",
    ),
    (
        "a collider with a contact of walls only",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }\ncontact = \"open\"",
    ),
    (
        "a sticky collider with friction",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }\ncontact = \"sticky\"\nfriction = 0.2",
    ),
    (
        "a collider called like a side",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nname = \"left\"\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }",
    ),
    (
        "two colliders of one name",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nname = \"a\"\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }\n\n[[colliders]]\nname = \"a\"\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }",
    ),
    (
        "a collider that moves twice",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }\nspin = 1.0\nkeyframes = [{ time = 0.0 }]",
    ),
    (
        "keyframes in disorder",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }\nkeyframes = [{ time = 1.0 }, { time = 0.5 }]",
    ),
    (
        "a typo in a keyframe",
        SHAPE,
        "shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }\n\n[[colliders]]\nshape = { ball = { center = [1.0, 0.5], radius = 0.2 } }\nkeyframes = [{ time = 1.0, rotation = 20.0 }]",
    ),
];

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float volume\nend_header\n0.1 0.1 0.01\n0.3 0.1 0.01\n";

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// Returns an .npz file with one array, whose header may contradict its numbers.
fn npz(descr: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((header.len() as u16).to_le_bytes());
    npy.extend(header.as_bytes());
    npy.extend(numbers);
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    writer.start_file("position.npy", options).unwrap();
    std::io::Write::write_all(&mut writer, &npy).unwrap();
    writer.finish().unwrap().into_inner()
}

/// Returns the error of a scene that must have one.
fn failure(text: &str, pairs: &[(&str, &str)]) -> SceneError {
    match Scene::parse(text, "column.toml", &overrides(pairs)) {
        Err(error) => error,
        Ok(scene) => panic!(
            "no error in this scene: {text}\n{:?} {}",
            scene.overrides,
            scene.summary()
        ),
    }
}

#[test]
fn broken_scenes() {
    Scene::parse(GOOD, "column.toml", &[]).unwrap();
    let mut all = String::new();
    for (name, from, to) in BROKEN {
        assert!(GOOD.contains(from), "{name}: {from}");
        let error = failure(&GOOD.replacen(from, to, 1), &[]);
        assert!(error.line > 0, "{name} has no place: {error}");
        writeln!(all, "# {name}\n{error}\n").unwrap();
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

/// A folder that broken files are written to.
struct Folder(TempDir);

impl Folder {
    /// Writes a file and returns its path.
    fn write(&self, name: &str, bytes: &[u8]) -> String {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.display().to_string()
    }

    /// Writes a particle list and a scene that uses it; returns the scene's path.
    fn list(&self, name: &str, bytes: &[u8]) -> String {
        self.write(name, bytes);
        self.scene_with_list(name)
    }

    /// Writes the good scene with a particle list for its shape; returns its path.
    fn scene_with_list(&self, name: &str) -> String {
        let text = GOOD.replace(SHAPE, &format!("particles = \"{name}\""));
        self.write("scene.toml", text.as_bytes())
    }

    /// Writes a scene with a mesh for its shape; returns its path.
    fn scene_with_mesh(&self, name: &str) -> String {
        let text = format!(
            "dimension = 3\ndx = 0.1\n[materials.jelly]\npreset = \"jelly\"\n[[bodies]]\nmaterial = \"jelly\"\nshape = {{ mesh = \"{name}\" }}\n"
        );
        self.write("scene.toml", text.as_bytes())
    }
}

/// Returns bytes without a meaning.
fn junk() -> Vec<u8> {
    (0..600_u32).map(|i| (i * 37 % 251) as u8).collect()
}

/// Writes the files of a case to a folder and returns the path of its scene.
type WriteCase = fn(&Folder) -> String;

/// Faults of files: (name, files).
const BROKEN_FILES: &[(&str, WriteCase)] = &[
    ("an empty file", |f| f.write("empty.toml", b"")),
    ("only a comment", |f| f.write("comment.toml", b"# later\n")),
    ("a folder", |f| f.0.path().display().to_string()),
    ("binary junk", |f| f.write("junk.toml", &junk())),
    ("junk that is text", |f| {
        f.write("text.toml", b"\x01\x02 hello \x00 world \x7f ~~~")
    }),
    ("no such file", |_| "dam-brake".to_owned()),
    ("no such file at all", |_| "no/such/file.toml".to_owned()),
    ("an empty list", |f| f.list("empty.csv", b"")),
    ("a list of nothing", |f| {
        f.list("nothing.csv", b"x,y,volume\n")
    }),
    ("a list without a header", |f| {
        f.list("header.csv", b"0.1,0.2\n0.2,0.2\n")
    }),
    ("a list cut short", |f| {
        f.list("cut.csv", b"x,y,volume\n0.1,0.2,0.01\n0.2,0.")
    }),
    ("a list with a word", |f| {
        f.list("word.csv", b"x,y,volume\n0.1,much,0.01\n")
    }),
    ("a list with nan", |f| {
        f.list("nan.csv", b"x,y,volume\n0.1,nan,0.01\n")
    }),
    ("a list with a negative volume", |f| {
        f.list("negative.csv", b"x,y,volume\n0.1,0.2,-0.01\n")
    }),
    ("a list with an unknown column", |f| {
        f.list("column.csv", b"x,y,vollume\n0.1,0.2,0.01\n")
    }),
    ("a list of 3D", |f| {
        f.list("three.csv", b"x,y,z\n0.1,0.2,0.3\n")
    }),
    ("a list without volumes", |f| {
        f.list("bare.csv", b"x,y\n0.1,0.2\n")
    }),
    ("a list outside the domain", |f| {
        f.list("outside.csv", b"x,y,volume\n0.1,0.2,0.01\n0.1,2.2,0.01\n")
    }),
    ("a list of junk", |f| f.list("junk.csv", &junk())),
    ("an npz of junk", |f| f.list("junk.npz", &junk())),
    ("an npz of words", |f| {
        f.list("words.npz", &npz("<U4", "(2, 2)", &[0; 64]))
    }),
    ("an npz of another shape", |f| {
        f.list("shape.npz", &npz("<f8", "(4,)", &[0; 32]))
    }),
    ("an npz that is shorter than it says", |f| {
        f.list("short.npz", &npz("<f8", "(1000000000, 2)", &[0; 32]))
    }),
    ("a ply of 3D junk", |f| f.list("junk.ply", &junk())),
    ("a ply that promises too much", |f| {
        f.list(
            "lie.ply",
            PLY.replace("vertex 2", "vertex 1000000000000").as_bytes(),
        )
    }),
    ("a ply with a word", |f| {
        f.list("word.ply", PLY.replace("0.3 0.1", "0.3 much").as_bytes())
    }),
    ("a ply of nothing", |f| {
        f.list(
            "nothing.ply",
            PLY.replace("vertex 2", "vertex 0").as_bytes(),
        )
    }),
    ("a ply without y", |f| {
        f.list("flat.ply", PLY.replace("float y", "float w").as_bytes())
    }),
    ("a list with a mark of byte order, cut", |f| {
        f.list("mark.csv", "\u{feff}x,y,volume\n0.1,0.2\n".as_bytes())
    }),
    ("a list in bytes of another alphabet", |f| {
        f.list("latin.csv", b"x,y,volume\n0.1,0.2,0.01 # gr\xfc\xdfe\n")
    }),
    ("a list with decimal commas", |f| {
        f.list("comma.csv", b"x;y;volume\n0,1;0,2;0,01\n")
    }),
    ("a scene in bytes of another alphabet", |f| {
        f.write("latin.toml", b"title = \"gr\xfc\xdfe\"\ndx = 0.1\n")
    }),
    ("a scene in two bytes a letter", |f| {
        f.write("wide.toml", b"\xff\xfed\x00x\x00 \x00=\x00 \x001\x00")
    }),
    ("a scene cut short", |f| {
        f.write("half.toml", &GOOD.as_bytes()[..GOOD.len() / 2])
    }),
    ("a list that is a folder", |f| {
        std::fs::create_dir(f.0.path().join("folder.csv")).unwrap();
        f.scene_with_list("folder.csv")
    }),
    ("a mesh that is not there", |f| {
        f.scene_with_mesh("none.stl")
    }),
    ("a mesh of another kind", |f| {
        f.write("mesh.fbx", b"x");
        f.scene_with_mesh("mesh.fbx")
    }),
    ("an empty mesh", |f| {
        f.write("empty.obj", b"");
        f.scene_with_mesh("empty.obj")
    }),
    ("an open mesh", |f| {
        f.write("open.obj", OBJ.replace("f 1 3 2\n", "").as_bytes());
        f.scene_with_mesh("open.obj")
    }),
    ("a mesh with nan", |f| {
        f.write("nan.obj", OBJ.replace("v 0 1 0", "v 0 nan 0").as_bytes());
        f.scene_with_mesh("nan.obj")
    }),
    ("a mesh with a corner that is not there", |f| {
        f.write("corner.obj", OBJ.replace("f 1 3 2", "f 1 3 20").as_bytes());
        f.scene_with_mesh("corner.obj")
    }),
    ("a mesh cut short", |f| {
        let mut bytes = vec![0; 84 + 50];
        bytes[80] = 9;
        f.write("cut.stl", &bytes);
        f.scene_with_mesh("cut.stl")
    }),
    ("a mesh without thickness", |f| {
        f.write("flat.obj", OBJ.replace("v 0 0 1", "v 1 1 0").as_bytes());
        f.scene_with_mesh("flat.obj")
    }),
    ("an npz that is not there", |f| {
        f.scene_with_list("none.npz")
    }),
];

#[test]
fn broken_files() {
    let folder = Folder(tempfile::tempdir().unwrap());
    let place = folder.0.path().display().to_string();
    let mut all = String::new();
    for (name, write) in BROKEN_FILES {
        let error = match Scene::load(&write(&folder), &[]) {
            Err(error) => error.to_string().replace(&place, "DIR"),
            Ok(scene) => panic!("{name}: {}", scene.summary()),
        };
        writeln!(all, "# {name}\n{error}\n").unwrap();
    }
    insta::assert_snapshot!(all);
}

/// Devices and pipes may never end, so they are refused without being read.
#[cfg(unix)]
#[test]
fn only_plain_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.csv");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.is_ok_and(|status| status.success()));
    let pipe = pipe.display().to_string();
    for path in ["/dev/zero", &pipe] {
        let error = Scene::load(path, &[]).unwrap_err();
        assert!(error.message.contains("a device or a pipe"), "{error}");
    }
    let zero = folder.path().join("zero.npz");
    std::os::unix::fs::symlink("/dev/zero", &zero).unwrap();
    for path in [&*pipe, &zero.display().to_string()] {
        let text = GOOD.replace(SHAPE, &format!("particles = \"{path}\""));
        let error = failure(&text, &[]);
        assert!(error.message.contains("a device or a pipe"), "{error}");
        assert!(error.line > 0, "{error}");
    }
}

#[test]
fn line_ends_and_byte_order_marks_of_other_systems_are_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("column.toml");
    for text in [GOOD.replace('\n', "\r\n"), format!("\u{feff}{GOOD}")] {
        std::fs::write(&path, text).unwrap();
        Scene::load(&path.display().to_string(), &[]).unwrap_or_else(|error| panic!("{error}"));
    }
    std::fs::write(&path, GOOD.replace('\n', "\r\n").replace("dx =", "dy =")).unwrap();
    let error = Scene::load(&path.display().to_string(), &[]).unwrap_err();
    assert_eq!(
        (error.line, error.column, &*error.text),
        (2, 1, "dy = 0.05")
    );
}

#[test]
fn the_memory_limit_can_be_set() {
    let small = Limits { memory: 10_000 };
    assert!(Scene::parse_within(GOOD, "a", &[], &small).is_err());
    assert!(Scene::parse_within(GOOD, "a", &[], &Limits { memory: 1_000_000 }).is_ok());
}

#[test]
fn errors_are_colored_on_request_only() {
    let error = failure("dx = 1\nzebra = 2", &[]);
    assert!(!error.to_string().contains('\u{1b}'));
    assert!(error.render(true).contains('\u{1b}'));
}
