//! Files that are written whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::OutputError;

/// Ending of the temporary name of a file that is being written.
pub(crate) const PARTIAL: &str = "partial";

/// Bytes that are buffered before they are handed to the system.
const BUFFER: usize = 1 << 18;

/// When a file that was written must be on the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Durability {
    /// When the system chooses.
    Eventual,
    /// Before it takes its name, so that a power cut leaves the old file or the new one.
    Immediate,
}

/// Writes `path` whole or not at all: under a temporary name beside it first, which is then renamed. A link at `path`
/// is replaced; its target is left alone.
///
/// # Errors
/// If the file cannot be written; a file that was there stays as it was.
pub(crate) fn write_whole(
    path: &Path,
    durability: Durability,
    write: impl FnOnce(BufWriter<File>) -> io::Result<BufWriter<File>>,
) -> Result<(), OutputError> {
    write_whole_io(path, durability, write).map_err(OutputError::at(path))
}

/// [`write_whole`] with the system's error.
pub(crate) fn write_whole_io(
    path: &Path,
    durability: Durability,
    write: impl FnOnce(BufWriter<File>) -> io::Result<BufWriter<File>>,
) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(PARTIAL);
    let partial = path.with_file_name(name);
    let result = create_new(&partial)
        .and_then(|file| write(BufWriter::with_capacity(BUFFER, file)))
        .and_then(|writer| writer.into_inner().map_err(io::IntoInnerError::into_error))
        .and_then(|file| match durability {
            Durability::Immediate => file.sync_all(),
            Durability::Eventual => Ok(()),
        })
        .and_then(|()| fs::rename(&partial, path));
    if result.is_err() {
        // A disk that is full should not keep the part that fitted.
        drop(fs::remove_file(&partial));
    }
    result
}

/// Writes `bytes` to the file `path`, whole or not at all. A link at `path` is replaced; its target is left alone.
///
/// # Errors
/// If the file cannot be written; a file that was there stays as it was.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), OutputError> {
    write_whole(path, Durability::Eventual, |mut writer| {
        writer.write_all(bytes.as_ref())?;
        Ok(writer)
    })
}

/// Removes the file or link `path` if there is one; the target of a link stays.
///
/// # Errors
/// If it cannot be removed.
pub fn remove_file(path: &Path) -> Result<(), OutputError> {
    remove_file_io(path).map_err(OutputError::at(path))
}

/// [`remove_file`] with the system's error.
pub(crate) fn remove_file_io(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Opens a new, empty file in place of the file or link `path`.
pub(super) fn create_new(path: &Path) -> io::Result<File> {
    let open = || {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create_new(true).open(path)
    };
    match open() {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            remove_file_io(path)?;
            open()
        }
        result => result,
    }
}

/// Waits until all renames in `folder` are on the disk. Windows has no way to ask for that.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), OutputError> {
    if cfg!(unix) {
        File::open(folder)
            .and_then(|folder| folder.sync_all())
            .map_err(OutputError::at(folder))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_partial_one() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a");
        write_file(&path, "old").unwrap();
        let failed = write_whole(&path, Durability::Immediate, |mut writer| {
            writer.write_all(b"half")?;
            Err(io::Error::other("no space"))
        });
        assert_eq!(failed.unwrap_err().what, "cannot write: no space");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_replaced_and_their_targets_stay() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let precious = root.path().join("precious");
        fs::write(&precious, "precious").unwrap();
        let path = root.path().join("report.html");
        symlink(&precious, &path).unwrap();
        symlink(&precious, root.path().join("report.html.partial")).unwrap();
        write_file(&path, "new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read(&precious).unwrap(), b"precious");
    }
}
