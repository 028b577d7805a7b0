//! How fast it goes: pictures and particle-steps by the clock, a line a second.

use std::time::{Duration, Instant};

use crate::solver::Side;

/// How often there is a line.
const INTERVAL: Duration = Duration::from_secs(1);

/// Counts between two lines.
pub(crate) struct Meter {
    say: fn(&str),
    /// When the program began.
    start: Instant,
    since: Instant,
    drawn: u32,
    /// Particles × substeps and simulated time at `since`.
    before: (f64, f64),
    has_begun: bool,
}

impl Meter {
    pub(crate) fn new(say: fn(&str), start: Instant) -> Self {
        Self {
            say,
            start,
            since: start,
            drawn: 0,
            before: (0.0, 0.0),
            has_begun: false,
        }
    }

    /// The window has been drawn with these sides in it.
    pub(crate) fn drawn(&mut self, sides: &[Side]) {
        let Some(first) = sides.first() else { return };
        let steps = (sides.iter())
            .map(|side| side.readouts.substeps as f64 * side.readouts.particles as f64)
            .sum::<f64>();
        let now = (steps, first.readouts.time);
        if !self.has_begun {
            self.has_begun = true;
            let seconds = self.start.elapsed().as_secs_f64();
            (self.say)(&format!("first picture after {seconds:.2} s"));
            (self.since, self.before) = (Instant::now(), now);
            return;
        }
        self.drawn += 1;
        let elapsed = self.since.elapsed();
        if elapsed < INTERVAL {
            return;
        }
        let seconds = elapsed.as_secs_f64();
        let rate = (now.0 - self.before.0) / seconds;
        let pace = (now.1 - self.before.1) / seconds;
        // A restart in between would count backwards.
        if rate >= 0.0 {
            let pictures = f64::from(self.drawn) / seconds;
            (self.say)(&format!(
                "{:.3} s simulated, {pace:.3} s/s, {:.2} M particle-steps/s, {pictures:.1} pictures/s",
                now.1,
                rate / 1e6,
            ));
        }
        (self.since, self.before, self.drawn) = (Instant::now(), now, 0);
    }
}
