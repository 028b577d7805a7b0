//! The progress of a command on standard error: a bar on a terminal, and a few lines otherwise.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lahar::Advance;
use lahar_lab::numbers::{duration, with_prefix};

use crate::terminal;

/// The number of lines per run where standard error is not a terminal.
const LINES: u64 = 10;

/// The bar or the lines of one command.
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    frames: u64,
    /// The number of lines printed so far.
    lines: u64,
}

/// The state of a run after a frame.
pub(crate) struct Milestone {
    /// The number of the frame.
    pub(crate) frame: u64,
    /// Simulated time \[s\].
    pub(crate) time: f64,
    /// Mean rate of this process \[particle-steps/s\].
    pub(crate) rate: f64,
    /// Time since the start of the program \[s\].
    pub(crate) seconds: f64,
    /// The substeps of the frame.
    pub(crate) advance: Advance,
}

impl Progress {
    /// Begins to show the progress over `frames` frames.
    pub(crate) fn new(frames: u64) -> Self {
        let bar = terminal::is_watched().then(|| {
            let bar = ProgressBar::with_draw_target(Some(frames), ProgressDrawTarget::stderr());
            if let Ok(style) =
                ProgressStyle::with_template("{bar:30.cyan/blue} frame {pos}/{len}  {msg}")
            {
                bar.set_style(style.progress_chars("━╸─"));
            }
            bar.set_message("first frame");
            bar.tick();
            bar
        });
        Self {
            bar,
            frames,
            lines: 0,
        }
    }

    /// Shows the state of a run after a frame.
    pub(crate) fn update(&mut self, milestone: &Milestone) {
        let left = milestone.seconds / milestone.frame.max(1) as f64
            * self.frames.saturating_sub(milestone.frame) as f64;
        let text = format!(
            "t = {:.3} s  {} particle-steps/s  dt {:.2e} s ({})  {} left",
            milestone.time,
            with_prefix(milestone.rate),
            milestone.advance.dt_min,
            milestone.advance.limit.name(),
            duration(left),
        );
        self.show(milestone.frame, text);
    }

    /// Shows that `frame` frames are done, with a text.
    pub(crate) fn show(&mut self, frame: u64, text: String) {
        if let Some(bar) = &self.bar {
            bar.set_position(frame);
            bar.set_message(text);
        } else if frame * LINES / self.frames.max(1) > self.lines {
            self.lines = frame * LINES / self.frames.max(1);
            terminal::note(&format!("frame {frame}/{}  {text}", self.frames));
        }
    }

    /// Prints a line above the bar.
    pub(crate) fn note(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| terminal::note(line)),
            None => terminal::note(line),
        }
    }

    /// Removes the bar.
    pub(crate) fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
