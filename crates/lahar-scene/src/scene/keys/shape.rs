//! Keys of shapes.

use crate::scene::choices::UP_AXES;
use crate::scene::key::WhenAbsent::{Required, Value, Words};
use crate::scene::key::{Bound, Key, Kind, Section, key, words};

pub(crate) static SHAPE: Section = Section {
    name: "shape",
    header: "shape = { .. } in [[bodies]]: exactly one of the first ten, and what is done to it",
    keys: &[&[
        key(
            "box",
            Kind::Table(&BOX),
            "",
            Words("–"),
            "A box along the axes.",
        ),
        key(
            "ball",
            Kind::Table(&BALL),
            "",
            Words("–"),
            "A ball; in 2D a disc.",
        ),
        key(
            "half_space",
            Kind::Table(&HALF_SPACE),
            "",
            Words("–"),
            "All on one side of a plane (in 2D: of a line); needs a domain.",
        ),
        key(
            "polygon",
            Kind::Table(&POLYGON),
            "",
            Words("–"),
            "A polygon, in 2D only.",
        ),
        key(
            "cylinder",
            Kind::Table(&ROD),
            "",
            Words("–"),
            "A rod with flat ends, in 3D only.",
        ),
        key(
            "capsule",
            Kind::Table(&ROD),
            "",
            Words("–"),
            "A rod with round ends; in 2D a strip.",
        ),
        key(
            "mesh",
            Kind::OneOf(&[Kind::Text, Kind::Table(&MESH)]),
            "",
            Words("–"),
            "The inside of a closed mesh of triangles, in 3D only: the name of an .stl or .obj file, or a table.",
        ),
        key(
            "union",
            Kind::Tables(&SHAPE),
            "",
            Words("–"),
            "All that is in any of these shapes.",
        ),
        key(
            "difference",
            Kind::Tables(&SHAPE),
            "",
            Words("–"),
            "All that is in the first shape and in none of the others.",
        ),
        key(
            "intersection",
            Kind::Tables(&SHAPE),
            "",
            Words("–"),
            "All that is in every one of these shapes.",
        ),
        key(
            "scale",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Vector]),
            "",
            Words("1"),
            "Makes the shape larger, by one factor or one for each axis.",
        ),
        key(
            "rotate",
            Kind::Rotation,
            "°",
            Words("0"),
            "Then turns it counter-clockwise; in 3D about this axis, by as many degrees as it is long.",
        ),
        key(
            "about",
            Kind::Vector,
            "m",
            Words("the middle of the shape's bounds"),
            "The point that `scale` and `rotate` leave where it is.",
        ),
        key("translate", Kind::Vector, "m", Words("0"), "Then moves it."),
        key(
            "copies",
            Kind::Table(&COPIES),
            "",
            Words("none"),
            "Then repeats it.",
        ),
    ]],
};

pub(crate) static BOX: Section = Section {
    name: "box",
    header: "box = { .. }",
    keys: &[&[
        key("min", Kind::Vector, "m", Required, "Lower corner."),
        key("max", Kind::Vector, "m", Required, "Upper corner."),
    ]],
};

pub(crate) static BALL: Section = Section {
    name: "ball",
    header: "ball = { .. }",
    keys: &[&[
        key("center", Kind::Vector, "m", Required, "Its centre."),
        key(
            "radius",
            Kind::Number(Bound::Positive),
            "m",
            Required,
            "Its radius.",
        ),
    ]],
};

pub(crate) static HALF_SPACE: Section = Section {
    name: "half_space",
    header: "half_space = { .. }",
    keys: &[&[
        key(
            "point",
            Kind::Vector,
            "m",
            Required,
            "A point on the plane.",
        ),
        key(
            "normal",
            Kind::Vector,
            "",
            Required,
            "Direction out of the body, of any length.",
        ),
    ]],
};

pub(crate) static POLYGON: Section = Section {
    name: "polygon",
    header: "polygon = { .. }",
    keys: &[&[key(
        "points",
        Kind::Points,
        "m",
        Required,
        "Its corners in order, either way round; at least 3, sides must not cross.",
    )]],
};

const FROM: Key = key(
    "from",
    Kind::Vector,
    "m",
    Required,
    "The middle of one end.",
);

const TO: Key = key(
    "to",
    Kind::Vector,
    "m",
    Required,
    "The middle of the other.",
);

const RADIUS: Key = key(
    "radius",
    Kind::Number(Bound::Positive),
    "m",
    Required,
    "Distance of the surface from the line between them.",
);

pub(crate) static ROD: Section = Section {
    name: "rod",
    header: "cylinder = { .. } and capsule = { .. }",
    keys: &[&[FROM, TO, RADIUS]],
};

pub(crate) static MESH: Section = Section {
    name: "mesh",
    header: "mesh = { .. }",
    keys: &[&[
        key(
            "file",
            Kind::Text,
            "",
            Required,
            "Mesh, .stl (text or binary) or .obj, found from the scene's folder.",
        ),
        key(
            "up",
            Kind::Word(&words(&UP_AXES)),
            "",
            Value("\"y\""),
            "Which axis of the file points up; z is turned to y.",
        ),
        key(
            "size",
            Kind::Number(Bound::Positive),
            "m",
            Words("as in the file, taken as metres"),
            "Longest side of its bounds.",
        ),
        key(
            "center",
            Kind::Vector,
            "m",
            Words("as in the file"),
            "Where the middle of its bounds is put.",
        ),
    ]],
};

pub(crate) static COPIES: Section = Section {
    name: "copies",
    header: "copies = { .. }",
    keys: &[&[
        key(
            "count",
            Kind::Vector,
            "",
            Required,
            "How many along each axis, 1 or more.",
        ),
        key(
            "step",
            Kind::Vector,
            "m",
            Required,
            "From one to the next along each axis.",
        ),
    ]],
};
