//! Simulated time against real time, and rates.

use std::time::{Duration, Instant};

/// The largest delay of a frame that later frames make up for, in real time \[s\].
const MAX_MADE_UP_DELAY: f64 = 0.05;
/// The time over which rates are measured.
const RATE_INTERVAL: Duration = Duration::from_millis(500);

/// Tells when a simulated time is due in real time.
pub(super) struct Clock {
    start: Instant,
    time: f64,
}

impl Clock {
    /// Starts at the simulated time `time` \[s\].
    pub(super) fn at(time: f64) -> Self {
        Self {
            start: Instant::now(),
            time,
        }
    }

    /// The wait until the simulated time `time` is due, at `speed` simulated seconds per second. `None` if it is due.
    pub(super) fn until(&self, time: f64, speed: f64) -> Option<Duration> {
        let wait = (time - self.time) / speed - self.start.elapsed().as_secs_f64();
        // A day at most: with speeds near zero the caller asks again later.
        (wait > 0.0).then(|| Duration::from_secs_f64(wait.min(86_400.0)))
    }

    /// Restarts the clock at `time` if that is later than [`MAX_MADE_UP_DELAY`] after it was due.
    pub(super) fn forgive(&mut self, time: f64, speed: f64) {
        let due = self.time + speed * self.start.elapsed().as_secs_f64();
        if due - time > MAX_MADE_UP_DELAY * speed {
            *self = Self::at(time);
        }
    }
}

/// The growth of a value per second of real time, over [`RATE_INTERVAL`].
pub(super) struct Rate {
    start: Instant,
    from: f64,
    last: f64,
}

impl Rate {
    /// Starts at `value`.
    pub(super) fn from(value: f64) -> Self {
        Self {
            start: Instant::now(),
            from: value,
            last: 0.0,
        }
    }

    /// Starts again at `value`. The rate stays until there is a new one.
    pub(super) fn restart(&mut self, value: f64) {
        (self.start, self.from) = (Instant::now(), value);
    }

    /// Returns the newest rate, given the present value \[1/s\].
    pub(super) fn update(&mut self, value: f64) -> f64 {
        let elapsed = self.start.elapsed();
        if elapsed >= RATE_INTERVAL {
            self.last = (value - self.from) / elapsed.as_secs_f64();
            self.restart(value);
        }
        self.last
    }
}

/// Particle-steps per second spent computing, over [`RATE_INTERVAL`] of computing.
#[derive(Default)]
pub(super) struct Throughput {
    busy: Duration,
    particle_steps: u64,
    last: f64,
}

impl Throughput {
    /// Adds particle-steps and the time spent computing them.
    pub(super) fn add(&mut self, busy: Duration, particle_steps: u64) {
        self.busy += busy;
        self.particle_steps += particle_steps;
        // The first rate comes soon, the next ones are steady.
        if self.busy >= RATE_INTERVAL || self.last == 0.0 && !self.busy.is_zero() {
            self.last = self.particle_steps as f64 / self.busy.as_secs_f64();
            if self.busy >= RATE_INTERVAL {
                (self.busy, self.particle_steps) = (Duration::ZERO, 0);
            }
        }
    }

    /// The newest rate \[1/s\]; 0 before there is one.
    pub(super) fn per_second(&self) -> f64 {
        self.last
    }
}
