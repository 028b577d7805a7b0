//! Paths that stay in one folder: no way up, no links.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use super::OutputError;

/// Returns true if `path` is a symbolic link, whether or not its target exists.
pub fn is_link(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|info| info.is_symlink())
}

/// Returns `root` joined with `relative`, a path that a file of the run names.
///
/// # Errors
/// A sentence about `relative`, if it is absolute, leads out of `root`, or passes through a link below `root`.
pub fn confined(root: &Path, relative: &str) -> Result<PathBuf, String> {
    let mut path = root.to_owned();
    for component in Path::new(relative).components() {
        let Component::Normal(name) = component else {
            return Err(format!("\"{relative}\" leads out of the run's folder"));
        };
        path.push(name);
        if is_link(&path) {
            return Err(link_message(&path));
        }
    }
    Ok(path)
}

/// Makes the folder `path` if there is none. Its parents may be links, the folder itself may not.
///
/// # Errors
/// If it cannot be made, or is a link or a file.
pub fn make_folder(path: &Path) -> Result<(), OutputError> {
    refuse_link(path)?;
    fs::create_dir_all(path).map_err(OutputError::at(path))
}

/// Makes the folder for a command's files: the one that the user named, which may be a link, or else `default`, a folder
/// inside of a run, which may not.
///
/// # Errors
/// If it cannot be made, or is a link inside of a run.
pub fn output_folder(named: Option<&Path>, default: PathBuf) -> Result<PathBuf, OutputError> {
    match named {
        Some(folder) => {
            fs::create_dir_all(folder).map_err(OutputError::at(folder))?;
            Ok(folder.to_owned())
        }
        None => {
            make_folder(&default)?;
            Ok(default)
        }
    }
}

/// Refuses a link in the place of a folder or of a file that is kept.
///
/// # Errors
/// If `path` is a link.
pub(super) fn refuse_link(path: &Path) -> Result<(), OutputError> {
    match is_link(path) {
        true => Err(OutputError::usage(path, LINK)),
        false => Ok(()),
    }
}

const LINK: &str =
    "is a link, and links in a run's folder are not followed; put the file or folder itself there";

fn link_message(path: &Path) -> String {
    format!("{} {LINK}", path.display())
}

/// Like [`refuse_link`], as an I/O error.
pub(super) fn refuse_link_io(path: &Path) -> io::Result<()> {
    match is_link(path) {
        true => Err(io::Error::new(io::ErrorKind::InvalidInput, LINK)),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_lead_out_are_refused() {
        let root = tempfile::tempdir().unwrap();
        let inside = confined(root.path(), "frames/000000.npz").unwrap();
        assert_eq!(inside, root.path().join("frames/000000.npz"));
        for out in ["../x", "/etc/passwd", "frames/../../x"] {
            let why = confined(root.path(), out).unwrap_err();
            assert!(why.contains("out of the run's folder"), "{why}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_refused() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let elsewhere = tempfile::tempdir().unwrap();
        symlink(elsewhere.path(), root.path().join("frames")).unwrap();
        let why = confined(root.path(), "frames/x").unwrap_err();
        assert!(why.contains("frames is a link"), "{why}");
        let error = make_folder(&root.path().join("frames")).unwrap_err();
        assert!(error.usage && error.what.contains("is a link"), "{error}");
        // A folder that the user names may be a link, or be reached through links.
        make_folder(&root.path().join("frames/below")).unwrap();
        assert!(elsewhere.path().join("below").is_dir());
        let named = root.path().join("frames");
        assert_eq!(
            output_folder(Some(&named), PathBuf::new()).as_ref(),
            Ok(&named)
        );
        assert!(output_folder(None, named).is_err());
    }
}
