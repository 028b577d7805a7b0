//! How a run is coming along, on standard error: a bar for who watches, a line now and then for logs.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lahar::Advance;

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

/// `12.3 M`: three digits and a prefix.
pub(crate) fn with_prefix(number: f64) -> String {
    let (scaled, prefix) = match number {
        n if n >= 1e9 => (n / 1e9, " G"),
        n if n >= 1e6 => (n / 1e6, " M"),
        n if n >= 1e3 => (n / 1e3, " k"),
        n => (n, ""),
    };
    let digits = if scaled >= 100.0 || scaled == 0.0 {
        0
    } else if scaled >= 10.0 {
        1
    } else {
        2
    };
    format!("{scaled:.digits$}{prefix}")
}

/// `1 h 02 min`, `3 min 20 s`, `4.2 s`.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.1} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(with_prefix(0.0), "0");
        assert_eq!(with_prefix(12_345_678.0), "12.3 M");
        assert_eq!(with_prefix(999.0), "999");
        assert_eq!(with_prefix(1.5e9), "1.50 G");
        assert_eq!(duration(3.25), "3.2 s");
        assert_eq!(duration(200.0), "3 min 20 s");
        assert_eq!(duration(3725.0), "1 h 02 min");
    }
}
