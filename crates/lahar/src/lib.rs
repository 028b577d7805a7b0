//! MLS-MPM.
pub mod math;
