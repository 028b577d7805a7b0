//! A picture: pixels in memory, and PNG files.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use crate::files::{Durability, write_whole_io};

/// A picture in sRGB, rows from the top.
///
/// ```
/// use lahar_io::image::Picture;
///
/// let picture = Picture { width: 2, height: 1, rgb: vec![255, 0, 0, 0, 0, 255] };
/// let mut png = Vec::new();
/// picture.write_png(&mut png)?;
/// assert!(png.starts_with(b"\x89PNG"));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width of the picture \[pixels\].
    pub width: u32,
    /// Height of the picture \[pixels\].
    pub height: u32,
    /// Red, green and blue of each pixel, row after row.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write_png(&self, writer: impl Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(writer, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        Ok(writer.finish()?)
    }

    /// Reads a PNG file that [`Self::write_png`] has written.
    ///
    /// # Errors
    /// If the file cannot be read, or is not a PNG with three channels of eight bits.
    pub fn load_png(path: impl AsRef<Path>) -> io::Result<Self> {
        let decoder = png::Decoder::new(io::BufReader::new(File::open(path)?));
        let mut reader = decoder.read_info()?;
        let (width, height) = reader.info().size();
        let is_rgb = reader.output_color_type() == (png::ColorType::Rgb, png::BitDepth::Eight);
        let bytes = reader.output_buffer_size().filter(|_| is_rgb);
        let Some(bytes) = bytes else {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "not a PNG with three channels of eight bits",
            ));
        };
        let mut rgb = vec![0; bytes];
        reader.next_frame(&mut rgb)?;
        Ok(Self { width, height, rgb })
    }

    /// Writes the picture to the PNG file `path`, whole or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save_png(&self, path: impl AsRef<Path>) -> io::Result<()> {
        write_whole_io(path.as_ref(), Durability::Eventual, |mut writer| {
            self.write_png(&mut writer)?;
            Ok(writer)
        })
    }
}
