//! Saves the window as a PNG file (F12).

use std::fs::OpenOptions;
use std::io::{BufWriter, ErrorKind};
use std::path::{Path, PathBuf};

use eframe::egui::ColorImage;
use lahar_io::image::Picture;

/// Writes the picture under the first free name `lahar-SCENE-000.png`, …, and returns its path.
///
/// # Errors
/// A sentence with the path.
pub(crate) fn save(folder: &Path, scene: &str, image: &ColorImage) -> Result<PathBuf, String> {
    let stem: String = Path::new(scene)
        .file_stem()
        .map_or_else(|| "scene".into(), |stem| stem.to_string_lossy())
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || c == '-' {
                c
            } else {
                '_'
            }
        })
        .collect();
    for number in 0..1000 {
        let path = folder.join(format!("lahar-{stem}-{number:03}.png"));
        let why =
            |error: &dyn std::fmt::Display| format!("cannot write {}: {error}", path.display());
        // A file that exists is left alone.
        let file = match OpenOptions::new().write(true).create_new(true).open(&path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
            Err(error) => return Err(why(&error)),
            Ok(file) => file,
        };
        let picture = Picture {
            width: image.size[0] as u32,
            height: image.size[1] as u32,
            rgb: (image.pixels.iter())
                .flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()])
                .collect(),
        };
        picture
            .write_png(BufWriter::new(file))
            .map_err(|error| why(&error))?;
        return Ok(std::path::absolute(&path).unwrap_or(path));
    }
    Err(format!(
        "{} is full of lahar-{stem}-*.png",
        folder.display()
    ))
}
