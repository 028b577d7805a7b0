//! Errors that say what is wrong and where.

use core::fmt;

/// A setup or batch that cannot be simulated.
///
/// ```
/// use lahar::{Setup, Simulation};
///
/// let error = Simulation::<f32, 2>::new(Setup::new(-0.1, Vec::new()), &[]).err().ok_or("refused")?;
/// assert_eq!(error.to_string(), "dx: must be a positive number, not -0.1");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SetupError {
    /// The part of the setup, by its name in scene files ("dx", "domain.max", "materials.water.density"), or the field
    /// of the batch.
    pub key: String,
    /// The problem, and what to do about it.
    pub message: String,
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.message)
    }
}

impl core::error::Error for SetupError {}

/// A substep that failed, since a particle is no longer a finite number or is out of the range of positions. The
/// simulation cannot go on from there: [`Simulate::retry_frame`](crate::Simulate::retry_frame) goes back to the start
/// of the frame.
///
/// ```
/// use lahar::{Command, DtLimit, ParticleBatch, Setup, Simulate, Simulation, TimeStep};
///
/// let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// let mut setup = Setup::<2>::new(0.02, vec![jelly]);
/// setup.time_step = TimeStep::Fixed(0.01);
/// let drop = ParticleBatch { position: vec![[0.5, 0.5]], volume: vec![1e-4], ..Default::default() };
/// let mut simulation = Simulation::<f32, 2>::new(setup, &[drop])?;
/// simulation.command(Command::Gravity([0.0, -1e9, 0.0]));
/// let failure = simulation.advance_to(1.0).err().ok_or("the particle stays")?;
/// assert_eq!((failure.particle, failure.dt_limit), (0, DtLimit::Fixed));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// A sentence on the particle's problem.
    pub problem: String,
    /// The id of the first particle.
    pub particle: u32,
    /// The name of its material.
    pub material: String,
    /// The number of its body.
    pub body: u32,
    /// Its last known position \[m\].
    pub position: [f64; 3],
    /// Number of particles that failed.
    pub count: u64,
    /// Number of the substep that failed, from 1.
    pub substep: u64,
    /// Time at the start of that substep \[s\].
    pub time: f64,
    /// Length of that substep \[s\].
    pub dt: f64,
    /// The limit of its length.
    pub dt_limit: DtLimit,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.position;
        write!(
            f,
            "{} in substep {} at t = {:.6} s: particle {} of material \"{}\" (body {}), last at ({x:.4}, {y:.4}, {z:.4}) m, \
             {} particle(s) in all; dt was {:.3e} s, limited by {}",
            self.problem,
            self.substep,
            self.time,
            self.particle,
            self.material,
            self.body,
            self.count,
            self.dt,
            self.dt_limit.name()
        )
    }
}

impl core::error::Error for Failure {}

/// The limit that decided the length of a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DtLimit {
    /// The setup fixes the length.
    Fixed,
    /// Sound crosses at most a part of a cell.
    Sound,
    /// A particle crosses at most a part of a cell.
    Speed,
    /// A collider crosses at most a part of a cell.
    Collider,
    /// The explicit viscous step must be stable.
    Viscosity,
    /// The setup's longest substep.
    Longest,
    /// The frame is tried again, or a frame was shortly before: the substep is shorter than the other limits allow.
    Retry,
    /// The end of the frame.
    #[default]
    Frame,
}

impl DtLimit {
    /// All limits. A checkpoint refers to a limit by its place in this list.
    pub const ALL: [Self; 8] = [
        Self::Fixed,
        Self::Sound,
        Self::Speed,
        Self::Collider,
        Self::Viscosity,
        Self::Longest,
        Self::Retry,
        Self::Frame,
    ];

    /// The limit in one word, for files and screens.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Sound => "sound",
            Self::Speed => "speed",
            Self::Collider => "collider",
            Self::Viscosity => "viscosity",
            Self::Longest => "longest",
            Self::Retry => "retry",
            Self::Frame => "frame",
        }
    }
}
