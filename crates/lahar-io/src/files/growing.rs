//! A file that grows with every frame and can be cut back to an earlier length.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::confined::{confined, refuse_link_io};
use super::whole::{create_new, write_whole_io};
use super::{Durability, OutputError};

/// The length of a growing file at one moment, with a checksum.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Length {
    /// Path of the file, relative to the run's folder.
    pub file: String,
    /// Length in bytes.
    pub bytes: u64,
    /// CRC-32 of these bytes.
    pub crc32: u32,
}

impl Length {
    /// Measures the first `bytes` bytes of the file `path` in the run's folder `run`.
    pub(crate) fn of(run: &Path, path: &Path, bytes: u64) -> io::Result<Self> {
        let mut sum = crc32fast::Hasher::new();
        let bytes = sum_up(File::open(path)?.take(bytes), &mut sum)?;
        Ok(Self::new(run, path, bytes, sum))
    }

    fn new(run: &Path, path: &Path, bytes: u64, sum: crc32fast::Hasher) -> Self {
        let file = path.strip_prefix(run).unwrap_or(path);
        Self {
            file: file.to_string_lossy().replace('\\', "/"),
            bytes,
            crc32: sum.finalize(),
        }
    }

    /// Checks that the file in the run's folder `run` still begins with the same bytes.
    ///
    /// # Errors
    /// A sentence that says what is missing or altered.
    pub fn check(&self, run: &Path) -> Result<(), String> {
        let path = confined(run, &self.file)?;
        let file = File::open(&path)
            .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
        let mut sum = crc32fast::Hasher::new();
        let read = sum_up(file.take(self.bytes), &mut sum)
            .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
        if read < self.bytes {
            return Err(format!(
                "{} was cut: {read} bytes of {} are there",
                path.display(),
                self.bytes
            ));
        }
        if sum.finalize() != self.crc32 {
            return Err(format!("{} was altered", path.display()));
        }
        Ok(())
    }
}

fn sum_up(mut from: impl Read, sum: &mut crc32fast::Hasher) -> io::Result<u64> {
    let mut piece = vec![0; 1 << 16];
    let mut total = 0;
    loop {
        let count = from.read(&mut piece)?;
        if count == 0 {
            return Ok(total);
        }
        sum.update(&piece[..count]);
        total += count as u64;
    }
}

/// A file that is appended to. Added bytes are handed to the system at once.
#[derive(Debug)]
pub(crate) struct GrowingFile {
    path: PathBuf,
    file: File,
    bytes: u64,
    sum: crc32fast::Hasher,
}

impl GrowingFile {
    /// Opens a new file in place of the file or link `path`, or cuts the file that is there back to `length`.
    pub(crate) fn open(path: &Path, length: Option<&Length>) -> Result<Self, OutputError> {
        let opened = match length {
            None => create_new(path).map(|file| (file, 0, crc32fast::Hasher::new())),
            Some(length) => cut_back(path, length.bytes),
        };
        let (file, bytes, sum) = opened.map_err(OutputError::at(path))?;
        Ok(Self {
            path: path.to_owned(),
            file,
            bytes,
            sum,
        })
    }

    /// Appends `bytes` to the file.
    pub(crate) fn add(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        self.file
            .write_all(bytes)
            .map_err(OutputError::at(&self.path))?;
        self.sum.update(bytes);
        self.bytes += bytes.len() as u64;
        Ok(())
    }

    /// Waits until all bytes are on the disk and returns the length; `run` is the run's folder.
    pub(crate) fn settle(&self, run: &Path) -> Result<Length, OutputError> {
        self.file.sync_data().map_err(OutputError::at(&self.path))?;
        Ok(Length::new(run, &self.path, self.bytes, self.sum.clone()))
    }
}

/// Opens the file `path` and cuts it to `bytes` bytes; returns it with its length and checksum.
fn cut_back(path: &Path, bytes: u64) -> io::Result<(File, u64, crc32fast::Hasher)> {
    refuse_link_io(path)?;
    if has_other_names(path)? {
        // A hard link: a copy leaves the file under its other name as it is.
        let mut from = File::open(path)?.take(bytes);
        write_whole_io(path, Durability::Eventual, |mut writer| {
            io::copy(&mut from, &mut writer)?;
            Ok(writer)
        })?;
    }
    let mut file = OpenOptions::new().read(true).write(true).open(path)?;
    let mut sum = crc32fast::Hasher::new();
    let bytes = sum_up((&mut file).take(bytes), &mut sum)?;
    file.set_len(bytes)?;
    file.seek(SeekFrom::Start(bytes))?;
    Ok((file, bytes, sum))
}

/// Returns true if the file has more than one name in the file system.
#[cfg(unix)]
fn has_other_names(path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt as _;
    Ok(std::fs::metadata(path)?.nlink() > 1)
}

#[cfg(not(unix))]
fn has_other_names(_path: &Path) -> io::Result<bool> {
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_is_cut_back_and_grows_on() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.csv");
        let mut file = GrowingFile::open(&path, None).unwrap();
        file.add(b"head\n1\n").unwrap();
        let was = file.settle(root.path()).unwrap();
        assert_eq!((was.file.as_str(), was.bytes), ("a.csv", 7));
        file.add(b"2\n3").unwrap();
        drop(file);
        was.check(root.path()).unwrap();
        let mut file = GrowingFile::open(&path, Some(&was)).unwrap();
        file.add(b"2\n").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"head\n1\n2\n");
        let now = file.settle(root.path()).unwrap();
        now.check(root.path()).unwrap();
        fs::write(&path, "head\n2\n2\n").unwrap();
        assert!(was.check(root.path()).unwrap_err().contains("altered"));
        fs::write(&path, "hea").unwrap();
        assert!(was.check(root.path()).unwrap_err().contains("3 bytes of 7"));
        fs::remove_file(&path).unwrap();
        assert!(
            was.check(root.path())
                .unwrap_err()
                .contains("a.csv cannot be read")
        );
    }

    #[cfg(unix)]
    #[test]
    fn files_behind_links_stay_as_they_are() {
        let root = tempfile::tempdir().unwrap();
        let (path, precious) = (root.path().join("a.csv"), root.path().join("precious"));
        fs::write(&precious, "precious").unwrap();
        let length = Length::of(root.path(), &precious, 4).unwrap();
        // A symbolic link is replaced by a new file, and never cut back.
        std::os::unix::fs::symlink(&precious, &path).unwrap();
        assert!(GrowingFile::open(&path, Some(&length)).is_err());
        GrowingFile::open(&path, None).unwrap().add(b"x").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"x");
        // A hard link becomes a file of its own.
        fs::remove_file(&path).unwrap();
        fs::hard_link(&precious, &path).unwrap();
        let mut file = GrowingFile::open(&path, Some(&length)).unwrap();
        file.add(b"x").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"precx");
        assert_eq!(fs::read(&precious).unwrap(), b"precious");
    }

    #[test]
    fn a_length_names_no_file_outside_of_the_run() {
        let root = tempfile::tempdir().unwrap();
        let length = Length {
            file: "../precious".into(),
            bytes: 1,
            crc32: 0,
        };
        let why = length.check(root.path()).unwrap_err();
        assert!(why.contains("out of the run's folder"), "{why}");
    }
}
