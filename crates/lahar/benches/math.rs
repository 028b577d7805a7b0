//! Speed of the computations of single particles: decompositions and constitutive models.
//!
//! They run in lanes of the machine's widest instruction set, on numbers that stay in the first-level cache:
//! `cargo bench -p lahar --bench math`

use criterion::{Criterion, Throughput};
use fearless_simd::{Level, Simd, dispatch};
use lahar::material::{ConstitutiveModel, Corotated, Dust, NeoHookean, Snow, Variables, lame};
use lahar::math::{Lanes, Matrix, Real, polar, svd};
use lahar::{Model, material};
use std::hint::black_box;

/// Number of particles per call.
const BATCH: usize = 512;

/// The largest number of columns that a computation reads.
const COLUMNS: usize = 16;

/// Returns columns of small numbers, of the size of strains.
fn numbers<T: Lanes>() -> [Vec<T>; COLUMNS] {
    let mut state = 1_u64;
    let mut number = || {
        state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
        T::from_f64(0.02 * ((state >> 33) as f64 / f64::from(u32::MAX >> 1) - 0.5))
    };
    core::array::from_fn(|_| (0..BATCH).map(|_| number()).collect())
}

/// A computation on the numbers of a particle.
trait Work<const D: usize> {
    /// Returns the sum of all results, so that none is optimized away.
    fn of<R: Real>(&self, column: impl Fn(usize) -> R) -> R;
}

fn matrix<R: Real, const D: usize>(column: impl Fn(usize) -> R, identity: f64) -> Matrix<R, D> {
    Matrix::from_fn(|i, j| {
        let h = column(j * D + i);
        if i == j { h + h.lit(identity) } else { h }
    })
}

#[inline(always)]
fn sum<R: Real, const D: usize>(m: Matrix<R, D>) -> R {
    let mut sum = m[(0, 0)].zero();
    for j in 0..D {
        for i in 0..D {
            sum += m[(i, j)];
        }
    }
    sum
}

struct SingularValues;
impl<const D: usize> Work<D> for SingularValues {
    #[inline(always)]
    fn of<R: Real>(&self, column: impl Fn(usize) -> R) -> R {
        let svd = svd::<R, D>(matrix(column, 1.0));
        sum(svd.u) + sum(svd.v) + svd.sigma[0] + svd.sigma[D - 1]
    }
}

struct Rotation;
impl<const D: usize> Work<D> for Rotation {
    #[inline(always)]
    fn of<R: Real>(&self, column: impl Fn(usize) -> R) -> R {
        sum(polar::<R, D>(matrix(column, 1.0)).rotation)
    }
}

struct Stress<M>(M);
impl<const D: usize, M: ConstitutiveModel<D>> Work<D> for Stress<M> {
    #[inline(always)]
    fn of<R: Real>(&self, column: impl Fn(usize) -> R) -> R {
        let strain = M::Strain::<R>::read(&column);
        sum(self.0.kirchhoff_stress(strain, matrix(&column, 0.0)))
    }
}

struct Advance<M>(M);
impl<const D: usize, M: ConstitutiveModel<D>> Work<D> for Advance<M> {
    #[inline(always)]
    fn of<R: Real>(&self, column: impl Fn(usize) -> R) -> R {
        let strain = M::Strain::<R>::read(&column);
        let mut sum = column(0).zero();
        let advanced = self.0.advance(strain, matrix(&column, 0.0));
        advanced.write(|_, value| sum += value);
        sum
    }
}

#[inline(always)]
fn in_lanes<S: Simd, T: Lanes, const D: usize>(
    simd: S,
    work: &impl Work<D>,
    columns: &[Vec<T>; COLUMNS],
    out: &mut [T],
) {
    for k in (0..BATCH).step_by(T::WIDTH) {
        let result = work.of(|column| T::load(simd, &columns[column][k..]));
        T::store::<S>(result, &mut out[k..]);
    }
}

fn time<T: Lanes, const D: usize>(criterion: &mut Criterion, name: &str, work: &impl Work<D>) {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(BATCH as u64));
    let (columns, mut out) = (numbers::<T>(), vec![T::default(); BATCH]);
    let level = Level::new();
    group.bench_function(format!("{D}d-{}", T::NAME), |bencher| {
        bencher.iter(|| {
            let columns = black_box(&columns);
            dispatch!(level, simd => in_lanes(simd, work, columns, &mut out));
            black_box(&mut out);
        });
    });
    group.finish();
}

fn decompositions(criterion: &mut Criterion) {
    time::<f32, 2>(criterion, "svd", &SingularValues);
    time::<f32, 3>(criterion, "svd", &SingularValues);
    time::<f64, 3>(criterion, "svd", &SingularValues);
    time::<f32, 2>(criterion, "polar", &Rotation);
    time::<f32, 3>(criterion, "polar", &Rotation);
    time::<f64, 3>(criterion, "polar", &Rotation);
}

fn law<M: ConstitutiveModel<3>>(criterion: &mut Criterion, name: &str, model: M) {
    time::<f32, 3>(criterion, &format!("{name} stress"), &Stress(model));
    time::<f32, 3>(criterion, &format!("{name} advance"), &Advance(model));
}

fn laws(criterion: &mut Criterion) {
    let (lambda, mu) = lame(1e5, 0.3);
    law(criterion, "dust", Dust);
    for name in ["water", "mud"] {
        let preset = material::preset(name, 30.0).map(|material| material.model);
        let Some(Model::Fluid(fluid)) = preset else {
            unreachable!("{name} is a preset for fluids")
        };
        law(criterion, name, fluid);
    }
    law(criterion, "corotated", Corotated { lambda, mu });
    law(criterion, "neo-hookean", NeoHookean::from_lame(lambda, mu));
    law(criterion, "snow", Snow::default());
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    decompositions(&mut criterion);
    laws(&mut criterion);
    criterion.final_summary();
}
