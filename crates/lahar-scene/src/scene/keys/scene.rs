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
            "Title of the scene.",
        ),
        key(
            "dimension",
            Kind::Integer(2, 3),
            "",
            Value("2"),
            "Number of dimensions. In 2D all quantities are per meter of depth.",
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
            Words("60.0, or what `substeps_per_frame` comes to"),
            "Frames (outputs) per simulated second.",
        ),
        key(
            "gravity",
            Kind::Formulas(Variables::PlaceAndTime),
            "m/s²",
            ByDimension("[0.0, -9.81]", "[0.0, -9.81, 0.0]"),
            "Acceleration of all material, as numbers or expressions.",
        ),
        key(
            "dx",
            Kind::Number(Bound::Positive),
            "m",
            Required,
            "Distance between nodes of the grid: the resolution.",
        ),
        key(
            "precision",
            Kind::Word(&words(&PRECISIONS)),
            "",
            Value("\"f32\""),
            "Precision of the simulation: 32 or 64 bits.",
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
            "Transfer scheme between particles and grid.",
        ),
        key(
            "flip_blend",
            Kind::Number(Bound::Part),
            "",
            Words("0.99, with `transfer = \"flip\"` only"),
            "Part of FLIP in the velocity of a particle; the rest is PIC.",
        ),
        key(
            "force",
            Kind::Word(&words(&FORCE_FORMS)),
            "",
            Value("\"mls\""),
            "Form of the internal force: by moving least squares, or by the gradients of the weights as in the original MPM.",
        ),
        key(
            "cfl",
            Kind::Number(Bound::Part),
            "",
            Value("0.4"),
            "With an automatic time step: the part of a cell that sound or a particle may cross in one substep.",
        ),
        key(
            "dt",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&["auto"])]),
            "s",
            Value("\"auto\""),
            "Length of every substep. `\"auto\"` finds it from the state.",
        ),
        key(
            "dt_max",
            Kind::Number(Bound::Positive),
            "s",
            Words("no limit"),
            "With an automatic time step: the longest substep.",
        ),
        key(
            "substeps_per_frame",
            Kind::Integer(1, 1_000_000),
            "",
            Words("as many as fill the frame"),
            "With a fixed `dt`: number of substeps in a frame.",
        ),
        key(
            "seed",
            Kind::Integer(0, i64::MAX),
            "",
            Value("0"),
            "Seed of all random numbers. The same seed gives the same particles.",
        ),
        key(
            "domain",
            Kind::Table(&DOMAIN),
            "",
            Words("unbounded"),
            "The box that the scene takes place in.",
        ),
        key(
            "materials",
            Kind::Materials,
            "",
            Required,
            "Materials of bodies, by name: `[materials.NAME]`.",
        ),
        key(
            "bodies",
            Kind::Tables(&BODY),
            "",
            Required,
            "The bodies at the start: one `[[bodies]]` each.",
        ),
        key(
            "camera",
            Kind::Table(&CAMERA),
            "",
            Value("{}"),
            "The camera of the window and of pictures.",
        ),
        key(
            "controls",
            Kind::Table(&CONTROLS),
            "",
            Value("{}"),
            "Controls of keys and mouse in the window.",
        ),
        key(
            "output",
            Kind::Table(&OUTPUT),
            "",
            Value("{}"),
            "Output of a run.",
        ),
        key(
            "colliders",
            Kind::Tables(&COLLIDER),
            "",
            Words("none"),
            "Solids that material cannot enter, at rest or moving: one `[[colliders]]` each.",
        ),
        key(
            "forces",
            Kind::Tables(&FORCE),
            "",
            Words("none"),
            "Accelerations of all material in addition to gravity: one `[[forces]]` each.",
        ),
        key(
            "probes",
            Kind::Tables(&PROBE),
            "",
            Words("none"),
            "Measurements during the run: one `[[probes]]` each.",
        ),
        later("emitters"),
        later("drains"),
    ]],
};
