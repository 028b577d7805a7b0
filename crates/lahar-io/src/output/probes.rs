//! `probes/NAME.csv`: the readings of probes, one row per reading.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use lahar::ProbeSamples;

use crate::files::{GrowingFile, Length, OutputError, confined, file_name, make_folder};

/// The growing files, one per probe. They are made when the first readings come.
#[derive(Debug)]
pub(super) struct ProbeFiles {
    folder: PathBuf,
    files: Vec<GrowingFile>,
}

impl ProbeFiles {
    pub(super) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            files: Vec::new(),
        }
    }

    /// Opens the files of the run in `run`, cut back to earlier lengths.
    pub(super) fn resume(folder: &Path, run: &Path, were: &[Length]) -> Result<Self, OutputError> {
        let open = |length: &Length| {
            let path = confined(run, &length.file).map_err(|what| OutputError::usage(run, what))?;
            GrowingFile::open(&path, Some(length))
        };
        Ok(Self {
            folder: folder.to_owned(),
            files: were.iter().map(open).collect::<Result<_, _>>()?,
        })
    }

    /// Adds readings; each call must bring the same probes in the same order.
    pub(super) fn push(&mut self, probes: &[ProbeSamples]) -> Result<(), OutputError> {
        if self.files.is_empty() && !probes.is_empty() {
            make_folder(&self.folder)?;
            for probe in probes {
                let path = self.folder.join(format!("{}.csv", file_name(&probe.name)));
                let mut file = GrowingFile::open(&path, None)?;
                file.add(format!("time,{}\n", probe.columns.join(",")).as_bytes())?;
                self.files.push(file);
            }
        }
        for (file, probe) in self.files.iter_mut().zip(probes) {
            file.add(rows(probe).as_bytes())?;
        }
        Ok(())
    }

    pub(super) fn files(&self) -> &[GrowingFile] {
        &self.files
    }
}

fn rows(probe: &ProbeSamples) -> String {
    let mut text = String::new();
    for sample in &probe.samples {
        write!(text, "{:?}", sample.time).expect("writing to a String");
        for value in &sample.values {
            write!(text, ",{value:?}").expect("writing to a String");
        }
        text.push('\n');
    }
    text
}
