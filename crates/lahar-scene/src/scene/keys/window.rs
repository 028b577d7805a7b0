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
            "Point in the middle of the picture.",
        ),
        key(
            "height",
            Kind::Number(Bound::Positive),
            "m",
            Words("all of the domain, or of the bodies"),
            "Height of the scene that the picture shows at its center.",
        ),
        only_3d(key(
            "direction",
            Kind::Vector,
            "",
            Value("[0.5, 0.35, 1.0]"),
            "Direction from the center to the camera; its length does not matter. Up is y.",
        )),
        only_3d(key(
            "field_of_view",
            Kind::Number(Bound::Positive),
            "°",
            Value("35.0"),
            "Angle between the lower and the upper edge of the picture.",
        )),
        key(
            "background",
            Kind::Color,
            "",
            Value("\"#112f41\""),
            "Background color.",
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
            "Quantity that particles are colored by.",
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
            "Largest speed at first, in simulated seconds per second. The keys + and - change it.",
        ),
        key(
            "gravity_keys",
            Kind::Table(&GRAVITY_KEYS),
            "",
            Value("{}"),
            "Effect of the keys W, A, S, D and the arrows on gravity.",
        ),
        key(
            "pointer",
            Kind::Table(&HAND),
            "",
            Value("{}"),
            "Effect of the mouse on the material.",
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
            Words("the size of `gravity`, or 9.81 if there is none"),
            "Size of gravity towards the side of the key.",
        ),
        key(
            "hold",
            Kind::Flag,
            "",
            Value("false"),
            "True: gravity acts while the key is pressed, and ends with it. False: gravity stays.",
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
            "`\"attract\"`: the left button pulls nodes towards the pointer, the right button drives them away. `\"push\"`: the left button \
             pushes particles away, the right button pulls them.",
        ),
        key(
            "strength",
            Kind::Number(Bound::Positive),
            "m/s²",
            Words("10/3 of the size of gravity"),
            "Acceleration towards the pointer or away from it.",
        ),
        key(
            "radius",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&["everywhere"])]),
            "m",
            Words("a quarter of the scene's smallest extent"),
            "Reach of the pointer. `\"everywhere\"`: the same acceleration at any distance.",
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
