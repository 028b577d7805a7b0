//! A finished run, frame by frame, as it was written.

use std::sync::Arc;

use lahar::Snapshot;
use lahar_io::output::Recording;

use super::{Readouts, Side};

/// The frame in sight, and where the next one comes from.
pub(super) struct Replay {
    recording: Recording,
    frame: usize,
    snapshot: Arc<Snapshot>,
    /// The frame that follows, once it was looked at for its time.
    next: Option<Arc<Snapshot>>,
}

impl Replay {
    /// At the first frame.
    pub(super) fn new(recording: Recording) -> Result<Self, String> {
        let snapshot = Arc::new(recording.frame(0).map_err(|error| error.to_string())?);
        let mut replay = Self {
            recording,
            frame: 0,
            snapshot,
            next: None,
        };
        replay.look_ahead()?;
        Ok(replay)
    }

    fn look_ahead(&mut self) -> Result<(), String> {
        self.next = None;
        if self.frame + 1 < self.recording.len() {
            let next = self.recording.frame(self.frame + 1);
            self.next = Some(Arc::new(next.map_err(|error| error.to_string())?));
        }
        Ok(())
    }

    /// Time of the frame in sight \[s\].
    pub(super) fn time(&self) -> f64 {
        self.snapshot.time
    }

    /// Time of the next one \[s\]; `None` at the end.
    pub(super) fn next_time(&self) -> Option<f64> {
        self.next.as_ref().map(|next| next.time)
    }

    /// One frame on; none at the end.
    pub(super) fn advance(&mut self) -> Result<(), String> {
        if let Some(next) = self.next.take() {
            self.frame += 1;
            self.snapshot = next;
            self.look_ahead()?;
        }
        Ok(())
    }

    /// Another frame, or the last one.
    pub(super) fn seek(&mut self, frame: usize) -> Result<(), String> {
        let frame = frame.min(self.recording.len() - 1);
        if frame == self.frame + 1 {
            return self.advance();
        }
        if frame != self.frame {
            let snapshot = self.recording.frame(frame);
            self.snapshot = Arc::new(snapshot.map_err(|error| error.to_string())?);
            self.frame = frame;
            self.look_ahead()?;
        }
        Ok(())
    }

    /// What there is to see of it now.
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
