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
            "Files a run writes: particles by frame (`npz`, `vtk`, `ply`, `bgeo`), pictures by frame, an animation.",
        ),
        key(
            "fields",
            Kind::Fields,
            "",
            Words("all that say something of the materials"),
            "Fields in files of particles. `deformation_gradient` goes without saying where all materials remember J only (fluids, dust), `plastic_J` where none yields.",
        ),
        key(
            "every",
            Kind::Integer(1, 1_000_000_000),
            "frames",
            Value("1"),
            "Write every so many frames.",
        ),
        key(
            "checkpoint_every",
            Kind::Integer(0, 1_000_000_000),
            "frames",
            Value("0"),
            "Keep a checkpoint every so many frames, which `lahar resume` goes on from; 0: none by frames.",
        ),
        key(
            "checkpoint_minutes",
            Kind::Number(Bound::NotNegative),
            "min",
            Value("5.0"),
            "Keep a checkpoint at the end of a frame when so much time has passed since the last one; 0: none by time.",
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
