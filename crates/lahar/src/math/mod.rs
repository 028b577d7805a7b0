//! Numbers, vectors and matrices: knows no physics.

pub mod lanes;
pub mod matrix;
pub mod near_one;
pub mod polar;
pub mod real;
mod shape;
mod split;
pub mod svd;
pub mod vector;

pub use lanes::{Lanes, Row};
pub use matrix::Matrix;
pub use polar::{Polar, polar};
pub use real::{Mask, Real, Register, Scalar};
pub use shape::Shape;
pub use svd::{Svd, svd};
pub use vector::Vector;
