//! Everything between the lahar simulator and the disk: run folders, checkpoints, exports, pictures and films.

pub mod checkpoint;
pub mod export;
pub mod files;
#[doc(hidden)]
pub mod fuzzing;
pub mod image;
pub mod output;
#[cfg(feature = "surface")]
pub mod surface;
