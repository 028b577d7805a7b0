//! Particles to add to a simulation, as plain data.

/// Particles to add, all of one material.
#[derive(Clone, Debug, Default)]
pub struct ParticleBatch<const D: usize> {
    /// Index into [`Setup::materials`](crate::Setup::materials).
    pub material: usize,
    /// The body they belong to; free for the caller to number.
    pub body: u32,
    /// Positions \[m\], one a particle.
    pub position: Vec<[f64; D]>,
    /// Velocities \[m/s\]: none (at rest), one for all, or one a particle.
    pub velocity: Vec<[f64; D]>,
    /// Rest volumes \[m³; m² in 2D\]: one for all, or one a particle.
    pub volume: Vec<f64>,
    /// Whether the volumes are measured at the start: each particle's V⁰ becomes its volume as given
    /// times the J of equation (7g), with the masses left as they are.
    pub measure_volume: bool,
    /// Masses \[kg\]: none (density × volume), one for all, or one a particle.
    pub mass: Vec<f64>,
    /// Affine matrices C \[1/s\], `c[i][j]` = ∂v_i/∂x_j: none (zero), or one a particle.
    pub affine: Vec<[[f64; D]; D]>,
    /// Deformation at the start.
    pub deformation: Deformation<D>,
    /// J_P of models with plastic flow: none (1), or one a particle. Other models do not read it.
    pub plastic_jacobian: Vec<f64>,
}

/// How particles are deformed at the start.
#[derive(Clone, Debug, Default)]
pub enum Deformation<const D: usize> {
    /// Not at all: F = I.
    #[default]
    Rest,
    /// Swollen or compressed: J, one a particle; F = J^(1/D) I.
    Jacobian(Vec<f64>),
    /// Deformation gradients `f[i][j]`, one a particle.
    Gradient(Vec<[[f64; D]; D]>),
}
