//! Keys of the domain and its walls.

use super::shape::BOX;
use crate::scene::choices::{CONTACTS, SIDES, WALL_STYLES};
use crate::scene::key::WhenAbsent::{Required, Value, Words};
use crate::scene::key::{Bound, Kind, Section, key, only_3d, words};

const SIDE: Kind = Kind::OneOf(&[Kind::Word(&words(&CONTACTS)), Kind::Table(&CONTACT)]);

pub(crate) static DOMAIN: Section = Section {
    name: "domain",
    header: "[domain]",
    keys: &[&[
        key(
            "min",
            Kind::Vector,
            "m",
            Required,
            "Lower corner; nodes are counted from it.",
        ),
        key(
            "max",
            Kind::Vector,
            "m",
            Required,
            "Upper corner; each side must be a whole number of `dx`.",
        ),
        key(
            "walls",
            Kind::OneOf(&[Kind::Word(&words(&SIDES)), Kind::Table(&WALLS)]),
            "",
            Value("\"separate\""),
            "A contact for all sides, or a table by side.",
        ),
        key(
            "clamp",
            Kind::Table(&BOX),
            "",
            Words("none"),
            "A box like that of a shape; particles that leave it are put back on its sides, their velocities stay.",
        ),
        key(
            "cushion",
            Kind::Table(&CUSHION),
            "",
            Words("none"),
            "Slows particles down before they reach the walls.",
        ),
    ]],
};

pub(crate) static CUSHION: Section = Section {
    name: "cushion",
    header: "cushion = { .. } in [domain]",
    keys: &[&[
        key(
            "min",
            Kind::Vector,
            "m",
            Required,
            "Lower corner of the box that particles slow down to stay in.",
        ),
        key("max", Kind::Vector, "m", Required, "Upper corner."),
        key(
            "time",
            Kind::Number(Bound::Positive),
            "s",
            Required,
            "How far ahead it looks: at the end of a substep no velocity is left that would carry its particle out within this time.",
        ),
    ]],
};

pub(crate) static WALLS: Section = Section {
    name: "walls",
    header: "walls = { .. } in [domain]",
    keys: &[&[
        key(
            "contact",
            SIDE,
            "",
            Value("\"separate\""),
            "Contact of the sides that are not named.",
        ),
        key(
            "left",
            SIDE,
            "",
            Words("`contact`"),
            "Side at the lowest x.",
        ),
        key(
            "right",
            SIDE,
            "",
            Words("`contact`"),
            "Side at the highest x.",
        ),
        key(
            "bottom",
            SIDE,
            "",
            Words("`contact`"),
            "Side at the lowest y.",
        ),
        key(
            "top",
            SIDE,
            "",
            Words("`contact`"),
            "Side at the highest y.",
        ),
        only_3d(key(
            "back",
            SIDE,
            "",
            Words("`contact`"),
            "Side at the lowest z.",
        )),
        only_3d(key(
            "front",
            SIDE,
            "",
            Words("`contact`"),
            "Side at the highest z.",
        )),
        key(
            "x",
            Kind::Word(&["periodic"]),
            "",
            Words("walls"),
            "What leaves at one end of the axis comes in at the other.",
        ),
        key(
            "y",
            Kind::Word(&["periodic"]),
            "",
            Words("walls"),
            "The same along y.",
        ),
        only_3d(key(
            "z",
            Kind::Word(&["periodic"]),
            "",
            Words("walls"),
            "The same along z.",
        )),
        key(
            "style",
            Kind::Word(&words(&WALL_STYLES)),
            "",
            Value("\"plane\""),
            "Walls on the domain's planes, or at whole layers of nodes inside it as in the Taichi examples.",
        ),
        key(
            "padding",
            Kind::Integer(1, 64),
            "nodes",
            Words("3, with `style = \"nodes\"` only"),
            "Layers of nodes that a wall takes.",
        ),
    ]],
};

pub(crate) static CONTACT: Section = Section {
    name: "contact",
    header: "{ .. } for a side",
    keys: &[&[
        key(
            "contact",
            Kind::Word(&words(&CONTACTS)),
            "",
            Required,
            "`sticky`: no motion; `slip`: none through the wall or away from it; `separate`: none into it, free to leave; `open`: particles that pass are removed.",
        ),
        key(
            "friction",
            Kind::Number(Bound::NotNegative),
            "",
            Words("0, with `slip` and `separate` only"),
            "Coefficient of Coulomb friction.",
        ),
    ]],
};
