//! The clock, and the length of the next substep with the limit that decides it.

use crate::error::DtLimit;
use crate::setup::TimeStep;

/// The part of the explicit limit dx²/(2 d ν) that viscosity allows.
const VISCOUS_SAFETY: f64 = 0.5;

/// Number of frames that must succeed with a shortened step, the failed frame included, before it is doubled. Each
/// further frame that fails doubles this number.
const CLEAN_FRAMES: u32 = 4;

/// Number of failed frames after which the step grows back no more slowly.
const MOST_DOUBLINGS: u32 = 12;

/// A bound on the parts that a substep is divided into; no number of failed frames asks for more.
const MOST_PARTS: f64 = 9007199254740992.0;

/// The number up to which substeps are counted exactly as real numbers; no run comes near it.
const MOST_SUBSTEPS: u64 = 1 << f64::MANTISSA_DIGITS;

/// Number of remaining substeps from which on they are made equal, so that the last one is not very short.
const EQUAL_STEPS: f64 = 2.0;

/// Chooses the length of each substep from the state after the last one.
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
    /// Number of substeps taken.
    pub(crate) substeps: u64,
    time: f64,
    shortest: (f64, DtLimit),
    /// The part of the usual substep that is taken: less than 1 after a retry.
    part: f64,
    /// Number of frames that have begun with this part.
    clean_frames: u32,
    /// Number of frames that had to be tried again.
    failed_frames: u32,
    /// Time and number of substeps when the part last changed, for a fixed step.
    changed: (f64, u64),
}

impl StepControl {
    /// Creates a control at time 0, with gravity of size `gravity` \[m/s²\].
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

    /// Returns all that is not setup, for checkpoints.
    pub(crate) fn numbers(&self) -> ([f64; 10], [u64; 5]) {
        // Each field by name, so that a new one is not forgotten.
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

    /// Returns this control with what [`Self::numbers`] has returned, or `None` if it cannot have returned that.
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
            && clean_frames <= u64::from(CLEAN_FRAMES << MOST_DOUBLINGS)
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

    /// Returns the length of the next substep \[s\] if only the state limits it, and that limit.
    pub(crate) fn next(&self) -> (f64, DtLimit) {
        let (dt, limit) = self.usual();
        if self.part < 1.0 {
            (dt * self.part, DtLimit::Retry)
        } else {
            (dt, limit)
        }
    }

    /// Returns how many substeps make up one fixed dt.
    pub(crate) fn per_fixed(&self) -> u64 {
        match self.step {
            TimeStep::Fixed(_) => (1.0 / self.part) as u64, // a power of two
            TimeStep::Automatic { .. } => 1,
        }
    }

    /// Begins a frame. A shortened step grows back, the more slowly the more frames have failed.
    pub(crate) fn begin_frame(&mut self) {
        self.shortest = (f64::INFINITY, DtLimit::Frame);
        if self.part < 1.0 {
            self.clean_frames += 1;
            let failures = self.failed_frames.clamp(1, MOST_DOUBLINGS) - 1;
            if self.clean_frames >= CLEAN_FRAMES << failures {
                self.take_part(2.0 * self.part);
            }
        }
    }

    /// Halves the step `halvings` times. Returns the part of the usual step that it is now.
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

    /// Returns the next substep as if no frame had been retried.
    fn usual(&self) -> (f64, DtLimit) {
        let (cfl, longest) = match self.step {
            TimeStep::Fixed(dt) => return (dt, DtLimit::Fixed),
            TimeStep::Automatic { cfl, longest } => (cfl, longest),
        };
        // Gravity and forces add to the speed while a particle crosses its part of a cell.
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

    /// Returns the next substep on the way to `time` \[s\], or `None` at that time.
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
        } else if steps <= EQUAL_STEPS {
            Some((left / steps, limit))
        } else {
            Some((dt, limit))
        }
    }

    /// Counts a substep that was taken.
    pub(crate) fn advance(&mut self, dt: f64, limit: DtLimit) {
        self.substeps += 1;
        self.time += dt;
        if dt < self.shortest.0 {
            self.shortest = (dt, limit);
        }
    }

    /// Sets the clock to `time` \[s\] after the substeps up to it, whose sum is rounded.
    pub(crate) fn arrived(&mut self, time: f64) {
        if self.time < time || self.time - time < 1e-9 * time.abs() {
            self.time = time;
        }
    }

    /// Returns the shortest substep since the frame began, or (0, frame) if there was none.
    pub(crate) fn shortest(&self) -> (f64, DtLimit) {
        let (dt, limit) = self.shortest;
        if dt.is_finite() {
            (dt, limit)
        } else {
            (0.0, DtLimit::Frame)
        }
    }
}
