//! Every constitutive model, tested by the physics that all models share.
//!
//! One line of [`conforms!`] gives a model all the tests of the first part: no stress and no energy at rest;
//! τ = (∂Φ/∂F) Fᵀ by finite differences; frame indifference and isotropy; the same numbers in f32 and in the lanes of every
//! instruction set; small strains that do not drown in rounding; and a wave modulus that is an upper bound.

use crate::fluids::PASTE;
use fearless_simd::{Level, Simd, dispatch};
use lahar::material::{
    ConstitutiveModel, Corotated, DisplacementGradient, Dust, Eos, Fluid, HardeningFrom,
    JacobianUpdate, LOGARITHM_ENDS, LinearElastic, Model, NeoHookean, PlasticGradient, Rheology,
    Snow, Strain, Variables, lame, lame_from_bulk_and_shear, preset, presets,
};
use lahar::math::{Lanes, Matrix, Scalar, Vector, polar, svd};
use lahar::{
    Domain, Field, Material, ParticleBatch, Setup, Sides, Simulate, Simulation, TimeStep, WallStyle,
};
use lahar_lab::method::random::Random;

// ---- One line per model ----

/// Makes a module of tests of one model, in 2D and 3D.
macro_rules! conforms {
    ($name:ident, $model:expr) => {
        conforms!($name, $model, frame_indifferent_and_isotropic);
    };
    ($name:ident, $model:expr, $indifference:ident) => {
        mod $name {
            use super::*;
            conforms!(@tests $model;
                nothing_at_rest,
                stress_is_the_gradient_of_energy,
                $indifference,
                single_precision,
                lanes_of_every_instruction_set,
                small_strains_survive_single_precision,
                wave_modulus_is_a_bound,
                follows_the_motion,
                storage_keeps_everything,
            );
        }
    };
    (@tests $model:expr; $($test:ident,)*) => {
        $(
            #[test]
            fn $test() {
                super::$test::<_, 2>(&$model);
                super::$test::<_, 3>(&$model);
            }
        )*
    };
}

conforms!(dust, Dust);
conforms!(water, Fluid::water_like(1000.0, 10.0));
conforms!(
    honey,
    Fluid {
        viscosity: 5.0,
        bulk_viscosity: 2.0,
        ..Fluid::water_like(1400.0, 10.0)
    }
);
conforms!(
    tait_1,
    Fluid {
        tension: f64::INFINITY,
        ..Fluid::inviscid(400.0)
    }
);
conforms!(
    paste,
    Fluid {
        rheology: Rheology::HerschelBulkley(PASTE),
        ..Fluid::water_like(1000.0, 10.0)
    }
);
conforms!(tait_1_without_tension, Fluid::inviscid(400.0));
conforms!(
    tait_air,
    Fluid {
        eos: Eos::Tait { gamma: 1.4 },
        tension: 3e4,
        ..Fluid::inviscid(1e5)
    }
);
conforms!(
    linear_j,
    Fluid {
        eos: Eos::LinearJ,
        tension: 30.0,
        jacobian_update: JacobianUpdate::Determinant,
        ..Fluid::inviscid(277.0)
    }
);
conforms!(corotated, Corotated::new(1e4, 0.3));
conforms!(corotated_auxetic, Corotated::new(1e4, -0.3));
conforms!(neo_hookean, NeoHookean::new(1e4, 0.3));
conforms!(rubber, NeoHookean::new(2e6, 0.49));
conforms!(snow, Snow::default());
conforms!(
    linear_elastic,
    LinearElastic::new(1e4, 0.3),
    indifferent_to_first_order
);

// ---- Checks of any model ----

fn nothing_at_rest<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    fn check<M: ConstitutiveModel<D>, T: Scalar, const D: usize>(model: &M, zero: T) {
        let rest = M::Strain::<T>::rest(zero);
        let still = Matrix::scaled_identity(zero);
        assert_eq!(model.kirchhoff_stress(rest, still), still);
        assert_eq!(model.energy_density(rest), zero);
        assert_eq!(rest.jacobian_minus_one(), zero);
        assert_eq!(rest.displacement_gradient(), still);
        let moved = model.advance(rest, still);
        assert_eq!(moved.displacement_gradient(), still);
        assert_eq!(model.kirchhoff_stress(moved, still), still);
    }
    check::<M, f32, D>(model, 0.0);
    check::<M, f64, D>(model, 0.0);
}

fn stress_is_the_gradient_of_energy<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    // With this seed no sample lies so close to a tension cut-off that the differences straddle it.
    let mut random = Random(4);
    for size in [1e-3, 0.1, 0.4] {
        for _ in 0..50 {
            let h = random.regular(size);
            let error = (stress(model, h) - gradient_stress(model, h)).norm();
            let scale = modulus(model, h);
            assert!(error <= 1e-8 * scale, "{error} of {scale} at {h:?}");
            assert!(energy(model, h) >= 0.0);
        }
    }
}

fn frame_indifferent_and_isotropic<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    let mut random = Random(1);
    for _ in 0..100 {
        let h: Matrix<f64, D> = random.regular(0.4);
        let l: Matrix<f64, D> = random.matrix(1.0);
        let q: Matrix<f64, D> = random.rotation();
        let shift = q - identity();
        let seen = |h, l| model.kirchhoff_stress(M::Strain::from_displacement_gradient(h), l);
        let tau = seen(h, l);
        let scale = 1e-12 * (modulus(model, h) + tau.norm());

        let turned = seen(q * h + shift, q * l * q.transpose());
        let error = (turned - q * tau * q.transpose()).norm();
        assert!(error <= scale, "frame: {error} at {h:?}");
        let grain = (seen(h * q + shift, l) - tau).norm();
        assert!(grain <= scale, "isotropy: {grain} at {h:?}");
        let energies = (energy(model, q * h + shift) - energy(model, h)).abs();
        assert!(energies <= scale, "energy: {energies} at {h:?}");
        assert!((tau - tau.transpose()).norm() <= scale, "symmetry at {h:?}");
    }
}

/// The error is of second order where strains and rotations are small, and of first order only for
/// large rotations.
fn indifferent_to_first_order<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    let mut random = Random(1);
    let rest = modulus(model, Matrix::<f64, D>::scaled_identity(0.0));
    for size in [1e-2, 1e-3, 1e-4] {
        for _ in 0..50 {
            let h: Matrix<f64, D> = random.matrix(size);
            let spin: Matrix<f64, D> = random.matrix(size);
            let q = polar(identity() + (spin - spin.transpose())).rotation;
            let shift = q - identity();
            let tau = stress(model, h);
            let turned = stress(model, q * h + shift);
            let error = (turned - q * tau * q.transpose()).norm();
            assert!(
                error <= 10.0 * size * size * rest,
                "frame: {error} at {h:?}"
            );
            let grain = (stress(model, h * q + shift) - tau).norm();
            assert!(
                grain <= 10.0 * size * size * rest,
                "isotropy: {grain} at {h:?}"
            );
            let skew = (tau - tau.transpose()).norm();
            assert!(
                skew <= 10.0 * size * size * rest,
                "symmetry: {skew} at {h:?}"
            );
        }
    }
    // A quarter turn is taken for a compression.
    let mut quarter: Matrix<f64, D> = identity();
    quarter.0[0] = Vector::from_fn(|i| f64::from(i == 1));
    quarter.0[1] = Vector::from_fn(|i| -f64::from(i == 0));
    assert!(stress(model, quarter - identity()).norm() > 0.1 * rest);
}

fn single_precision<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    let mut random = Random(1);
    for _ in 0..200 {
        let (h, l) = (single(random.regular(0.4)), single(random.matrix(1.0)));
        let error = {
            let exact = model.kirchhoff_stress(M::Strain::from_displacement_gradient(h), l);
            let ours = model.kirchhoff_stress(
                M::Strain::from_displacement_gradient(cast::<f32, D>(h)),
                cast::<f32, D>(l),
            );
            (cast_up(ours) - exact).norm()
        };
        let scale = modulus(model, h);
        assert!(error <= 3e-6 * scale, "{error} of {scale} at {h:?}");
        let ours = model.wave_modulus(M::Strain::from_displacement_gradient(cast::<f32, D>(h)));
        assert!((f64::from(ours) - scale).abs() <= 3e-5 * scale);
    }
}

fn lanes_of_every_instruction_set<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    for (name, level) in levels() {
        // Without fused multiply-adds lanes do what scalars do, to the bit.
        let fused = if name == "portable" { 0.0 } else { 1.0 };
        in_lanes_as_in_scalars::<M, f32, D>(model, name, level, 4e-6 * fused);
        in_lanes_as_in_scalars::<M, f64, D>(model, name, level, 1e-14 * fused);
    }
}

fn small_strains_survive_single_precision<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    let mut random = Random(1);
    let worst = (0..200).fold(0.0, |worst: f64, _| {
        let h = single(random.matrix(1e-6));
        let exact = stress(model, h);
        let strain = M::Strain::<f32>::from_displacement_gradient(cast(h));
        let ours = cast_up(model.kirchhoff_stress(strain, Matrix::scaled_identity(0.0)));
        if exact.norm() == 0.0 {
            assert_eq!(ours.norm(), 0.0);
            return worst;
        }
        let stored = energy(model, h);
        let relative = (f64::from(model.energy_density(strain)) - stored).abs() / stored;
        assert!(relative <= 1e-4, "energy off by {relative} at {h:?}");
        worst.max((ours - exact).norm() / exact.norm())
    });
    assert!(worst <= 1e-5, "{worst}");
}

/// Checks `wave_modulus` against plane waves a e^{ik(n·x − ct)}: ρ₀c² is the largest eigenvalue of
/// (∂P_iJ/∂F_kL)(Fᵀn)_J (Fᵀn)_L over all directions n.
fn wave_modulus_is_a_bound<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    let zero = Matrix::scaled_identity(0.0);
    let (rest, exact) = (modulus(model, zero), largest_stiffness(model, zero, 0.0));
    // At rest, a law without tension is stiff on one side only, so central differences give half the modulus.
    assert!(
        exact <= rest * (1.0 + 1e-6) && exact >= rest * 0.49,
        "{exact} {rest}"
    );

    let mut random = Random(1);
    for (size, samples) in [(0.02, 20), (0.3, 60), (0.9, 60)] {
        let mut loosest: f64 = 0.0;
        for _ in 0..samples {
            let h = random.regular(size);
            let (bound, exact) = (
                modulus(model, h),
                largest_stiffness(model, h, random.signed()),
            );
            assert!(
                exact <= bound * (1.0 + 1e-6),
                "{exact} above {bound} at {h:?}"
            );
            // Beyond a cut-off there is no stiffness to compare with.
            if exact > 0.01 * rest {
                loosest = loosest.max(bound / exact);
            }
        }
        assert!(loosest <= if size < 0.1 { 1.3 } else { 4.0 }, "{loosest}");
    }
}

fn follows_the_motion<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
    let mut random = Random(1);
    let mut strain = M::Strain::<f64>::rest(0.0);
    let mut f: Matrix<f64, D> = identity();
    for _ in 0..10 {
        let increment = random.matrix(1e-4);
        strain = model.advance(strain, increment);
        f = (identity() + increment) * f;
    }
    let jacobian = f.determinant() - 1.0;
    // 1 + tr and det differ to second order.
    assert!((strain.jacobian_minus_one() - jacobian).abs() <= 1e-6);
    if M::Strain::<f64>::COLUMNS >= D * D {
        let error = strain.displacement_gradient() - (f - identity());
        assert!(error.norm() <= 1e-15, "{error:?}");
    }
}

fn storage_keeps_everything<M: ConstitutiveModel<D>, const D: usize>(_: &M) {
    let columns = M::Strain::<f64>::COLUMNS;
    let stored: Vec<f64> = (0..columns).map(|i| 0.01 * (i as f64 + 1.0)).collect();
    let strain = M::Strain::<f64>::read(|column| stored[column]);
    let mut again = vec![f64::NAN; columns];
    strain.write(|column, value| again[column] = value);
    assert_eq!(stored, again);
    let h = strain.displacement_gradient();
    let jacobian = h.determinant_of_identity_plus_minus_one();
    assert!((jacobian - strain.jacobian_minus_one()).abs() < 1e-15);
}

// ---- Helpers of these checks ----

/// Random matrices for the checks.
pub(crate) trait Matrices {
    fn matrix<const D: usize>(&mut self, size: f64) -> Matrix<f64, D>;
    /// A displacement gradient with entries up to `size` and J > ⅕, seen from a random frame.
    fn regular<const D: usize>(&mut self, size: f64) -> Matrix<f64, D>;
    fn rotation<const D: usize>(&mut self) -> Matrix<f64, D>;
    fn direction<const D: usize>(&mut self) -> Vector<f64, D>;
}

impl Matrices for Random {
    fn matrix<const D: usize>(&mut self, size: f64) -> Matrix<f64, D> {
        Matrix::from_fn(|_, _| size * self.signed())
    }
    fn regular<const D: usize>(&mut self, size: f64) -> Matrix<f64, D> {
        let q = self.rotation();
        loop {
            let h = self.matrix(size);
            if h.determinant_of_identity_plus_minus_one() > -0.8 {
                return q * h + (q - identity());
            }
        }
    }
    fn rotation<const D: usize>(&mut self) -> Matrix<f64, D> {
        svd(self.matrix(1.0)).u
    }
    fn direction<const D: usize>(&mut self) -> Vector<f64, D> {
        let v = Vector::from_fn(|_| self.signed());
        v * (1.0 / v.norm())
    }
}

pub(crate) trait Norm {
    fn norm(self) -> f64;
}
impl<const D: usize> Norm for Matrix<f64, D> {
    fn norm(self) -> f64 {
        self.squared_norm().sqrt()
    }
}

pub(crate) fn identity<const D: usize>() -> Matrix<f64, D> {
    Matrix::identity(1.0)
}
fn cast<T: Scalar, const D: usize>(m: Matrix<f64, D>) -> Matrix<T, D> {
    Matrix::from_fn(|i, j| T::from_f64(m[(i, j)]))
}
fn cast_up<T: Scalar, const D: usize>(m: Matrix<T, D>) -> Matrix<f64, D> {
    Matrix::from_fn(|i, j| m[(i, j)].to_f64())
}
/// Rounds to numbers that f32 can represent.
fn single<const D: usize>(m: Matrix<f64, D>) -> Matrix<f64, D> {
    cast_up(cast::<f32, D>(m))
}

fn stress<M: ConstitutiveModel<D>, const D: usize>(model: &M, h: Matrix<f64, D>) -> Matrix<f64, D> {
    model.kirchhoff_stress(
        M::Strain::from_displacement_gradient(h),
        Matrix::scaled_identity(0.0),
    )
}
pub(crate) fn energy<M: ConstitutiveModel<D>, const D: usize>(model: &M, h: Matrix<f64, D>) -> f64 {
    model.energy_density(M::Strain::from_displacement_gradient(h))
}
fn modulus<M: ConstitutiveModel<D>, const D: usize>(model: &M, h: Matrix<f64, D>) -> f64 {
    model.wave_modulus(M::Strain::from_displacement_gradient(h))
}

/// Returns ∂f/∂F_kl by differences of fourth order.
fn derivative<const D: usize>(
    h: Matrix<f64, D>,
    (k, l): (usize, usize),
    f: impl Fn(Matrix<f64, D>) -> f64,
) -> f64 {
    let step = 1e-6;
    let at = |times: f64| {
        let mut moved = h;
        moved[(k, l)] += times * step;
        f(moved)
    };
    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step)
}

/// Returns (∂Φ/∂F) Fᵀ by differences.
fn gradient_stress<M: ConstitutiveModel<D>, const D: usize>(
    model: &M,
    h: Matrix<f64, D>,
) -> Matrix<f64, D> {
    let p = Matrix::from_fn(|i, j| derivative(h, (i, j), |h| energy(model, h)));
    p * (identity() + h).transpose()
}

/// Returns F⁻¹ from its cofactors, which are the derivatives of the determinant.
fn inverse<const D: usize>(f: Matrix<f64, D>) -> Matrix<f64, D> {
    let determinant = f.determinant();
    Matrix::from_fn(|i, j| {
        // The determinant is linear in each entry, so this derivative by f_ji is exact.
        let with = |value: f64| {
            let mut changed = f;
            changed[(j, i)] = value;
            changed.determinant()
        };
        (with(1.0) - with(0.0)) / determinant
    })
}

/// Returns the largest ρ₀c² of plane waves along the principal axes and in random directions that `seed` selects.
fn largest_stiffness<M: ConstitutiveModel<D>, const D: usize>(
    model: &M,
    h: Matrix<f64, D>,
    seed: f64,
) -> f64 {
    let first_piola = |h: Matrix<f64, D>| stress(model, h) * inverse(identity() + h).transpose();
    let tangent = |k: usize, l: usize| -> Matrix<f64, D> {
        Matrix::from_fn(|i, j| derivative(h, (k, l), |h| first_piola(h)[(i, j)]))
    };
    let tangents: [[Matrix<f64, D>; D]; D] =
        std::array::from_fn(|k| std::array::from_fn(|l| tangent(k, l)));
    let f = identity() + h;

    let mut random = Random(1);
    random.0 ^= seed.to_bits();
    let principal = svd(f).u;
    let directions = principal
        .0
        .into_iter()
        .chain((0..30).map(|_| random.direction()));
    let stiffness = directions.map(|n| {
        let m = f.transpose() * n;
        let mut acoustic = Matrix::<f64, D>::scaled_identity(0.0);
        for (k, row) in tangents.iter().enumerate() {
            for (l, tangent) in row.iter().enumerate() {
                let column = *tangent * m * m[l];
                for i in 0..D {
                    acoustic[(i, k)] += column[i];
                }
            }
        }
        // The matrix is symmetric: its singular values, with their signs, are its eigenvalues.
        let parts = svd((acoustic + acoustic.transpose()) * 0.5);
        (0..D)
            .map(|i| parts.sigma[i] * parts.u.0[i].dot(parts.v.0[i]).signum())
            .fold(0.0, f64::max)
    });
    stiffness.fold(0.0, f64::max)
}

/// Returns the instruction sets that this machine has.
fn levels() -> Vec<(&'static str, Level)> {
    let mut levels = vec![("portable", Level::baseline())];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        let best = Level::new();
        levels.extend(best.as_avx2().map(|token| ("avx2", Level::Avx2(token))));
        levels.extend(
            best.as_avx512()
                .map(|token| ("avx512", Level::Avx512(token))),
        );
    }
    #[cfg(target_arch = "aarch64")]
    levels.extend(
        Level::new()
            .as_neon()
            .map(|token| ("neon", Level::Neon(token))),
    );
    levels
}

/// The results of a model for one register of particles, by columns.
#[derive(Default)]
struct Results<T> {
    /// τ by columns of the matrix, then Φ and the wave modulus.
    stress: Vec<Vec<T>>,
    /// The strain after a substep.
    strain: Vec<Vec<T>>,
}

#[inline(always)]
fn evaluate<S: Simd, M: ConstitutiveModel<D>, T: Lanes, const D: usize>(
    simd: S,
    model: &M,
    columns: &[Vec<T>],
) -> Results<T> {
    let load = |column: usize| T::load(simd, &columns[column]);
    let store = |value: T::Of<S>| {
        let mut stored = vec![T::default(); T::WIDTH];
        T::store(value, &mut stored);
        stored
    };
    let count = M::Strain::<T::Of<S>>::COLUMNS;
    let strain = M::Strain::<T::Of<S>>::read(load);
    let gradient = Matrix::from_fn(|i, j| load(count + j * D + i));
    let mut results = Results::default();

    let tau = model.kirchhoff_stress(strain, gradient);
    let entries = (0..D * D).map(|k| tau[(k % D, k / D)]);
    let scalars = [model.energy_density(strain), model.wave_modulus(strain)];
    results.stress.extend(entries.chain(scalars).map(store));
    results.strain.resize(count, Vec::new());
    model
        .advance(strain, gradient)
        .write(|column, value| results.strain[column] = store(value));
    results
}

fn in_lanes_as_in_scalars<M: ConstitutiveModel<D>, T: Lanes, const D: usize>(
    model: &M,
    name: &str,
    level: Level,
    tolerance: f64,
) {
    let mut random = Random(1);
    let count = M::Strain::<T>::COLUMNS;
    for size in [1e-3, 0.05, 0.3] {
        let particles: Vec<Vec<T>> = (0..T::WIDTH)
            .map(|_| {
                let h = cast::<T, D>(random.regular(size));
                let l = cast::<T, D>(random.matrix(size));
                let mut row = vec![T::default(); count];
                M::Strain::<T>::from_displacement_gradient(h)
                    .write(|column, value| row[column] = value);
                row.extend(l.0.into_iter().flat_map(|column| column.0));
                row
            })
            .collect();
        let columns: Vec<Vec<T>> = (0..count + D * D)
            .map(|column| particles.iter().map(|row| row[column]).collect())
            .collect();
        let ours = dispatch!(level, simd => evaluate::<_, M, T, D>(simd, model, &columns));

        for (lane, row) in particles.iter().enumerate() {
            let strain = M::Strain::<T>::read(|column| row[column]);
            let gradient = Matrix::from_fn(|i, j| row[count + j * D + i]);
            let modulus = model.wave_modulus(strain);
            let tau = model.kirchhoff_stress(strain, gradient);
            let close = |quantity: &str, ours: T, exact: T, scale: f64| {
                let error = (ours.to_f64() - exact.to_f64()).abs();
                let allowed = tolerance * scale;
                assert!(
                    error <= allowed,
                    "{name} {} {quantity}: {ours:?} for {exact:?}",
                    T::NAME
                );
            };
            for k in 0..D * D {
                close(
                    "stress",
                    ours.stress[k][lane],
                    tau[(k % D, k / D)],
                    modulus.to_f64(),
                );
            }
            let energy = model.energy_density(strain);
            close("energy", ours.stress[D * D][lane], energy, modulus.to_f64());
            close(
                "modulus",
                ours.stress[D * D + 1][lane],
                modulus,
                modulus.to_f64(),
            );
            model.advance(strain, gradient).write(|column, value| {
                close("strain", ours.strain[column][lane], value, 2.0);
            });
        }
    }
}

// ---- Solids ----

/// Stress of the neo-Hookean and corotated laws is the gradient of their energies at J ≤ 0 too, and is bounded there.
#[test]
fn solids_turned_inside_out_have_an_energy() {
    fn check<M: ConstitutiveModel<D>, const D: usize>(model: &M) {
        let mut random = Random(1);
        let mut met = 0;
        while met < 40 {
            let h: Matrix<f64, D> = random.matrix(1.6);
            let f = identity() + h;
            let (j, sigma) = (f.determinant(), svd(f).sigma);
            // Skips places near which the nearest rotation or the law is not smooth.
            let kink = (j - LOGARITHM_ENDS).abs() < 1e-3;
            if !(-1.0..LOGARITHM_ENDS).contains(&j) || kink || sigma[D - 2] + sigma[D - 1] < 0.1 {
                continue;
            }
            met += 1;
            let error = (stress(model, h) - gradient_stress(model, h)).norm();
            assert!(error <= 1e-7 * modulus(model, h), "{error} at {h:?}");
            let (bound, exact) = (modulus(model, h), largest_stiffness(model, h, 0.0));
            assert!(
                exact <= bound * (1.0 + 1e-6),
                "{exact} above {bound} at {h:?}"
            );
        }
    }
    check::<_, 2>(&NeoHookean::new(1e4, 0.3));
    check::<_, 3>(&NeoHookean::new(1e4, 0.3));
    check::<_, 2>(&Corotated::new(1e4, 0.3));
    check::<_, 3>(&Corotated::new(1e4, 0.3));
}

/// Bodies pressed flat, with F = diag(1, 0, 0) or 0, have finite stress.
#[test]
fn solids_pressed_flat_stay_finite() {
    fn check<M: ConstitutiveModel<3>>(model: &M) {
        for flat in [0.0f32, -1.0] {
            let h = Matrix::from_diagonal(Vector([flat, -1.0, -1.0]));
            let strain = M::Strain::from_displacement_gradient(h);
            let tau = model.kirchhoff_stress(strain, Matrix::scaled_identity(0.0));
            assert!(tau.squared_norm().is_finite(), "{tau:?}");
            assert!(model.wave_modulus(strain).is_finite());
            assert!(model.energy_density(strain).is_finite());
        }
    }
    check(&Corotated::new(1e4, 0.3));
    check(&NeoHookean::new(1e4, 0.3));
    check(&Snow::default());
}

// ---- Linear elasticity ----

/// Waves in a slab without ends: u = a sin(k x) cos(k c t), along the direction of travel with
/// c² = (λ + 2μ)/ρ, and across it with c² = μ/ρ. The velocity of every particle is compared over one
/// period.
fn carries_waves<const D: usize>()
where
    f64: lahar::Instance<D>,
{
    const CELLS: usize = 40;
    const DENSITY: f64 = 2.0;
    const SPEED: f64 = 1e-3;
    let dx = 1.0 / CELLS as f64;
    let law = LinearElastic::new(50.0, 0.25);
    let wave_number = core::f64::consts::TAU;
    for (axis, modulus) in [(0, law.lambda + 2.0 * law.mu), (1, law.mu)] {
        let mut position = vec![];
        for cell in 0..(2 * CELLS) * 8_usize.pow(D as u32 - 1) {
            let rest = cell / (2 * CELLS);
            let index = [cell % (2 * CELLS), rest % 8, rest / 8];
            position.push(core::array::from_fn::<_, D, _>(|i| {
                (index[i] as f64 + 0.5) * dx / 2.0
            }));
        }
        let profile: Vec<f64> = position
            .iter()
            .map(|x| (wave_number * x[0]).sin())
            .collect();
        let velocity = (profile.iter())
            .map(|sine| core::array::from_fn(|i| if i == axis { SPEED * sine } else { 0.0 }))
            .collect();
        let batch = ParticleBatch {
            position,
            velocity,
            volume: vec![(dx / 2.0).powi(D as i32)],
            ..ParticleBatch::default()
        };
        let material = Material {
            name: "slab".into(),
            density: DENSITY,
            model: Model::LinearElastic(law),
        };
        let frequency = wave_number * (modulus / DENSITY).sqrt();
        let steps = 400;
        let dt = core::f64::consts::TAU / frequency / f64::from(steps);
        let mut max = [4.0 * dx; D];
        max[0] = 1.0;
        let setup = Setup {
            domain: Some(Domain {
                min: [0.0; D],
                max,
                sides: [Sides::Periodic; D],
                style: WallStyle::Plane,
            }),
            time_step: TimeStep::Fixed(dt),
            ..Setup::new(dx, vec![material])
        };
        let mut simulation = Simulation::<f64, D>::new(setup, &[batch]).unwrap();
        for step in 1..=steps {
            simulation.substep().unwrap();
            // Velocities of the leapfrog belong to the middle of a substep.
            let exact = SPEED * (frequency * (f64::from(step) + 0.5) * dt).cos();
            let velocities = simulation.snapshot(&[Field::Velocity]).columns[0]
                .1
                .to_f64();
            for (v, sine) in velocities.chunks_exact(D).zip(&profile) {
                let error = (v[axis] - exact * sine).abs();
                assert!(error < 0.03 * SPEED, "axis {axis}, substep {step}: {error}");
            }
        }
    }
}

#[test]
fn linear_elasticity_carries_waves_2d() {
    carries_waves::<2>();
}

#[test]
fn linear_elasticity_carries_waves_3d() {
    carries_waves::<3>();
}

// ---- Snow ----

/// Compares with mpm99's order of operations, written for axis-parallel stretches: F is updated, h is evaluated, F yields,
/// J_P is updated, stress follows. That is `Previous`; `Updated` evaluates h last.
#[test]
fn snow_follows_mpm99_in_either_order() {
    for hardening_from in [HardeningFrom::Previous, HardeningFrom::Updated] {
        let law = Snow {
            critical_stretch: 4.5e-3,
            hardening_from,
            ..Snow::new(1000.0, 0.2)
        };
        let (lambda, mu) = lame(1000.0, 0.2);
        let mut random = Random(1);
        let mut strain = PlasticGradient::<f64, 2>::rest(0.0);
        let (mut sigma, mut plastic): ([f64; 2], f64) = ([1.0; 2], 1.0);
        for _ in 0..500 {
            let step = Vector::<f64, 2>::from_fn(|_| 8e-3 * random.signed());
            strain = law.advance(strain, Matrix::from_diagonal(step));

            let before = (10.0 * (1.0 - plastic)).exp();
            for i in 0..2 {
                let new = (1.0 + step[i]) * sigma[i];
                sigma[i] = new.clamp(1.0 - 2.5e-2, 1.0 + 4.5e-3);
                plastic *= new / sigma[i];
            }
            let after = (10.0 * (1.0 - plastic)).exp();
            let h = if hardening_from == HardeningFrom::Previous {
                before
            } else {
                after
            };
            let j = sigma[0] * sigma[1];
            let exact = Matrix::from_diagonal(Vector::<f64, 2>::from_fn(|i| {
                h * (2.0 * mu * (sigma[i] - 1.0) * sigma[i] + lambda * j * (j - 1.0))
            }));

            let tau = law.kirchhoff_stress(strain, Matrix::scaled_identity(0.0));
            assert!((tau - exact).norm() <= 1e-9 * h, "{tau:?} for {exact:?}");
            assert!((1.0 + strain.plastic_jacobian_minus_one - plastic).abs() < 1e-12);
        }
        assert!(
            (plastic - 1.0).abs() > 0.02,
            "it should have yielded: {plastic}"
        );
    }
}

#[test]
fn snow_on_the_edge_of_yielding_does_not_creep() {
    let law = Snow::default();
    let mut random = Random(1);
    for _ in 0..20 {
        let h = cast::<f32, 3>(random.regular(0.1));
        let still = Matrix::scaled_identity(0.0);
        let yielded = law.advance(PlasticGradient::from_displacement_gradient(h), still);
        let mut strain = yielded;
        for _ in 0..10_000 {
            strain = law.advance(strain, still);
        }
        assert_eq!(strain.h, yielded.h);
        assert_eq!(
            strain.plastic_jacobian_minus_one,
            yielded.plastic_jacobian_minus_one
        );
    }
}

#[test]
fn snow_stays_within_its_ranges() {
    let law = Snow {
        hardening_range: [0.1, 5.0],
        ..Snow::default()
    };
    let still = Matrix::<f64, 2>::scaled_identity(0.0);
    for (stretch, plastic, hardening) in [(0.3f64, 0.6, 5.0), (9.0, 20.0, 0.1), (-2.0, 0.6, 5.0)] {
        let h = Matrix::from_diagonal(Vector([stretch - 1.0, 2.0 * stretch.abs() - 1.0]));
        let strain = law.advance(PlasticGradient::from_displacement_gradient(h), still);
        let ours = 1.0 + strain.plastic_jacobian_minus_one;
        assert!((ours - plastic).abs() < 1e-12, "{stretch}: {ours}");
        assert_eq!(law.hardening(strain), hardening);
        // The wave modulus includes the hardening.
        let rest =
            ConstitutiveModel::<2>::wave_modulus(&law, PlasticGradient { h: still, ..strain });
        assert!((rest - hardening * (law.lambda + 2.0 * law.mu)).abs() <= 1e-9 * rest);
    }
}

// ---- Names ----

#[test]
fn presets_exist_and_have_the_asked_speed_of_sound() {
    for (name, about) in presets() {
        let material = preset(name, 12.0).unwrap();
        assert_eq!(material.name, name);
        assert!(about.ends_with('.') && Model::NAMES.contains(&material.model.name()));
        match material.model {
            Model::Fluid(_) => assert!((material.sound_speed() - 12.0).abs() < 1e-12),
            _ => assert!(material.sound_speed() > 1.0),
        }
    }
    assert_eq!(preset("treacle", 12.0), None);
}

#[test]
fn moduli_convert() {
    let (lambda, mu) = lame(1e4, 0.3);
    let (again, shear) = lame_from_bulk_and_shear(lambda + mu * 2.0 / 3.0, mu);
    assert!((again - lambda).abs() < 1e-9 && shear == mu);
    assert!((mu - 1e4 / 2.6).abs() < 1e-9 && (lambda - 3e3 / (1.3 * 0.4)).abs() < 1e-9);
    let strain = DisplacementGradient {
        h: Matrix::<f64, 2>::scaled_identity(0.0),
    };
    let modulus = Corotated { lambda, mu }.wave_modulus(strain);
    assert_eq!(modulus, lambda + 2.0 * mu);
}
