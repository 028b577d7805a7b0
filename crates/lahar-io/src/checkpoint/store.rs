//! The folder of checkpoints: the newest two, each whole or absent.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

use lahar::Checkpoint;

use super::format::{self, Header};
use crate::files::{Durability, OutputError, is_link, sync_folder, write_whole};

const ENDING: &str = "checkpoint";

/// Number of checkpoints that are kept: the last one, and the one before in case the last is damaged.
const KEPT: usize = 2;

/// The checkpoints of a run.
///
/// ```
/// use lahar_io::checkpoint::Store;
///
/// let folder = tempfile::tempdir()?;
/// let newest = Store::new(folder.path()).newest(|_| Ok(()));
/// assert!(newest.found.is_none() && newest.refused.is_empty());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store {
    folder: PathBuf,
}

/// The newest usable checkpoint, with the ones that were passed over.
#[derive(Debug)]
pub struct Newest {
    /// The newest checkpoint that can be used: path, header and state. `None`: the run begins at its start.
    pub found: Option<(PathBuf, Header, Checkpoint)>,
    /// An error for each newer checkpoint that cannot be used.
    pub refused: Vec<OutputError>,
}

impl Store {
    /// Refers to the checkpoints in `folder`.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
        }
    }

    /// Writes a checkpoint, waits until it is on the disk, and removes all but the newest two. Returns its path.
    ///
    /// # Errors
    /// If it cannot be written; the older checkpoints stay.
    pub fn add(&self, header: &Header, checkpoint: &Checkpoint) -> Result<PathBuf, OutputError> {
        let name = format!("{:06}.{ENDING}", header.progress.frame);
        let path = self.folder.join(name);
        write_whole(&path, Durability::Immediate, |writer| {
            format::write(writer, header, checkpoint)
        })?;
        sync_folder(&self.folder)?;
        for (_, old) in self.all().into_iter().skip(KEPT) {
            fs::remove_file(&old).map_err(OutputError::at(&old))?;
        }
        Ok(path)
    }

    /// Returns the frames and paths of all checkpoints, the newest first.
    pub fn all(&self) -> Vec<(u64, PathBuf)> {
        let Ok(entries) = fs::read_dir(&self.folder) else {
            return Vec::new();
        };
        let mut all: Vec<(u64, PathBuf)> = entries
            .filter_map(|entry| {
                // A link may lead anywhere.
                let entry = entry.ok().filter(|entry| !is_link(&entry.path()))?;
                let path = entry.path();
                let is_one = path.extension()? == ENDING;
                let frame = path.file_stem()?.to_str()?.parse().ok()?;
                is_one.then_some((frame, path))
            })
            .collect();
        all.sort_unstable();
        all.reverse();
        all
    }

    /// Reads the newest checkpoint that is whole and that `usable` accepts. `usable` returns the reason if it does not.
    pub fn newest(&self, usable: impl Fn(&Header) -> Result<(), String>) -> Newest {
        let mut refused = Vec::new();
        for (_, path) in self.all() {
            let read = File::open(&path)
                .and_then(|file| Ok((file.metadata()?.len(), file)))
                .map_err(|error| format!("cannot be read: {error}"))
                .and_then(|(length, file)| format::read(BufReader::new(file), length))
                .and_then(|(header, checkpoint)| {
                    usable(&header)?;
                    Ok((header, checkpoint))
                });
            match read {
                Ok((header, checkpoint)) => {
                    return Newest {
                        found: Some((path, header, checkpoint)),
                        refused,
                    };
                }
                Err(what) => refused.push(OutputError {
                    path,
                    what,
                    usage: false,
                }),
            }
        }
        Newest {
            found: None,
            refused,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Progress;
    use super::*;
    use lahar::checkpoint::{Array, Values};

    fn add(store: &Store, frame: u64) {
        let header = Header {
            lahar: "1".into(),
            dimension: 2,
            precision: "f32".into(),
            isa: "portable".into(),
            start: 1,
            progress: Progress {
                frame,
                ..Progress::default()
            },
        };
        let checkpoint = Checkpoint {
            arrays: vec![Array {
                name: "frame".into(),
                shape: vec![],
                values: Values::U64(vec![frame]),
            }],
        };
        store.add(&header, &checkpoint).unwrap();
    }

    fn frames(store: &Store) -> Vec<u64> {
        store.all().iter().map(|(frame, _)| *frame).collect()
    }

    #[test]
    fn the_newest_two_are_kept_and_a_damaged_one_is_passed_over() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::new(root.path());
        assert!(store.newest(|_| Ok(())).found.is_none());
        for frame in [0, 7, 1_000_000, 2_000_000] {
            add(&store, frame);
        }
        fs::write(root.path().join("notes.txt"), "").unwrap();
        assert_eq!(frames(&store), [2_000_000, 1_000_000]);
        let found = |newest: &Newest| newest.found.as_ref().map(|found| found.1.progress.frame);
        let newest = store.newest(|_| Ok(()));
        assert_eq!((found(&newest), newest.refused.len()), (Some(2_000_000), 0));
        // A checkpoint that the caller cannot use is passed over ..
        let newest = store.newest(|header| match header.progress.frame {
            2_000_000 => Err("not that one".to_owned()),
            _ => Ok(()),
        });
        assert_eq!((found(&newest), newest.refused.len()), (Some(1_000_000), 1));
        // .. and so is one that is cut.
        let path = &store.all()[0].1;
        let bytes = fs::read(path).unwrap();
        fs::write(path, &bytes[..bytes.len() - 5]).unwrap();
        let newest = store.newest(|_| Ok(()));
        assert_eq!(found(&newest), Some(1_000_000));
        let why = newest.refused[0].to_string();
        assert!(
            why.contains("2000000.checkpoint") && why.contains("cut short"),
            "{why}"
        );
    }
}
