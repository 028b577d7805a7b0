//! The folder of a run: where it goes, and that nobody else's files are touched.

use std::ffi::OsString;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{OutputError, PARTIAL};
use crate::checkpoint::{Lock, Start};

/// Whether a run has begun there.
fn is_run(path: &Path) -> bool {
    path.join("run.json").exists() || Start::is_in(&path.join(CHECKPOINTS))
}

/// Whether there is nothing in a folder, or only what a run leaves that was stopped before it began.
fn is_free(path: &Path) -> Result<bool, OutputError> {
    let names = |path: &Path| -> Result<Vec<OsString>, OutputError> {
        let entries = fs::read_dir(path).map_err(OutputError::at(path))?;
        let names = entries.map(|entry| entry.map(|entry| entry.file_name()));
        names
            .collect::<Result<_, _>>()
            .map_err(OutputError::at(path))
    };
    let checkpoints = path.join(CHECKPOINTS);
    Ok(match names(path)?.as_slice() {
        [] => true,
        [only] if only == CHECKPOINTS && checkpoints.is_dir() => names(&checkpoints)?
            .iter()
            .all(|name| name == LOCK || name == "files" || name == "start.json.partial"),
        _ => false,
    })
}

/// A file or a folder with all in it, if it is there; the lock stays.
fn remove(path: &Path) -> Result<(), OutputError> {
    let removed = match path.is_dir() {
        true if path.ends_with(CHECKPOINTS) => {
            let entries = fs::read_dir(path).map_err(OutputError::at(path))?;
            let others = entries.flatten().filter(|entry| entry.file_name() != LOCK);
            return others
                .map(|entry| entry.path())
                .try_for_each(|path| remove(&path));
        }
        true => fs::remove_dir_all(path),
        false => fs::remove_file(path),
    };
    match removed {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(OutputError::at(path)(error)),
        _ => Ok(()),
    }
}

/// The files and folders that a run writes, and that `--overwrite` removes.
const OWN: &[&str] = &[
    "run.json",
    "diagnostics.csv",
    "frames",
    "particles.pvd",
    "images",
    "meshes",
    "render",
    "plots",
    "report.html",
    "video.gif",
    "probes",
    "checkpoints",
];

/// A folder that is this run's alone, as long as this or a clone of it is there.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    _lock: Arc<Lock>,
}

const CHECKPOINTS: &str = "checkpoints";
const LOCK: &str = "lock";

impl RunFolder {
    /// The usual place: `out/NAME` under `parent`, or `out/NAME-2` and so on, the first that is not taken.
    ///
    /// # Errors
    /// If no folder can be made.
    pub fn numbered(parent: &Path, name: &str) -> Result<Self, OutputError> {
        let out = parent.join("out");
        fs::create_dir_all(&out).map_err(OutputError::at(&out))?;
        let mut number = 1_u32;
        loop {
            let path = out.join(if number == 1 {
                name.to_owned()
            } else {
                format!("{name}-{number}")
            });
            match fs::create_dir(&path) {
                Ok(()) => return Self::locked(&path),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(OutputError::at(&path)(error)),
            }
        }
    }

    /// The given place. An empty folder is taken as it is; a run in it is removed only if `overwrite`; a folder with
    /// anything but a run in it is refused.
    ///
    /// # Errors
    /// If the folder is taken or cannot be made.
    pub fn at(path: &Path, overwrite: bool) -> Result<Self, OutputError> {
        if path.is_file() {
            return Err(OutputError::usage(path, "is a file, not a folder"));
        }
        let is_run = is_run(path);
        if is_run && !overwrite {
            return Err(OutputError::usage(
                path,
                format!(
                    "there is a run in this folder already; `lahar resume {}` goes on with it, `--overwrite` replaces it, or choose another folder",
                    path.display()
                ),
            ));
        }
        fs::create_dir_all(path).map_err(OutputError::at(path))?;
        if !is_run && !is_free(path)? {
            return Err(OutputError::usage(
                path,
                "this folder holds something that is not a run; choose an empty or a new one",
            ));
        }
        let folder = Self::locked(path)?;
        if is_run {
            // run.json last: what is left of it is a run till then, which can be replaced again.
            for own in OWN.iter().rev() {
                remove(&path.join(own))?;
            }
        }
        Ok(folder)
    }

    /// A run that goes on. What was left half written is removed.
    ///
    /// # Errors
    /// There is no run, or another program is at it.
    pub fn of_run(path: &Path) -> Result<Self, OutputError> {
        if !is_run(path) {
            let what = match path.is_dir() {
                true => {
                    "there is no run in this folder, or it was stopped before anything was kept; `lahar run` starts one"
                }
                false => "there is no such folder",
            };
            return Err(OutputError::usage(path, what));
        }
        let folder = Self::locked(path)?;
        let files = folder.checkpoints().join("files");
        for folder in [
            path,
            &folder.frames(),
            &folder.images(),
            &folder.checkpoints(),
            &files,
        ] {
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let path = entry.path();
                if path.extension().is_some_and(|ending| ending == PARTIAL) {
                    fs::remove_file(&path).map_err(OutputError::at(&path))?;
                }
            }
        }
        Ok(folder)
    }

    /// The folder, with its lock.
    fn locked(path: &Path) -> Result<Self, OutputError> {
        let checkpoints = path.join(CHECKPOINTS);
        fs::create_dir_all(&checkpoints).map_err(OutputError::at(&checkpoints))?;
        Ok(Self {
            path: path.to_owned(),
            _lock: Arc::new(Lock::take(&checkpoints.join(LOCK), path)?),
        })
    }

    /// The folder alone, for something that is not a run.
    ///
    /// # Errors
    /// If the lock cannot be removed.
    pub fn into_plain(self) -> Result<PathBuf, OutputError> {
        let checkpoints = self.checkpoints();
        fs::remove_dir_all(&checkpoints).map_err(OutputError::at(&checkpoints))?;
        Ok(self.path)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// `run.json` in it.
    pub fn record(&self) -> PathBuf {
        self.path.join("run.json")
    }

    /// `diagnostics.csv` in it.
    pub fn diagnostics(&self) -> PathBuf {
        self.path.join("diagnostics.csv")
    }

    /// `frames/` in it.
    pub fn frames(&self) -> PathBuf {
        self.path.join("frames")
    }

    /// `particles.pvd` in it: the frames by time, for ParaView.
    pub fn time_series(&self) -> PathBuf {
        self.path.join("particles.pvd")
    }

    /// `probes/` in it.
    pub fn probes(&self) -> PathBuf {
        self.path.join("probes")
    }

    /// `checkpoints/` in it.
    pub fn checkpoints(&self) -> PathBuf {
        self.path.join(CHECKPOINTS)
    }

    /// `checkpoints/film` in it: the pictures of the film that is being made.
    pub fn film_pictures(&self) -> PathBuf {
        self.checkpoints().join("film")
    }

    /// Removes [`RunFolder::film_pictures`]: the film is made.
    ///
    /// # Errors
    /// If that fails.
    pub fn forget_film_pictures(&self) -> Result<(), OutputError> {
        remove(&self.film_pictures())
    }

    /// `images/` in it.
    pub fn images(&self) -> PathBuf {
        self.path.join("images")
    }

    /// `video.gif` in it.
    pub fn video(&self) -> PathBuf {
        self.path.join("video.gif")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taken_names_are_numbered() {
        let root = tempfile::tempdir().unwrap();
        let names: Vec<_> = (0..3)
            .map(|_| RunFolder::numbered(root.path(), "dam").unwrap().path)
            .collect();
        let out = root.path().join("out");
        assert_eq!(
            names,
            [out.join("dam"), out.join("dam-2"), out.join("dam-3")]
        );
    }

    #[test]
    fn a_run_is_replaced_only_when_told_and_other_files_stay() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        RunFolder::at(&path, false).unwrap();
        fs::write(path.join("run.json"), "{}").unwrap();
        fs::create_dir(path.join("frames")).unwrap();
        fs::write(path.join("frames/000000.npz"), "x").unwrap();
        fs::write(path.join("notes.txt"), "mine").unwrap();
        let error = RunFolder::at(&path, false).unwrap_err();
        assert!(error.usage && error.what.contains("resume") && error.what.contains("--overwrite"));
        RunFolder::at(&path, true).unwrap();
        assert!(!path.join("run.json").exists() && !path.join("frames").exists());
        assert!(path.join("notes.txt").exists());
        // No run any more, but not empty: refused, told or not.
        assert!(RunFolder::at(&path, true).unwrap_err().usage);
    }

    #[test]
    fn a_file_in_the_way_is_named() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("x");
        fs::write(&path, "").unwrap();
        assert!(RunFolder::at(&path, false).unwrap_err().usage);
        let below = RunFolder::at(&path.join("y"), false).unwrap_err();
        assert!(below.to_string().contains("x/y"), "{below}");
    }
}
