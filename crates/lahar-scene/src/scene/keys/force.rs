//! Keys of forces.

use crate::scene::formula::Variables;
use crate::scene::key::WhenAbsent::{ByDimension, Required, Value, Words};
use crate::scene::key::{Bound, Key, Kind, Section, key, only_3d};

pub(crate) static FORCE: Section = Section {
    name: "force",
    header: "[[forces]]: exactly one besides the name",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Words("its number from 0"),
            "Name, for `--set forces.NAME.acceleration=..`.",
        ),
        key(
            "acceleration",
            Kind::Formulas(Variables::PlaceAndTime),
            "m/s²",
            Words("–"),
            "An acceleration, numbers or expressions.",
        ),
        key(
            "central",
            Kind::Table(&CENTRAL),
            "",
            Words("–"),
            "An acceleration towards a point.",
        ),
        key(
            "vortex",
            Kind::Table(&VORTEX),
            "",
            Words("–"),
            "An acceleration around a point, in 3D around an axis.",
        ),
        key(
            "drag",
            Kind::Table(&DRAG),
            "",
            Words("–"),
            "Resistance of air or another medium.",
        ),
        key(
            "damping",
            Kind::Number(Bound::NotNegative),
            "1/s",
            Words("–"),
            "Drag of a medium at rest: velocities decay at this rate.",
        ),
    ]],
};

const CENTER: Key = key("center", Kind::Vector, "m", Required, "The point.");

const ACCELERATION: Key = key(
    "acceleration",
    Kind::Number(Bound::Any),
    "m/s²",
    Required,
    "A: its size at `distance`; negative turns it round.",
);

const DISTANCE: Key = key(
    "distance",
    Kind::Number(Bound::Positive),
    "m",
    Value("1.0"),
    "d: the distance at which it has that size.",
);

const SOFTENING: Key = key(
    "softening",
    Kind::Number(Bound::Positive),
    "m",
    Words("`dx`"),
    "ε: below it the distance hardly counts.",
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
            "n: 2 as of a planet, 0 the same everywhere, -1 a spring.",
        ),
        SOFTENING,
    ]],
};

pub(crate) static VORTEX: Section = Section {
    name: "vortex",
    header: "vortex = { .. }: the same, turned counter-clockwise by a right angle",
    keys: &[&[
        CENTER,
        only_3d(key(
            "axis",
            Kind::Vector,
            "",
            Value("[0.0, 1.0, 0.0]"),
            "Direction of the axis, of any length.",
        )),
        ACCELERATION,
        DISTANCE,
        key(
            "power",
            Kind::Number(Bound::Any),
            "",
            Value("1.0"),
            "n: how fast it falls with the distance.",
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
            "How fast the difference to the medium's velocity decays.",
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
