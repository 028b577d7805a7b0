//! What can go wrong, said so that the reader knows what and where.

use core::fmt;

/// A setup or batch that cannot be simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct SetupError {
    /// The part of the setup, by its name in scene files ("dx", "domain.max", "materials.water.density").
    pub key: String,
    /// What is wrong with it and what to do.
    pub message: String,
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.message)
    }
}

impl core::error::Error for SetupError {}

/// A run that cannot go on: a particle that is not a number, or has left what positions can say.
/// The simulation cannot go on from there: [`Simulate::retry_frame`](crate::Simulate::retry_frame) goes
/// back to the start of the frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// What happened.
    pub what: String,
    /// The first particle, by id.
    pub particle: u32,
    /// The name of its material.
    pub material: String,
    /// Its body.
    pub body: u32,
    /// The last position that was known \[m\].
    pub position: [f64; 3],
    /// Particles in this state.
    pub count: u64,
    /// The substep in which it happened, from 1.
    pub substep: u64,
    /// Time at the start of that substep \[s\].
    pub time: f64,
    /// Its length \[s\].
    pub dt: f64,
    /// What limited dt.
    pub dt_limit: DtLimit,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} in substep {} at t = {:.6} s: particle {} of material \"{}\" (body {}), last at ({:.4}, {:.4}, {:.4}) m, \
             {} particle(s) in all; dt was {:.3e} s, limited by {}",
            self.what,
            self.substep,
            self.time,
            self.particle,
            self.material,
            self.body,
            self.position[0],
            self.position[1],
            self.position[2],
            self.count,
            self.dt,
            self.dt_limit.name()
        )
    }
}

impl core::error::Error for Failure {}

/// What decided the length of a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DtLimit {
    /// The scene gives it.
    Fixed,
    /// Sound may cross a part of a cell.
    Sound,
    /// A particle may cross a part of a cell.
    Speed,
    /// A collider may cross a part of a cell.
    Collider,
    /// Viscosity.
    Viscosity,
    /// The scene's longest substep.
    Longest,
    /// A frame is tried again with less than any of these allow, or one was shortly before.
    Retry,
    /// The frame ends.
    #[default]
    Frame,
}

impl DtLimit {
    /// All of them; a checkpoint says which by its place here.
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

    /// In a word, for files and screens.
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
