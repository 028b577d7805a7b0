//! Films as MP4 (H.264), made by an installed ffmpeg, or by an encoder inside this program (feature `mp4`).

mod ffmpeg;
#[cfg(feature = "mp4")]
mod openh264;

use std::fmt;
use std::io;
use std::path::Path;

use super::Picture;
use crate::files::remove_file_io;
use ffmpeg::Ffmpeg;

/// A program or library that makes MP4.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mp4Maker {
    /// An installed ffmpeg, with the first line of its version.
    Ffmpeg(String),
    /// The encoder in this program, for pictures up to 3840 × 2160 pixels.
    #[cfg(feature = "mp4")]
    OpenH264,
}

impl fmt::Display for Mp4Maker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ffmpeg(version) => f.write_str(version),
            #[cfg(feature = "mp4")]
            Self::OpenH264 => f.write_str("lahar with OpenH264"),
        }
    }
}

impl Mp4Maker {
    /// Returns a maker that exists on this machine: ffmpeg if possible, since its files are smaller.
    pub fn find() -> Option<Self> {
        let installed = Ffmpeg::version().map(Self::Ffmpeg);
        #[cfg(feature = "mp4")]
        let installed = installed.or(Some(Self::OpenH264));
        installed
    }

    /// Begins a film at `path` of `rate` pictures per second, all of the size of `first`. The film does not contain `first`
    /// until it is pushed. A file that was there is removed.
    ///
    /// # Errors
    /// If the file cannot be written, or ffmpeg does not start.
    pub fn start(&self, path: &Path, rate: f64, first: &Picture) -> io::Result<Mp4> {
        // Encoders would write through a link, so the old file is removed first.
        remove_file_io(path)?;
        let encoder = match self {
            Self::Ffmpeg(_) => Encoder::Ffmpeg(Ffmpeg::start(path, rate, first)?),
            #[cfg(feature = "mp4")]
            Self::OpenH264 => {
                Encoder::OpenH264(Box::new(openh264::OpenH264::start(path, rate, first)?))
            }
        };
        Ok(Mp4 {
            encoder,
            size: (first.width, first.height),
        })
    }
}

/// An MP4 film that is being made.
pub struct Mp4 {
    encoder: Encoder,
    size: (u32, u32),
}

enum Encoder {
    Ffmpeg(Ffmpeg),
    #[cfg(feature = "mp4")]
    OpenH264(Box<openh264::OpenH264>),
}

impl Mp4 {
    /// Adds a picture.
    ///
    /// # Errors
    /// If its size differs, or the encoder has failed; then [`Self::finish`] returns the reason.
    pub fn push(&mut self, picture: &Picture) -> io::Result<()> {
        if (picture.width, picture.height) != self.size {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "pictures of a film have one size",
            ));
        }
        match &mut self.encoder {
            Encoder::Ffmpeg(ffmpeg) => ffmpeg.push(picture),
            #[cfg(feature = "mp4")]
            Encoder::OpenH264(encoder) => encoder.push(picture),
        }
    }

    /// Ends the film and waits until it is written.
    ///
    /// # Errors
    /// If the encoder fails, with its message.
    pub fn finish(self) -> io::Result<()> {
        match self.encoder {
            Encoder::Ffmpeg(ffmpeg) => ffmpeg.finish(),
            #[cfg(feature = "mp4")]
            Encoder::OpenH264(encoder) => encoder.finish(),
        }
    }
}
