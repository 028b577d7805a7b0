//! Keys of probes.

use crate::scene::choices::ENDS;
use crate::scene::key::WhenAbsent::{Required, Value, Words};
use crate::scene::key::{Bound, Key, Kind, Section, key, words};

pub(crate) static PROBE: Section = Section {
    name: "probe",
    header: "[[probes]]: exactly one key besides name and rate",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Required,
            "Name of the file probes/NAME.csv, of letters, digits, - and _.",
        ),
        key(
            "rate",
            Kind::Number(Bound::Positive),
            "1/s",
            Words("`frame_rate`"),
            "Readings per second. Each is taken at the end of the first substep at or after its time.",
        ),
        key(
            "pressure",
            Kind::Table(&PRESSURE),
            "",
            Words("–"),
            "Pressure at a point, or the mean pressure over a plate.",
        ),
        key(
            "velocity",
            Kind::Table(&VELOCITY_PROBE),
            "",
            Words("–"),
            "Velocity at a point.",
        ),
        key(
            "height",
            Kind::Table(&HEIGHT),
            "",
            Words("–"),
            "Height of the surface.",
        ),
        key(
            "front",
            Kind::Table(&FRONT),
            "",
            Words("–"),
            "Position of the front of the material along an axis.",
        ),
        key(
            "force",
            Kind::Table(&FORCE_PROBE),
            "",
            Words("–"),
            "Mean force of the material on a wall or collider between two readings.",
        ),
    ]],
};

pub(crate) static PRESSURE: Section = Section {
    name: "pressure",
    header: "pressure = { .. } in [[probes]]",
    keys: &[&[
        key(
            "at",
            Kind::Vector,
            "m",
            Required,
            "The point, on a wall or inside; for a plate its middle.",
        ),
        key(
            "radius",
            Kind::Number(Bound::Positive),
            "m",
            Words("2 `dx`"),
            "Distance up to which particles count.",
        ),
        key(
            "normal",
            Kind::Vector,
            "",
            Words("a point, no plate"),
            "Direction across the plate; its length does not matter.",
        ),
        key(
            "width",
            Kind::Number(Bound::Positive),
            "m",
            Words("a point, no plate"),
            "Length of the plate in 2D, diameter of the disc in 3D.",
        ),
    ]],
};

pub(crate) static VELOCITY_PROBE: Section = Section {
    name: "velocity at a point",
    header: "velocity = { .. } in [[probes]]",
    keys: &[&[
        key("at", Kind::Vector, "m", Required, "The point."),
        key(
            "radius",
            Kind::Number(Bound::Positive),
            "m",
            Words("2 `dx`"),
            "Distance up to which particles count.",
        ),
    ]],
};

const AXIS: Kind = Kind::Word(&["x", "y", "z"]);

const UP: Key = key("up", AXIS, "", Value("\"y\""), "Axis that points up.");

pub(crate) static HEIGHT: Section = Section {
    name: "height",
    header: "height = { .. } in [[probes]]",
    keys: &[&[
        key(
            "at",
            Kind::Vector,
            "m",
            Words("the mean over the domain: filled volume over area"),
            "A point in the column.",
        ),
        UP,
    ]],
};

pub(crate) static FRONT: Section = Section {
    name: "front",
    header: "front = { .. } in [[probes]]",
    keys: &[&[
        key(
            "along",
            AXIS,
            "",
            Value("\"x\""),
            "Axis that the front moves along.",
        ),
        key(
            "towards",
            Kind::Word(&words(&ENDS)),
            "",
            Value("\"high\""),
            "End of the axis that the front moves towards.",
        ),
        key(
            "depth",
            Kind::Number(Bound::Positive),
            "m",
            Required,
            "Depth of the front: the last column of cells that is deeper is the front.",
        ),
        UP,
    ]],
};

pub(crate) static FORCE_PROBE: Section = Section {
    name: "force on a wall",
    header: "force = { .. } in [[probes]]",
    keys: &[&[key(
        "on",
        Kind::Text,
        "",
        Required,
        "A wall of the domain (`left`, `right`, `bottom`, `top`, `back` or `front`) or the name of a collider.",
    )]],
};
