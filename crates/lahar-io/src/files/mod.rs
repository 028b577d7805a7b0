//! Safe access to files: written whole or not at all, below one folder, never through a link.
//!
//! ```text
//! names     a user's name for something  ─►  a file name
//! confined  a path in a run's folder     ─►  the same path, or an error if it leads out of the folder
//! whole     a file written under a temporary name, then renamed
//! growing   a file that is appended to, and can be cut back
//! lock      one process per folder
//! ```
//! Run folders travel between people. A link in one could point at any file of the reader, so this module replaces
//! links to files and refuses links to folders.

mod confined;
mod error;
mod growing;
mod lock;
mod names;
mod whole;

pub use confined::{confined, is_link, make_folder, output_folder};
pub use error::OutputError;
pub(crate) use growing::GrowingFile;
pub use growing::Length;
pub(crate) use lock::Lock;
pub use names::file_name;
pub(crate) use whole::{
    Durability, PARTIAL, remove_file_io, sync_folder, write_whole, write_whole_io,
};
pub use whole::{remove_file, write_file};
