//! A finished run, replayed frame by frame.

use std::sync::Arc;

use lahar::Snapshot;
use lahar_io::output::Recording;

use super::{Readouts, Side};

/// A recording and the frame of it that is shown.
pub(super) struct Replay {
    recording: Recording,
    frame: usize,
    snapshot: Arc<Snapshot>,
    /// The next frame, read ahead because its time decides when it is shown; `None` at the end.
    next: Option<Arc<Snapshot>>,
}

impl Replay {
    /// Shows the first frame.
    pub(super) fn new(recording: Recording) -> Result<Self, String> {
        let snapshot = Arc::new(recording.frame(0).map_err(|error| error.to_string())?);
        let mut replay = Self {
            recording,
            frame: 0,
            snapshot,
            next: None,
        };
        replay.read_ahead()?;
        Ok(replay)
    }

    fn read_ahead(&mut self) -> Result<(), String> {
        self.next = None;
        if self.frame + 1 < self.recording.len() {
            let next = self.recording.frame(self.frame + 1);
            self.next = Some(Arc::new(next.map_err(|error| error.to_string())?));
        }
        Ok(())
    }

    /// Time of the frame shown \[s\].
    pub(super) fn time(&self) -> f64 {
        self.snapshot.time
    }

    /// Time of the next frame \[s\]; `None` at the end.
    pub(super) fn next_time(&self) -> Option<f64> {
        self.next.as_ref().map(|next| next.time)
    }

    /// Shows the next frame; at the end, does nothing.
    pub(super) fn advance(&mut self) -> Result<(), String> {
        if let Some(next) = self.next.take() {
            self.frame += 1;
            self.snapshot = next;
            self.read_ahead()?;
        }
        Ok(())
    }

    /// Shows another frame, or the last one if there is none of this number.
    pub(super) fn seek(&mut self, frame: usize) -> Result<(), String> {
        let frame = frame.min(self.recording.len() - 1);
        if frame == self.frame + 1 {
            return self.advance();
        }
        if frame != self.frame {
            let snapshot = self.recording.frame(frame);
            self.snapshot = Arc::new(snapshot.map_err(|error| error.to_string())?);
            self.frame = frame;
            self.read_ahead()?;
        }
        Ok(())
    }

    /// The frame shown, with its numbers.
    pub(super) fn side(&self, real_time: f64) -> Side {
        Side {
            title: String::new(),
            snapshot: Arc::clone(&self.snapshot),
            readouts: Readouts {
                time: self.snapshot.time,
                real_time,
                particles: self.snapshot.count,
                frame: self.frame,
                ..Readouts::default()
            },
            retry: None,
        }
    }
}
