//! Shapes of quantities, and their numbers of entries.

/// The shape of a quantity: one number, a vector or a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Shape {
    /// A single number.
    Scalar,
    /// A vector of D numbers.
    Vector,
    /// D × D numbers, row by row.
    Matrix,
}

impl Shape {
    /// Returns the number of entries in `dimension` dimensions.
    pub const fn len(self, dimension: usize) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector => dimension,
            Self::Matrix => dimension * dimension,
        }
    }
}
