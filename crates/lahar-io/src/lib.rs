//! Everything between the lahar simulator and the disk: particle arrays, run folders, pictures.

pub mod image;
pub mod npz;
pub mod output;
