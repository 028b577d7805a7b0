//! Everything between the lahar simulator and the disk: scenes and particles to start from, run folders, pictures.

mod after_error;
pub mod builtin;
pub mod checkpoint;
pub mod driver;
pub mod error;
mod even;
pub mod export;
mod expression;
#[doc(hidden)]
pub mod fuzzing;
pub mod image;
mod mesh_file;
pub mod npz;
pub mod output;
pub mod particle_list;
mod ply;
pub mod sampling;
pub mod scene;
pub mod shape;
#[cfg(feature = "surface")]
pub mod surface;
