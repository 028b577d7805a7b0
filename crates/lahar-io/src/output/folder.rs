//! The folder of a run: its place, its lock, and the files in it that are lahar's.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use crate::checkpoint::Start;
use crate::export::{Format, MeshFormat};
use crate::files::{
    Lock, OutputError, PARTIAL, confined, file_name, is_link, make_folder, remove_file,
};

const RECORD: &str = "run.json";
const CHECKPOINTS: &str = "checkpoints";
const LOCK: &str = "lock";

/// Beginning of the name of a film that a resumed run has set aside.
const OLD_VIDEO: &str = "video-to-";

/// File names (without the ending .svg) of the plots that `lahar plot` draws from `diagnostics.csv`; those of probes
/// begin with [`PROBE_PLOT`].
pub const PLOTS: [&str; 6] = [
    "energy",
    "angular-momentum",
    "momentum",
    "volume",
    "speed",
    "time-step",
];

/// Beginning of the names of plots of probes.
pub const PROBE_PLOT: &str = "probe-";

/// A folder below a run's folder, and a test for the names of the files that lahar writes there.
struct OwnFolder {
    path: &'static str,
    is_own: fn(&str) -> bool,
}

/// Every folder that lahar makes in a run's folder, inner ones first, and the run's folder itself. `run.json` is removed
/// last and on its own: until then the folder is still a run, which can be replaced again.
const OWN_FOLDERS: [OwnFolder; 8] = [
    own("frames", |name| {
        (Format::ALL.iter()).any(|format| is_frame(name, format.info().ending))
    }),
    own("images", |name| is_frame(name, "png")),
    own("render", |name| {
        is_frame(name, "png") || ["video.gif", "video.mp4"].contains(&name)
    }),
    own("plots", |name| {
        let stem = name.strip_suffix(".svg");
        stem.is_some_and(|stem| PLOTS.contains(&stem) || stem.starts_with(PROBE_PLOT))
    }),
    own("probes", |name| name.ends_with(".csv")),
    own("checkpoints/files", |name| {
        let number = name.split('.').next().unwrap_or_default();
        is_number(number, 1)
    }),
    own(CHECKPOINTS, |name| {
        ["start.json", "film"].contains(&name) || is_frame(name, "checkpoint")
    }),
    own("", |name| {
        [
            "diagnostics.csv",
            "particles.pvd",
            "report.html",
            "video.gif",
        ]
        .contains(&name)
            || (name.strip_prefix(OLD_VIDEO)).is_some_and(|name| is_frame(name, "gif"))
    }),
];

const fn own(path: &'static str, is_own: fn(&str) -> bool) -> OwnFolder {
    OwnFolder { path, is_own }
}

/// Returns true for 000012.npz and the like.
fn is_frame(name: &str, ending: &str) -> bool {
    (name.strip_suffix(ending))
        .and_then(|rest| rest.strip_suffix('.'))
        .is_some_and(|number| is_number(number, 6))
}

fn is_number(text: &str, least_digits: usize) -> bool {
    text.len() >= least_digits && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Contents of a folder that a run is to be written into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Contents {
    /// Nothing, or the rest of a run that was stopped before it began.
    Empty,
    /// A run of lahar's.
    Run,
    /// A `run.json` that lahar did not write.
    ForeignRecord,
    /// Files of any other kind.
    Other,
}

impl Contents {
    fn of(path: &Path) -> Result<Self, OutputError> {
        let record = path.join(RECORD);
        if fs::symlink_metadata(&record).is_ok() {
            return Ok(match is_record(&record) {
                true => Self::Run,
                false => Self::ForeignRecord,
            });
        }
        if Start::is_in(&path.join(CHECKPOINTS)) {
            return Ok(Self::Run);
        }
        Ok(match is_empty(path)? {
            true => Self::Empty,
            false => Self::Other,
        })
    }
}

/// Returns true if lahar wrote the file: an object with the version, the state and the scene of a run. Other fields may
/// differ between versions of the program.
fn is_record(path: &Path) -> bool {
    let text = match is_link(path) || !path.is_file() {
        true => None,
        false => fs::read(path).ok(),
    };
    let record: Option<Value> = text.and_then(|text| serde_json::from_slice(&text).ok());
    record.is_some_and(|record| {
        let is_text = |key: &str| record[key].is_string();
        is_text("version")
            && is_text("status")
            && is_text("scene_name")
            && record["scene"].is_object()
    })
}

/// Returns true if nothing is in the folder `path` but what a run leaves that was stopped before it began.
fn is_empty(path: &Path) -> Result<bool, OutputError> {
    let names = |path: &Path| -> Result<Vec<String>, OutputError> {
        let entries = fs::read_dir(path).map_err(OutputError::at(path))?;
        entries
            .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
            .collect::<Result<_, _>>()
            .map_err(OutputError::at(path))
    };
    let checkpoints = path.join(CHECKPOINTS);
    Ok(match names(path)?.as_slice() {
        [] => true,
        [only] if only == CHECKPOINTS && checkpoints.is_dir() && !is_link(&checkpoints) => {
            let rest = [LOCK, "files", "start.json.partial"];
            (names(&checkpoints)?.iter()).all(|name| rest.contains(&name.as_str()))
        }
        _ => false,
    })
}

/// A run's folder, locked: as long as this value or a clone of it exists, no other process writes into it.
///
/// ```
/// use lahar_io::output::RunFolder;
///
/// let root = tempfile::tempdir()?;
/// let folder = RunFolder::numbered(root.path(), "dam-break")?;
/// assert!(folder.path().ends_with("out/dam-break"));
/// assert!(folder.frames().ends_with("out/dam-break/frames"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    _lock: Arc<Lock>,
}

impl RunFolder {
    /// Makes `out/NAME` below `parent`, or `out/NAME-2` and so on: the first that does not exist.
    ///
    /// # Errors
    /// If no folder can be made.
    pub fn numbered(parent: &Path, name: &str) -> Result<Self, OutputError> {
        let out = parent.join("out");
        fs::create_dir_all(&out).map_err(OutputError::at(&out))?;
        let name = file_name(name);
        let mut number = 1_u32;
        loop {
            let path = out.join(if number == 1 {
                name.clone()
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

    /// Makes or takes the folder `path`. An empty folder is used as it is. A run in it is removed if `overwrite` is
    /// true: the files that lahar wrote, and no others.
    ///
    /// # Errors
    /// If there is a run and `overwrite` is false, if there is anything else, if a part of the run is a link, or if the
    /// folder cannot be made.
    pub fn at(path: &Path, overwrite: bool) -> Result<Self, OutputError> {
        if path.is_file() {
            return Err(OutputError::usage(path, "is a file, not a folder"));
        }
        // A run's folder must be made, or be there, before its contents are looked at.
        let contents = match path.is_dir() {
            true => Contents::of(path)?,
            false => Contents::Empty,
        };
        let problem = match contents {
            Contents::Empty => None,
            Contents::Run if overwrite => None,
            Contents::Run => Some(format!(
                "there is a run in this folder already; `lahar resume {}` continues it, `--overwrite` replaces it, or choose another folder",
                path.display()
            )),
            Contents::ForeignRecord => Some(
                "the run.json in this folder is not lahar's, so nothing in it is replaced; choose an empty or a new folder"
                    .to_owned(),
            ),
            Contents::Other => Some(
                "this folder contains files that are not a run's; choose an empty or a new one".to_owned(),
            ),
        };
        if let Some(problem) = problem {
            return Err(OutputError::usage(path, problem));
        }
        fs::create_dir_all(path).map_err(OutputError::at(path))?;
        refuse_links(path)?;
        let folder = Self::locked(path)?;
        if contents == Contents::Run {
            folder.remove_run()?;
        }
        Ok(folder)
    }

    /// Makes or takes the folder `path` for several runs, each in a folder of its own, and for pictures that compare
    /// them. With `overwrite` it may be the folder of an earlier comparison: one that has a run in a folder below.
    ///
    /// # Errors
    /// If the folder is in use for anything else, or cannot be made.
    pub fn for_comparison(path: &Path, overwrite: bool) -> Result<PathBuf, OutputError> {
        if !overwrite || !path.is_dir() || is_empty(path)? {
            return Self::at(path, false)?.into_plain();
        }
        let entries = fs::read_dir(path).map_err(OutputError::at(path))?;
        let mut folders = entries.flatten().map(|entry| entry.path());
        let is_run = |folder: PathBuf| !is_link(&folder) && is_record(&folder.join(RECORD));
        if !folders.any(is_run) {
            return Err(OutputError::usage(
                path,
                "there is no earlier comparison in this folder to overwrite; choose an empty or a new folder",
            ));
        }
        for own in ["images", "plots"] {
            confined(path, own).map_err(|what| OutputError::usage(path, what))?;
        }
        Ok(path.to_owned())
    }

    /// Opens the folder of a run that goes on, and removes files that were left half written.
    ///
    /// # Errors
    /// If there is no run, a part of it is a link, or another process writes into it.
    pub fn of_run(path: &Path) -> Result<Self, OutputError> {
        let contents = match path.is_dir() {
            true => Contents::of(path)?,
            false => return Err(OutputError::usage(path, "there is no such folder")),
        };
        let problem = match contents {
            Contents::Run => None,
            Contents::ForeignRecord => Some("the run.json in this folder is not lahar's"),
            Contents::Empty | Contents::Other => Some(
                "there is no run in this folder, or it was stopped before anything was kept; `lahar run` starts one",
            ),
        };
        if let Some(problem) = problem {
            return Err(OutputError::usage(path, problem));
        }
        refuse_links(path)?;
        let folder = Self::locked(path)?;
        for OwnFolder { path: own, is_own } in OWN_FOLDERS {
            let is_left_over = |name: &str| {
                let whole = name
                    .strip_suffix(PARTIAL)
                    .and_then(|name| name.strip_suffix('.'));
                whole.is_some_and(|name| is_own(name) || name == RECORD)
            };
            remove_files(&path.join(own), is_left_over)?;
        }
        Ok(folder)
    }

    /// Makes the folder if it is missing, and locks it.
    fn locked(path: &Path) -> Result<Self, OutputError> {
        let checkpoints = path.join(CHECKPOINTS);
        make_folder(&checkpoints)?;
        Ok(Self {
            path: path.to_owned(),
            _lock: Arc::new(Lock::take(&checkpoints.join(LOCK), path)?),
        })
    }

    /// Removes the files that lahar wrote, and the folders that are empty then. The lock stays.
    fn remove_run(&self) -> Result<(), OutputError> {
        remove_meshes(&self.meshes())?;
        for OwnFolder { path: own, is_own } in OWN_FOLDERS {
            let folder = self.path.join(own);
            remove_files(&folder, |name| {
                is_own(name) || name.strip_suffix(".partial").is_some_and(is_own)
            })?;
            if !own.is_empty() && own != CHECKPOINTS {
                remove_if_empty(&folder)?;
            }
        }
        remove_file(&self.record())
    }

    /// Gives the folder up for something that is not a run: removes the lock and returns the path.
    ///
    /// # Errors
    /// If the lock cannot be removed.
    pub fn into_plain(self) -> Result<PathBuf, OutputError> {
        let checkpoints = self.checkpoints();
        remove_file(&checkpoints.join(LOCK))?;
        remove_if_empty(&checkpoints)?;
        Ok(self.path)
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of `run.json`.
    pub fn record(&self) -> PathBuf {
        self.path.join(RECORD)
    }

    /// Path of `diagnostics.csv`.
    pub fn diagnostics(&self) -> PathBuf {
        self.path.join("diagnostics.csv")
    }

    /// Path of `frames/`.
    pub fn frames(&self) -> PathBuf {
        self.path.join("frames")
    }

    /// Path of `particles.pvd`, which lists the frames by time for ParaView.
    pub fn time_series(&self) -> PathBuf {
        self.path.join("particles.pvd")
    }

    /// Path of `probes/`.
    pub fn probes(&self) -> PathBuf {
        self.path.join("probes")
    }

    /// Path of `checkpoints/`.
    pub fn checkpoints(&self) -> PathBuf {
        self.path.join(CHECKPOINTS)
    }

    /// Path of `checkpoints/film`, which collects the film's pictures. It stays when the run is done, so that a run that
    /// is extended has them all in its film.
    pub fn film_pictures(&self) -> PathBuf {
        self.checkpoints().join("film")
    }

    /// Path of `images/`.
    pub fn images(&self) -> PathBuf {
        self.path.join("images")
    }

    /// Path of `video.gif`.
    pub fn video(&self) -> PathBuf {
        self.path.join("video.gif")
    }

    /// Renames `video.gif`, whose pictures are lost, so that a film of later frames does not replace it. Returns the new
    /// path if there was a film.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn keep_old_video(&self, last_frame: u64) -> Result<Option<PathBuf>, OutputError> {
        let old = self.path.join(format!("{OLD_VIDEO}{last_frame:06}.gif"));
        match fs::rename(self.video(), &old) {
            Ok(()) => Ok(Some(old)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(OutputError::at(&old)(error)),
        }
    }

    fn meshes(&self) -> PathBuf {
        self.path.join("meshes")
    }
}

/// Refuses a run in which a folder of lahar's is a link: what lahar writes or removes there would be elsewhere.
fn refuse_links(run: &Path) -> Result<(), OutputError> {
    for OwnFolder { path, .. } in OWN_FOLDERS {
        confined(run, path).map_err(|what| OutputError::usage(run, what))?;
    }
    confined(run, "meshes").map_err(|what| OutputError::usage(run, what))?;
    Ok(())
}

/// Removes the files (and links) of `folder` that `is_own` names, if there is such a folder.
fn remove_files(folder: &Path, is_own: impl Fn(&str) -> bool) -> Result<(), OutputError> {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if !is_folder && entry.file_name().to_str().is_some_and(&is_own) {
            remove_file(&entry.path())?;
        }
    }
    Ok(())
}

/// Removes `meshes/MATERIAL.pvd` and `meshes/MATERIAL/000000.ply` and the like.
fn remove_meshes(folder: &Path) -> Result<(), OutputError> {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        // Links are not followed: their type is not that of a folder.
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            let is_mesh =
                |name: &str| (MeshFormat::ALL.iter()).any(|format| is_frame(name, format.ending()));
            remove_files(&entry.path(), is_mesh)?;
            remove_if_empty(&entry.path())?;
        }
    }
    remove_files(folder, |name| name.ends_with(".pvd"))?;
    remove_if_empty(folder)
}

fn remove_if_empty(folder: &Path) -> Result<(), OutputError> {
    match fs::remove_dir(folder) {
        Err(error)
            if ![ErrorKind::NotFound, ErrorKind::DirectoryNotEmpty].contains(&error.kind()) =>
        {
            Err(OutputError::at(folder)(error))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECORD_TEXT: &str =
        r#"{ "version": "0.1.0", "status": "done", "scene_name": "dust", "scene": {} }"#;

    /// A folder with a run in it, and with files of the user's own beside lahar's.
    fn run_with_notes(path: &Path) {
        for file in [
            "frames/000000.npz",
            "frames/000001.npz.partial",
            "images/000000.png",
            "meshes/water/000000.ply",
            "meshes/water.pvd",
            "plots/energy.svg",
            "plots/probe-P1.svg",
            "probes/P1.csv",
            "checkpoints/000010.checkpoint",
            "checkpoints/start.json",
            "checkpoints/film",
            "checkpoints/files/0.csv",
            "render/video.mp4",
            "report.html",
            "video.gif",
            "video-to-000010.gif",
        ]
        .iter()
        .chain(NOTES)
        {
            let file = path.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, "x").unwrap();
        }
        fs::write(path.join(RECORD), RECORD_TEXT).unwrap();
    }

    const NOTES: &[&str] = &[
        "notes.txt",
        "frames/best/000000.npz",
        "images/holiday.jpg",
        "plots/mine.svg",
        "meshes/water/fixed.ply",
        "checkpoints/thesis.tex",
    ];

    fn all_files(folder: &Path) -> Vec<String> {
        fn walk(root: &Path, folder: &Path, files: &mut Vec<String>) {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    walk(root, &path, files);
                } else {
                    let relative = path.strip_prefix(root).unwrap();
                    files.push(relative.to_str().unwrap().to_owned());
                }
            }
        }
        let mut files = Vec::new();
        walk(folder, folder, &mut files);
        files.sort();
        files
    }

    #[test]
    fn names_in_use_are_numbered() {
        let root = tempfile::tempdir().unwrap();
        let names: Vec<_> = (0..3)
            .map(|_| RunFolder::numbered(root.path(), "dam").unwrap().path)
            .collect();
        let out = root.path().join("out");
        assert_eq!(
            names,
            [out.join("dam"), out.join("dam-2"), out.join("dam-3")]
        );
        let odd = RunFolder::numbered(root.path(), "../../dam").unwrap();
        assert_eq!(odd.path().parent(), Some(out.as_path()));
    }

    #[test]
    fn overwriting_removes_only_what_lahar_wrote() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b");
        RunFolder::at(&path, false).unwrap();
        run_with_notes(&path);
        let error = RunFolder::at(&path, false).unwrap_err();
        assert!(error.usage && error.what.contains("resume") && error.what.contains("--overwrite"));
        RunFolder::at(&path, true).unwrap();
        let mut left: Vec<String> = NOTES.iter().map(|name| (*name).to_owned()).collect();
        left.push("checkpoints/lock".to_owned());
        left.sort();
        assert_eq!(all_files(&path), left);
        // No run any more, but not empty: refused, with or without --overwrite.
        assert!(RunFolder::at(&path, true).unwrap_err().usage);
    }

    #[test]
    fn a_folder_that_is_not_lahars_is_left_alone() {
        let root = tempfile::tempdir().unwrap();
        for text in ["{\"scripts\": {}}", "{}", "[1]", "no JSON", ""] {
            let path = root.path().join("project");
            fs::create_dir_all(path.join("images")).unwrap();
            fs::write(path.join("images/000000.png"), "x").unwrap();
            fs::write(path.join(RECORD), text).unwrap();
            let error = RunFolder::at(&path, true).unwrap_err();
            assert!(error.usage && error.what.contains("not lahar's"), "{error}");
            assert!(RunFolder::of_run(&path).unwrap_err().usage);
            assert_eq!(all_files(&path), ["images/000000.png", "run.json"]);
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_neither_emptied_nor_followed() {
        use std::os::unix::fs::symlink;
        for linked in ["checkpoints", "frames", "meshes", "checkpoints/files"] {
            let root = tempfile::tempdir().unwrap();
            let (path, thesis) = (root.path().join("run"), root.path().join("thesis"));
            fs::create_dir_all(&thesis).unwrap();
            for file in [
                "000000.npz",
                "000000.npz.partial",
                "000000.checkpoint",
                "0.csv",
            ] {
                fs::write(thesis.join(file), "precious").unwrap();
            }
            fs::create_dir_all(path.join("checkpoints")).unwrap();
            fs::write(path.join(RECORD), RECORD_TEXT).unwrap();
            if linked == CHECKPOINTS {
                fs::remove_dir(path.join(CHECKPOINTS)).unwrap();
            }
            symlink(&thesis, path.join(linked)).unwrap();
            for error in [
                RunFolder::at(&path, true).unwrap_err(),
                RunFolder::of_run(&path).unwrap_err(),
            ] {
                assert!(error.usage && error.what.contains("is a link"), "{error}");
            }
            assert_eq!(all_files(&thesis).len(), 4, "{linked}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_to_files_are_removed_and_their_targets_stay() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let (path, precious) = (root.path().join("run"), root.path().join("precious"));
        fs::write(&precious, "precious").unwrap();
        fs::create_dir_all(path.join("frames")).unwrap();
        fs::write(path.join(RECORD), RECORD_TEXT).unwrap();
        for link in ["diagnostics.csv", "frames/000000.npz"] {
            symlink(&precious, path.join(link)).unwrap();
        }
        RunFolder::at(&path, true).unwrap();
        assert_eq!(all_files(&path), ["checkpoints/lock"]);
        assert_eq!(fs::read(&precious).unwrap(), b"precious");
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
