//! A model as the engine runs it: on columns of storage, one chunk of particles at a time, compiled
//! for the instruction set in use.
//!
//! This is the seam between the solver and the laws. It is dynamic, with one call per chunk, so that
//! the compiled code is the sum of laws and transfers and not their product, and so that laws from
//! outside the crate run as fast as the built-in ones.

use super::variables::{Variable, Variables, columns, find};
use super::{ConstitutiveModel, FluidModel, Model, Strain, for_model};
use crate::dispatch::on_level;
use crate::math::{Lanes, Matrix, Vector};
use crate::particles::{Largest, Rows};
use core::ops::Deref;
use fearless_simd::{Level, Simd};

/// The state of one particle, as it follows from its strain and velocity gradient, in f64.
#[derive(Clone, Debug)]
pub struct ParticleState<const D: usize> {
    /// The Jacobian J.
    pub jacobian: f64,
    /// The deformation gradient F, row by row.
    pub deformation_gradient: [[f64; D]; D],
    /// −tr σ/d, with the Cauchy stress σ \[Pa\].
    pub pressure: f64,
}

/// The volume and the energy of one particle, in f64.
#[derive(Clone, Copy, Debug)]
pub struct ParticleEnergy {
    /// The Jacobian J.
    pub jacobian: f64,
    /// The energy density Φ \[Pa\].
    pub energy_density: f64,
}

/// An instruction set that the machine has, for laws.
#[derive(Clone, Copy, Debug)]
pub struct IsaToken(pub(crate) Level);

mod sealed {
    /// Only [`super::Compiled`] is a law.
    pub trait Sealed {}
}

/// A law on storage. Made from a [`ConstitutiveModel`] by [`law`]; it cannot be implemented by hand.
///
/// Methods on a chunk take particles `start .. start + count`, at most one chunk. The columns have a
/// whole chunk from `start` on.
pub trait Law<T: Lanes, const D: usize>: sealed::Sealed + Send + Sync {
    /// Returns the internal variables, in the order of their columns.
    fn variables(&self) -> &'static [Variable];
    /// Returns the number of columns of the internal variables.
    fn strain_columns(&self) -> usize {
        columns(self.variables(), D)
    }
    /// Writes J − 1 of a chunk, plastic flow included.
    fn jacobian_minus_one(
        &self,
        isa: IsaToken,
        strain: &[&[T]],
        start: usize,
        count: usize,
        out: &mut Rows<T>,
    );
    /// Writes the Kirchhoff stress of a chunk: `out[j·D + i][p]` = τ_ij \[Pa\].
    fn kirchhoff_stress(
        &self,
        isa: IsaToken,
        strain: &[&[T]],
        affine: &[&[T]],
        start: usize,
        count: usize,
        out: &mut [Rows<T>; 9],
    );
    /// Advances the strain of a chunk by Δt ∂v/∂x, laid out as `increment[j·D + i][p]`, and takes the
    /// wave moduli \[Pa\] after it into account.
    fn advance(
        &self,
        isa: IsaToken,
        strain: &mut [&mut [T]],
        start: usize,
        count: usize,
        increment: &[Rows<T>; 9],
        wave_modulus: &mut Largest<T>,
    );
    /// Returns the largest wave modulus \[Pa\] of the first `count` particles.
    fn wave_modulus(&self, strain: &[Vec<T>], count: usize) -> f64;
    /// Returns the viscosity that limits the time step \[Pa s\].
    fn viscosity(&self) -> f64;
    /// Returns the model as a fluid, or `None` if it is not one.
    fn fluid(&self) -> Option<&dyn FluidModel>;
    /// Returns the same law with another bulk modulus \[Pa\], if it is a fluid's.
    fn with_bulk_modulus(&self, bulk_modulus: f64) -> Box<dyn Law<T, D>>;
    /// Returns the columns of a particle that starts with the deformation gradient `f` and the `given`
    /// values of other variables: each with its name and its entries, those of a matrix row by row.
    fn start(&self, f: [[f64; D]; D], given: &[(&str, &[f64])]) -> Vec<f64>;
    /// Returns the state of a particle with these columns.
    fn describe(&self, strain: &[f64], velocity_gradient: [[f64; D]; D]) -> ParticleState<D>;
    /// Returns the volume and the energy of a particle with these columns.
    fn energy(&self, strain: &[f64]) -> ParticleEnergy;
}

/// Returns the law of a built-in model.
pub(crate) fn built_in<T: Lanes, const D: usize>(model: &Model) -> Box<dyn Law<T, D>> {
    for_model!(*model, model => law(model))
}

/// Returns the law of any model, your own included; see [`crate::Simulation::with_laws`].
///
/// ```
/// use lahar::material::{ConstitutiveModel, Dilatation, Dust, law};
/// use lahar::math::{Matrix, Real};
/// use lahar::{Material, Model, ParticleBatch, Setup, Simulate, Simulation};
///
/// /// A gas: p = K/J.
/// #[derive(Clone, Copy)]
/// struct Gas {
///     /// Bulk modulus at rest [Pa].
///     modulus: f64,
/// }
///
/// impl<const D: usize> ConstitutiveModel<D> for Gas {
///     type Strain<R: Real> = Dilatation<R>;
///     fn kirchhoff_stress<R: Real>(&self, strain: Dilatation<R>, _: Matrix<R, D>) -> Matrix<R, D> {
///         Matrix::scaled_identity(strain.jacobian_minus_one.lit(-self.modulus)) // τ = −J p I
///     }
///     fn advance<R: Real>(&self, strain: Dilatation<R>, increment: Matrix<R, D>) -> Dilatation<R> {
///         let e = strain.jacobian_minus_one;
///         Dilatation { jacobian_minus_one: e + increment.trace() * (e + e.one()) }
///     }
///     fn energy_density<R: Real>(&self, strain: Dilatation<R>) -> R {
///         -(strain.jacobian_minus_one + strain.jacobian_minus_one.one()).ln() * strain.jacobian_minus_one.lit(self.modulus)
///     }
///     fn wave_modulus<R: Real>(&self, strain: Dilatation<R>) -> R {
///         strain.jacobian_minus_one.lit(self.modulus)
///     }
/// }
///
/// // The model named in the setup is not used: the law given with it takes its place.
/// let material = Material { name: "gas".into(), density: 1.2, model: Model::Dust(Dust) };
/// let puff = ParticleBatch { position: vec![[0.0, 0.0]], volume: vec![0.01], ..Default::default() };
/// let mut simulation =
///     Simulation::<f32, 2>::with_laws(Setup::new(0.2, vec![material]), vec![law(Gas { modulus: 100.0 })], &[puff])?;
/// simulation.advance_to(0.01)?;
/// assert!(simulation.diagnostics().particle_volume > 0.01, "gas expands");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn law<T: Lanes, const D: usize, M: ConstitutiveModel<D> + 'static>(
    model: M,
) -> Box<dyn Law<T, D>> {
    Box::new(Compiled(model))
}

struct Compiled<M>(M);

impl<M> sealed::Sealed for Compiled<M> {}

/// Returns the columns of a particle that starts with F = I + `h` and the `given` values of other
/// variables; see [`Law::start`]. Names that the model does not have are passed over.
pub(crate) fn start<M: ConstitutiveModel<D>, const D: usize>(
    h: Matrix<f64, D>,
    given: &[(&str, &[f64])],
) -> Vec<f64> {
    let columns_of = |strain: M::Strain<f64>| {
        let mut columns = vec![0.0; <M::Strain<f64> as Variables<f64, D>>::COLUMNS];
        strain.write(|column, value| columns[column] = value);
        columns
    };
    let mut columns = columns_of(M::Strain::from_displacement_gradient(h));
    for (name, values) in given {
        let Some((first, variable)) = find(M::Strain::<f64>::TABLE, name, D) else {
            continue;
        };
        for (entry, value) in values.iter().enumerate() {
            columns[first + variable.column_of(entry, D)] = value - variable.rest_of(entry, D);
        }
    }
    columns_of(M::Strain::read(|column| columns[column]).with_hidden_variables())
}

/// Loads the vectors of a register of particles, from row `at` on.
#[inline(always)]
pub(crate) fn load_vector<S: Simd, T: Lanes, const D: usize>(
    simd: S,
    columns: &[impl Deref<Target = [T]>],
    at: usize,
) -> Vector<T::Of<S>, D> {
    let mut v = Vector([T::load(simd, &columns[0][at..]); D]);
    for axis in 1..D {
        v[axis] = T::load(simd, &columns[axis][at..]);
    }
    v
}

/// Loads the matrices of a register of particles, from row `at` on. The columns go through the
/// matrix column by column.
#[inline(always)]
pub(crate) fn load_matrix<S: Simd, T: Lanes, const D: usize>(
    simd: S,
    columns: &[impl Deref<Target = [T]>],
    at: usize,
) -> Matrix<T::Of<S>, D> {
    let mut m = Matrix([load_vector(simd, columns, at); D]);
    for j in 1..D {
        m.0[j] = load_vector(simd, &columns[j * D..], at);
    }
    m
}

impl<T: Lanes, const D: usize, M: ConstitutiveModel<D> + 'static> Law<T, D> for Compiled<M> {
    fn variables(&self) -> &'static [Variable] {
        <M::Strain<f64> as Variables<f64, D>>::TABLE
    }

    fn jacobian_minus_one(
        &self,
        isa: IsaToken,
        strain: &[&[T]],
        start: usize,
        count: usize,
        out: &mut Rows<T>,
    ) {
        on_level!(isa.0, simd => jacobian_chunk::<_, T, D, M>(simd, strain, start, count, out));
    }

    fn kirchhoff_stress(
        &self,
        isa: IsaToken,
        strain: &[&[T]],
        affine: &[&[T]],
        start: usize,
        count: usize,
        out: &mut [Rows<T>; 9],
    ) {
        let model = self.0;
        on_level!(isa.0, simd => stress_chunk::<_, T, D, M>(simd, &model, strain, affine, start, count, out));
    }

    fn advance(
        &self,
        isa: IsaToken,
        strain: &mut [&mut [T]],
        start: usize,
        count: usize,
        increment: &[Rows<T>; 9],
        wave_modulus: &mut Largest<T>,
    ) {
        let model = self.0;
        on_level!(isa.0, simd => {
            advance_chunk::<_, T, D, M>(simd, &model, strain, start, count, increment, wave_modulus);
        });
    }

    fn wave_modulus(&self, strain: &[Vec<T>], count: usize) -> f64 {
        let mut largest = 0.0_f64;
        for p in 0..count {
            let strain = M::Strain::<f64>::read(|column| strain[column][p].to_f64());
            largest = largest.max(self.0.wave_modulus(strain));
        }
        largest
    }

    fn viscosity(&self) -> f64 {
        self.0.viscosity()
    }

    fn fluid(&self) -> Option<&dyn FluidModel> {
        self.0.fluid()
    }

    fn with_bulk_modulus(&self, bulk_modulus: f64) -> Box<dyn Law<T, D>> {
        let mut model = self.0;
        if let Some(fluid) = model.fluid_mut() {
            fluid.set_bulk_modulus(bulk_modulus);
        }
        law(model)
    }

    fn start(&self, f: [[f64; D]; D], given: &[(&str, &[f64])]) -> Vec<f64> {
        let h = Matrix::from_fn(|i, j| f[i][j] - if i == j { 1.0 } else { 0.0 });
        start::<M, D>(h, given)
    }

    fn describe(&self, strain: &[f64], velocity_gradient: [[f64; D]; D]) -> ParticleState<D> {
        let strain = M::Strain::<f64>::read(|column| strain[column]);
        let h = strain.displacement_gradient();
        let jacobian = 1.0 + strain.jacobian_minus_one();
        let gradient = Matrix::from_fn(|i, j| velocity_gradient[i][j]);
        let tau = self.0.kirchhoff_stress(strain, gradient);
        ParticleState {
            jacobian,
            deformation_gradient: core::array::from_fn(|i| {
                core::array::from_fn(|j| h[(i, j)] + if i == j { 1.0 } else { 0.0 })
            }),
            pressure: -tau.trace() / (D as f64 * jacobian),
        }
    }

    fn energy(&self, strain: &[f64]) -> ParticleEnergy {
        let strain = M::Strain::<f64>::read(|column| strain[column]);
        ParticleEnergy {
            jacobian: 1.0 + strain.jacobian_minus_one(),
            energy_density: self.0.energy_density(strain),
        }
    }
}

#[inline(always)]
fn stress_chunk<S: Simd, T: Lanes, const D: usize, M: ConstitutiveModel<D>>(
    simd: S,
    model: &M,
    strain: &[&[T]],
    affine: &[&[T]],
    start: usize,
    count: usize,
    out: &mut [Rows<T>; 9],
) {
    let strain = &strain[..<M::Strain<f64> as Variables<f64, D>>::COLUMNS];
    let affine = &affine[..D * D];
    let mut p = 0;
    while p < count {
        let lanes = M::Strain::read(|column| T::load(simd, &strain[column][start + p..]));
        let gradient = load_matrix(simd, affine, start + p);
        let tau = model.kirchhoff_stress(lanes, gradient);
        for j in 0..D {
            for i in 0..D {
                T::store::<S>(tau[(i, j)], &mut out[j * D + i][p..]);
            }
        }
        p += T::WIDTH;
    }
}

#[inline(always)]
fn jacobian_chunk<S: Simd, T: Lanes, const D: usize, M: ConstitutiveModel<D>>(
    simd: S,
    strain: &[&[T]],
    start: usize,
    count: usize,
    out: &mut Rows<T>,
) {
    let strain = &strain[..<M::Strain<f64> as Variables<f64, D>>::COLUMNS];
    let mut p = 0;
    while p < count {
        let strain: M::Strain<T::Of<S>> =
            M::Strain::read(|column| T::load(simd, &strain[column][start + p..]));
        let (elastic, plastic) = (
            strain.jacobian_minus_one(),
            strain.plastic_jacobian_minus_one(),
        );
        T::store::<S>(elastic + plastic + elastic * plastic, &mut out[p..]);
        p += T::WIDTH;
    }
}

#[inline(always)]
fn advance_chunk<S: Simd, T: Lanes, const D: usize, M: ConstitutiveModel<D>>(
    simd: S,
    model: &M,
    strain: &mut [&mut [T]],
    start: usize,
    count: usize,
    increment: &[Rows<T>; 9],
    wave_modulus: &mut Largest<T>,
) {
    let strain = &mut strain[..<M::Strain<f64> as Variables<f64, D>>::COLUMNS];
    let mut p = 0;
    while p < count {
        let before = M::Strain::read(|column| T::load(simd, &strain[column][start + p..]));
        let mut change = Matrix([Vector([T::load(simd, &increment[0][p..]); D]); D]);
        for j in 0..D {
            for i in 0..D {
                change.0[j][i] = T::load(simd, &increment[j * D + i][p..]);
            }
        }
        let after = model.advance(before, change); // (7)
        after.write(|column, value| T::store::<S>(value, &mut strain[column][start + p..]));
        wave_modulus.include(simd, model.wave_modulus(after));
        p += T::WIDTH;
    }
}
