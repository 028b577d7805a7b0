//! Particles to add to a simulation, as plain data.

use crate::error::SetupError;
use crate::material::{DEFORMATION_GRADIENT, JACOBIAN, Rest, Variable};
use crate::math::Shape;
use core::ops::Range;

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
    /// Values of other internal variables of the model at the start. Variables that are not given are at
    /// rest.
    pub variables: Vec<StartingValues>,
}

/// The values of one internal variable at the start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartingValues {
    /// The name of one of the [`Model::variables`](crate::Model::variables), such as "plastic_J".
    pub name: String,
    /// The values, particle after particle; those of a matrix row by row.
    pub values: Vec<f64>,
}

impl StartingValues {
    /// Returns the values of the particles in `range`, of `count` particles in all.
    pub fn part(&self, range: Range<usize>, count: usize) -> Self {
        let width = self.values.len() / count.max(1);
        Self {
            name: self.name.clone(),
            values: self.values[range.start * width..range.end * width].to_vec(),
        }
    }
}

impl<const D: usize> ParticleBatch<D> {
    /// Checks the starting values against the variables of the model.
    pub(crate) fn check_variables(&self, table: &[Variable]) -> Result<(), SetupError> {
        for StartingValues { name, values } in &self.variables {
            let fail = |message: String| {
                Err(SetupError {
                    key: format!("batch.variables.{name}"),
                    message,
                })
            };
            let known =
                (table.iter()).find(|variable| variable.name == *name && !variable.is_hidden);
            let Some(variable) = known else {
                return fail("the model of these particles has no such variable".to_owned());
            };
            if name == JACOBIAN.name || name == DEFORMATION_GRADIENT.name {
                return fail("is given as the deformation of the batch".to_owned());
            }
            let count = self.position.len() * variable.shape.len(D);
            if values.len() != count {
                return fail(format!("has {} values; {count} are needed", values.len()));
            }
            let is_ratio = variable.rest == Rest::One && variable.shape == Shape::Scalar;
            if let Some(bad) = (values.iter()).find(|x| !x.is_finite() || is_ratio && **x <= 0.0) {
                let wanted = if is_ratio { "a positive" } else { "a finite" };
                return fail(format!("must be {wanted} number, not {bad}"));
            }
        }
        Ok(())
    }

    /// Returns the values that particle `i` starts with, by the names of their variables.
    pub(crate) fn variables_of(&self, i: usize) -> Vec<(&str, &[f64])> {
        let of_particle = |given: &StartingValues| {
            let width = given.values.len() / self.position.len();
            i * width..(i + 1) * width
        };
        (self.variables.iter())
            .map(|given| (given.name.as_str(), &given.values[of_particle(given)]))
            .collect()
    }
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
