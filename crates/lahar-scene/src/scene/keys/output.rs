//! Keys of the output of a run.

use crate::scene::key::WhenAbsent::{Value, Words};
use crate::scene::key::{Bound, Kind, Section, key};

pub(crate) static OUTPUT: Section = Section {
    name: "output",
    header: "[output]",
    keys: &[&[
        key(
            "formats",
            Kind::Words(&["npz", "vtk", "ply", "bgeo", "png", "gif", "none"]),
            "",
            Value("[\"npz\", \"gif\"]"),
            "Formats of the files of a run: particles per frame (`npz`, `vtk`, `ply`, `bgeo`), a picture per frame (`png`), an animation (`gif`).",
        ),
        key(
            "fields",
            Kind::Fields,
            "",
            Words("all that one of the materials stores"),
            "Particle fields in files. By default, `deformation_gradient` is left out if all materials store J only (fluids, dust), and `plastic_J` if no material yields.",
        ),
        key(
            "every",
            Kind::Integer(1, 1_000_000_000),
            "frames",
            Value("1"),
            "Number of frames between frames that are written.",
        ),
        key(
            "checkpoint_every",
            Kind::Integer(0, 1_000_000_000),
            "frames",
            Value("0"),
            "Number of frames between checkpoints, from which `lahar resume` continues; 0 for none by frames.",
        ),
        key(
            "checkpoint_minutes",
            Kind::Number(Bound::NotNegative),
            "min",
            Value("5.0"),
            "Time between checkpoints, which are kept at the end of a frame; 0 for none by time.",
        ),
        key(
            "picture_size",
            Kind::Size,
            "pixels",
            Value("[960, 540]"),
            "Width and height of pictures.",
        ),
    ]],
};
