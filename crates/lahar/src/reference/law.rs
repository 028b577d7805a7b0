//! Laws of the oracle: constitutive models on lists of numbers.

use crate::material::{
    ConstitutiveModel, FluidModel, Model, Strain, Variables, VolumeRule, for_model, start,
};
use crate::math::Matrix;

/// A [`ConstitutiveModel`] in `f64`, with its strain as a list of columns.
pub(super) trait Law<const D: usize> {
    fn start(&self, displacement_gradient: Matrix<f64, D>, given: &[(&str, &[f64])]) -> Vec<f64>;
    fn displacement_gradient(&self, strain: &[f64]) -> Matrix<f64, D>;
    fn jacobian_minus_one(&self, strain: &[f64]) -> f64;
    fn plastic_jacobian(&self, strain: &[f64]) -> f64;
    fn kirchhoff_stress(&self, strain: &[f64], gradient: Matrix<f64, D>) -> Matrix<f64, D>;
    fn advance(&self, strain: &[f64], increment: Matrix<f64, D>) -> Vec<f64>;
    fn energy_density(&self, strain: &[f64]) -> f64;
    fn volume_rule(&self) -> VolumeRule;
    fn rest_modulus(&self) -> f64;
}

/// Returns the law of a model.
pub(super) fn law<const D: usize>(model: &Model) -> &dyn Law<D> {
    for_model!(model, law => law)
}

impl<M: ConstitutiveModel<D>, const D: usize> Law<D> for M {
    fn start(&self, displacement_gradient: Matrix<f64, D>, given: &[(&str, &[f64])]) -> Vec<f64> {
        start::<M, D>(displacement_gradient, given)
    }
    fn displacement_gradient(&self, strain: &[f64]) -> Matrix<f64, D> {
        M::Strain::read(|column| strain[column]).displacement_gradient()
    }
    fn jacobian_minus_one(&self, strain: &[f64]) -> f64 {
        M::Strain::read(|column| strain[column]).jacobian_minus_one()
    }
    fn plastic_jacobian(&self, strain: &[f64]) -> f64 {
        1.0 + M::Strain::read(|column| strain[column]).plastic_jacobian_minus_one()
    }
    fn kirchhoff_stress(&self, strain: &[f64], gradient: Matrix<f64, D>) -> Matrix<f64, D> {
        self.kirchhoff_stress(M::Strain::read(|column| strain[column]), gradient)
    }
    fn advance(&self, strain: &[f64], increment: Matrix<f64, D>) -> Vec<f64> {
        columns(self.advance(M::Strain::read(|column| strain[column]), increment))
    }
    fn energy_density(&self, strain: &[f64]) -> f64 {
        self.energy_density(M::Strain::<f64>::read(|column| strain[column]))
    }
    fn rest_modulus(&self) -> f64 {
        self.wave_modulus(M::Strain::rest(0.0_f64))
    }

    fn volume_rule(&self) -> VolumeRule {
        ConstitutiveModel::<D>::fluid(self).map_or(VolumeRule::Jacobian, FluidModel::volume_rule)
    }
}

fn columns<S: Strain<f64, D>, const D: usize>(strain: S) -> Vec<f64> {
    let mut columns = vec![0.0; S::COLUMNS];
    strain.write(|column, value| columns[column] = value);
    columns
}
