//! The one table of the fields of particles, and snapshots of them.

use crate::array::Data;
use crate::material::{DEFORMATION_GRADIENT, Model, SHOWN_VARIABLES, Variable};
use crate::math::Shape;

/// A field of particles, as exports, checkpoints and plots name it. [`FIELDS`] has names, shapes and units.
///
/// ```
/// use lahar::Field;
///
/// let info = Field::Pressure.info();
/// assert_eq!((info.name, info.unit), ("pressure", "Pa"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Field {
    /// Number that stays with a particle for life.
    Id,
    /// Number of the body that it belongs to.
    Body,
    /// Index of its material.
    Material,
    /// Position in the world.
    Position,
    /// Velocity of the particle.
    Velocity,
    /// C, the velocity gradient that APIC carries: `[i][j]` = ∂v_i/∂x_j.
    Affine,
    /// Jacobian J = V/V⁰.
    Jacobian,
    /// Deformation gradient F; the elastic part for plastic models.
    DeformationGradient,
    /// An internal variable of a model, besides J and F; at rest for materials that do not have it.
    Variable(&'static Variable),
    /// Pressure −tr σ/d, with σ the Cauchy stress.
    Pressure,
    /// Mass of the particle.
    Mass,
    /// Volume at rest V⁰.
    Volume0,
}

/// One line of the table [`FIELDS`].
#[derive(Clone, Copy, Debug)]
pub struct FieldInfo {
    /// The field that the line is about.
    pub field: Field,
    /// The name in files.
    pub name: &'static str,
    /// The shape in memory and files.
    pub shape: Shape,
    /// The unit in 3D.
    pub unit: &'static str,
}

/// The fields that all particles have, in the order of files.
const COMMON: [FieldInfo; 11] = {
    const fn field(
        field: Field,
        name: &'static str,
        shape: Shape,
        unit: &'static str,
    ) -> FieldInfo {
        FieldInfo {
            field,
            name,
            shape,
            unit,
        }
    }
    [
        field(Field::Position, "position", Shape::Vector, "m"),
        field(Field::Velocity, "velocity", Shape::Vector, "m/s"),
        field(Field::Affine, "affine", Shape::Matrix, "1/s"),
        field(Field::Jacobian, "J", Shape::Scalar, "1"),
        field(
            Field::DeformationGradient,
            "deformation_gradient",
            Shape::Matrix,
            "1",
        ),
        field(Field::Pressure, "pressure", Shape::Scalar, "Pa"),
        field(Field::Mass, "mass", Shape::Scalar, "kg"),
        field(Field::Volume0, "volume0", Shape::Scalar, "m^3"),
        field(Field::Material, "material", Shape::Scalar, ""),
        field(Field::Body, "body", Shape::Scalar, ""),
        field(Field::Id, "id", Shape::Scalar, ""),
    ]
};

/// The number of common fields that stand before the internal variables.
const BEFORE_VARIABLES: usize = 5;

/// Every field, in the order of files. The internal variables of the built-in models are among them.
pub const FIELDS: &[FieldInfo] = &{
    let mut all = [COMMON[0]; COMMON.len() + SHOWN_VARIABLES.len()];
    let mut i = 0;
    while i < all.len() {
        all[i] = if i < BEFORE_VARIABLES {
            COMMON[i]
        } else if i < BEFORE_VARIABLES + SHOWN_VARIABLES.len() {
            Field::of_variable(&SHOWN_VARIABLES[i - BEFORE_VARIABLES])
        } else {
            COMMON[i - SHOWN_VARIABLES.len()]
        };
        i += 1;
    }
    all
};

impl Field {
    /// Returns the name, the shape and the unit of the field.
    pub fn info(self) -> FieldInfo {
        match self {
            Self::Variable(variable) => Self::of_variable(variable),
            field => *COMMON
                .iter()
                .find(|info| info.field == field)
                .expect("all other fields are common"),
        }
    }

    const fn of_variable(variable: &'static Variable) -> FieldInfo {
        FieldInfo {
            field: Self::Variable(variable),
            name: variable.name,
            shape: variable.shape,
            unit: variable.unit,
        }
    }

    /// Returns true if particles of `model` store this field. A model that stores only J has
    /// F = J^(1/D) I, and a variable that a model does not have is at rest.
    pub fn is_stored_by(self, model: &Model) -> bool {
        match self {
            Self::DeformationGradient => model.variables().contains(&DEFORMATION_GRADIENT),
            Self::Variable(variable) => model.variables().contains(variable),
            Self::Id
            | Self::Body
            | Self::Material
            | Self::Position
            | Self::Velocity
            | Self::Affine
            | Self::Jacobian
            | Self::Pressure
            | Self::Mass
            | Self::Volume0 => true,
        }
    }
}

/// A copy of chosen fields at one moment, by ascending id; made by
/// [`Simulate::snapshot`](crate::Simulate::snapshot).
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Simulated time \[s\].
    pub time: f64,
    /// The number of dimensions, 2 or 3.
    pub dimension: usize,
    /// The number of particles.
    pub count: usize,
    /// The fields that were asked for, in that order. Positions are always `f64`; other reals have the simulation's
    /// precision.
    pub columns: Vec<(Field, Data)>,
}

impl Snapshot {
    /// Returns the numbers of `field`, if it was asked for.
    pub fn get(&self, field: Field) -> Option<&Data> {
        self.columns
            .iter()
            .find(|(f, _)| *f == field)
            .map(|(_, data)| data)
    }
}
