//! Keys at the top of a scene file.

use super::body::BODY;
use super::collider::COLLIDER;
use super::domain::DOMAIN;
use super::force::FORCE;
use super::output::OUTPUT;
use super::probe::PROBE;
use super::window::{CAMERA, CONTROLS};
use crate::scene::choices::{FORCE_FORMS, KERNELS, PRECISIONS, TRANSFERS};
use crate::scene::formula::Variables;
use crate::scene::key::WhenAbsent::{ByDimension, Required, Value, Words};
use crate::scene::key::{Bound, Kind, Section, key, later, words};

pub(crate) static SCENE: Section = Section {
    name: "scene",
    header: "at the top of the file",
    keys: &[&[
        key(
            "title",
            Kind::Text,
            "",
            Value("\"\""),
            "What the scene is, for people.",
        ),
        key(
            "dimension",
            Kind::Integer(2, 3),
            "",
            Value("2"),
            "2 or 3; in 2D everything is per metre of depth.",
        ),
        key(
            "duration",
            Kind::Number(Bound::Positive),
            "s",
            Value("1.0"),
            "Simulated time of a run.",
        ),
        key(
            "frame_rate",
            Kind::Number(Bound::Positive),
            "1/s",
            Words("60.0; with `substeps_per_frame`, what that comes to"),
            "Frames (outputs) a simulated second.",
        ),
        key(
            "gravity",
            Kind::Formulas(Variables::PlaceAndTime),
            "m/s²",
            ByDimension("[0.0, -9.81]", "[0.0, -9.81, 0.0]"),
            "Acceleration of everything; may be expressions.",
        ),
        key(
            "dx",
            Kind::Number(Bound::Positive),
            "m",
            Required,
            "Distance between the grid's nodes: the resolution.",
        ),
        key(
            "precision",
            Kind::Word(&words(&PRECISIONS)),
            "",
            Value("\"f32\""),
            "Numbers of 32 or of 64 bits.",
        ),
        key(
            "kernel",
            Kind::Word(&words(&KERNELS)),
            "",
            Value("\"quadratic\""),
            "Weight function between particles and nodes; `linear` needs `force = \"classic\"`.",
        ),
        key(
            "transfer",
            Kind::Word(&words(&TRANSFERS)),
            "",
            Value("\"apic\""),
            "What particles and grid exchange.",
        ),
        key(
            "flip_blend",
            Kind::Number(Bound::Part),
            "",
            Words("0.99, with `transfer = \"flip\"` only"),
            "Part of FLIP in the particle's velocity, the rest is PIC.",
        ),
        key(
            "force",
            Kind::Word(&words(&FORCE_FORMS)),
            "",
            Value("\"mls\""),
            "Force by moving least squares, or by the gradients of the weights as in the original MPM.",
        ),
        key(
            "cfl",
            Kind::Number(Bound::Part),
            "",
            Value("0.4"),
            "Part of a cell that sound or a particle may cross in a substep, when the time step is automatic.",
        ),
        key(
            "dt",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&["auto"])]),
            "s",
            Value("\"auto\""),
            "Length of every substep; `\"auto\"` finds it from the state.",
        ),
        key(
            "dt_max",
            Kind::Number(Bound::Positive),
            "s",
            Words("no limit"),
            "Longest substep when the time step is automatic.",
        ),
        key(
            "substeps_per_frame",
            Kind::Integer(1, 1_000_000),
            "",
            Words("as many as fill the frame"),
            "With a fixed `dt`: a frame is this many substeps, whatever the clock says.",
        ),
        key(
            "seed",
            Kind::Integer(0, i64::MAX),
            "",
            Value("0"),
            "Of everything random; the same seed gives the same particles.",
        ),
        key(
            "domain",
            Kind::Table(&DOMAIN),
            "",
            Words("unbounded"),
            "The box that holds the scene.",
        ),
        key(
            "materials",
            Kind::Materials,
            "",
            Required,
            "What bodies are made of, by name: `[materials.NAME]`.",
        ),
        key(
            "bodies",
            Kind::Tables(&BODY),
            "",
            Required,
            "What is there at the start: one `[[bodies]]` each.",
        ),
        key(
            "camera",
            Kind::Table(&CAMERA),
            "",
            Value("{}"),
            "How the window and pictures look at the scene.",
        ),
        key(
            "controls",
            Kind::Table(&CONTROLS),
            "",
            Value("{}"),
            "What keys and mouse do in the window.",
        ),
        key(
            "output",
            Kind::Table(&OUTPUT),
            "",
            Value("{}"),
            "What a run writes.",
        ),
        key(
            "colliders",
            Kind::Tables(&COLLIDER),
            "",
            Words("none"),
            "What material cannot enter, standing or moving: one `[[colliders]]` each.",
        ),
        key(
            "forces",
            Kind::Tables(&FORCE),
            "",
            Words("none"),
            "What acts on everything besides gravity: one `[[forces]]` each.",
        ),
        key(
            "probes",
            Kind::Tables(&PROBE),
            "",
            Words("none"),
            "What is measured on the way: one `[[probes]]` each.",
        ),
        later("emitters"),
        later("drains"),
    ]],
};
