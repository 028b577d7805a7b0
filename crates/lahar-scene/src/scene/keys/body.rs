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
            Words("\"body-N\" with its number N, counted from 0"),
            "Name in outputs and in `--set bodies.NAME.velocity=..`.",
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
            "Space that the body fills. Parts outside the domain are cut off.",
        ),
        key(
            "particles",
            Kind::Text,
            "",
            Words("this or `shape`"),
            "Particle list (.csv, .npz or .ply), found from the folder of the scene.",
        ),
        key(
            "velocity",
            Kind::Formulas(Variables::Place),
            "m/s",
            ByDimension("[0.0, 0.0]", "[0.0, 0.0, 0.0]"),
            "Velocity at the start, as numbers or expressions in x, y, z. It is added to that of a particle list.",
        ),
        key(
            "velocity_spread",
            Kind::Vector,
            "m/s",
            Words("none"),
            "Largest random deviation of a particle's velocity along each axis.",
        ),
        key(
            "spin",
            Kind::Rotation,
            "rad/s",
            ByDimension("0.0", "[0.0, 0.0, 0.0]"),
            "Rotation about the center of mass of the body, counter-clockwise.",
        ),
        key(
            "velocity_gradient",
            Kind::Matrix,
            "1/s",
            Words("none"),
            "Rows of ∂v_i/∂x_j, about the center of mass of the body.",
        ),
        key(
            "particles_per_cell",
            Kind::Number(Bound::Positive),
            "",
            Words("4 in 2D, 8 in 3D; unless `spacing` or `count` is given"),
            "Particles per cell of the grid that the body fills.",
        ),
        key(
            "spacing",
            Kind::Number(Bound::Positive),
            "m",
            Words("from `particles_per_cell`"),
            "Distance between particles, in place of `particles_per_cell`.",
        ),
        key(
            "count",
            Kind::Integer(1, 4_294_967_295),
            "",
            Words("from `particles_per_cell`"),
            "Number of particles, in place of `particles_per_cell`; with `random` and `poisson` sampling only.",
        ),
        key(
            "sampling",
            Kind::Word(&words(&SAMPLINGS)),
            "",
            Value("\"jittered\""),
            "Positions of particles. `lattice`: a lattice fitted to the shape. `jittered`: one random point in each cell of that lattice. `random`: random points. `poisson`: random points that keep a distance from each other.",
        ),
        key(
            "particle_volume",
            Kind::Number(Bound::Positive),
            "m³",
            Words("volume of the shape / number of particles, so that the mass is exact"),
            "Rest volume of each particle.",
        ),
        key(
            "volume",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&words(&VOLUMES))]),
            "m³",
            Words("`\"even\"` for fluids whose particles are not on a lattice, else `\"alike\"`"),
            "Rest volume of the body. A number is shared equally by its particles. `\"alike\"`: the volume of the shape, shared equally. `\"even\"`: the volume of the shape, with less for particles that are close together, so that the grid is evenly filled. `\"measured\"`: masses as without this key, and the rest volume of each particle is the volume that it has on the grid at the start.",
        ),
        key(
            "pressure",
            Kind::Word(&words(&START_PRESSURES)),
            "",
            Value("\"auto\""),
            "Pressure of a fluid at the start. `none`: no pressure. `hydrostatic`: the pressure of a body at rest under gravity with its surface at its highest point. `auto`: hydrostatic if the body stands on the floor, does not move and has `volume = \"corrected\"` in its material.",
        ),
        key(
            "color",
            Kind::Color,
            "",
            Words("the material's"),
            "Color of its particles.",
        ),
    ]],
};
