//! A model as the engine runs it: on columns of storage, a chunk of particles at a time, compiled
//! for the instruction set in use.
//!
//! This is the seam between the solver and the laws. It is dynamic (one call a chunk), so that the
//! code is a sum of laws and transfers and not their product, and so that laws from outside the
//! crate run as fast as ours.

use super::{ConstitutiveModel, Model, Strain, VolumeCorrection, VolumeRule, for_model};
use crate::dispatch::on_level;
use crate::math::{Lanes, Matrix, Vector};
use crate::particles::{Largest, Rows};
use core::ops::Deref;
use fearless_simd::{Level, Simd};

/// What a law makes of the strain and velocity gradient of one particle, in f64.
#[derive(Clone, Debug)]
pub struct ParticleState<const D: usize> {
    /// J.
    pub jacobian: f64,
    /// F, `[i][j]`.
    pub deformation_gradient: [[f64; D]; D],
    /// J_P.
    pub plastic_jacobian: f64,
    /// −tr σ/d, σ the Cauchy stress \[Pa\].
    pub pressure: f64,
}

/// What one particle stores, in f64.
#[derive(Clone, Copy, Debug)]
pub struct ParticleEnergy {
    /// J.
    pub jacobian: f64,
    /// Φ \[Pa\].
    pub energy_density: f64,
}

/// An instruction set as laws get it.
#[derive(Clone, Copy, Debug)]
pub struct IsaToken(pub(crate) Level);

/// A law on storage. Made from a [`ConstitutiveModel`] by [`law`]; not to be implemented by hand.
pub trait Law<T: Lanes, const D: usize>: Send + Sync {
    /// Columns of strain a particle.
    fn strain_columns(&self) -> usize;
    /// The column of J − 1, for a model that gathers it from the grid before each substep.
    fn gathered_column(&self) -> Option<usize>;
    /// The column of J − 1 and how fast it is set right, for a model that wants that.
    fn corrected_column(&self) -> Option<(usize, VolumeCorrection)>;
    /// Writes J − 1 of particles `start .. start + count`, plastic flow included. Here as below, at most a
    /// chunk; columns have a whole one.
    fn jacobian_minus_one(
        &self,
        isa: IsaToken,
        strain: &[&[T]],
        start: usize,
        count: usize,
        out: &mut Rows<T>,
    );
    /// Writes Kirchhoff stress of particles `start .. start + count`: `out[j·D + i][p]` = τ_ij \[Pa\].
    fn kirchhoff_stress(
        &self,
        isa: IsaToken,
        strain: &[&[T]],
        affine: &[&[T]],
        start: usize,
        count: usize,
        out: &mut [Rows<T>; 9],
    );
    /// Advances the strain of particles `start .. start + count` by Δt ∂v/∂x, laid out as
    /// `increment[j·D + i][p]`, and takes their wave moduli \[Pa\] into account.
    fn advance(
        &self,
        isa: IsaToken,
        strain: &mut [&mut [T]],
        start: usize,
        count: usize,
        increment: &[Rows<T>; 9],
        wave_modulus: &mut Largest<T>,
    );
    /// The largest wave modulus \[Pa\] of `count` particles.
    fn wave_modulus(&self, strain: &[Vec<T>], count: usize) -> f64;
    /// Viscosity for the time step \[Pa s\].
    fn viscosity(&self) -> f64;
    /// Bulk modulus at rest \[Pa\], of a law that can be made stiffer while it runs.
    fn bulk_modulus(&self) -> Option<f64>;
    /// The law with another bulk modulus \[Pa\].
    fn with_bulk_modulus(&self, bulk_modulus: f64) -> Box<dyn Law<T, D>>;
    /// Gives every particle of `strain` the pressure that it had when the bulk modulus was `before` \[Pa\].
    fn keep_pressure(&self, before: f64, strain: &mut [Vec<T>]);
    /// Strain columns for a particle that starts with the deformation gradient `f` and J_P.
    fn start(&self, f: [[f64; D]; D], plastic_jacobian: f64) -> Vec<f64>;
    /// What the columns mean.
    fn describe(&self, strain: &[f64], velocity_gradient: [[f64; D]; D]) -> ParticleState<D>;
    /// What they store.
    fn energy(&self, strain: &[f64]) -> ParticleEnergy;
}

/// The law of a built-in model.
pub(crate) fn built_in<T: Lanes, const D: usize>(model: &Model) -> Box<dyn Law<T, D>> {
    for_model!(*model, model => law(model))
}

/// The law of any model, your own included; see [`crate::Simulation::with_laws`].
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

impl<M> Compiled<M> {
    fn jacobian_column<const D: usize>(&self) -> Option<usize>
    where
        M: ConstitutiveModel<D>,
    {
        <M::Strain<f64> as Strain<f64, D>>::JACOBIAN_COLUMN
    }
}

/// A vector of the register of particles from row `at` on, from its columns.
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

/// A matrix from its columns of numbers, column by column.
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
    fn strain_columns(&self) -> usize {
        <M::Strain<f64> as Strain<f64, D>>::COLUMNS
    }

    fn gathered_column(&self) -> Option<usize> {
        self.jacobian_column()
            .filter(|_| self.0.volume_rule() == VolumeRule::Gathered)
    }

    fn corrected_column(&self) -> Option<(usize, VolumeCorrection)> {
        match self.0.volume_rule() {
            VolumeRule::Corrected(rates) => Some((self.jacobian_column()?, rates)),
            VolumeRule::Jacobian | VolumeRule::Gathered => None,
        }
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

    fn bulk_modulus(&self) -> Option<f64> {
        self.0.bulk_modulus()
    }

    fn with_bulk_modulus(&self, bulk_modulus: f64) -> Box<dyn Law<T, D>> {
        law(self.0.with_bulk_modulus(bulk_modulus))
    }

    fn keep_pressure(&self, before: f64, strain: &mut [Vec<T>]) {
        let before = self.0.with_bulk_modulus(before);
        for p in 0..strain.first().map_or(0, Vec::len) {
            let old = M::Strain::<f64>::read(|column| strain[column][p].to_f64());
            self.0
                .at_same_pressure(old, &before)
                .write(|column, value| strain[column][p] = T::from_f64(value));
        }
    }

    fn start(&self, f: [[f64; D]; D], plastic_jacobian: f64) -> Vec<f64> {
        let h = Matrix::from_fn(|i, j| f[i][j] - if i == j { 1.0 } else { 0.0 });
        let strain = M::Strain::<f64>::from_displacement_gradient(h)
            .with_plastic_jacobian_minus_one(plastic_jacobian - 1.0);
        let mut columns = vec![0.0; <M::Strain<f64> as Strain<f64, D>>::COLUMNS];
        strain.write(|column, value| columns[column] = value);
        columns
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
            plastic_jacobian: 1.0 + strain.plastic_jacobian_minus_one(),
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
    let strain = &strain[..<M::Strain<f64> as Strain<f64, D>>::COLUMNS];
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
    let strain = &strain[..<M::Strain<f64> as Strain<f64, D>>::COLUMNS];
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
    let strain = &mut strain[..<M::Strain<f64> as Strain<f64, D>>::COLUMNS];
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
        wave_modulus.take(simd, model.wave_modulus(after));
        p += T::WIDTH;
    }
}
