//! Seconds by stage and by phase of the substep.

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
