//! Keys of colliders.

use super::shape::SHAPE;
use crate::scene::key::WhenAbsent::{ByDimension, Required, Value, Words};
use crate::scene::key::{Bound, Kind, Section, key};

pub(crate) static COLLIDER: Section = Section {
    name: "collider",
    header: "[[colliders]]",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Words("\"collider-N\" with its number N, counted from 0"),
            "Name in outputs and in `--set colliders.NAME.velocity=..`.",
        ),
        key(
            "shape",
            Kind::Table(&SHAPE),
            "",
            Required,
            "Space that the collider takes up, written as for bodies: boxes, balls, half-spaces, polygons, cylinders, capsules and unions of them, which can be scaled (balls, cylinders and capsules by one number), rotated, translated and copied.",
        ),
        key(
            "contact",
            Kind::Word(&["sticky", "slip", "separate"]),
            "",
            Value("\"separate\""),
            "`sticky`: material moves with the collider. `slip`: no motion through its surface or away from it. `separate`: no motion into it, but material can leave it.",
        ),
        key(
            "friction",
            Kind::Number(Bound::NotNegative),
            "",
            Words("0, with `slip` and `separate` only"),
            "Coefficient of Coulomb friction.",
        ),
        key(
            "center",
            Kind::Vector,
            "m",
            Words("the middle of its shape; for a half-space its point"),
            "Point that the collider turns about, that keyframes move, and that its torque refers to.",
        ),
        key(
            "velocity",
            Kind::Vector,
            "m/s",
            Words("0"),
            "Velocity of its center, at all times.",
        ),
        key(
            "spin",
            Kind::Rotation,
            "rad/s",
            Words("0"),
            "Rotation about its center, counter-clockwise.",
        ),
        key(
            "keyframes",
            Kind::Tables(&KEYFRAME),
            "",
            Words("none"),
            "Positions at given times, in place of `velocity` and `spin`. The collider moves from one to the next at constant speeds, and rests before the first and after the last.",
        ),
        key(
            "color",
            Kind::Color,
            "",
            Words("gray"),
            "Color in windows and pictures.",
        ),
    ]],
};

pub(crate) static KEYFRAME: Section = Section {
    name: "keyframe",
    header: "keyframes = [{ .. }, ..] in [[colliders]]",
    keys: &[&[
        key(
            "time",
            Kind::Number(Bound::Any),
            "s",
            Required,
            "Time of the keyframe, later than that of the keyframe before.",
        ),
        key(
            "position",
            Kind::Vector,
            "m",
            Words("the collider's `center`"),
            "Position of the center.",
        ),
        key(
            "rotate",
            Kind::Rotation,
            "degrees",
            ByDimension("0.0", "[0.0, 0.0, 0.0]"),
            "Counter-clockwise rotation since the start. In 3D the direction of the vector is the axis, and its length the angle.",
        ),
    ]],
};
