//! How a run is coming along, on standard error: a bar for who watches, a line now and then for logs.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lahar::Advance;
use lahar_lab::numbers::{duration, with_prefix};

use crate::terminal;

/// Without anyone watching, so many lines a run.
const LINES: u64 = 10;

/// The bar.
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    frames: u64,
    told: u64,
}

/// How a run stands.
pub(crate) struct Standing {
    /// Frames done.
    pub(crate) frame: u64,
    /// Simulated time \[s\].
    pub(crate) time: f64,
    /// Particle-steps a second so far.
    pub(crate) rate: f64,
    /// Seconds since the start.
    pub(crate) seconds: f64,
    /// The frame's substeps.
    pub(crate) advance: Advance,
}

impl Progress {
    /// For a run of `frames` frames; silent if `quiet`.
    pub(crate) fn new(frames: u64) -> Self {
        let bar = terminal::watched().then(|| {
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
            told: 0,
        }
    }

    /// After a frame.
    pub(crate) fn update(&mut self, standing: &Standing) {
        let left = standing.seconds / standing.frame.max(1) as f64
            * self.frames.saturating_sub(standing.frame) as f64;
        let words = format!(
            "t = {:.3} s  {} particle-steps/s  dt {:.2e} s ({})  {} left",
            standing.time,
            with_prefix(standing.rate),
            standing.advance.dt_min,
            standing.advance.limit.name(),
            duration(left),
        );
        self.at(standing.frame, words);
    }

    /// After `frame` frames, with what there is to say.
    pub(crate) fn at(&mut self, frame: u64, words: String) {
        if let Some(bar) = &self.bar {
            bar.set_position(frame);
            bar.set_message(words);
        } else if frame * LINES / self.frames.max(1) > self.told {
            self.told = frame * LINES / self.frames.max(1);
            terminal::note(&format!("frame {frame}/{}  {words}", self.frames));
        }
    }

    /// Something to know, in between.
    pub(crate) fn note(&self, what: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| terminal::note(what)),
            None => terminal::note(what),
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
