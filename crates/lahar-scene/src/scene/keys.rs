//! The one table of keys: the reader checks scenes by it and takes the defaults from it; the JSON
//! schema and the tables of docs/scene-format.md are made from it.

use super::formula::Variables;
use super::key::WhenAbsent::{ByDimension, Required, Value, Words};
use super::key::{Bound, Key, Kind, Section, key, later, only_3d};

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

pub(crate) static SCENE: Section = Section {
    name: "scene",
    header: "at the top of the file",
    keys: &[&[
        key(
            "title",
            Kind::Text,
            "",
            Value("\"\""),
            "What the scene is, for people.",
        ),
        key(
            "dimension",
            Kind::Integer(2, 3),
            "",
            Value("2"),
            "2 or 3; in 2D everything is per metre of depth.",
        ),
        key(
            "duration",
            Kind::Number(Bound::Positive),
            "s",
            Value("1.0"),
            "Simulated time of a run.",
        ),
        key(
            "frame_rate",
            Kind::Number(Bound::Positive),
            "1/s",
            Words("60.0; with `substeps_per_frame`, what that comes to"),
            "Frames (outputs) a simulated second.",
        ),
        key(
            "gravity",
            Kind::Formulas(Variables::PlaceAndTime),
            "m/s²",
            ByDimension("[0.0, -9.81]", "[0.0, -9.81, 0.0]"),
            "Acceleration of everything; may be expressions.",
        ),
        key(
            "dx",
            Kind::Number(Bound::Positive),
            "m",
            Required,
            "Distance between the grid's nodes: the resolution.",
        ),
        key(
            "precision",
            Kind::Word(&["f32", "f64"]),
            "",
            Value("\"f32\""),
            "Numbers of 32 or of 64 bits.",
        ),
        key(
            "kernel",
            Kind::Word(&["quadratic", "cubic", "linear"]),
            "",
            Value("\"quadratic\""),
            "Weight function between particles and nodes; `linear` needs `force = \"classic\"`.",
        ),
        key(
            "transfer",
            Kind::Word(&["apic", "pic", "flip"]),
            "",
            Value("\"apic\""),
            "What particles and grid exchange.",
        ),
        key(
            "flip_blend",
            Kind::Number(Bound::Part),
            "",
            Words("0.99, with `transfer = \"flip\"` only"),
            "Part of FLIP in the particle's velocity, the rest is PIC.",
        ),
        key(
            "force",
            Kind::Word(&["mls", "classic"]),
            "",
            Value("\"mls\""),
            "Force by moving least squares, or by the gradients of the weights as in the original MPM.",
        ),
        key(
            "cfl",
            Kind::Number(Bound::Part),
            "",
            Value("0.4"),
            "Part of a cell that sound or a particle may cross in a substep, when the time step is automatic.",
        ),
        key(
            "dt",
            Kind::OneOf(&[Kind::Number(Bound::Positive), Kind::Word(&["auto"])]),
            "s",
            Value("\"auto\""),
            "Length of every substep; `\"auto\"` finds it from the state.",
        ),
        key(
            "dt_max",
            Kind::Number(Bound::Positive),
            "s",
            Words("no limit"),
            "Longest substep when the time step is automatic.",
        ),
        key(
            "substeps_per_frame",
            Kind::Integer(1, 1_000_000),
            "",
            Words("as many as fill the frame"),
            "With a fixed `dt`: a frame is this many substeps, whatever the clock says.",
        ),
        key(
            "seed",
            Kind::Integer(0, i64::MAX),
            "",
            Value("0"),
            "Of everything random; the same seed gives the same particles.",
        ),
        key(
            "domain",
            Kind::Table(&DOMAIN),
            "",
            Words("unbounded"),
            "The box that holds the scene.",
        ),
        key(
            "materials",
            Kind::Materials,
            "",
            Required,
            "What bodies are made of, by name: `[materials.NAME]`.",
        ),
        key(
            "bodies",
            Kind::Tables(&BODY),
            "",
            Required,
            "What is there at the start: one `[[bodies]]` each.",
        ),
        key(
            "camera",
            Kind::Table(&CAMERA),
            "",
            Value("{}"),
            "How the window and pictures look at the scene.",
        ),
        key(
            "controls",
            Kind::Table(&CONTROLS),
            "",
            Value("{}"),
            "What keys and mouse do in the window.",
        ),
        key(
            "output",
            Kind::Table(&OUTPUT),
            "",
            Value("{}"),
            "What a run writes.",
        ),
        key(
            "colliders",
            Kind::Tables(&COLLIDER),
            "",
            Words("none"),
            "What material cannot enter, standing or moving: one `[[colliders]]` each.",
        ),
        key(
            "forces",
            Kind::Tables(&FORCE),
            "",
            Words("none"),
            "What acts on everything besides gravity: one `[[forces]]` each.",
        ),
        key(
            "probes",
            Kind::Tables(&PROBE),
            "",
            Words("none"),
            "What is measured on the way: one `[[probes]]` each.",
        ),
        later("emitters"),
        later("drains"),
    ]],
};

const CONTACTS: &[&str] = &["sticky", "slip", "separate", "open"];
const CONTACTS_OR_PERIODIC: &[&str] = &["sticky", "slip", "separate", "open", "periodic"];
const SIDE: Kind = Kind::OneOf(&[Kind::Word(CONTACTS), Kind::Table(&CONTACT)]);

pub(crate) static DOMAIN: Section = Section {
    name: "domain",
    header: "[domain]",
    keys: &[&[
        key(
            "min",
            Kind::Vector,
            "m",
            Required,
            "Lower corner; nodes are counted from it.",
        ),
        key(
            "max",
            Kind::Vector,
            "m",
            Required,
            "Upper corner; each side must be a whole number of `dx`.",
        ),
        key(
            "walls",
            Kind::OneOf(&[Kind::Word(CONTACTS_OR_PERIODIC), Kind::Table(&WALLS)]),
            "",
            Value("\"separate\""),
            "A contact for all sides, or a table by side.",
        ),
        key(
            "clamp",
            Kind::Table(&BOX),
            "",
            Words("none"),
            "A box like that of a shape; particles that leave it are put back on its sides, their velocities stay.",
        ),
        key(
            "cushion",
            Kind::Table(&CUSHION),
            "",
            Words("none"),
            "Slows particles down before they reach the walls.",
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
            "Lower corner of the box that particles slow down to stay in.",
        ),
        key("max", Kind::Vector, "m", Required, "Upper corner."),
        key(
            "time",
            Kind::Number(Bound::Positive),
            "s",
            Required,
            "How far ahead it looks: at the end of a substep no velocity is left that would carry its particle out within this time.",
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
            "Contact of the sides that are not named.",
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
            "What leaves at one end of the axis comes in at the other.",
        ),
        key(
            "y",
            Kind::Word(&["periodic"]),
            "",
            Words("walls"),
            "The same along y.",
        ),
        only_3d(key(
            "z",
            Kind::Word(&["periodic"]),
            "",
            Words("walls"),
            "The same along z.",
        )),
        key(
            "style",
            Kind::Word(&["plane", "nodes"]),
            "",
            Value("\"plane\""),
            "Walls on the domain's planes, or at whole layers of nodes inside it as in the Taichi examples.",
        ),
        key(
            "padding",
            Kind::Integer(1, 64),
            "nodes",
            Words("3, with `style = \"nodes\"` only"),
            "Layers of nodes that a wall takes.",
        ),
    ]],
};

pub(crate) static CONTACT: Section = Section {
    name: "contact",
    header: "{ .. } for a side",
    keys: &[&[
        key(
            "contact",
            Kind::Word(CONTACTS),
            "",
            Required,
            "`sticky`: no motion; `slip`: none through the wall or away from it; `separate`: none into it, free to leave; `open`: particles that pass are removed.",
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
            Kind::Word(&["lattice", "jittered", "random", "poisson"]),
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
            Kind::OneOf(&[
                Kind::Number(Bound::Positive),
                Kind::Word(&["even", "alike", "measured"]),
            ]),
            "m³",
            Words("`\"even\"` for fluids whose particles are not on a lattice, else `\"alike\"`"),
            "Rest volume of the whole body, shared by its particles alike. `\"alike\"`: the shape's; `\"even\"`: the shape's, with less for particles that stand close, so that the grid is evenly filled; `\"measured\"`: masses as without this key, and each particle's rest volume is the room that it has on the grid at the start.",
        ),
        key(
            "pressure",
            Kind::Word(&["auto", "none", "hydrostatic"]),
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
            Kind::Word(&["y", "z"]),
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

pub(crate) static COLLIDER: Section = Section {
    name: "collider",
    header: "[[colliders]]",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Words("\"collider-N\", N its number from 0"),
            "Name, for outputs and `--set colliders.NAME.velocity=..`.",
        ),
        key(
            "shape",
            Kind::Table(&SHAPE),
            "",
            Required,
            "The space it takes, as for bodies: boxes, balls, half-spaces, polygons, cylinders, capsules and unions of them, scaled (balls, cylinders and capsules by one number), turned, moved and repeated.",
        ),
        key(
            "contact",
            Kind::Word(&["sticky", "slip", "separate"]),
            "",
            Value("\"separate\""),
            "`sticky`: material moves with it; `slip`: none through its surface or away from it; `separate`: none into it, free to leave.",
        ),
        key(
            "friction",
            Kind::Number(Bound::NotNegative),
            "",
            Words("0, with `slip` and `separate` only"),
            "Coefficient of Coulomb friction.",
        ),
        key(
            "center",
            Kind::Vector,
            "m",
            Words("the middle of its shape; a half-space's point"),
            "The point that it turns about, that keyframes place, and that its torque is about.",
        ),
        key(
            "velocity",
            Kind::Vector,
            "m/s",
            Words("0"),
            "Velocity of its center, always on.",
        ),
        key(
            "spin",
            Kind::Rotation,
            "rad/s",
            Words("0"),
            "Rotation about its center, counter-clockwise.",
        ),
        key(
            "keyframes",
            Kind::Tables(&KEYFRAME),
            "",
            Words("none"),
            "Where it is when, instead of `velocity` and `spin`: it goes from one to the next at constant speeds, and stays before the first and after the last.",
        ),
        key(
            "color",
            Kind::Color,
            "",
            Words("grey"),
            "Its colour in windows and pictures.",
        ),
    ]],
};

pub(crate) static KEYFRAME: Section = Section {
    name: "keyframe",
    header: "keyframes = [{ .. }, ..] in [[colliders]]",
    keys: &[&[
        key(
            "time",
            Kind::Number(Bound::Any),
            "s",
            Required,
            "When; later than the keyframe before.",
        ),
        key(
            "position",
            Kind::Vector,
            "m",
            Words("the collider's `center`"),
            "Where the center is.",
        ),
        key(
            "rotate",
            Kind::Rotation,
            "degrees",
            ByDimension("0.0", "[0.0, 0.0, 0.0]"),
            "How far it has turned, counter-clockwise; in 3D about the direction of this vector, by its length.",
        ),
    ]],
};

pub(crate) static FORCE: Section = Section {
    name: "force",
    header: "[[forces]]: exactly one besides the name",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Words("its number from 0"),
            "Name, for `--set forces.NAME.acceleration=..`.",
        ),
        key(
            "acceleration",
            Kind::Formulas(Variables::PlaceAndTime),
            "m/s²",
            Words("–"),
            "An acceleration, numbers or expressions.",
        ),
        key(
            "central",
            Kind::Table(&CENTRAL),
            "",
            Words("–"),
            "An acceleration towards a point.",
        ),
        key(
            "vortex",
            Kind::Table(&VORTEX),
            "",
            Words("–"),
            "An acceleration around a point, in 3D around an axis.",
        ),
        key(
            "drag",
            Kind::Table(&DRAG),
            "",
            Words("–"),
            "Resistance of air or another medium.",
        ),
        key(
            "damping",
            Kind::Number(Bound::NotNegative),
            "1/s",
            Words("–"),
            "Drag of a medium at rest: velocities decay at this rate.",
        ),
    ]],
};

const CENTER: Key = key("center", Kind::Vector, "m", Required, "The point.");
const ACCELERATION: Key = key(
    "acceleration",
    Kind::Number(Bound::Any),
    "m/s²",
    Required,
    "A: its size at `distance`; negative turns it round.",
);
const DISTANCE: Key = key(
    "distance",
    Kind::Number(Bound::Positive),
    "m",
    Value("1.0"),
    "d: the distance at which it has that size.",
);
const SOFTENING: Key = key(
    "softening",
    Kind::Number(Bound::Positive),
    "m",
    Words("`dx`"),
    "ε: below it the distance hardly counts.",
);

pub(crate) static CENTRAL: Section = Section {
    name: "central",
    header: "central = { .. }: A (d/s)ⁿ r/s with s = √(r² + ε²)",
    keys: &[&[
        CENTER,
        ACCELERATION,
        DISTANCE,
        key(
            "power",
            Kind::Number(Bound::Any),
            "",
            Value("2.0"),
            "n: 2 as of a planet, 0 the same everywhere, -1 a spring.",
        ),
        SOFTENING,
    ]],
};

pub(crate) static VORTEX: Section = Section {
    name: "vortex",
    header: "vortex = { .. }: the same, turned counter-clockwise by a right angle",
    keys: &[&[
        CENTER,
        only_3d(key(
            "axis",
            Kind::Vector,
            "",
            Value("[0.0, 1.0, 0.0]"),
            "Direction of the axis, of any length.",
        )),
        ACCELERATION,
        DISTANCE,
        key(
            "power",
            Kind::Number(Bound::Any),
            "",
            Value("1.0"),
            "n: how fast it falls with the distance.",
        ),
        SOFTENING,
    ]],
};

pub(crate) static DRAG: Section = Section {
    name: "drag",
    header: "drag = { .. }: -rate (v - velocity)",
    keys: &[&[
        key(
            "rate",
            Kind::Number(Bound::NotNegative),
            "1/s",
            Required,
            "How fast the difference to the medium's velocity decays.",
        ),
        key(
            "velocity",
            Kind::Vector,
            "m/s",
            ByDimension("[0.0, 0.0]", "[0.0, 0.0, 0.0]"),
            "Velocity of the medium: wind, a current.",
        ),
    ]],
};

pub(crate) static PROBE: Section = Section {
    name: "probe",
    header: "[[probes]]: exactly one besides name and rate",
    keys: &[&[
        key(
            "name",
            Kind::Text,
            "",
            Required,
            "Name of its file, probes/NAME.csv: letters, digits, - and _.",
        ),
        key(
            "rate",
            Kind::Number(Bound::Positive),
            "1/s",
            Words("`frame_rate`"),
            "How often it is read: at the end of the first substep at or after each moment.",
        ),
        key(
            "pressure",
            Kind::Table(&PRESSURE),
            "",
            Words("–"),
            "Pressure at a point, or its mean over a plate.",
        ),
        key(
            "velocity",
            Kind::Table(&VELOCITY_PROBE),
            "",
            Words("–"),
            "Velocity at a point.",
        ),
        key(
            "height",
            Kind::Table(&HEIGHT),
            "",
            Words("–"),
            "Where the surface is.",
        ),
        key(
            "front",
            Kind::Table(&FRONT),
            "",
            Words("–"),
            "How far the material has come along an axis.",
        ),
        key(
            "force",
            Kind::Table(&FORCE_PROBE),
            "",
            Words("–"),
            "Mean force of the material on a wall between readings.",
        ),
    ]],
};

pub(crate) static PRESSURE: Section = Section {
    name: "pressure",
    header: "pressure = { .. } in [[probes]]",
    keys: &[&[
        key(
            "at",
            Kind::Vector,
            "m",
            Required,
            "The point, on a wall or inside; the middle of the plate.",
        ),
        key(
            "radius",
            Kind::Number(Bound::Positive),
            "m",
            Words("2 `dx`"),
            "How far away particles count.",
        ),
        key(
            "normal",
            Kind::Vector,
            "",
            Words("a point, no plate"),
            "Direction across the plate, of any length.",
        ),
        key(
            "width",
            Kind::Number(Bound::Positive),
            "m",
            Words("a point, no plate"),
            "Length of the plate in 2D, diameter of the disc in 3D.",
        ),
    ]],
};

pub(crate) static VELOCITY_PROBE: Section = Section {
    name: "velocity at a point",
    header: "velocity = { .. } in [[probes]]",
    keys: &[&[
        key("at", Kind::Vector, "m", Required, "The point."),
        key(
            "radius",
            Kind::Number(Bound::Positive),
            "m",
            Words("2 `dx`"),
            "How far away particles count.",
        ),
    ]],
};

const AXIS: Kind = Kind::Word(&["x", "y", "z"]);
const UP: Key = key("up", AXIS, "", Value("\"y\""), "The axis that points up.");

pub(crate) static HEIGHT: Section = Section {
    name: "height",
    header: "height = { .. } in [[probes]]",
    keys: &[&[
        key(
            "at",
            Kind::Vector,
            "m",
            Words("the mean over the domain: filled volume over area"),
            "Any point of the column.",
        ),
        UP,
    ]],
};

pub(crate) static FRONT: Section = Section {
    name: "front",
    header: "front = { .. } in [[probes]]",
    keys: &[&[
        key("along", AXIS, "", Value("\"x\""), "The axis it runs along."),
        key(
            "towards",
            Kind::Word(&["high", "low"]),
            "",
            Value("\"high\""),
            "Towards which end of it.",
        ),
        key(
            "depth",
            Kind::Number(Bound::Positive),
            "m",
            Required,
            "The last column of one cell that is deeper counts.",
        ),
        UP,
    ]],
};

pub(crate) static FORCE_PROBE: Section = Section {
    name: "force on a wall",
    header: "force = { .. } in [[probes]]",
    keys: &[&[key(
        "on",
        Kind::Text,
        "",
        Required,
        "A wall of the domain: `left`, `right`, `bottom`, `top`, `back` or `front`; or a collider by its name.",
    )]],
};

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
            Kind::Word(&super::view::ColorBy::WORDS),
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
