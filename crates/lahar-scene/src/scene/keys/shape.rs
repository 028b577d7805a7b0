//! Keys of shapes.

use crate::scene::choices::UP_AXES;
use crate::scene::key::WhenAbsent::{Required, Value, Words};
use crate::scene::key::{Bound, Key, Kind, Section, key, words};

pub(crate) static SHAPE: Section = Section {
    name: "shape",
    header: "shape = { .. } in [[bodies]]: exactly one of the first ten keys, and changes to it",
    keys: &[&[
        key(
            "box",
            Kind::Table(&BOX),
            "",
            Words("–"),
            "A box with sides along the axes.",
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
            "Everything on one side of a plane (in 2D, of a line). A body of this shape needs a domain.",
        ),
        key(
            "polygon",
            Kind::Table(&POLYGON),
            "",
            Words("–"),
            "A polygon; 2D only.",
        ),
        key(
            "cylinder",
            Kind::Table(&ROD),
            "",
            Words("–"),
            "A rod with flat ends; 3D only.",
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
            "The inside of a closed mesh of triangles: the name of an .stl or .obj file, or a table. 3D only.",
        ),
        key(
            "union",
            Kind::Tables(&SHAPE),
            "",
            Words("–"),
            "The points that are in any of these shapes.",
        ),
        key(
            "difference",
            Kind::Tables(&SHAPE),
            "",
            Words("–"),
            "The points that are in the first shape and in none of the others.",
        ),
        key(
            "intersection",
            Kind::Tables(&SHAPE),
            "",
            Words("–"),
            "The points that are in all of these shapes.",
        ),
        key(
            "scale",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Vector]),
            "",
            Words("1"),
            "Factor by which the shape grows, or one factor per axis.",
        ),
        key(
            "rotate",
            Kind::Rotation,
            "°",
            Words("0"),
            "Counter-clockwise rotation after scaling. In 3D the direction of the vector is the axis, and its length the angle.",
        ),
        key(
            "about",
            Kind::Vector,
            "m",
            Words("the middle of the shape's bounds"),
            "Point that `scale` and `rotate` leave in place.",
        ),
        key(
            "translate",
            Kind::Vector,
            "m",
            Words("0"),
            "Translation after rotation.",
        ),
        key(
            "copies",
            Kind::Table(&COPIES),
            "",
            Words("none"),
            "Copies of the shape in rows along the axes.",
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
        key("center", Kind::Vector, "m", Required, "Center."),
        key(
            "radius",
            Kind::Number(Bound::Positive),
            "m",
            Required,
            "Radius.",
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
            "Direction out of the body; its length does not matter.",
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
        "Corners in order, clockwise or counter-clockwise. At least 3; sides must not cross.",
    )]],
};

const FROM: Key = key("from", Kind::Vector, "m", Required, "Middle of one end.");

const TO: Key = key(
    "to",
    Kind::Vector,
    "m",
    Required,
    "Middle of the other end.",
);

const RADIUS: Key = key(
    "radius",
    Kind::Number(Bound::Positive),
    "m",
    Required,
    "Distance of the surface from the line between `from` and `to`.",
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
            "Mesh file, .stl (text or binary) or .obj, found from the folder of the scene.",
        ),
        key(
            "up",
            Kind::Word(&words(&UP_AXES)),
            "",
            Value("\"y\""),
            "Axis of the file that points up. z is turned to y.",
        ),
        key(
            "size",
            Kind::Number(Bound::Positive),
            "m",
            Words("as in the file, in meters"),
            "Longest side of the bounds of the mesh.",
        ),
        key(
            "center",
            Kind::Vector,
            "m",
            Words("as in the file"),
            "Position of the middle of the bounds.",
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
            "Number of copies along each axis, 1 or more.",
        ),
        key(
            "step",
            Kind::Vector,
            "m",
            Required,
            "Distance between copies along each axis.",
        ),
    ]],
};
