//! A lock that lets one process at a time write into a folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;

use super::OutputError;
use super::confined::refuse_link;

/// A lock on a run's folder. The system releases it when the process ends, however it ends.
#[derive(Debug)]
pub(crate) struct Lock {
    _file: File,
}

impl Lock {
    /// Takes the lock at `path`, in the run's folder `run`.
    ///
    /// # Errors
    /// If another run has locked it, or it cannot be made.
    pub(crate) fn take(path: &Path, run: &Path) -> Result<Self, OutputError> {
        refuse_link(path)?;
        let file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .write(true)
            .open(path)
            .map_err(OutputError::at(path))?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => Err(OutputError::usage(
                run,
                "another run is writing into this folder; wait for it, or choose another folder",
            )),
            Err(TryLockError::Error(error)) => Err(OutputError::at(path)(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_at_a_time() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("lock");
        let first = Lock::take(&path, root.path()).unwrap();
        let error = Lock::take(&path, root.path()).unwrap_err();
        assert!(error.usage && error.what.contains("another run"), "{error}");
        drop(first);
        Lock::take(&path, root.path()).unwrap();
    }
}
