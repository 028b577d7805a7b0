//! A writer that reports only its first error.

use std::io::{self, Seek, SeekFrom, Write};

/// Passes bytes on to a writer until that fails. From then on it accepts and drops everything, and reports positions
/// as if it had been written.
///
/// The zip writer ends its archive when it is dropped, and prints if that fails. A library must not print, and the
/// first error has been reported already.
pub(crate) struct AfterError<W> {
    inner: W,
    failed: bool,
    /// The position of the next byte.
    position: u64,
}

impl<W> AfterError<W> {
    pub(crate) fn new(inner: W) -> Self {
        Self {
            inner,
            failed: false,
            position: 0,
        }
    }

    pub(crate) fn into_inner(self) -> W {
        self.inner
    }

    fn until_it_fails<R>(
        &mut self,
        afterwards: R,
        act: impl FnOnce(&mut W) -> io::Result<R>,
    ) -> io::Result<R> {
        if self.failed {
            return Ok(afterwards);
        }
        let result = act(&mut self.inner);
        self.failed = result
            .as_ref()
            .is_err_and(|error| error.kind() != io::ErrorKind::Interrupted);
        result
    }
}

impl<W: Write> Write for AfterError<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.until_it_fails(bytes.len(), |inner| match inner.write(bytes)? {
            0 if !bytes.is_empty() => Err(io::ErrorKind::WriteZero.into()),
            count => Ok(count),
        })?;
        self.position += count as u64;
        Ok(count)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.until_it_fails((), W::flush)
    }
}

impl<W: Seek> Seek for AfterError<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(place) => place,
            SeekFrom::Current(by) | SeekFrom::End(by) => self.position.saturating_add_signed(by),
        };
        self.position = self.until_it_fails(place, |inner| inner.seek(to))?;
        Ok(self.position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zip_archive_that_has_no_room_ends_in_silence() {
        let options = zip::write::SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored);
        for room in [0, 10, 40, 100, 900, 1100, 1190] {
            let mut bytes = vec![0; room];
            let writer = AfterError::new(io::Cursor::new(&mut bytes[..]));
            let mut archive = zip::ZipWriter::new(writer);
            let begun = archive.start_file("a", options);
            let written = begun
                .map_err(io::Error::other)
                .and_then(|()| archive.write_all(&[7; 1000]))
                .and_then(|()| archive.start_file("b", options).map_err(io::Error::other))
                .and_then(|()| archive.write_all(&[8; 1000]));
            assert!(written.is_err(), "{room} bytes hold no 2000");
            // The zip writer would print this error when it is dropped.
            archive.finish().unwrap();
        }
    }

    #[test]
    fn the_first_error_is_told_and_then_silence() {
        let mut room = [0; 4];
        let mut writer = AfterError::new(io::Cursor::new(&mut room[..]));
        writer.write_all(b"abc").unwrap();
        assert!(writer.write_all(b"defg").is_err());
        writer.write_all(b"h").unwrap();
        writer.seek(SeekFrom::Start(1)).unwrap();
        writer.flush().unwrap();
        assert_eq!(&room, b"abcd");
    }
}
