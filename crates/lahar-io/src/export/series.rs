//! `.pvd`: ParaView's list of files by time. It is whole after every frame: a single write replaces the end tags by the
//! new entry and end tags.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::files::{Durability, Length, OutputError, write_whole_io};

const HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n";
const TAIL: &str = "</Collection>\n</VTKFile>\n";

/// A growing list of files by time.
#[derive(Debug)]
pub(crate) struct TimeSeries {
    path: PathBuf,
    file: File,
    /// Place of the end tags.
    end: u64,
}

impl TimeSeries {
    /// Creates the list `path`, beginning with the first `keep` entries of the list that is there.
    pub(crate) fn start(path: &Path, keep: usize) -> io::Result<Self> {
        let mut text = HEAD.to_owned();
        if keep > 0 {
            let old = fs::read_to_string(path)?;
            let entries = old.lines().filter(|line| line.starts_with("<DataSet "));
            for entry in entries.take(keep) {
                text += entry;
                text.push('\n');
            }
        }
        let end = text.len() as u64;
        write_whole_io(path, Durability::Eventual, |mut writer| {
            writer.write_all((text + TAIL).as_bytes())?;
            Ok(writer)
        })?;
        Ok(Self {
            path: path.to_owned(),
            file: OpenOptions::new().write(true).open(path)?,
            end,
        })
    }

    /// Returns the path of the list.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until the list is on the disk and returns its length without the end tags; `run` is the run's folder.
    pub(crate) fn settle(&self, run: &Path) -> Result<Length, OutputError> {
        let at = OutputError::at(&self.path);
        self.file.sync_data().map_err(&at)?;
        Length::of(run, &self.path, self.end).map_err(&at)
    }

    /// Adds a file of the time `time` \[s\]; `file` is relative to the list's folder.
    pub(crate) fn push(&mut self, time: f64, file: &str) -> io::Result<()> {
        let entry = format!("<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>\n");
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all((entry.clone() + TAIL).as_bytes())?;
        self.end += entry.len() as u64;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_whole_after_every_entry_and_continues_where_it_is_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("particles.pvd");
        let text = || fs::read_to_string(&path).unwrap();
        let mut list = TimeSeries::start(&path, 0).unwrap();
        assert_eq!(text(), format!("{HEAD}{TAIL}"));
        for i in 0..3 {
            list.push(0.1 * f64::from(i), &format!("frames/{i}.vtp"))
                .unwrap();
            assert!(text().starts_with(HEAD) && text().ends_with(TAIL));
            assert_eq!(text().matches("<DataSet").count() as i32, i + 1);
        }
        let whole = text();
        let mut list = TimeSeries::start(&path, 1).unwrap();
        assert_eq!(text().matches("<DataSet").count(), 1);
        list.push(0.1, "frames/1.vtp").unwrap();
        list.push(0.2, "frames/2.vtp").unwrap();
        assert_eq!(text(), whole);
    }
}
