//! `checkpoints/start.json`: the start of a run, so that it can begin or be resumed without the scene's own files.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::files::{Durability, OutputError, confined, make_folder, sync_folder, write_whole};
use lahar_scene::error::SceneError;
use lahar_scene::scene::{KeptFile, Limits, Scene};

/// The start of a run: scene, files, instruction set and outputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Version of the program.
    pub lahar: String,
    /// Name of the scene: of a built-in scene, or of its file.
    pub scene: String,
    /// Text of the scene file.
    pub text: String,
    /// Keys and values that were laid over the scene.
    pub set: Vec<(String, String)>,
    /// Copies of the files that the scene names.
    pub files: Vec<KeptFile>,
    /// Name of the instruction set in use.
    pub isa: String,
    /// Number of frames after the one at the start.
    pub frames: u64,
    /// Outputs of the run, in the caller's own form.
    pub outputs: serde_json::Value,
    /// Warnings about the scene.
    pub warnings: Vec<String>,
}

const NAME: &str = "start.json";
const FILES: &str = "files";

impl Start {
    /// Returns true if `folder` (`DIR/checkpoints`) holds the start of a run.
    pub fn is_in(folder: &Path) -> bool {
        Self::read(folder).is_ok()
    }

    /// Copies the files of `scene` to `folder`, writes `start.json` there, and waits until all is on the disk.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn write(&mut self, scene: &Scene, folder: &Path) -> Result<(), OutputError> {
        let files = folder.join(FILES);
        self.files.clear();
        for (index, file) in scene.files.iter().enumerate() {
            make_folder(&files)?;
            let ending = Path::new(&file.name).extension().unwrap_or_default();
            let copy = Path::new(&index.to_string()).with_extension(ending);
            let path = files.join(&copy);
            let mut sum = Summed::default();
            write_whole(&path, Durability::Immediate, |mut writer| {
                let mut from = file.open()?;
                io::copy(&mut from, &mut Both(&mut writer, &mut sum))?;
                Ok(writer)
            })?;
            self.files.push(KeptFile {
                name: file.name.clone(),
                here: file.here,
                copy: copy.to_string_lossy().into_owned(),
                bytes: sum.bytes,
                crc32: sum.crc.finalize(),
            });
        }
        if !self.files.is_empty() {
            sync_folder(&files)?;
        }
        self.rewrite(folder)
    }

    /// Writes `start.json` alone to `folder` (`DIR/checkpoints`).
    ///
    /// # Errors
    /// If it cannot be written; the old file stays.
    pub fn rewrite(&self, folder: &Path) -> Result<(), OutputError> {
        write_whole(&folder.join(NAME), Durability::Immediate, |mut writer| {
            writer.write_all(&self.text()?)?;
            Ok(writer)
        })?;
        sync_folder(folder)
    }

    fn text(&self) -> io::Result<Vec<u8>> {
        let mut text = serde_json::to_vec_pretty(self)?;
        text.push(b'\n');
        Ok(text)
    }

    /// Returns a checksum that ties checkpoints to this run. The number of frames is no part of it, so that a run can be
    /// extended.
    pub fn sum(&self) -> u32 {
        let any_length = Self {
            frames: 0,
            ..self.clone()
        };
        any_length.text().map_or(0, |text| crc32fast::hash(&text))
    }

    /// Reads the start of the run in `folder` (`DIR/checkpoints`).
    ///
    /// # Errors
    /// If it is missing or damaged.
    pub fn read(folder: &Path) -> Result<Self, OutputError> {
        let path = confined(folder, NAME).map_err(|what| OutputError::usage(folder, what))?;
        let text = fs::read(&path)
            .map_err(|error| OutputError::usage(&path, format!("cannot be read: {error}")))?;
        serde_json::from_slice(&text)
            .map_err(|error| OutputError::usage(&path, format!("it is damaged: {error}")))
    }

    /// Builds the scene from this value and the copies in `folder` alone.
    ///
    /// # Errors
    /// If a copy was altered, or this program cannot read the scene.
    pub fn scene(&self, folder: &Path) -> Result<Scene, StartError> {
        let files = folder.join(FILES);
        for kept in &self.files {
            let path = confined(&files, &kept.copy)
                .map_err(|what| StartError::File(OutputError::usage(&files, what)))?;
            let mut sum = Summed::default();
            let read = File::open(&path).and_then(|mut file| io::copy(&mut file, &mut sum));
            let what = match read {
                Err(error) => format!("cannot be read: {error}"),
                Ok(_) if (sum.bytes, sum.crc.clone().finalize()) != (kept.bytes, kept.crc32) => {
                    format!("it was altered since it was copied from {}", kept.name)
                }
                Ok(_) => continue,
            };
            return Err(StartError::File(OutputError::usage(&path, what)));
        }
        let limits = Limits::default();
        Scene::kept(
            &self.scene,
            &self.text,
            &self.set,
            &limits,
            (&self.files, &files),
        )
        .map_err(|error| StartError::Scene(Box::new(error)))
    }
}

/// An error about the scene of a run.
#[derive(Debug)]
pub enum StartError {
    /// A copy of a file is missing or was altered.
    File(OutputError),
    /// This program cannot read the scene.
    Scene(Box<SceneError>),
}

/// A writer that counts bytes and computes their checksum.
#[derive(Clone, Default)]
struct Summed {
    bytes: u64,
    crc: crc32fast::Hasher,
}

impl Write for Summed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.crc.update(bytes);
        self.bytes += bytes.len() as u64;
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A writer that passes bytes on to the first writer and to the checksum.
struct Both<'a, W>(&'a mut W, &'a mut Summed);

impl<W: Write> Write for Both<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write_all(bytes)?;
        self.1.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
