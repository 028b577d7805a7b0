//! Operations of the engine on the stored columns of fluids.

use super::{FluidModel, VolumeCorrection, VolumeRule};
use crate::material::{JACOBIAN, Law, find};
use crate::math::Lanes;

impl<T: Lanes, const D: usize> dyn Law<T, D> {
    /// The strain column of J − 1 of a fluid.
    fn jacobian_column(&self) -> Option<usize> {
        find(self.variables(), JACOBIAN.name, D).map(|(column, _)| column)
    }

    /// Returns the strain column of J − 1 if the fluid gathers it from the grid before each substep.
    pub(crate) fn gathered_column(&self) -> Option<usize> {
        match self.fluid()?.volume_rule() {
            VolumeRule::Gathered => self.jacobian_column(),
            VolumeRule::Jacobian | VolumeRule::Corrected(_) => None,
        }
    }

    /// Returns the strain column of J − 1 and the rates of correction if the fluid is corrected.
    pub(crate) fn corrected_column(&self) -> Option<(usize, VolumeCorrection)> {
        match self.fluid()?.volume_rule() {
            VolumeRule::Corrected(rates) => Some((self.jacobian_column()?, rates)),
            VolumeRule::Jacobian | VolumeRule::Gathered => None,
        }
    }

    /// Returns the bulk modulus at rest \[Pa\] of a fluid.
    pub(crate) fn bulk_modulus(&self) -> Option<f64> {
        self.fluid().map(FluidModel::bulk_modulus)
    }

    /// Changes J of every particle of a fluid such that the pressures stay what they were when the bulk
    /// modulus was `before` \[Pa\].
    pub(crate) fn keep_pressure(&self, before: f64, strain: &mut [Vec<T>]) {
        let (Some(fluid), Some(column)) = (self.fluid(), self.jacobian_column()) else {
            return;
        };
        for e in &mut strain[column] {
            *e = T::from_f64(fluid.at_same_pressure(e.to_f64(), before));
        }
    }
}
