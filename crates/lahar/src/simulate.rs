//! [`Simulate`]: a simulation without the types of its numbers and its dimension.

use crate::boundary::BoundaryImpulse;
use crate::error::{DtLimit, Failure};
use crate::particles::{Field, Snapshot};
use crate::setup::{Command, Isa, ProbeSamples};
use crate::state::checkpoint::{Checkpoint, CheckpointError};
use crate::state::diagnostics::Diagnostics;
use crate::state::retry::Retry;

/// What an advance did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Advance {
    /// Substeps taken.
    pub substeps: u64,
    /// The shortest of them \[s\].
    pub dt_min: f64,
    /// What limited it.
    pub limit: DtLimit,
}

/// Seconds spent by phase, if a clock was given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhaseTimes {
    /// Moving particles to their blocks.
    pub sort: f64,
    /// Setting volumes right by how full the grid is.
    pub volume: f64,
    /// Particles to grid.
    pub scatter: f64,
    /// Grid update.
    pub grid: f64,
    /// Grid to particles, the law's update included.
    pub gather: f64,
    /// Sorts done.
    pub sorts: u64,
}

/// A simulation of any dimension and precision.
pub trait Simulate: Send {
    /// 2 or 3.
    fn dimension(&self) -> usize;
    /// "f32" or "f64".
    fn precision(&self) -> &'static str;
    /// The instruction set in use.
    fn isa(&self) -> Isa;
    /// Distance between nodes \[m\].
    fn dx(&self) -> f64;
    /// Corners of the domain \[m\]; `None`: unbounded.
    fn domain(&self) -> Option<([f64; 3], [f64; 3])>;
    /// Gravity now \[m/s²\].
    fn gravity(&self) -> [f64; 3];
    /// Names of the materials, by index.
    fn materials(&self) -> Vec<String>;
    /// Simulated time \[s\].
    fn time(&self) -> f64;
    /// Substeps since the start.
    fn substeps(&self) -> u64;
    /// Particles now.
    fn particle_count(&self) -> usize;
    /// Length that the next substep would have \[s\], and why.
    fn next_dt(&self) -> (f64, DtLimit);
    /// One substep. If the scene fixes its length and a frame is tried again with a part of it, as many
    /// as make it.
    fn substep(&mut self) -> Result<Advance, Failure>;
    /// Substeps until `time` \[s\]: exactly with an automatic time step, to the nearest substep with
    /// a fixed one.
    fn advance_to(&mut self, time: f64) -> Result<Advance, Failure> {
        self.advance_while(time, &mut || true)
    }
    /// [`Self::advance_to`], which ends early when `go_on`, asked before each substep, says no.
    fn advance_while(
        &mut self,
        time: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Advance, Failure>;
    /// Takes effect at the next substep.
    fn command(&mut self, command: Command);
    /// Keeps a copy of the state, which [`Self::retry_frame`] goes back to. A time step that was shortened
    /// before recovers by and by. [`crate::frame`] does both.
    fn begin_frame(&mut self);
    /// Goes back to where [`Self::begin_frame`] was called, to go on with half the time step of the last
    /// attempt; commands given since stay. `None` if that was never called, or has been tried to 1/64.
    fn retry_frame(&mut self, failure: &Failure) -> Option<Retry>;
    /// Goes back to where [`Self::begin_frame`] was called, as if it had not been; false if it was not.
    fn give_up_frame(&mut self) -> bool;
    /// All that decides how it goes on, besides its setup; between frames.
    fn checkpoint(&self) -> Checkpoint;
    /// Goes on from `checkpoint`, which a simulation of the same setup has given: with the same bits as that
    /// one.
    ///
    /// # Errors
    /// It is not of such a simulation, or damaged; this one stays as it was.
    fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), CheckpointError>;
    /// A copy of `fields`, rows by ascending id.
    fn snapshot(&self, fields: &[Field]) -> Snapshot;
    /// Totals now. Sorts first if the next substep would: the run's bits do not change.
    fn diagnostics(&mut self) -> Diagnostics;
    /// What each wall and each collider has taken from the material since the start, in the order of
    /// sides and colliders. The difference of two moments over the time between is the mean force.
    fn boundary_impulses(&self) -> Vec<BoundaryImpulse>;
    /// What probes have read since this was last asked, in the order of [`Setup::probes`](crate::Setup::probes); the reading
    /// at the start comes first.
    fn take_probe_samples(&mut self) -> Vec<ProbeSamples>;
    /// Gives the simulation a clock that returns seconds, for [`Simulate::phase_times`].
    fn set_clock(&mut self, clock: fn() -> f64);
    /// Seconds by phase since the clock was given.
    fn phase_times(&self) -> PhaseTimes;
    /// Blocks of nodes in use, and bytes held by grid and particles.
    fn memory(&self) -> Memory;
}

/// What a simulation holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Blocks of nodes.
    pub blocks: usize,
    /// Nodes in them.
    pub nodes: usize,
    /// Bytes of grid and tiles.
    pub grid_bytes: usize,
    /// Bytes of particles, buffers included.
    pub particle_bytes: usize,
    /// Bytes of the copy that a frame that fails begins again from; 0 before the first frame.
    pub retry_bytes: usize,
}
