//! A run's frames, read back one by one: what `mesh`, `render` and `report` have in common.

use std::path::Path;
use std::str::FromStr;

use lahar::Snapshot;
use lahar_io::output::{Recording, RecordingError};
use lahar_scene::scene::Scene;

use crate::error::CliError;
use crate::interrupt;
use crate::progress::Progress;

/// Which frames, by their numbers: `12`, `0..60` (the last one included), `0..60:5`, `10..`.
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
    fn holds(self, number: u64) -> bool {
        (self.first..=self.last).contains(&number)
            && (number - self.first).is_multiple_of(self.every)
    }
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "write it as 12, 0..60, 0..60:5 or 10..".to_owned();
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

pub(crate) fn unreadable(error: RecordingError) -> CliError {
    CliError::Usage(error.to_string())
}

/// The run in a folder.
pub(crate) fn open(folder: &Path) -> Result<Recording, CliError> {
    Recording::open(folder).map_err(unreadable)
}

/// The scene of a run, with changes.
pub(crate) fn scene(
    recording: &Recording,
    changes: &[(String, String)],
) -> Result<Scene, CliError> {
    let record = recording.record();
    Ok(Scene::recorded(&record.scene, &record.scene_name, changes)?)
}

/// What the frames came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Done,
    Interrupted,
}

/// `work(number, snapshot)` on each of the chosen frames, in order; it says what is to be shown of them.
pub(crate) fn each(
    recording: &Recording,
    frames: Frames,
    mut work: impl FnMut(u64, &Snapshot) -> Result<String, CliError>,
) -> Result<End, CliError> {
    let chosen = chosen(recording, frames)?;
    interrupt::watch()?;
    let mut progress = Progress::new(chosen.len() as u64);
    let mut end = End::Done;
    for (done, index) in (1..).zip(chosen) {
        if interrupt::asked_to_stop() {
            end = End::Interrupted;
            break;
        }
        let snapshot = recording.frame(index).map_err(unreadable)?;
        let words = work(recording.number(index), &snapshot)?;
        progress.at(done, words);
    }
    progress.finish();
    Ok(end)
}

/// The places of the chosen frames in the recording, at least one.
pub(crate) fn chosen(recording: &Recording, frames: Frames) -> Result<Vec<usize>, CliError> {
    let number = |index: &usize| recording.number(*index);
    let chosen: Vec<usize> = (0..recording.len())
        .filter(|index| frames.holds(number(index)))
        .collect();
    if chosen.is_empty() {
        return Err(CliError::Usage(format!(
            "{} has none of these frames, it has {} to {}",
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
        let holds = |text: &str| -> Vec<u64> {
            let frames: Frames = text.parse().unwrap();
            (0..13).filter(|n| frames.holds(*n)).collect()
        };
        assert_eq!(holds("7"), [7]);
        assert_eq!(holds("2..4"), [2, 3, 4]);
        assert_eq!(holds("1..12:5"), [1, 6, 11]);
        assert_eq!(holds("10.."), [10, 11, 12]);
        assert_eq!(holds("0..:6"), [0, 6, 12]);
        for wrong in ["", "x", "4..2", "1..5:0", "-3", "1:2:3"] {
            assert!(wrong.parse::<Frames>().is_err(), "{wrong}");
        }
    }
}
