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
            "Lower corner. The first node is here.",
        ),
        key(
            "max",
            Kind::Vector,
            "m",
            Required,
            "Upper corner. Each side must be a whole number of `dx` long.",
        ),
        key(
            "walls",
            Kind::OneOf(&[Kind::Word(&words(&SIDES)), Kind::Table(&WALLS)]),
            "",
            Value("\"separate\""),
            "Contact of all sides, or a table by side.",
        ),
        key(
            "clamp",
            Kind::Table(&BOX),
            "",
            Words("none"),
            "A box, written as in a shape. Particles that leave it are put back on its surface and keep their velocities.",
        ),
        key(
            "cushion",
            Kind::Table(&CUSHION),
            "",
            Words("none"),
            "A box that particles slow down to stay in.",
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
            "Lower corner of the box.",
        ),
        key(
            "max",
            Kind::Vector,
            "m",
            Required,
            "Upper corner of the box.",
        ),
        key(
            "time",
            Kind::Number(Bound::Positive),
            "s",
            Required,
            "Time over which particles slow down: at the end of a substep, no particle is fast enough to leave the box within this time.",
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
            "Contact of the sides without a key of their own.",
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
            "Joins the two ends of the axis: material that leaves at one end enters at the other.",
        ),
        key(
            "y",
            Kind::Word(&["periodic"]),
            "",
            Words("walls"),
            "Joins the ends of y.",
        ),
        only_3d(key(
            "z",
            Kind::Word(&["periodic"]),
            "",
            Words("walls"),
            "Joins the ends of z.",
        )),
        key(
            "style",
            Kind::Word(&words(&WALL_STYLES)),
            "",
            Value("\"plane\""),
            "Position of the walls: `plane` for the sides of the domain, `nodes` for whole layers of nodes inside it, as in the Taichi examples.",
        ),
        key(
            "padding",
            Kind::Integer(1, 64),
            "nodes",
            Words("3, with `style = \"nodes\"` only"),
            "Layers of nodes that belong to a wall.",
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
            "`sticky`: no motion at the wall. `slip`: no motion through the wall or away from it. `separate`: no motion into the wall, but material can leave it. `open`: no wall, particles that pass are removed.",
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
