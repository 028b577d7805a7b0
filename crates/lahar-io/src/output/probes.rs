//! `probes/NAME.csv`: what probes have read, a row a reading.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use lahar::ProbeSamples;

use super::OutputError;

/// The growing files, one a probe, made when the first readings come.
#[derive(Debug)]
pub(super) struct ProbeFiles {
    folder: PathBuf,
    files: Vec<(PathBuf, File)>,
}

impl ProbeFiles {
    pub(super) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            files: Vec::new(),
        }
    }

    /// Adds readings; always of the same probes.
    pub(super) fn push(&mut self, probes: &[ProbeSamples]) -> Result<(), OutputError> {
        if self.files.is_empty() && !probes.is_empty() {
            fs::create_dir_all(&self.folder).map_err(OutputError::at(&self.folder))?;
            for probe in probes {
                let path = self.folder.join(&probe.name).with_extension("csv");
                let mut file = File::create(&path).map_err(OutputError::at(&path))?;
                file.write_all(format!("time,{}\n", probe.columns.join(",")).as_bytes())
                    .map_err(OutputError::at(&path))?;
                self.files.push((path, file));
            }
        }
        for ((path, file), probe) in self.files.iter_mut().zip(probes) {
            file.write_all(rows(probe).as_bytes())
                .map_err(OutputError::at(path))?;
        }
        Ok(())
    }
}

fn rows(probe: &ProbeSamples) -> String {
    let mut text = String::new();
    for sample in &probe.samples {
        write!(text, "{:?}", sample.time).expect("strings take everything");
        for value in &sample.values {
            write!(text, ",{value:?}").expect("strings take everything");
        }
        text.push('\n');
    }
    text
}
