//! Keys of bodies.

use super::shape::SHAPE;
use crate::scene::choices::{SAMPLINGS, START_PRESSURES, VOLUMES};
use crate::scene::formula::Variables;
use crate::scene::key::WhenAbsent::{ByDimension, Required, Value, Words};
use crate::scene::key::{Bound, Kind, Section, key, words};

pub(crate) static BODY: Section = Section {
    name: "body",
    header: "[[bodies]]",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Words("\"body-N\", N its number from 0"),
            "Name, for outputs and `--set bodies.NAME.velocity=..`.",
        ),
        key(
            "material",
            Kind::Text,
            "",
            Required,
            "Name of one of the materials.",
        ),
        key(
            "shape",
            Kind::Table(&SHAPE),
            "",
            Words("this or `particles`"),
            "The space it fills; what lies outside the domain is cut off.",
        ),
        key(
            "particles",
            Kind::Text,
            "",
            Words("this or `shape`"),
            "Particle list, .csv, .npz or .ply, found from the scene's folder.",
        ),
        key(
            "velocity",
            Kind::Formulas(Variables::Place),
            "m/s",
            ByDimension("[0.0, 0.0]", "[0.0, 0.0, 0.0]"),
            "Velocity at the start, numbers or expressions in x, y, z; added to that of a particle list.",
        ),
        key(
            "velocity_spread",
            Kind::Vector,
            "m/s",
            Words("none"),
            "Each particle's velocity differs by up to this, at random, on each axis.",
        ),
        key(
            "spin",
            Kind::Rotation,
            "rad/s",
            ByDimension("0.0", "[0.0, 0.0, 0.0]"),
            "Rotation about the body's centre of mass, counter-clockwise.",
        ),
        key(
            "velocity_gradient",
            Kind::Matrix,
            "1/s",
            Words("none"),
            "Rows of ∂v_i/∂x_j, about the body's centre of mass.",
        ),
        key(
            "particles_per_cell",
            Kind::Number(Bound::Positive),
            "",
            Words("4 in 2D, 8 in 3D; unless `spacing` or `count` is given"),
            "Particles in a cell of the grid that the body fills.",
        ),
        key(
            "spacing",
            Kind::Number(Bound::Positive),
            "m",
            Words("from `particles_per_cell`"),
            "Distance between particles, instead.",
        ),
        key(
            "count",
            Kind::Integer(1, 4_294_967_295),
            "",
            Words("from `particles_per_cell`"),
            "Number of particles, instead; with `random` and `poisson` sampling only.",
        ),
        key(
            "sampling",
            Kind::Word(&words(&SAMPLINGS)),
            "",
            Value("\"jittered\""),
            "Where particles are: on a lattice fitted to the shape; at random in that lattice's cells; anywhere; anywhere but never close together.",
        ),
        key(
            "particle_volume",
            Kind::Number(Bound::Positive),
            "m³",
            Words("shape's volume / number of particles, so that the mass is exact"),
            "Rest volume of each particle.",
        ),
        key(
            "volume",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&words(&VOLUMES))]),
            "m³",
            Words("`\"even\"` for fluids whose particles are not on a lattice, else `\"alike\"`"),
            "Rest volume of the whole body, shared by its particles alike. `\"alike\"`: the shape's; `\"even\"`: the shape's, with less for particles that stand close, so that the grid is evenly filled; `\"measured\"`: masses as without this key, and each particle's rest volume is the room that it has on the grid at the start.",
        ),
        key(
            "pressure",
            Kind::Word(&words(&START_PRESSURES)),
            "",
            Value("\"auto\""),
            "Pressure at the start, fluids only: none, or that of a body at rest under gravity whose surface is at its highest point; `auto`: that, if it stands on the floor, does not move and its volume is `corrected`.",
        ),
        key(
            "color",
            Kind::Color,
            "",
            Words("the material's"),
            "Colour of its particles.",
        ),
    ]],
};
