//! Numbers, vectors and matrices: knows no physics.

pub mod lanes;
pub mod matrix;
pub mod real;
pub mod vector;

pub use lanes::{Lanes, Row};
pub use matrix::Matrix;
pub use real::{Mask, Real, Scalar};
pub use vector::Vector;
