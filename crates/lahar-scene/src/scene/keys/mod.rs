//! The one table of keys. The reader checks scenes by it and takes the defaults from it; the JSON schema and
//! the tables of docs/scene-format.md are made from it.

mod body;
mod collider;
mod domain;
mod force;
mod output;
mod probe;
mod scene;
mod shape;
mod window;

use body::BODY;
use collider::{COLLIDER, KEYFRAME};
use domain::{CONTACT, CUSHION, DOMAIN, WALLS};
use force::{CENTRAL, DRAG, FORCE, VORTEX};
use output::OUTPUT;
use probe::{FORCE_PROBE, FRONT, HEIGHT, PRESSURE, PROBE, VELOCITY_PROBE};
pub(crate) use scene::SCENE;
pub(crate) use shape::SHAPE;
use shape::{BALL, BOX, COPIES, HALF_SPACE, MESH, POLYGON, ROD};
use window::{CAMERA, CONTROLS, GRAVITY_KEYS, HAND};

use super::key::Section;

/// The tables that have a name of their own in the documentation, in its order.
pub(crate) fn sections() -> impl Iterator<Item = &'static Section> {
    let before: [&Section; 5] = [&SCENE, &DOMAIN, &WALLS, &CONTACT, &CUSHION];
    let after: [&Section; 26] = [
        &BODY,
        &SHAPE,
        &BOX,
        &BALL,
        &HALF_SPACE,
        &POLYGON,
        &ROD,
        &MESH,
        &COPIES,
        &COLLIDER,
        &KEYFRAME,
        &FORCE,
        &CENTRAL,
        &VORTEX,
        &DRAG,
        &PROBE,
        &PRESSURE,
        &VELOCITY_PROBE,
        &HEIGHT,
        &FRONT,
        &FORCE_PROBE,
        &CAMERA,
        &CONTROLS,
        &GRAVITY_KEYS,
        &HAND,
        &OUTPUT,
    ];
    (before.into_iter())
        .chain(super::material::MODELS.iter().map(|model| model.section))
        .chain(after)
}
