//! The error of everything that writes.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// An error about one file or folder that could not be made, written or used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// The problem, and the way out where there is one.
    pub what: String,
    /// True if the command is wrong (a folder that is in use), false if the disk is.
    pub usage: bool,
}

impl OutputError {
    /// Returns a function that turns an I/O error of `path` into this type, for `map_err`.
    pub(crate) fn at(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        move |error| Self {
            path: path.to_owned(),
            what: format!("cannot write: {error}"),
            usage: false,
        }
    }

    /// Returns an error that the user can avoid by another command.
    pub(crate) fn usage(path: &Path, what: impl Into<String>) -> Self {
        Self {
            path: path.to_owned(),
            what: what.into(),
            usage: true,
        }
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.what)
    }
}

impl std::error::Error for OutputError {}
