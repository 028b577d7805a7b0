//! Seconds by stage and by phase of the substep.

/// Number of stages of the substep.
pub(crate) const STAGE_COUNT: usize = 13;

/// Seconds by stage, since a clock was given.
#[derive(Clone, Debug, Default)]
pub(crate) struct StageTimes {
    /// A function that returns seconds.
    clock: Option<fn() -> f64>,
    /// The seconds of each stage.
    pub(crate) seconds: [f64; STAGE_COUNT],
}

impl StageTimes {
    /// Begins to count at zero, by `clock`.
    pub(crate) fn new(clock: fn() -> f64) -> Self {
        Self {
            clock: Some(clock),
            seconds: [0.0; STAGE_COUNT],
        }
    }

    /// Returns the present second; 0 without a clock.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}

/// A part of the substep that times are told by: one or several stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Sort,
    Volume,
    Scatter,
    Grid,
    Gather,
    /// All other stages; their times count for no phase.
    Other,
}

/// Seconds by phase, since a clock was given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhaseTimes {
    /// Sorting particles by block.
    pub sort: f64,
    /// Correcting and gathering volumes.
    pub volume: f64,
    /// Particles to grid.
    pub scatter: f64,
    /// Sums, forces and boundaries on the grid.
    pub grid: f64,
    /// Grid to particles, the laws' updates included.
    pub gather: f64,
    /// How often particles were sorted.
    pub sorts: u64,
}

impl PhaseTimes {
    /// Adds the seconds of a stage to those of its phase.
    pub(crate) fn add(&mut self, phase: Phase, seconds: f64) {
        match phase {
            Phase::Sort => self.sort += seconds,
            Phase::Volume => self.volume += seconds,
            Phase::Scatter => self.scatter += seconds,
            Phase::Grid => self.grid += seconds,
            Phase::Gather => self.gather += seconds,
            Phase::Other => {}
        }
    }
}
