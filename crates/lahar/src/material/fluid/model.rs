//! The trait of fluids, beside that of all models.

use super::volume_rule::VolumeRule;

/// A constitutive model of a fluid, with the properties that solids lack. Its strain has the variable J
/// ([`JACOBIAN`](crate::material::JACOBIAN)).
pub trait FluidModel {
    /// Returns the source of J.
    fn volume_rule(&self) -> VolumeRule;

    /// Returns the bulk modulus at rest \[Pa\].
    fn bulk_modulus(&self) -> f64;

    /// Sets the bulk modulus at rest \[Pa\].
    fn set_bulk_modulus(&mut self, bulk_modulus: f64);

    /// Returns the J − 1 at which this fluid has the pressure that it had at `jacobian_minus_one` when
    /// its bulk modulus was `before` \[Pa\].
    fn at_same_pressure(&self, jacobian_minus_one: f64, before: f64) -> f64;
}
