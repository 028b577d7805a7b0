//! Files that a scene is, or names. Only plain files are read, and no more of them than is allowed:
//! a device or a pipe would never end.

use crate::builtin;
use crate::error::{SceneError, nearest};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The copy of a file that a scene names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptFile {
    /// As the scene names it.
    pub name: String,
    /// Whether it was looked for where the command was given, not beside the scene.
    pub here: bool,
    /// The copy's name in `checkpoints/files/`.
    pub copy: String,
    /// Its length.
    pub bytes: u64,
    /// CRC-32 of its bytes.
    pub crc32: u32,
}

/// Largest scene file \[bytes\]: beyond it, it is something else.
const LARGEST_SCENE: u64 = 16 << 20;

/// The text of a scene file, or why there is none.
pub(crate) fn read_text(path: &str) -> Result<String, SceneError> {
    let fail = |message: &str| SceneError::of_file(path, message);
    if path.is_empty() {
        return Err(
            fail("the name of the scene is empty").hint("`lahar list` names the built-in scenes")
        );
    }
    let info = match std::fs::metadata(path) {
        Ok(info) => info,
        Err(error) => {
            let error = fail(&format!(
                "this is neither a built-in scene nor a file: {}",
                io_words(&error)
            ));
            let names = builtin::list().iter().map(|scene| scene.name);
            return Err(match nearest(path, names) {
                Some(near) => error.hint(format!("did you mean \"{near}\"?")),
                None => error.hint("`lahar list` names the built-in scenes"),
            });
        }
    };
    if info.is_dir() {
        return Err(fail("this is a folder, not a scene file").hint("name the .toml file in it"));
    }
    let bytes = read_plain(Path::new(path), LARGEST_SCENE).map_err(|reason| fail(&reason))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        not_text(path, error.as_bytes(), at).hint("a scene is a TOML text file")
    })?;
    // Some editors begin a file with a mark of its byte order.
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

/// An error at the first byte that is no text, number `at`.
pub(crate) fn not_text(path: &str, bytes: &[u8], at: usize) -> SceneError {
    /// Bytes shown after it.
    const AFTER: usize = 100;
    let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(at + AFTER)]);
    let message = format!("this is not a text file: byte {at} is no UTF-8");
    SceneError::at(path, &shown, at, at + 1, message)
}

/// Where the files that a scene names are.
pub(crate) enum Place<'a> {
    /// Beside the scene's own.
    Folder(&'a Path),
    /// In the program.
    Embedded(&'static [(&'static str, &'static str)]),
    /// Copies that a run has made, in this folder.
    Kept(&'a [KeptFile], &'a Path),
}

/// The files that a scene names, and which of them it has asked for.
pub(crate) struct Files<'a> {
    place: Place<'a>,
    used: RefCell<Vec<SceneFile>>,
}

/// A file that a scene was made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFile {
    /// As the scene names it.
    pub name: String,
    /// Whether it was looked for where the command was given, not beside the scene.
    pub here: bool,
    source: FileSource,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum FileSource {
    Path(PathBuf),
    Embedded(&'static str),
}

impl SceneFile {
    /// Its bytes.
    ///
    /// # Errors
    /// If it can no longer be opened.
    pub fn open(&self) -> std::io::Result<Box<dyn Read>> {
        Ok(match &self.source {
            FileSource::Path(path) => Box::new(File::open(path)?),
            FileSource::Embedded(text) => Box::new(text.as_bytes()),
        })
    }
}

impl<'a> Files<'a> {
    pub(crate) fn new(place: Place<'a>) -> Self {
        Self {
            place,
            used: RefCell::default(),
        }
    }

    /// The files that were asked for.
    pub(crate) fn used(&self) -> Vec<SceneFile> {
        self.used.borrow().clone()
    }

    /// Where a file is; `here`: not beside the scene, but where the command was given.
    fn find(&self, name: &str, here: bool) -> Result<FileSource, String> {
        let source = match self.place {
            Place::Kept(files, folder) => {
                let is_it = |file: &&KeptFile| file.name == name && file.here == here;
                match files.iter().find(is_it) {
                    Some(file) => FileSource::Path(folder.join(&file.copy)),
                    None => return Err("the run has kept no copy of it".to_owned()),
                }
            }
            _ if here => FileSource::Path(PathBuf::from(name)),
            Place::Folder(folder) => FileSource::Path(folder.join(name)),
            Place::Embedded(files) => match files.iter().find(|(file, _)| *file == name) {
                Some((_, text)) => FileSource::Embedded(text),
                None => return Err("built-in scenes have no such file".to_owned()),
            },
        };
        let file = SceneFile {
            name: name.to_owned(),
            here,
            source: source.clone(),
        };
        let mut used = self.used.borrow_mut();
        if !used.contains(&file) {
            used.push(file);
        }
        Ok(source)
    }

    /// The content of a file of at most `limit` bytes, or why there is none.
    pub(crate) fn bytes(&self, name: &str, here: bool, limit: u64) -> Result<Vec<u8>, String> {
        match self.find(name, here)? {
            FileSource::Path(path) => read_plain(&path, limit),
            FileSource::Embedded(text) => Ok(text.as_bytes().to_vec()),
        }
    }

    /// Its path, if it is there.
    pub(crate) fn path(&self, name: &str, here: bool) -> Result<PathBuf, String> {
        match self.find(name, here)? {
            FileSource::Path(path) => {
                check_plain(&path)?;
                Ok(path)
            }
            FileSource::Embedded(_) => Err("built-in scenes have no such file".to_owned()),
        }
    }
}

/// Whether there is a plain file, or why not; its length.
fn check_plain(path: &Path) -> Result<u64, String> {
    let info = std::fs::metadata(path).map_err(|error| io_words(&error))?;
    if info.is_file() {
        Ok(info.len())
    } else if info.is_dir() {
        Err("it is a folder".to_owned())
    } else {
        Err("it is a device or a pipe, not a file".to_owned())
    }
}

/// All of a plain file, if it has no more than `limit` bytes.
fn read_plain(path: &Path, limit: u64) -> Result<Vec<u8>, String> {
    let too_large = |length: u64| {
        Err(format!(
            "it has {} MB or more, {} are read at the most",
            length >> 20,
            limit >> 20
        ))
    };
    let length = check_plain(path)?;
    if length > limit {
        return too_large(length);
    }
    let file = File::open(path).map_err(|error| io_words(&error))?;
    let mut bytes = Vec::with_capacity(length as usize);
    // It may have grown meanwhile, or be one of those that never say how long they are.
    file.take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| io_words(&error))?;
    if bytes.len() as u64 > limit {
        return too_large(limit);
    }
    Ok(bytes)
}

/// What the system says, without its number.
fn io_words(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "no permission to read it".to_owned(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        kind => kind.to_string(),
    }
}
