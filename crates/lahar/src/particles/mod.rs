//! Particles: the one table of their fields, storage, and snapshots for everything outside.

pub use crate::array::Data;

mod chunk;
mod sort;
mod store;

pub(crate) use chunk::{AHEAD, CHUNK, Chunk, Largest, Padded, Rows, close_chunk, open_chunk, pad};
pub(crate) use sort::{DRIFT_LIMIT, Escaped, Sorter, in_range};
pub(crate) use store::{
    BLOCK_LIMIT, ColumnsMut, Group, Layout, MOST_COLUMNS, PerParticle, Run, block_edge, locate,
    slices, split_runs,
};

/// What a particle has, as exports, checkpoints and plots name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Field {
    /// Number that stays with a particle for life.
    Id,
    /// Body it belongs to.
    Body,
    /// Material it is made of.
    Material,
    /// Where it is.
    Position,
    /// Its velocity.
    Velocity,
    /// C, the velocity gradient that APIC carries: `[i][j]` = ∂v_i/∂x_j.
    Affine,
    /// J = V/V⁰.
    Jacobian,
    /// F; of the elastic part for plastic models.
    DeformationGradient,
    /// J_P of plastic models; 1 for others.
    PlasticJacobian,
    /// −tr σ/d of the Cauchy stress.
    Pressure,
    /// Its mass.
    Mass,
    /// Its volume at rest V⁰.
    Volume0,
}

/// How many numbers a field has a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One.
    Scalar,
    /// D.
    Vector,
    /// D × D, row by row.
    Matrix,
}

impl Shape {
    /// Numbers a particle, in `dimension` dimensions.
    pub fn len(self, dimension: usize) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector => dimension,
            Self::Matrix => dimension * dimension,
        }
    }
    /// Never: a field has at least one number.
    pub fn is_empty(self) -> bool {
        false
    }
}

/// One line of the table of fields.
#[derive(Clone, Copy, Debug)]
pub struct FieldInfo {
    /// Which field.
    pub field: Field,
    /// Its name in files.
    pub name: &'static str,
    /// Its shape.
    pub shape: Shape,
    /// Its unit in 3D.
    pub unit: &'static str,
}

macro_rules! fields {
    ($($field:ident $name:literal $shape:ident $unit:literal;)*) => {
        /// Every field, in the order of files.
        pub const FIELDS: &[FieldInfo] = &[$(FieldInfo { field: Field::$field, name: $name, shape: Shape::$shape, unit: $unit }),*];
    };
}

fields! {
    Position "position" Vector "m";
    Velocity "velocity" Vector "m/s";
    Affine "affine" Matrix "1/s";
    Jacobian "J" Scalar "1";
    DeformationGradient "deformation_gradient" Matrix "1";
    PlasticJacobian "plastic_J" Scalar "1";
    Pressure "pressure" Scalar "Pa";
    Mass "mass" Scalar "kg";
    Volume0 "volume0" Scalar "m^3";
    Material "material" Scalar "";
    Body "body" Scalar "";
    Id "id" Scalar "";
}

impl Field {
    /// Its line in [`FIELDS`].
    pub fn info(self) -> &'static FieldInfo {
        FIELDS
            .iter()
            .find(|info| info.field == self)
            .expect("every field is in the table")
    }
}

/// A copy of chosen fields at one moment, rows by ascending id.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Simulated time \[s\].
    pub time: f64,
    /// 2 or 3.
    pub dimension: usize,
    /// Rows.
    pub count: usize,
    /// The fields asked for, in that order. Positions are `f64` always; what else is real has the
    /// simulation's precision.
    pub columns: Vec<(Field, Data)>,
}

impl Snapshot {
    /// The numbers of `field`, if it was asked for and any particle has it.
    pub fn get(&self, field: Field) -> Option<&Data> {
        self.columns
            .iter()
            .find(|(f, _)| *f == field)
            .map(|(_, data)| data)
    }
}
