//! Scenes of the lahar simulator: TOML text, the particles and meshes that it names, and what they build.

#[cfg(feature = "npz")]
mod after_error;
pub mod builtin;
pub mod driver;
pub mod error;
mod even;
mod expression;
#[doc(hidden)]
pub mod fuzzing;
mod mesh_file;
#[cfg(feature = "npz")]
pub mod npz;
mod parallel;
pub mod particle_list;
pub mod ply;
pub mod scene;
mod text;

/// The Rust block of this crate's README, compiled and run by the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
