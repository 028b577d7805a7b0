//! What goes in and out of the simulator: scene files, particles to start from, outputs.

pub mod builtin;
pub mod error;
pub mod particle_list;
pub mod sampling;
pub mod scene;
pub mod shape;
