//! A film as MP4, by an ffmpeg that is installed: pictures go to it one by one, as they are drawn.

use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::Picture;

/// The program that makes MP4.
const FFMPEG: &str = "ffmpeg";

/// A film that is being made.
pub struct Mp4 {
    child: Child,
    size: (u32, u32),
}

impl Mp4 {
    /// Whether there is an ffmpeg on the path, and the first line that it says of itself.
    pub fn available() -> Option<String> {
        let output = Command::new(FFMPEG)
            .arg("-version")
            .stdin(Stdio::null())
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&output.stdout);
        let line = text.lines().next()?;
        output.status.success().then(|| line.to_owned())
    }

    /// Begins the film at `path`, of `rate` pictures a second, all of the size of `first`, which is not yet in it.
    ///
    /// # Errors
    /// If ffmpeg does not start.
    pub fn start(path: &Path, rate: f64, first: &Picture) -> io::Result<Self> {
        let size = (first.width, first.height);
        let child = Command::new(FFMPEG)
            .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y"])
            .args(["-f", "rawvideo", "-pixel_format", "rgb24"])
            .args(["-video_size", &format!("{}x{}", size.0, size.1)])
            .args(["-framerate", &format!("{rate:?}"), "-i", "-"])
            // Players want both sides even and colours in half the resolution.
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
        Ok(Self { child, size })
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// If its size is another, or ffmpeg has ended; then [`Self::finish`] says why.
    pub fn push(&mut self, picture: &Picture) -> io::Result<()> {
        if (picture.width, picture.height) != self.size {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "pictures of a film have one size",
            ));
        }
        match &mut self.child.stdin {
            Some(pipe) => pipe.write_all(&picture.rgb),
            None => Ok(()),
        }
    }

    /// Ends the film and waits until it is written.
    ///
    /// # Errors
    /// What ffmpeg says.
    pub fn finish(mut self) -> io::Result<()> {
        drop(self.child.stdin.take());
        let mut said = String::new();
        if let Some(errors) = &mut self.child.stderr {
            errors.read_to_string(&mut said)?;
        }
        match self.child.wait()?.success() {
            true => Ok(()),
            false => Err(io::Error::other(format!("ffmpeg: {}", said.trim()))),
        }
    }
}
