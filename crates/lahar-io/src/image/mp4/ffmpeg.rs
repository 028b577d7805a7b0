//! MP4 by an ffmpeg that is installed: pictures go to its standard input one by one.

use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::super::Picture;

/// The program that makes MP4.
const FFMPEG: &str = "ffmpeg";

/// A running ffmpeg.
pub(super) struct Ffmpeg(Child);

impl Ffmpeg {
    /// Whether there is an ffmpeg on the path, and the first line that it says of itself.
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
            // Players want both sides even and colors in half the resolution.
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

    /// # Errors
    /// If ffmpeg has ended; then [`Self::finish`] says why.
    pub(super) fn push(&mut self, picture: &Picture) -> io::Result<()> {
        match &mut self.0.stdin {
            Some(pipe) => pipe.write_all(&picture.rgb),
            None => Ok(()),
        }
    }

    /// # Errors
    /// What ffmpeg says.
    pub(super) fn finish(mut self) -> io::Result<()> {
        drop(self.0.stdin.take());
        let mut said = String::new();
        if let Some(errors) = &mut self.0.stderr {
            errors.read_to_string(&mut said)?;
        }
        match self.0.wait()?.success() {
            true => Ok(()),
            false => Err(io::Error::other(format!("ffmpeg: {}", said.trim()))),
        }
    }
}

impl Drop for Ffmpeg {
    /// A film that nobody finishes is not written on.
    fn drop(&mut self) {
        // Both fail where it has ended, which is as well.
        drop(self.0.kill());
        drop(self.0.wait());
    }
}
