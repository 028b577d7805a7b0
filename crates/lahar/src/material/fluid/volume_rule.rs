//! The rules for the volume of a fluid particle.

/// The source of a fluid's J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum VolumeRule {
    /// J follows the motion of the particle, (7).
    #[default]
    Jacobian,
    /// J follows the motion, and is corrected by the volume that the grid measures, (7h) and (7i).
    Corrected(VolumeCorrection),
    /// J is gathered from the grid before each substep, (7g). There is no memory, and so no drift; but
    /// at a free surface, where the grid is half empty, the fluid counts as expanded.
    Gathered,
}

/// The rates of volume correction, per shear of the fluid ∫ γ̇ dt. A fluid that does not deform is not
/// corrected: at rest, the differences in J balance the uneven spacing of the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeCorrection {
    /// Rate at which J approaches the mean around the particle, (7h).
    pub smoothing: f64,
    /// Rate at which J approaches the value at which particles fill the grid as at rest, (7i).
    pub correction: f64,
}

impl Default for VolumeCorrection {
    /// Rates of 5 and 3. Up to twenty times the smoothing and three times the correction preserve the
    /// volume of a sloshing tank equally well (docs/water.md).
    fn default() -> Self {
        Self {
            smoothing: 5.0,
            correction: 3.0,
        }
    }
}
