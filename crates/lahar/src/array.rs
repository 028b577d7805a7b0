//! Arrays of numbers of any type, as snapshots and checkpoints hand them out.

use crate::math::Scalar;

/// A scalar that [`Data`] and [`Values`] can hold arrays of.
pub trait Element: Scalar {
    /// Wraps the numbers of a snapshot's field.
    fn data(values: Vec<Self>) -> Data;
    /// Wraps the numbers of a checkpoint's array.
    fn values(values: Vec<Self>) -> Values;
    /// Returns the numbers of a checkpoint's array, or `None` if they are of another type.
    fn from_values(values: Values) -> Option<Vec<Self>>;
}

macro_rules! element {
    ($scalar:ty, $variant:ident) => {
        impl Element for $scalar {
            fn data(values: Vec<Self>) -> Data {
                Data::$variant(values)
            }
            fn values(values: Vec<Self>) -> Values {
                Values::$variant(values)
            }
            fn from_values(values: Values) -> Option<Vec<Self>> {
                match values {
                    Values::$variant(values) => Some(values),
                    _ => None,
                }
            }
        }
    };
}

element!(f32, F32);
element!(f64, F64);

/// The numbers of one field, particle after particle.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
    /// Whole numbers.
    U32(Vec<u32>),
}

impl Data {
    /// As `f64`, whatever they are.
    pub fn to_f64(&self) -> Vec<f64> {
        match self {
            Self::F32(v) => v.iter().map(|&x| f64::from(x)).collect(),
            Self::F64(v) => v.clone(),
            Self::U32(v) => v.iter().map(|&x| f64::from(x)).collect(),
        }
    }
    /// As `f32`, whatever they are.
    pub fn to_f32(&self) -> Vec<f32> {
        match self {
            Self::F32(v) => v.clone(),
            Self::F64(v) => v.iter().map(|&x| x as f32).collect(),
            Self::U32(v) => v.iter().map(|&x| x as f32).collect(),
        }
    }
}

/// An array of a checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// What it is, like "materials.0.position.1" or "drift".
    pub name: String,
    /// Its lengths, the slowest axis first; none for a single number.
    pub shape: Vec<usize>,
    /// Its numbers.
    pub values: Values,
}

/// Numbers of an array.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
    /// Whole numbers.
    U32(Vec<u32>),
    /// Whole numbers of either sign.
    I32(Vec<i32>),
    /// Large whole numbers.
    U64(Vec<u64>),
}

impl Values {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::U64(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(crate) fn f64s(self) -> Option<Vec<f64>> {
        match self {
            Self::F64(values) => Some(values),
            _ => None,
        }
    }

    pub(crate) fn u32s(self) -> Option<Vec<u32>> {
        match self {
            Self::U32(values) => Some(values),
            _ => None,
        }
    }

    pub(crate) fn i32s(self) -> Option<Vec<i32>> {
        match self {
            Self::I32(values) => Some(values),
            _ => None,
        }
    }

    pub(crate) fn u64s(self) -> Option<Vec<u64>> {
        match self {
            Self::U64(values) => Some(values),
            _ => None,
        }
    }
}
