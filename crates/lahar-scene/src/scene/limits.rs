//! Limits on the size of a scene.

/// Limits on the memory that a scene may ask for. They depend on the machine, not on the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Memory for particles and grid \[bytes\].
    pub memory: u64,
}

impl Limits {
    /// Memory per particle, with its part of the grid: an upper estimate \[bytes\].
    pub const BYTES_PER_PARTICLE: f64 = 250.0;
}

impl Default for Limits {
    /// Allows 16 GB.
    fn default() -> Self {
        Self {
            memory: 16_000_000_000,
        }
    }
}
