//! How long a substep is, and why.

use crate::error::DtLimit;
use crate::setup::TimeStep;

/// Part of the explicit limit dx²/(2 d ν) that viscosity is given.
const VISCOUS_SAFETY: f64 = 0.5;

/// Frames that a shortened step must do, the one that asked for it included, before it is doubled; twice as
/// many after each further frame that failed.
const CLEAN_FRAMES: u32 = 4;

/// So many failed frames make recovering no slower.
const MOST_PATIENCE: u32 = 12;

/// More parts of a substep than any number of frames that failed asks for.
const MOST_PARTS: f64 = 9007199254740992.0;

/// Substeps are counted exactly as real numbers up to this; no run comes near it.
const MOST_SUBSTEPS: u64 = 1 << f64::MANTISSA_DIGITS;

/// Substeps left to a moment that are still evened out, so that the last is not a splinter.
const EVEN_OUT: f64 = 2.0;

/// Chooses each substep from the state that the last one left.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StepControl {
    step: TimeStep,
    dx: f64,
    /// Largest particle speed \[m/s\].
    pub(crate) speed: f64,
    /// Largest speed of a collider's surface \[m/s\].
    pub(crate) boundary_speed: f64,
    /// Largest elastic wave speed \[m/s\].
    pub(crate) wave_speed: f64,
    /// Largest kinematic viscosity \[m²/s\].
    pub(crate) viscosity: f64,
    /// Size of gravity \[m/s²\].
    pub(crate) gravity: f64,
    /// Largest acceleration by other forces \[m/s²\].
    pub(crate) field: f64,
    /// Substeps taken.
    pub(crate) substeps: u64,
    time: f64,
    shortest: (f64, DtLimit),
    /// The part of the usual substep that is taken, since a frame had to be tried again; 1 else.
    part: f64,
    /// Frames done at this part.
    clean_frames: u32,
    /// Frames that had to be tried again.
    failed_frames: u32,
    /// With a fixed step: the time at which the part changed, and the substeps then.
    changed: (f64, u64),
}

impl StepControl {
    /// A control at time 0, with gravity of size `gravity` \[m/s²\].
    pub(crate) fn new(step: TimeStep, dx: f64, gravity: f64) -> Self {
        Self {
            step,
            dx,
            speed: 0.0,
            boundary_speed: 0.0,
            wave_speed: 0.0,
            viscosity: 0.0,
            gravity,
            field: 0.0,
            substeps: 0,
            time: 0.0,
            shortest: (f64::INFINITY, DtLimit::Frame),
            part: 1.0,
            clean_frames: 0,
            failed_frames: 0,
            changed: (0.0, 0),
        }
    }

    /// All that is not setup, for checkpoints.
    pub(crate) fn numbers(&self) -> ([f64; 10], [u64; 5]) {
        // By name, so that a new field asks whether it belongs here.
        let Self {
            step: _,
            dx: _,
            speed,
            boundary_speed,
            wave_speed,
            viscosity,
            gravity,
            field,
            substeps,
            time,
            shortest,
            part,
            clean_frames,
            failed_frames,
            changed,
        } = *self;
        (
            [
                speed,
                boundary_speed,
                wave_speed,
                viscosity,
                gravity,
                field,
                time,
                shortest.0,
                part,
                changed.0,
            ],
            [
                substeps,
                shortest.1 as u64,
                u64::from(clean_frames),
                u64::from(failed_frames),
                changed.1,
            ],
        )
    }

    /// This with what [`Self::numbers`] has given; `None` if it cannot have given them.
    pub(crate) fn with_numbers(&self, numbers: [f64; 10], counts: [u64; 5]) -> Option<Self> {
        let [
            speed,
            boundary_speed,
            wave_speed,
            viscosity,
            gravity,
            field,
            time,
            shortest,
            part,
            changed,
        ] = numbers;
        let [
            substeps,
            limit,
            clean_frames,
            failed_frames,
            changed_substeps,
        ] = counts;
        let whole_parts = 1.0 / part;
        let sound = numbers.iter().all(|x| *x >= 0.0)
            && time.is_finite()
            && changed.is_finite()
            && changed_substeps <= substeps
            && substeps <= MOST_SUBSTEPS
            && clean_frames <= u64::from(CLEAN_FRAMES << MOST_PATIENCE)
            && (1.0..=MOST_PARTS).contains(&whole_parts)
            && (whole_parts as u64).is_power_of_two();
        sound.then_some(())?;
        Some(Self {
            step: self.step,
            dx: self.dx,
            speed,
            boundary_speed,
            wave_speed,
            viscosity,
            gravity,
            field,
            substeps,
            time,
            shortest: (shortest, *DtLimit::ALL.get(usize::try_from(limit).ok()?)?),
            part,
            clean_frames: u32::try_from(clean_frames).ok()?,
            failed_frames: u32::try_from(failed_frames).ok()?,
            changed: (changed, changed_substeps),
        })
    }

    /// Simulated time \[s\].
    pub(crate) fn time(&self) -> f64 {
        match self.step {
            // Not a sum: after a million steps a sum of rounded steps is off by many roundings.
            TimeStep::Fixed(dt) => {
                self.changed.0 + (self.substeps - self.changed.1) as f64 * (dt * self.part)
            }
            TimeStep::Automatic { .. } => self.time,
        }
    }

    /// The next substep if nothing but the state limits it.
    pub(crate) fn next(&self) -> (f64, DtLimit) {
        let (dt, limit) = self.usual();
        if self.part < 1.0 {
            (dt * self.part, DtLimit::Retry)
        } else {
            (dt, limit)
        }
    }

    /// How many substeps make one that the scene fixes the length of.
    pub(crate) fn per_fixed(&self) -> u64 {
        match self.step {
            TimeStep::Fixed(_) => (1.0 / self.part) as u64, // a power of two
            TimeStep::Automatic { .. } => 1,
        }
    }

    /// A frame is done and the next begins: a shortened step slowly recovers, the more slowly the more
    /// often that went wrong.
    pub(crate) fn begin_frame(&mut self) {
        self.shortest = (f64::INFINITY, DtLimit::Frame);
        if self.part < 1.0 {
            self.clean_frames += 1;
            let failures = self.failed_frames.clamp(1, MOST_PATIENCE) - 1;
            if self.clean_frames >= CLEAN_FRAMES << failures {
                self.take_part(2.0 * self.part);
            }
        }
    }

    /// Halves the step, `halvings` times; returns what part of the usual it is now.
    pub(crate) fn shorten(&mut self, halvings: u32) -> f64 {
        self.take_part(self.part * 0.5_f64.powi(halvings as i32));
        self.failed_frames = self.failed_frames.saturating_add(1);
        self.part
    }

    fn take_part(&mut self, part: f64) {
        self.changed = (self.time(), self.substeps);
        self.part = part;
        self.clean_frames = 0;
    }

    /// The next substep without regard to retries.
    fn usual(&self) -> (f64, DtLimit) {
        let (cfl, longest) = match self.step {
            TimeStep::Fixed(dt) => return (dt, DtLimit::Fixed),
            TimeStep::Automatic { cfl, longest } => (cfl, longest),
        };
        // What gravity and forces add before the particle has crossed its part of a cell.
        let speed = self.speed + (cfl * self.dx * (self.gravity + self.field)).sqrt();
        let limits = [
            (cfl * self.dx / self.wave_speed, DtLimit::Sound),
            (cfl * self.dx / speed, DtLimit::Speed),
            (cfl * self.dx / self.boundary_speed, DtLimit::Collider),
            (
                VISCOUS_SAFETY * self.dx * self.dx / (6.0 * self.viscosity),
                DtLimit::Viscosity,
            ),
            (longest, DtLimit::Longest),
        ];
        limits
            .into_iter()
            .fold((f64::INFINITY, DtLimit::Frame), |least, limit| {
                if limit.0 < least.0 { limit } else { least }
            })
    }

    /// The next substep on the way to `time`; `None` when there.
    pub(crate) fn towards(&self, time: f64) -> Option<(f64, DtLimit)> {
        let left = time - self.time();
        let (dt, limit) = self.next();
        if matches!(self.step, TimeStep::Fixed(_)) {
            return (left > 0.5 * dt).then_some((dt, limit));
        }
        if left <= f64::EPSILON * time.abs() {
            return None;
        }
        let steps = (left / dt).ceil();
        if steps <= 1.0 {
            Some((
                left,
                if left < 0.5 * dt {
                    DtLimit::Frame
                } else {
                    limit
                },
            ))
        } else if steps <= EVEN_OUT {
            Some((left / steps, limit))
        } else {
            Some((dt, limit))
        }
    }

    /// A substep has been taken.
    pub(crate) fn advance(&mut self, dt: f64, limit: DtLimit) {
        self.substeps += 1;
        self.time += dt;
        if dt < self.shortest.0 {
            self.shortest = (dt, limit);
        }
    }

    /// The substeps to `time` are done: what their rounded sum missed is made up.
    pub(crate) fn arrived(&mut self, time: f64) {
        if self.time < time || self.time - time < 1e-9 * time.abs() {
            self.time = time;
        }
    }

    /// The shortest substep since the frame began; (0, frame) if there was none.
    pub(crate) fn shortest(&self) -> (f64, DtLimit) {
        let (dt, limit) = self.shortest;
        if dt.is_finite() {
            (dt, limit)
        } else {
            (0.0, DtLimit::Frame)
        }
    }
}
