//! [`Simulate`]: a simulation without the types of its numbers and its dimension.

use crate::boundary::BoundaryImpulse;
use crate::error::{DtLimit, Failure, SetupError};
use crate::particles::{Field, Snapshot};
use crate::setup::{Command, ParticleBatch, ProbeSamples};
use crate::state::checkpoint::{Checkpoint, CheckpointError};
use crate::state::diagnostics::Diagnostics;
use crate::state::retry::Retry;
use crate::step::PhaseTimes;

/// A simulation of any dimension and precision, on any backend. Outlets that open whatever scene they are given hold
/// a `Box<dyn Simulate>`. Vectors have three components; in 2D the third is zero, or ignored.
///
/// ```
/// use lahar::{ParticleBatch, Setup, Simulate, Simulation};
///
/// fn open(double: bool) -> Result<Box<dyn Simulate>, lahar::SetupError> {
///     let jelly = lahar::material::preset("jelly", 0.0).expect("a preset");
///     let setup = Setup::<2>::new(0.1, vec![jelly]);
///     Ok(match double {
///         true => Box::new(Simulation::<f64, 2>::new(setup, &[])?),
///         false => Box::new(Simulation::<f32, 2>::new(setup, &[])?),
///     })
/// }
///
/// let simulation = open(true)?;
/// assert_eq!((simulation.dimension(), simulation.precision()), (2, "f64"));
/// assert_eq!(simulation.materials(), ["jelly"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Simulate: Send {
    /// The number of dimensions, 2 or 3.
    fn dimension(&self) -> usize;

    /// The type of real numbers, "f32" or "f64".
    fn precision(&self) -> &'static str;

    /// The program that computes, and the instructions it uses.
    fn backend(&self) -> Backend;

    /// Distance between nodes \[m\].
    fn dx(&self) -> f64;

    /// Lower and upper corner of the domain \[m\]; `None` if it has no bounds.
    fn domain(&self) -> Option<([f64; 3], [f64; 3])>;

    /// Gravity at present \[m/s²\].
    fn gravity(&self) -> [f64; 3];

    /// Names of the materials, by index.
    fn materials(&self) -> Vec<String>;

    /// Simulated time \[s\].
    fn time(&self) -> f64;

    /// Number of substeps since the start.
    fn substeps(&self) -> u64;

    /// Number of particles at present.
    fn particle_count(&self) -> usize;

    /// Length of the next substep \[s\], and its limit.
    fn next_dt(&self) -> (f64, DtLimit);

    /// Takes one substep. While a fixed dt is subdivided after a retry, takes all the parts that make up one dt.
    ///
    /// # Errors
    /// If a particle is lost; [`Self::retry_frame`] goes back to the start of the frame.
    fn substep(&mut self) -> Result<Advance, Failure>;

    /// Takes substeps until `time` \[s\]: exactly with an automatic time step, to the nearest substep with a fixed one.
    ///
    /// # Errors
    /// As [`Self::substep`].
    fn advance_to(&mut self, time: f64) -> Result<Advance, Failure> {
        self.advance_while(time, &mut || true)
    }

    /// Takes substeps until `time` \[s\], or until `go_on`, which is called before each one, returns false.
    ///
    /// # Errors
    /// As [`Self::substep`].
    ///
    /// ```
    /// # use lahar::{ParticleBatch, Setup, Simulate, Simulation};
    /// # let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
    /// # let drop = ParticleBatch { position: vec![[0.5, 0.5]], volume: vec![1e-4], ..Default::default() };
    /// # let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.02, vec![jelly]), &[drop])?;
    /// let mut left = 3;
    /// let advance = simulation.advance_while(1.0, &mut || { left -= 1; left >= 0 })?;
    /// assert_eq!(advance.substeps, 3);
    /// assert!(simulation.time() < 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn advance_while(
        &mut self,
        time: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Advance, Failure>;

    /// Gives a command, which takes effect at the next substep; see [`Command`].
    fn command(&mut self, command: Command);

    /// Adds particles, also while the simulation is under way. Their ids go on from the last. If the frame in which
    /// they were added is retried, they are lost.
    ///
    /// # Errors
    /// Names the field that cannot be simulated; nothing is added then.
    ///
    /// ```
    /// # use lahar::{ParticleBatch, Setup, Simulate, Simulation};
    /// # let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
    /// # let drop = ParticleBatch { position: vec![[0.5, 0.5]], volume: vec![1e-4], ..Default::default() };
    /// # let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.02, vec![jelly]), &[drop])?;
    /// for frame in 1..=3 {
    ///     let drop = ParticleBatch::<3> {
    ///         position: vec![[0.5, 0.8, 0.0]],
    ///         velocity: vec![[0.0, -1.0, 0.0]],
    ///         volume: vec![1e-4],
    ///         ..Default::default()
    ///     };
    ///     simulation.add_particles(&drop)?;
    ///     simulation.advance_to(0.01 * f64::from(frame))?;
    /// }
    /// assert_eq!(simulation.particle_count(), 4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn add_particles(&mut self, batch: &ParticleBatch<3>) -> Result<(), SetupError>;

    /// Begins a frame: saves the state for [`Self::retry_frame`]. A dt shortened by an earlier retry grows back over
    /// the following frames. [`frame`] begins and retries a frame in one call.
    fn begin_frame(&mut self);

    /// Goes back to the start of the frame, to try again with half the time step of the last attempt. Commands given
    /// during the failed frame stay in force. Returns `None` if no frame has begun, or if 1/64 of the time step was
    /// tried; then the simulation stays at the start of the frame.
    fn retry_frame(&mut self, failure: &Failure) -> Option<Retry>;

    /// Goes back to the start of the frame, as if it had not begun. Returns false if none has.
    fn give_up_frame(&mut self) -> bool;

    /// Returns the whole state, between two frames, as named arrays. Together with the setup it decides all bits that
    /// follow.
    ///
    /// ```
    /// use lahar::{Field, ParticleBatch, Setup, Simulate, Simulation};
    ///
    /// let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
    /// let setup = Setup::<2>::new(0.02, vec![jelly]);
    /// let drop = ParticleBatch { position: vec![[0.5, 0.5]], volume: vec![1e-4], ..Default::default() };
    /// let mut first = Simulation::<f32, 2>::new(setup.clone(), &[drop])?;
    /// first.advance_to(0.01)?;
    /// let checkpoint = first.checkpoint();
    ///
    /// // A simulation of the same setup; the particles come from the checkpoint.
    /// let mut second = Simulation::<f32, 2>::new(setup, &[])?;
    /// second.resume(checkpoint)?;
    /// first.advance_to(0.02)?;
    /// second.advance_to(0.02)?;
    /// assert_eq!(first.checkpoint(), second.checkpoint());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn checkpoint(&self) -> Checkpoint;

    /// Replaces the state by that of `checkpoint`, which a simulation of the same setup has given, and goes on with
    /// the same bits as that one.
    ///
    /// # Errors
    /// If the checkpoint is damaged or of another setup; the state stays as it was.
    fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), CheckpointError>;

    /// Copies `fields` of all particles, by ascending id.
    ///
    /// ```
    /// # use lahar::{ParticleBatch, Setup, Simulate, Simulation};
    /// use lahar::Field;
    ///
    /// # let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
    /// # let pair = ParticleBatch { position: vec![[0.5, 0.5], [0.25, 0.75]], volume: vec![1e-4], ..Default::default() };
    /// # let simulation = Simulation::<f32, 2>::new(Setup::new(0.02, vec![jelly]), &[pair])?;
    /// let snapshot = simulation.snapshot(&[Field::Position, Field::Pressure]);
    /// assert_eq!(snapshot.count, 2);
    /// let position = snapshot.get(Field::Position).ok_or("not asked for")?;
    /// assert_eq!(position.to_f64(), [0.5, 0.5, 0.25, 0.75]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn snapshot(&self, fields: &[Field]) -> Snapshot;

    /// Measures totals over all particles.
    ///
    /// ```
    /// # use lahar::{ParticleBatch, Setup, Simulate, Simulation};
    /// # let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
    /// let drop = ParticleBatch {
    ///     position: vec![[0.5, 0.5]],
    ///     velocity: vec![[3.0, 0.0]],
    ///     volume: vec![1e-4],
    ///     mass: vec![2.0],
    ///     ..Default::default()
    /// };
    /// let simulation = Simulation::<f64, 2>::new(Setup::new(0.02, vec![jelly]), &[drop])?;
    /// let totals = simulation.diagnostics();
    /// assert_eq!((totals.mass, totals.momentum[0], totals.kinetic_energy), (2.0, 6.0, 9.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn diagnostics(&self) -> Diagnostics;

    /// Lists the impulses that the walls and then the colliders have taken from the material since the start. The
    /// difference between two moments, over the time between, is the mean force on a boundary.
    fn boundary_impulses(&self) -> Vec<BoundaryImpulse>;

    /// Takes out the readings of all probes since the last call, in the order of
    /// [`Setup::probes`](crate::Setup::probes). The reading at the start comes first.
    fn take_probe_samples(&mut self) -> Vec<ProbeSamples>;

    /// Gives the simulation a clock that returns seconds, and sets the times of [`Self::phase_times`] and
    /// [`Self::stage_times`] to zero.
    fn set_clock(&mut self, clock: fn() -> f64);

    /// Seconds by phase since the clock was given, and the number of sorts.
    fn phase_times(&self) -> PhaseTimes;

    /// Seconds by stage of the substep since the clock was given, in the order of the stages.
    ///
    /// ```
    /// # use lahar::{ParticleBatch, Setup, Simulate, Simulation};
    /// # let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
    /// # let drop = ParticleBatch { position: vec![[0.5, 0.5]], volume: vec![1e-4], ..Default::default() };
    /// # let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.02, vec![jelly]), &[drop])?;
    /// simulation.set_clock(|| 0.0); // a real one reads the time
    /// simulation.substep()?;
    /// let names: Vec<_> = simulation.stage_times().iter().map(|(name, _)| *name).collect();
    /// assert_eq!(names.first(), Some(&"sort"));
    /// assert!(names.contains(&"grid to particles"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn stage_times(&self) -> Vec<(&'static str, f64)>;

    /// Number of nodes, and memory in use.
    fn memory(&self) -> Memory;
}

/// The substeps of one advance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Advance {
    /// Number of substeps.
    pub substeps: u64,
    /// The shortest substep \[s\].
    pub dt_min: f64,
    /// The limit of the shortest substep.
    pub limit: DtLimit,
}

/// The program that computes a simulation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Backend {
    /// The program: "cpu" for the engine of this crate.
    pub name: String,
    /// The instruction set in use, by the name that [`Isa::name`](crate::Isa::name) gives it.
    pub instruction_set: String,
}

/// Nodes and memory of a simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Number of blocks of nodes.
    pub blocks: usize,
    /// Number of nodes in the blocks.
    pub nodes: usize,
    /// Memory of the grid and its tiles \[bytes\].
    pub grid_bytes: usize,
    /// Memory of the particles, buffers included \[bytes\].
    pub particle_bytes: usize,
    /// Memory of the copy for retries \[bytes\]; 0 before the first frame.
    pub retry_bytes: usize,
}

/// Computes one frame by `advance`, and tries it again with half the time step whenever a substep fails; `on_retry` is
/// called before each new attempt. Returns what the attempt that succeeded returned.
///
/// ```
/// # use lahar::{Setup, Simulate, Simulation};
/// # let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// # let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.1, vec![jelly]), &[])?;
/// for frame in 1..=10 {
///     let end = f64::from(frame) / 60.0;
///     lahar::frame(&mut simulation, |s| s.advance_to(end), |retry| eprintln!("{retry}"))?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The last failure, if 1/64 of the time step has failed too. The simulation is at the start of the frame then.
pub fn frame<S: Simulate + ?Sized, R>(
    simulation: &mut S,
    mut advance: impl FnMut(&mut S) -> Result<R, Failure>,
    mut on_retry: impl FnMut(&Retry),
) -> Result<R, Failure> {
    simulation.begin_frame();
    loop {
        match advance(simulation) {
            Ok(done) => return Ok(done),
            Err(failure) => match simulation.retry_frame(&failure) {
                Some(retry) => on_retry(&retry),
                None => return Err(failure),
            },
        }
    }
}
