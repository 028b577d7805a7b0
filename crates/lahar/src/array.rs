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
///
/// ```
/// use lahar::Data;
///
/// let data = Data::F32(vec![0.5, 2.0]);
/// assert_eq!(data.to_f64(), [0.5, 2.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// Reals of single precision.
    F32(Vec<f32>),
    /// Reals of double precision.
    F64(Vec<f64>),
    /// Non-negative whole numbers.
    U32(Vec<u32>),
}

impl Data {
    /// Converts all numbers to `f64`.
    pub fn to_f64(&self) -> Vec<f64> {
        match self {
            Self::F32(v) => v.iter().map(|&x| f64::from(x)).collect(),
            Self::F64(v) => v.clone(),
            Self::U32(v) => v.iter().map(|&x| f64::from(x)).collect(),
        }
    }

    /// Converts all numbers to `f32`, rounded.
    pub fn to_f32(&self) -> Vec<f32> {
        match self {
            Self::F32(v) => v.clone(),
            Self::F64(v) => v.iter().map(|&x| x as f32).collect(),
            Self::U32(v) => v.iter().map(|&x| x as f32).collect(),
        }
    }
}

/// A named array of a [`Checkpoint`](crate::Checkpoint).
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// The name, like "materials.0.position.1" or "drift".
    pub name: String,
    /// The lengths of the axes, the slowest first; empty for a single number.
    pub shape: Vec<usize>,
    /// The numbers, as many as the shape says.
    pub values: Values,
}

/// The numbers of an [`Array`].
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Reals of single precision.
    F32(Vec<f32>),
    /// Reals of double precision.
    F64(Vec<f64>),
    /// Non-negative whole numbers.
    U32(Vec<u32>),
    /// Whole numbers of either sign.
    I32(Vec<i32>),
    /// Large non-negative whole numbers.
    U64(Vec<u64>),
}

impl Values {
    /// Returns how many numbers there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::U64(values) => values.len(),
        }
    }

    /// Returns true if there are no numbers.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(crate) fn f64s(self) -> Option<Vec<f64>> {
        match self {
            Self::F64(values) => Some(values),
            Self::F32(_) | Self::U32(_) | Self::I32(_) | Self::U64(_) => None,
        }
    }

    pub(crate) fn u32s(self) -> Option<Vec<u32>> {
        match self {
            Self::U32(values) => Some(values),
            Self::F32(_) | Self::F64(_) | Self::I32(_) | Self::U64(_) => None,
        }
    }

    pub(crate) fn i32s(self) -> Option<Vec<i32>> {
        match self {
            Self::I32(values) => Some(values),
            Self::F32(_) | Self::F64(_) | Self::U32(_) | Self::U64(_) => None,
        }
    }

    pub(crate) fn u64s(self) -> Option<Vec<u64>> {
        match self {
            Self::U64(values) => Some(values),
            Self::F32(_) | Self::F64(_) | Self::U32(_) | Self::I32(_) => None,
        }
    }
}
