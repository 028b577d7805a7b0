//! A writer whose first error is its last.

use std::io::{self, Seek, SeekFrom, Write};

/// Passes on what is written until that fails; from then on it takes everything and drops it. The zip writer ends
/// its archive when it is dropped, and prints if it cannot: a library does not print, and the error that is worth
/// telling was told already.
pub(crate) struct AfterError<W> {
    inner: W,
    failed: bool,
}

impl<W> AfterError<W> {
    pub(crate) fn new(inner: W) -> Self {
        Self {
            inner,
            failed: false,
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
        self.until_it_fails(bytes.len(), |inner| match inner.write(bytes)? {
            0 if !bytes.is_empty() => Err(io::ErrorKind::WriteZero.into()),
            count => Ok(count),
        })
    }
    fn flush(&mut self) -> io::Result<()> {
        self.until_it_fails((), W::flush)
    }
}

impl<W: Seek> Seek for AfterError<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.until_it_fails(0, |inner| inner.seek(to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
