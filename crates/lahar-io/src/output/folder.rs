//! The folder of a run: where it goes, and that nobody else's files are touched.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::OutputError;

/// The files and folders that a run writes, and that `--overwrite` removes.
const OWN: [&str; 8] = [
    "run.json",
    "diagnostics.csv",
    "frames",
    "particles.pvd",
    "images",
    "video.gif",
    "probes",
    "checkpoints",
];

/// A folder that is this run's alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFolder {
    path: PathBuf,
}

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
                Ok(()) => return Ok(Self { path }),
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
        let folder = Self {
            path: path.to_owned(),
        };
        if path.join("run.json").exists() {
            if !overwrite {
                return Err(OutputError::usage(
                    path,
                    "there is a run in this folder already; replace it with `--overwrite`, or choose another folder (`lahar resume`, to go on with a run, is not there yet)",
                ));
            }
            for own in OWN {
                let own = path.join(own);
                let removed = if own.is_dir() {
                    fs::remove_dir_all(&own)
                } else {
                    fs::remove_file(&own)
                };
                match removed {
                    Err(error) if error.kind() != ErrorKind::NotFound => {
                        return Err(OutputError::at(&own)(error));
                    }
                    _ => {}
                }
            }
            return Ok(folder);
        }
        if path.is_file() {
            return Err(OutputError::usage(path, "is a file, not a folder"));
        }
        fs::create_dir_all(path).map_err(OutputError::at(path))?;
        let mut entries = fs::read_dir(path).map_err(OutputError::at(path))?;
        if entries.next().is_some() {
            return Err(OutputError::usage(
                path,
                "this folder holds something that is not a run; choose an empty or a new one",
            ));
        }
        Ok(folder)
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
