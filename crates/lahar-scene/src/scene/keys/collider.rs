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
            Words("\"collider-N\", N its number from 0"),
            "Name, for outputs and `--set colliders.NAME.velocity=..`.",
        ),
        key(
            "shape",
            Kind::Table(&SHAPE),
            "",
            Required,
            "The space it takes, as for bodies: boxes, balls, half-spaces, polygons, cylinders, capsules and unions of them, scaled (balls, cylinders and capsules by one number), turned, moved and repeated.",
        ),
        key(
            "contact",
            Kind::Word(&["sticky", "slip", "separate"]),
            "",
            Value("\"separate\""),
            "`sticky`: material moves with it; `slip`: none through its surface or away from it; `separate`: none into it, free to leave.",
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
            Words("the middle of its shape; a half-space's point"),
            "The point that it turns about, that keyframes place, and that its torque is about.",
        ),
        key(
            "velocity",
            Kind::Vector,
            "m/s",
            Words("0"),
            "Velocity of its center, always on.",
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
            "Where it is when, instead of `velocity` and `spin`: it goes from one to the next at constant speeds, and stays before the first and after the last.",
        ),
        key(
            "color",
            Kind::Color,
            "",
            Words("grey"),
            "Its colour in windows and pictures.",
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
            "When; later than the keyframe before.",
        ),
        key(
            "position",
            Kind::Vector,
            "m",
            Words("the collider's `center`"),
            "Where the center is.",
        ),
        key(
            "rotate",
            Kind::Rotation,
            "degrees",
            ByDimension("0.0", "[0.0, 0.0, 0.0]"),
            "How far it has turned, counter-clockwise; in 3D about the direction of this vector, by its length.",
        ),
    ]],
};
