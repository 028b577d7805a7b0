//! The scene file, and the files that it names.
//!
//! [`SceneFiles`] says where named files are: beside the scene, in the program, in the copies that a run has
//! kept, or in memory, where there is no file system. Only plain files are read, and no more of them than
//! the limit: a device or a pipe would never end.

use super::limits::Limits;
use crate::builtin;
use crate::error::{SceneError, nearest};
use crate::text::not_text;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The copy that a run keeps of a file named by its scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptFile {
    /// The name as the scene writes it.
    pub name: String,
    /// True if the file was named on the command line, and so was found from the working folder.
    pub here: bool,
    /// Name of the copy in `checkpoints/files/`.
    pub copy: String,
    /// Length of the copy \[bytes\].
    pub bytes: u64,
    /// CRC-32 of its bytes.
    pub crc32: u32,
}

/// Finds the files that a scene names: meshes and particle lists.
///
/// ```
/// use lahar_scene::scene::{FileSource, Limits, Scene, SceneFiles};
///
/// /// Two particles, without a file system.
/// struct InMemory;
///
/// impl SceneFiles for InMemory {
///     fn find(&self, name: &str, _: bool) -> Result<FileSource, String> {
///         match name {
///             "two.csv" => Ok(FileSource::Bytes(b"x,y,volume\n0.5,0.5,1e-3\n0.6,0.5,1e-3\n"[..].into())),
///             _ => Err("there is no such file".to_owned()),
///         }
///     }
/// }
///
/// let text = r#"
///     dx = 0.1
///     materials.jelly = { preset = "jelly" }
///     bodies = [{ material = "jelly", particles = "two.csv" }]
/// "#;
/// let scene = Scene::parse_with(text, "two.toml", &[], &Limits::default(), &InMemory)?;
/// assert_eq!(scene.expected_particles(), 2.0);
/// # Ok::<(), lahar_scene::error::SceneError>(())
/// ```
pub trait SceneFiles {
    /// Finds the file that the scene calls `name`. `here` is true if the name comes from the command line,
    /// and so is relative to the working folder and not to the scene's.
    ///
    /// # Errors
    /// The reason why there is no such file, as part of a sentence: "there is no such file".
    fn find(&self, name: &str, here: bool) -> Result<FileSource, String>;
}

/// The place of a file's content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileSource {
    /// A file of the file system. It need not exist.
    Path(PathBuf),
    /// The content itself.
    Bytes(Arc<[u8]>),
}

/// Files of the file system, found from a folder: the scene's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FolderFiles(pub PathBuf);

impl SceneFiles for FolderFiles {
    fn find(&self, name: &str, here: bool) -> Result<FileSource, String> {
        Ok(FileSource::Path(if here {
            PathBuf::from(name)
        } else {
            self.0.join(name)
        }))
    }
}

/// The files of a built-in scene, by name.
pub(super) struct EmbeddedFiles(pub(super) &'static [(&'static str, &'static str)]);

impl SceneFiles for EmbeddedFiles {
    fn find(&self, name: &str, here: bool) -> Result<FileSource, String> {
        if here {
            return Ok(FileSource::Path(PathBuf::from(name)));
        }
        match self.0.iter().find(|(file, _)| *file == name) {
            Some((_, text)) => Ok(FileSource::Bytes(text.as_bytes().into())),
            None => Err("built-in scenes have no such file".to_owned()),
        }
    }
}

/// The copies that a run has kept in a folder.
pub(super) struct KeptFiles<'a> {
    pub(super) files: &'a [KeptFile],
    pub(super) folder: &'a Path,
}

impl SceneFiles for KeptFiles<'_> {
    fn find(&self, name: &str, here: bool) -> Result<FileSource, String> {
        let mut files = self.files.iter();
        match files.find(|file| file.name == name && file.here == here) {
            Some(file) => Ok(FileSource::Path(self.folder.join(&file.copy))),
            None => Err("the run has kept no copy of it".to_owned()),
        }
    }
}

/// A file that a scene was made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFile {
    /// The name as the scene writes it.
    pub name: String,
    /// True if the file was named on the command line, and so was found from the working folder.
    pub here: bool,
    source: FileSource,
}

impl SceneFile {
    /// Opens the file to read its bytes.
    ///
    /// # Errors
    /// If it can no longer be opened.
    pub fn open(&self) -> std::io::Result<Box<dyn Read>> {
        Ok(match &self.source {
            FileSource::Path(path) => Box::new(File::open(path)?),
            FileSource::Bytes(bytes) => Box::new(Cursor::new(Arc::clone(bytes))),
        })
    }
}

/// The content of an open file, from which archives read here and there.
pub(crate) trait ReadSeek: Read + Seek {}

impl<T: Read + Seek> ReadSeek for T {}

/// An open file, with the name that messages give it.
pub(crate) struct OpenFile {
    pub(crate) name: String,
    pub(crate) content: Box<dyn ReadSeek>,
}

/// The files of a scene that is being read: where they are, how large they may be, and which were asked for.
pub(crate) struct Files<'a> {
    source: &'a dyn SceneFiles,
    limits: &'a Limits,
    used: RefCell<Vec<SceneFile>>,
}

impl<'a> Files<'a> {
    pub(crate) fn new(source: &'a dyn SceneFiles, limits: &'a Limits) -> Self {
        Self {
            source,
            limits,
            used: RefCell::default(),
        }
    }

    pub(crate) fn limits(&self) -> &'a Limits {
        self.limits
    }

    /// Returns the files that were asked for.
    pub(crate) fn used(&self) -> Vec<SceneFile> {
        self.used.borrow().clone()
    }

    fn find(&self, name: &str, here: bool) -> Result<FileSource, String> {
        let source = self.source.find(name, here)?;
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

    /// Returns the content of a file of at most `limit` bytes, or the reason why there is none.
    pub(crate) fn bytes(&self, name: &str, here: bool, limit: u64) -> Result<Vec<u8>, String> {
        match self.find(name, here)? {
            FileSource::Path(path) => read_plain(&path, limit),
            FileSource::Bytes(bytes) => Ok(bytes.to_vec()),
        }
    }

    /// Opens a file, or returns the reason why there is none.
    pub(crate) fn open(&self, name: &str, here: bool) -> Result<OpenFile, String> {
        Ok(match self.find(name, here)? {
            FileSource::Path(path) => {
                check_plain(&path)?;
                OpenFile {
                    name: path.display().to_string(),
                    content: Box::new(File::open(&path).map_err(|error| io_words(&error))?),
                }
            }
            FileSource::Bytes(bytes) => OpenFile {
                name: name.to_owned(),
                content: Box::new(Cursor::new(bytes)),
            },
        })
    }
}

/// Largest scene file \[bytes\]. A larger one is not a scene.
const LARGEST_SCENE: u64 = 16 << 20;

/// Reads the text of a scene file.
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

/// Returns the length of a plain file, or the reason why it cannot be read.
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

/// Reads all of a plain file that has no more than `limit` bytes.
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
    // The file may have grown since its length was read, or never say how long it is.
    file.take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| io_words(&error))?;
    if bytes.len() as u64 > limit {
        return too_large(limit);
    }
    Ok(bytes)
}

/// Returns the message of the system without its number.
fn io_words(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "no permission to read it".to_owned(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        kind => kind.to_string(),
    }
}
