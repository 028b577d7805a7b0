//! Numbers, vectors and matrices. Nothing here knows of physics, or imports from outside of this folder.
//!
//! | file | |
//! |---|---|
//! | `real.rs` | the arithmetic that formulas are written with; scalars |
//! | `lanes.rs` | vector registers of the machine, and rows of nodes in them |
//! | `vector.rs`, `matrix.rs`, `shape.rs` | small vectors and matrices, and their shapes |
//! | `near_one.rs` | functions of 1 + e that keep the digits of e |
//! | `polar.rs`, `svd.rs`, `split.rs` | decompositions of a matrix |

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
