//! Simulated time against the clock's, and rates.

use std::time::{Duration, Instant};

/// How late a frame may be and still be made up for \[s\]; later ones set the clock anew.
const GRACE: f64 = 0.05;
/// Rates are taken over this long.
const RATE_INTERVAL: Duration = Duration::from_millis(500);

/// Simulated time against the clock's.
pub(super) struct Clock {
    start: Instant,
    time: f64,
}

impl Clock {
    /// It is `time` now.
    pub(super) fn at(time: f64) -> Self {
        Self {
            start: Instant::now(),
            time,
        }
    }

    /// How long until simulated `time` is due; `None`: it is.
    pub(super) fn until(&self, time: f64, speed: f64) -> Option<Duration> {
        let wait = (time - self.time) / speed - self.start.elapsed().as_secs_f64();
        // A day at most: speeds near zero are asked again later.
        (wait > 0.0).then(|| Duration::from_secs_f64(wait.min(86_400.0)))
    }

    /// Lateness beyond [`GRACE`] is not made up for: never faster than asked.
    pub(super) fn forgive(&mut self, time: f64, speed: f64) {
        let due = self.time + speed * self.start.elapsed().as_secs_f64();
        if due - time > GRACE * speed {
            *self = Self::at(time);
        }
    }
}

/// Something that grows, against the clock, over [`RATE_INTERVAL`].
pub(super) struct Rate {
    start: Instant,
    from: f64,
    last: f64,
}

impl Rate {
    /// It is at `value` now.
    pub(super) fn from(value: f64) -> Self {
        Self {
            start: Instant::now(),
            from: value,
            last: 0.0,
        }
    }

    /// Counts anew from `value`; what was measured stands until there is better.
    pub(super) fn restart(&mut self, value: f64) {
        (self.start, self.from) = (Instant::now(), value);
    }

    /// Growth per second of the clock, now that it is at `value`.
    pub(super) fn at(&mut self, value: f64) -> f64 {
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
    /// So much was done in so long.
    pub(super) fn add(&mut self, busy: Duration, particle_steps: u64) {
        self.busy += busy;
        self.particle_steps += particle_steps;
        // The first number soon, the next ones steady.
        if self.busy >= RATE_INTERVAL || self.last == 0.0 && !self.busy.is_zero() {
            self.last = self.particle_steps as f64 / self.busy.as_secs_f64();
            if self.busy >= RATE_INTERVAL {
                (self.busy, self.particle_steps) = (Duration::ZERO, 0);
            }
        }
    }

    /// \[1/s\]; 0 before anything was done.
    pub(super) fn per_second(&self) -> f64 {
        self.last
    }
}
