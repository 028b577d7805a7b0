//! MP4 made by an installed ffmpeg: pictures go to its standard input one by one.

use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::super::Picture;

/// Name of the program.
const FFMPEG: &str = "ffmpeg";

/// A running ffmpeg.
pub(super) struct Ffmpeg(Child);

impl Ffmpeg {
    /// Returns the first line of the version of an installed ffmpeg.
    pub(super) fn version() -> Option<String> {
        let output = Command::new(FFMPEG)
            .arg("-version")
            .stdin(Stdio::null())
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&output.stdout);
        let line = text.lines().next()?;
        output.status.success().then(|| line.to_owned())
    }

    pub(super) fn start(path: &Path, rate: f64, first: &Picture) -> io::Result<Self> {
        let child = Command::new(FFMPEG)
            .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y"])
            .args(["-f", "rawvideo", "-pixel_format", "rgb24"])
            .args(["-video_size", &format!("{}x{}", first.width, first.height)])
            .args(["-framerate", &format!("{rate:?}"), "-i", "-"])
            // Players need even sides, and colors in half the resolution.
            .args([
                "-vf",
                "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                "-pix_fmt",
                "yuv420p",
            ])
            .args(["-movflags", "+faststart", "-f", "mp4"])
            .arg(path)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()?;
        Ok(Self(child))
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// If ffmpeg has ended; then [`Self::finish`] returns the reason.
    pub(super) fn push(&mut self, picture: &Picture) -> io::Result<()> {
        match &mut self.0.stdin {
            Some(pipe) => pipe.write_all(&picture.rgb),
            None => Ok(()),
        }
    }

    /// Ends the film.
    ///
    /// # Errors
    /// If ffmpeg fails, with its message.
    pub(super) fn finish(mut self) -> io::Result<()> {
        drop(self.0.stdin.take());
        let mut message = String::new();
        if let Some(errors) = &mut self.0.stderr {
            errors.read_to_string(&mut message)?;
        }
        match self.0.wait()?.success() {
            true => Ok(()),
            false => Err(io::Error::other(format!("ffmpeg: {}", message.trim()))),
        }
    }
}

impl Drop for Ffmpeg {
    /// Stops ffmpeg if the film is not finished.
    fn drop(&mut self) {
        // Both fail if it has ended already, which does no harm.
        drop(self.0.kill());
        drop(self.0.wait());
    }
}
