//! What the whole of the particles comes to: one row of diagnostics.csv. In f64, in a fixed order.

/// Totals at one moment. Vectors have three components; in 2D the third is zero, and angular
/// momentum is its third component.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Simulated time \[s\].
    pub time: f64,
    /// Substeps since the start.
    pub substeps: u64,
    /// Shortest substep since the last row \[s\].
    pub dt_min: f64,
    /// What limited it.
    pub dt_limit: &'static str,
    /// Particles.
    pub particles: u64,
    /// Σ over groups of equal particles of count × mass \[kg\].
    pub mass: f64,
    /// Σ m v \[kg m/s\].
    pub momentum: [f64; 3],
    /// Σ m x × v + what the affine matrices carry \[kg m²/s\], about the origin.
    pub angular_momentum: [f64; 3],
    /// Σ ½ m v² \[J\].
    pub kinetic_energy: f64,
    /// Σ V⁰ Φ \[J\].
    pub elastic_energy: f64,
    /// −Σ m g·x \[J\].
    pub potential_energy: f64,
    /// Largest particle speed \[m/s\].
    pub max_speed: f64,
    /// Space that is filled: Σ over cells of min(1, rest volume in it / dxᴰ) dxᴰ \[m³\].
    pub volume: f64,
    /// Σ J V⁰ \[m³\].
    pub particle_volume: f64,
    /// Particles that left through open sides since the start.
    pub escaped: u64,
    /// Their mass \[kg\].
    pub escaped_mass: f64,
}
