//! Particles to add to a simulation, as plain data.

use core::ops::Range;

/// Particles to add to a simulation, all of one material. They are given to
/// [`Simulation::new`](crate::Simulation::new), [`Simulation::add`](crate::Simulation::add) or
/// [`Simulate::add_particles`](crate::Simulate::add_particles).
///
/// ```
/// use lahar::{Deformation, ParticleBatch};
///
/// // A square of 10 × 10 particles that moves to the right and is compressed by one percent.
/// let spacing = 0.01;
/// let place = |i: usize| spacing * (i as f64 + 0.5);
/// let position: Vec<_> = (0..100).map(|i| [place(i / 10), place(i % 10)]).collect();
/// let batch = ParticleBatch {
///     velocity: vec![[1.0, 0.0]],           // one for all
///     volume: vec![spacing * spacing],      // one for all, at rest
///     deformation: Deformation::Jacobian(vec![0.99; position.len()]),
///     position,
///     ..Default::default()
/// };
/// # let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// # lahar::Simulation::<f32, 2>::new(lahar::Setup::new(0.02, vec![jelly]), &[batch])?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ParticleBatch<const D: usize> {
    /// Index into [`Setup::materials`](crate::Setup::materials).
    pub material: usize,
    /// Number of the body they belong to, which the caller is free to choose.
    pub body: u32,
    /// Positions \[m\], one per particle.
    pub position: Vec<[f64; D]>,
    /// Velocities \[m/s\]: empty (at rest), one for all, or one per particle.
    pub velocity: Vec<[f64; D]>,
    /// Volumes at rest \[m³; m² in 2D\]: one for all, or one per particle.
    pub volume: Vec<f64>,
    /// True to measure the volumes on the grid: V⁰ of each particle becomes its given volume times the J of equation
    /// (7g). Masses stay.
    pub measure_volume: bool,
    /// Masses \[kg\]: empty (density × volume), one for all, or one per particle.
    pub mass: Vec<f64>,
    /// Affine matrices C \[1/s\], `c[i][j]` = ∂v_i/∂x_j: empty (zero), or one per particle.
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

/// Deformation of particles at the start.
#[derive(Clone, Debug, Default)]
pub enum Deformation<const D: usize> {
    /// None: F = I.
    #[default]
    Rest,
    /// Swollen or compressed evenly: J, one per particle, with F = J^(1/D) I.
    Jacobian(Vec<f64>),
    /// Deformation gradients `f[i][j]`, one per particle.
    Gradient(Vec<[[f64; D]; D]>),
}

impl ParticleBatch<3> {
    /// Leaves out the third components in 2D.
    pub(crate) fn in_dimension<const D: usize>(&self) -> ParticleBatch<D> {
        let vector = |a: &[f64; 3]| core::array::from_fn(|i| a[i]);
        let matrix = |a: &[[f64; 3]; 3]| core::array::from_fn(|i| vector(&a[i]));
        let count = self.position.len().max(1);
        let variable = |given: &StartingValues| StartingValues {
            name: given.name.clone(),
            values: match given.values.len() / count {
                3 => first_components::<D>(&given.values, 3),
                9 => first_components::<D>(&first_rows::<D>(&given.values), 3),
                _ => given.values.clone(),
            },
        };
        ParticleBatch {
            material: self.material,
            body: self.body,
            position: self.position.iter().map(vector).collect(),
            velocity: self.velocity.iter().map(vector).collect(),
            volume: self.volume.clone(),
            measure_volume: self.measure_volume,
            mass: self.mass.clone(),
            affine: self.affine.iter().map(matrix).collect(),
            deformation: match &self.deformation {
                Deformation::Rest => Deformation::Rest,
                Deformation::Jacobian(j) => Deformation::Jacobian(j.clone()),
                Deformation::Gradient(f) => Deformation::Gradient(f.iter().map(matrix).collect()),
            },
            variables: self.variables.iter().map(variable).collect(),
        }
    }
}

/// Keeps the first `D` of each `width` numbers.
fn first_components<const D: usize>(values: &[f64], width: usize) -> Vec<f64> {
    let rows = values.chunks_exact(width);
    rows.flat_map(|row| &row[..D]).copied().collect()
}

/// Keeps the first `D` rows of each 3 × 3 matrix.
fn first_rows<const D: usize>(values: &[f64]) -> Vec<f64> {
    let matrices = values.chunks_exact(9);
    matrices
        .flat_map(|matrix| &matrix[..3 * D])
        .copied()
        .collect()
}
