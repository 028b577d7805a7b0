//! The window's own speed: pictures and particle-steps per second, told once a second.

use std::time::{Duration, Instant};

use crate::solver::Side;

/// The time between two lines.
const INTERVAL: Duration = Duration::from_secs(1);

/// Measures the speed of drawing and simulating.
pub(crate) struct Meter {
    print: fn(&str),
    /// The start of the program.
    start: Instant,
    since: Instant,
    drawn: u32,
    /// Particles × substeps, and simulated time \[s\], at `since`.
    before: (f64, f64),
    has_begun: bool,
}

impl Meter {
    pub(crate) fn new(print: fn(&str), start: Instant) -> Self {
        Self {
            print,
            start,
            since: start,
            drawn: 0,
            before: (0.0, 0.0),
            has_begun: false,
        }
    }

    /// Counts a picture of these sides, and prints a line if it is time.
    pub(crate) fn drawn(&mut self, sides: &[Side]) {
        let Some(first) = sides.first() else { return };
        let steps = (sides.iter())
            .map(|side| side.readouts.substeps as f64 * side.readouts.particles as f64)
            .sum::<f64>();
        let now = (steps, first.readouts.time);
        if !self.has_begun {
            self.has_begun = true;
            let seconds = self.start.elapsed().as_secs_f64();
            (self.print)(&format!("first picture after {seconds:.2} s"));
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
        // After a restart the counts are smaller than before: no line.
        if rate >= 0.0 {
            let pictures = f64::from(self.drawn) / seconds;
            (self.print)(&format!(
                "{:.3} s simulated, {pace:.3} s/s, {:.2} M particle-steps/s, {pictures:.1} pictures/s",
                now.1,
                rate / 1e6,
            ));
        }
        (self.since, self.before, self.drawn) = (Instant::now(), now, 0);
    }
}
