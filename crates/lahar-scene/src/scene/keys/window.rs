//! Keys of the camera and of the controls in the window.

use crate::scene::color_by::ColorBy;
use crate::scene::key::WhenAbsent::{Value, Words};
use crate::scene::key::{Bound, Kind, Section, key, only_3d};

pub(crate) static CAMERA: Section = Section {
    name: "camera",
    header: "[camera]",
    keys: &[&[
        key(
            "center",
            Kind::Vector,
            "m",
            Words("the middle of the domain, or of the bodies"),
            "What it looks at.",
        ),
        key(
            "height",
            Kind::Number(Bound::Positive),
            "m",
            Words("all of the domain, or of the bodies"),
            "Height of the scene that the picture shows, at the centre.",
        ),
        only_3d(key(
            "direction",
            Kind::Vector,
            "",
            Value("[0.5, 0.35, 1.0]"),
            "From the centre to the camera, of any length; up is y.",
        )),
        only_3d(key(
            "field_of_view",
            Kind::Number(Bound::Positive),
            "°",
            Value("35.0"),
            "Angle between the picture's lower and upper edge.",
        )),
        key(
            "background",
            Kind::Color,
            "",
            Value("\"#112f41\""),
            "Colour behind everything.",
        ),
        key(
            "particle_radius",
            Kind::Number(Bound::Positive),
            "m",
            Words("from the spacing of the particles"),
            "Radius of a particle as drawn.",
        ),
        key(
            "color_by",
            Kind::Word(&ColorBy::WORDS),
            "",
            Value("\"material\""),
            "What colours say.",
        ),
    ]],
};

pub(crate) static CONTROLS: Section = Section {
    name: "controls",
    header: "[controls]",
    keys: &[&[
        key(
            "speed",
            Kind::Number(Bound::Positive),
            "",
            Value("1.0"),
            "Simulated seconds a second at first, at most; + and - change it.",
        ),
        key(
            "gravity_keys",
            Kind::Table(&GRAVITY_KEYS),
            "",
            Value("{}"),
            "What W, A, S, D and the arrows do to gravity.",
        ),
        key(
            "pointer",
            Kind::Table(&HAND),
            "",
            Value("{}"),
            "What the mouse does to the material.",
        ),
    ]],
};

pub(crate) static GRAVITY_KEYS: Section = Section {
    name: "gravity_keys",
    header: "gravity_keys = { .. } in [controls]",
    keys: &[&[
        key(
            "strength",
            Kind::Number(Bound::Positive),
            "m/s²",
            Words("that of `gravity`; 9.81 where there is none"),
            "Size of gravity towards the key's side.",
        ),
        key(
            "hold",
            Kind::Flag,
            "",
            Value("false"),
            "Whether it acts while the key is held, and none after; else it stays.",
        ),
    ]],
};

pub(crate) static HAND: Section = Section {
    name: "pointer",
    header: "pointer = { .. } in [controls]",
    keys: &[&[
        key(
            "action",
            Kind::Word(&["attract", "push"]),
            "",
            Value("\"attract\""),
            "`\"attract\"`: the left button pulls nodes to the pointer, the right one away; `\"push\"`: the left button pushes particles \
             away, the right one pulls them.",
        ),
        key(
            "strength",
            Kind::Number(Bound::Positive),
            "m/s²",
            Words("10/3 of the size of gravity"),
            "Acceleration towards the pointer, or away from it.",
        ),
        key(
            "radius",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&["everywhere"])]),
            "m",
            Words("a quarter of the scene's smallest extent"),
            "How far it reaches; `\"everywhere\"`: as hard at any distance.",
        ),
        key(
            "softening",
            Kind::Number(Bound::Positive),
            "m",
            Words("`dx`"),
            "With `\"attract\"`, the acceleration is `strength` d/(d + `softening`) at the distance d.",
        ),
        key(
            "power",
            Kind::Number(Bound::NotNegative),
            "",
            Value("0.0"),
            "With `\"push\"`, the acceleration is `strength` (d/`radius`)^`power`, and none beyond `radius`.",
        ),
    ]],
};
