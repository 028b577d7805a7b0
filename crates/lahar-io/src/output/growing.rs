//! A file that grows by the frame, and can be cut back to what it was.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::OutputError;

/// How a growing file stood.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Length {
    /// The file, from the run's folder.
    pub file: String,
    /// Its length.
    pub bytes: u64,
    /// CRC-32 of its bytes.
    pub crc32: u32,
}

impl Length {
    /// Of the first `bytes` bytes of the file at `path`, in the run's folder `run`.
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

    /// Whether the file, in the run's folder `run`, still begins with what it was.
    ///
    /// # Errors
    /// Why not, in a sentence.
    pub fn check(&self, run: &Path) -> Result<(), String> {
        let path = run.join(&self.file);
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

/// The file while it grows. What is added is handed to the system at once.
#[derive(Debug)]
pub(super) struct Growing {
    path: PathBuf,
    file: File,
    bytes: u64,
    sum: crc32fast::Hasher,
}

impl Growing {
    /// A new file, or one cut back to what it was.
    pub(super) fn open(path: &Path, was: Option<&Length>) -> Result<Self, OutputError> {
        let at = OutputError::at(path);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(was.is_none())
            .open(path)
            .map_err(&at)?;
        let mut sum = crc32fast::Hasher::new();
        let bytes = was.map_or(0, |was| was.bytes);
        sum_up((&mut file).take(bytes), &mut sum).map_err(&at)?;
        file.set_len(bytes).map_err(&at)?;
        file.seek(SeekFrom::Start(bytes)).map_err(&at)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            bytes,
            sum,
        })
    }

    pub(super) fn add(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        self.file
            .write_all(bytes)
            .map_err(OutputError::at(&self.path))?;
        self.sum.update(bytes);
        self.bytes += bytes.len() as u64;
        Ok(())
    }

    /// How it stands, on the disk when this returns; `run` is the run's folder.
    pub(super) fn settle(&self, run: &Path) -> Result<Length, OutputError> {
        self.file.sync_data().map_err(OutputError::at(&self.path))?;
        Ok(Length::new(run, &self.path, self.bytes, self.sum.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_is_cut_back_and_grows_on() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.csv");
        let mut file = Growing::open(&path, None).unwrap();
        file.add(b"head\n1\n").unwrap();
        let was = file.settle(root.path()).unwrap();
        assert_eq!((was.file.as_str(), was.bytes), ("a.csv", 7));
        file.add(b"2\n3").unwrap();
        drop(file);
        was.check(root.path()).unwrap();
        let mut file = Growing::open(&path, Some(&was)).unwrap();
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
}
