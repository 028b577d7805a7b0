//! Keys of forces.

use crate::scene::formula::Variables;
use crate::scene::key::WhenAbsent::{ByDimension, Required, Value, Words};
use crate::scene::key::{Bound, Key, Kind, Section, key, only_3d};

pub(crate) static FORCE: Section = Section {
    name: "force",
    header: "[[forces]]: exactly one key besides the name",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Words("its number, counted from 0"),
            "Name in `--set forces.NAME.acceleration=..`.",
        ),
        key(
            "acceleration",
            Kind::Formulas(Variables::PlaceAndTime),
            "m/s²",
            Words("–"),
            "Acceleration, as numbers or expressions.",
        ),
        key(
            "central",
            Kind::Table(&CENTRAL),
            "",
            Words("–"),
            "Acceleration towards a point.",
        ),
        key(
            "vortex",
            Kind::Table(&VORTEX),
            "",
            Words("–"),
            "Acceleration around a point, in 3D around an axis.",
        ),
        key(
            "drag",
            Kind::Table(&DRAG),
            "",
            Words("–"),
            "Drag of air or another medium.",
        ),
        key(
            "damping",
            Kind::Number(Bound::NotNegative),
            "1/s",
            Words("–"),
            "Drag of a medium at rest: the rate at which velocities decay.",
        ),
    ]],
};

const CENTER: Key = key(
    "center",
    Kind::Vector,
    "m",
    Required,
    "Point that the force refers to.",
);

const ACCELERATION: Key = key(
    "acceleration",
    Kind::Number(Bound::Any),
    "m/s²",
    Required,
    "A: size of the acceleration at `distance`. A negative number reverses it.",
);

const DISTANCE: Key = key(
    "distance",
    Kind::Number(Bound::Positive),
    "m",
    Value("1.0"),
    "d: distance at which the acceleration has the size A.",
);

const SOFTENING: Key = key(
    "softening",
    Kind::Number(Bound::Positive),
    "m",
    Words("`dx`"),
    "ε: distance below which the acceleration stops growing.",
);

pub(crate) static CENTRAL: Section = Section {
    name: "central",
    header: "central = { .. }: A (d/s)ⁿ r/s with s = √(r² + ε²)",
    keys: &[&[
        CENTER,
        ACCELERATION,
        DISTANCE,
        key(
            "power",
            Kind::Number(Bound::Any),
            "",
            Value("2.0"),
            "n: 2 for a planet, 0 for the same size everywhere, -1 for a spring.",
        ),
        SOFTENING,
    ]],
};

pub(crate) static VORTEX: Section = Section {
    name: "vortex",
    header: "vortex = { .. }: the same size, turned counter-clockwise by a right angle",
    keys: &[&[
        CENTER,
        only_3d(key(
            "axis",
            Kind::Vector,
            "",
            Value("[0.0, 1.0, 0.0]"),
            "Direction of the axis; its length does not matter.",
        )),
        ACCELERATION,
        DISTANCE,
        key(
            "power",
            Kind::Number(Bound::Any),
            "",
            Value("1.0"),
            "n: power by which the acceleration falls with the distance.",
        ),
        SOFTENING,
    ]],
};

pub(crate) static DRAG: Section = Section {
    name: "drag",
    header: "drag = { .. }: -rate (v - velocity)",
    keys: &[&[
        key(
            "rate",
            Kind::Number(Bound::NotNegative),
            "1/s",
            Required,
            "Rate at which the difference to the velocity of the medium decays.",
        ),
        key(
            "velocity",
            Kind::Vector,
            "m/s",
            ByDimension("[0.0, 0.0]", "[0.0, 0.0, 0.0]"),
            "Velocity of the medium: wind, a current.",
        ),
    ]],
};
