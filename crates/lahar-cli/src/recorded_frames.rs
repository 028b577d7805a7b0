//! Reads the frames of a run one by one, for `lahar mesh`, `render` and `report`.

use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;

use lahar::Snapshot;
use lahar_io::output::{Recording, RecordingError};
use lahar_scene::scene::Scene;

use crate::error::{CliError, INTERRUPTED};
use crate::interrupt;
use crate::progress::Progress;

/// A choice of frames by number: `12`, `0..60` (60 included), `0..60:5` (every fifth), `10..`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Frames {
    first: u64,
    last: u64,
    every: u64,
}

impl Default for Frames {
    fn default() -> Self {
        Self {
            first: 0,
            last: u64::MAX,
            every: 1,
        }
    }
}

impl Frames {
    fn contains(self, number: u64) -> bool {
        (self.first..=self.last).contains(&number)
            && (number - self.first).is_multiple_of(self.every)
    }
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "expected frames like 12, 0..60, 0..60:5 or 10..".to_owned();
        let number = |text: &str| text.trim().parse::<u64>().map_err(|_| wrong());
        let (range, every) = match text.split_once(':') {
            Some((range, every)) => (range, number(every)?),
            None => (text, 1),
        };
        let (first, last) = match range.split_once("..") {
            Some((first, "")) => (number(first)?, u64::MAX),
            Some((first, last)) => (number(first)?, number(last)?),
            None => (number(range)?, number(range)?),
        };
        match first <= last && every > 0 {
            true => Ok(Self { first, last, every }),
            false => Err(wrong()),
        }
    }
}

/// Turns the error of a recording into one of the command line.
pub(crate) fn unreadable(error: RecordingError) -> CliError {
    CliError::Usage(error.to_string())
}

/// Opens the run in a folder.
pub(crate) fn open(folder: &Path) -> Result<Recording, CliError> {
    Recording::open(folder).map_err(unreadable)
}

/// Returns the scene of a run, with changes.
pub(crate) fn scene(
    recording: &Recording,
    changes: &[(String, String)],
) -> Result<Scene, CliError> {
    let record = recording.record();
    Ok(Scene::recorded(&record.scene, &record.scene_name, changes)?)
}

/// The end of the work on a choice of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Completion {
    /// All frames were worked on.
    Complete,
    /// Ctrl-C or SIGTERM came first.
    Interrupted,
}

impl Completion {
    /// The exit code of the command.
    pub(crate) fn exit_code(self) -> ExitCode {
        match self {
            Self::Complete => ExitCode::SUCCESS,
            Self::Interrupted => ExitCode::from(INTERRUPTED),
        }
    }
}

/// Calls `work(number, snapshot)` for each chosen frame, in order. `work` returns the text for the progress bar.
pub(crate) fn each(
    recording: &Recording,
    frames: Frames,
    mut work: impl FnMut(u64, &Snapshot) -> Result<String, CliError>,
) -> Result<Completion, CliError> {
    let chosen = chosen(recording, frames)?;
    interrupt::watch()?;
    let mut progress = Progress::new(chosen.len() as u64);
    let mut completion = Completion::Complete;
    for (done, index) in (1..).zip(chosen) {
        if interrupt::asked_to_stop() {
            completion = Completion::Interrupted;
            break;
        }
        let snapshot = recording.frame(index).map_err(unreadable)?;
        let text = work(recording.number(index), &snapshot)?;
        progress.show(done, text);
    }
    progress.finish();
    Ok(completion)
}

/// Returns the indices of the chosen frames in the recording, at least one.
pub(crate) fn chosen(recording: &Recording, frames: Frames) -> Result<Vec<usize>, CliError> {
    let number = |index: &usize| recording.number(*index);
    let chosen: Vec<usize> = (0..recording.len())
        .filter(|index| frames.contains(number(index)))
        .collect();
    if chosen.is_empty() {
        return Err(CliError::Usage(format!(
            "{} has none of these frames; it has frames {} to {}",
            recording.folder().display(),
            number(&0),
            number(&(recording.len() - 1)),
        )));
    }
    Ok(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_chosen_by_number() {
        let chosen = |text: &str| -> Vec<u64> {
            let frames: Frames = text.parse().unwrap();
            (0..13).filter(|n| frames.contains(*n)).collect()
        };
        assert_eq!(chosen("7"), [7]);
        assert_eq!(chosen("2..4"), [2, 3, 4]);
        assert_eq!(chosen("1..12:5"), [1, 6, 11]);
        assert_eq!(chosen("10.."), [10, 11, 12]);
        assert_eq!(chosen("0..:6"), [0, 6, 12]);
        for wrong in ["", "x", "4..2", "1..5:0", "-3", "1:2:3"] {
            assert!(wrong.parse::<Frames>().is_err(), "{wrong}");
        }
    }
}
