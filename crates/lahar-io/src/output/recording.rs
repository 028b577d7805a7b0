//! A run's folder, read back: the record and the frames.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use lahar::particles::{FIELDS, Shape};
use lahar::{Data, Field, Snapshot};

use super::Record;
use crate::files::confined;
use lahar_scene::npz;

/// A recorded run: its record and its frames of particles.
#[derive(Clone, Debug)]
pub struct Recording {
    folder: PathBuf,
    record: Record,
    frames: Vec<PathBuf>,
}

/// An error about a run or a frame that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingError {
    /// The folder or file.
    pub path: PathBuf,
    /// The problem, and the way out where there is one.
    pub what: String,
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.what)
    }
}

impl std::error::Error for RecordingError {}

fn error(path: &Path, what: impl Into<String>) -> RecordingError {
    RecordingError {
        path: path.to_owned(),
        what: what.into(),
    }
}

impl Recording {
    /// Opens the run in `folder`, which may also be the path of its `run.json`.
    ///
    /// # Errors
    /// If there is no run, its record cannot be read, or it has no frames of particles.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, RecordingError> {
        let folder = folder.as_ref();
        let folder = if folder.ends_with("run.json") {
            folder.parent().unwrap_or(Path::new(""))
        } else {
            folder
        };
        let (path, record) = read_record(folder)?;
        if !matches!(record.dimension, 2 | 3) {
            return Err(error(
                &path,
                format!("dimension is {}, not 2 or 3", record.dimension),
            ));
        }
        let frames = confined(folder, "frames").map_err(|what| error(folder, what))?;
        let frames = frame_files(&frames);
        if frames.is_empty() {
            return Err(error(
                folder,
                "the run has no frames of particles; run the scene again with --format npz",
            ));
        }
        Ok(Self {
            folder: folder.to_owned(),
            record,
            frames,
        })
    }

    /// Returns the run's folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the run's record.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Returns the number of frames with particles, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "a recording is never empty")]
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Returns the number in a frame's file name; `index` counts the files from 0.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn number(&self, index: usize) -> u64 {
        frame_number(&self.frames[index]).expect("only files with a number are frames")
    }

    /// Reads the particles of a frame with all fields of its file; `index` counts the files from 0.
    ///
    /// # Errors
    /// If the file cannot be read, or is not a frame of this run.
    pub fn frame(&self, index: usize) -> Result<Snapshot, RecordingError> {
        let path = (self.frames.get(index)).ok_or_else(|| {
            error(
                &self.folder,
                format!("there is no frame {index}, there are {}", self.len()),
            )
        })?;
        let arrays = npz::read(path).map_err(|why| match why.array {
            Some(array) => error(path, format!("array \"{array}\": {}", why.what)),
            None => error(path, why.what),
        })?;
        let d = self.record.dimension;
        let position = (arrays.iter())
            .find(|array| array.name == Field::Position.info().name)
            .ok_or_else(|| error(path, "there is no array \"position\""))?;
        let n = position.shape.first().copied().unwrap_or_default();
        let time = (arrays.iter().find(|array| array.name == "time"))
            .and_then(|array| array.data.to_f64().first().copied())
            .ok_or_else(|| error(path, "there is no array \"time\""))?;
        let mut columns: Vec<(Field, Data)> = vec![];
        for array in arrays {
            let Some(info) = FIELDS.iter().find(|info| info.name == array.name) else {
                continue; // of another program, or of a later version
            };
            let shape: &[usize] = match info.shape {
                Shape::Scalar => &[n],
                Shape::Vector => &[n, d],
                Shape::Matrix => &[n, d, d],
            };
            if array.shape != shape {
                return Err(error(
                    path,
                    format!(
                        "array \"{}\" has the shape {:?}, not {shape:?}",
                        array.name, array.shape
                    ),
                ));
            }
            columns.push((info.field, array.data));
        }
        Ok(Snapshot {
            time,
            dimension: d,
            count: n,
            columns,
        })
    }
}

/// Reads the record of the run in `folder`. Returns the path of `run.json` and the record.
///
/// # Errors
/// If there is no run, or its record cannot be read.
pub fn read_record(folder: &Path) -> Result<(PathBuf, Record), RecordingError> {
    let path = confined(folder, "run.json").map_err(|what| error(folder, what))?;
    let text = fs::read_to_string(&path).map_err(|why| match why.kind() {
        std::io::ErrorKind::NotFound => error(
            folder,
            "there is no run.json in it: it is not a run's folder",
        ),
        _ => error(&path, format!("cannot read: {why}")),
    })?;
    let record = serde_json::from_str(&text)
        .map_err(|why| error(&path, format!("it is damaged, or not of a run: {why}")))?;
    Ok((path, record))
}

/// Returns the number in a file's name: 12 for `000012.npz`.
fn frame_number(path: &Path) -> Option<u64> {
    let npz = path.extension().is_some_and(|ending| ending == "npz");
    let stem = path.file_stem()?.to_str()?;
    npz.then(|| stem.parse().ok()).flatten()
}

/// Returns the paths `000000.npz` and so on, in the order of their numbers. Links are left out.
fn frame_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<(u64, PathBuf)> = entries
        .filter(|entry| entry.file_type().is_ok_and(|kind| !kind.is_symlink()))
        .filter_map(|entry| Some((frame_number(&entry.path())?, entry.path())))
        .collect();
    files.sort_unstable();
    files.into_iter().map(|(_, path)| path).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{PhaseSeconds, Status, frame_name, write_frame};
    use super::*;
    use crate::export::Format;

    fn run(folder: &Path, frames: u64) {
        let record = Record {
            version: "1".into(),
            status: Status::Done,
            failure: None,
            scene_name: "dust".into(),
            scene: serde_json::json!({}),
            seed: 0,
            dimension: 2,
            precision: "f32".into(),
            isa: "portable".into(),
            threads: 1,
            frames,
            time: 1.0,
            substeps: 1,
            particles: 2,
            particle_steps: 2,
            particle_steps_per_second: 1.0,
            startup_seconds: 0.5,
            seconds: 1.0,
            phase_seconds: PhaseSeconds::default(),
            sorts: 1,
            warnings: vec![],
            retries: vec![],
        };
        record.write(&folder.join("run.json")).unwrap();
        fs::create_dir_all(folder.join("frames")).unwrap();
        for i in 0..frames {
            let x = i as f64;
            let snapshot = Snapshot {
                time: 0.5 * x,
                dimension: 2,
                count: 2,
                columns: vec![
                    (Field::Position, Data::F64(vec![x, 0.0, x, 1.0])),
                    (Field::Body, Data::U32(vec![0, 1])),
                ],
            };
            // Every other frame was written.
            let path = folder.join("frames").join(frame_name(2 * i, "npz"));
            write_frame(&path, &snapshot, Format::Npz).unwrap();
        }
    }

    #[test]
    fn frames_come_back_in_order() {
        let folder = tempfile::tempdir().unwrap();
        run(folder.path(), 12);
        let recording = Recording::open(folder.path().join("run.json")).unwrap();
        assert_eq!(
            (recording.len(), recording.record().scene_name.as_str()),
            (12, "dust")
        );
        let frame = recording.frame(11).unwrap();
        assert_eq!((frame.time, frame.count), (5.5, 2));
        assert_eq!(
            frame.get(Field::Position),
            Some(&Data::F64(vec![11.0, 0.0, 11.0, 1.0]))
        );
        assert!(recording.frame(12).is_err());
    }

    #[test]
    fn unreadable_runs_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let why = |path: &Path| Recording::open(path).unwrap_err().to_string();
        assert!(why(folder.path()).contains("not a run's folder"));
        run(folder.path(), 0);
        assert!(why(folder.path()).contains("--format npz"));
        fs::write(folder.path().join("run.json"), "{ \"version\": ").unwrap();
        assert!(why(folder.path()).contains("damaged"));
    }

    #[test]
    fn a_damaged_frame_is_named_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        run(folder.path(), 2);
        let recording = Recording::open(folder.path()).unwrap();
        let path = folder.path().join("frames/000002.npz");
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let why = recording.frame(1).unwrap_err().to_string();
        assert!(why.contains("000002.npz"), "{why}");

        let snapshot = Snapshot {
            time: 0.0,
            dimension: 3,
            count: 1,
            columns: vec![(Field::Position, Data::F64(vec![0.0; 3]))],
        };
        write_frame(&path, &snapshot, Format::Npz).unwrap();
        let why = recording.frame(1).unwrap_err().to_string();
        assert!(why.contains("shape [1, 3], not [1, 2]"), "{why}");
    }
}
