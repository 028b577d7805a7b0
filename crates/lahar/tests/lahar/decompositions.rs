//! The bounds that the documentation of `svd` and `polar` states, measured.
//!
//! A decomposition is right if its product is the matrix and its factors have the properties that they claim, for every
//! matrix that can come up in a simulation. The test takes a million matrices of each kind in 2D and 3D, f32 and f64, one
//! by one and in lanes (the widest of the machine and the baseline), and flushes denormal numbers in every other batch. The
//! worst error of each claim is compared with its bound.
//!
//! ```text
//!   sample (f64) → round to T → svd, polar in T (scalar | lanes) → errors, in f64, over ε of T
//! ```

use fearless_simd::{Level, Simd, dispatch};
use lahar::math::{Lanes, Mask, Matrix, Polar, Real, Register, Svd, Vector, polar, svd};
use lahar_lab::method::random::Random;
use std::hint::black_box;

/// The number of matrices of each kind, over all dimensions and precisions.
const SAMPLES: usize = 1 << 22;
/// The number of matrices per batch: a multiple of the lanes of every type.
const BATCH: usize = 16;

/// The matrices of a batch: each entry holds that entry of all of them.
type Batch<T, const D: usize> = Matrix<[T; BATCH], D>;

/// A kind of random matrices.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Independent normal entries.
    Gaussian,
    /// Prescribed singular values in any order, with ratios up to 10^±digits.
    Ratios,
    /// As `Ratios`, with a negative determinant.
    Reflected,
    /// Singular values that are equal or differ by a factor of 1 + 10⁻¹⁷ to 1.5.
    Repeated,
    /// Some or all singular values are zero; or entries are small whole numbers, so that many are singular.
    Singular,
    /// I + 10⁻¹ to 10⁻¹⁷ times a Gaussian matrix.
    NearIdentity,
    /// Rotations, reflections and signed permutations times a number.
    Rotation,
    /// Diagonal, and its columns permuted.
    Diagonal,
    /// I plus one entry off the diagonal, small to huge.
    Shear,
    /// `Gaussian` and `Ratios`, scaled to any magnitude.
    Scaled,
}

/// The ranges of random numbers for a precision.
trait Number: Lanes {
    /// Singular values range from 1 down to 10 to the power of minus this number.
    const DIGITS: f64;
    /// Scales range from 10 to the power of the first number to 10 to the power of the second.
    const DECADES: (f64, f64);
}
impl Number for f32 {
    const DIGITS: f64 = 6.0;
    const DECADES: (f64, f64) = (-30.0, 37.0);
}
impl Number for f64 {
    const DIGITS: f64 = 12.0;
    const DECADES: (f64, f64) = (-290.0, 306.0);
}

/// The largest allowed error of each claim in units of ε (0: the claim must hold exactly), and its name.
///
/// Measured over 16 million matrices of each kind: 7 for the product, 9 for the singular values (the
/// rounding of the sample, in f64, included), 9 and 7 for U and V, 12 for R; by climbing the
/// errors of f32 in 3D from 300 random starts: 7, 10 and 8 for U and V, 13 for R.
const CLAIMS: [(f64, &str); 12] = [
    (10.0, "‖U Σ Vᵀ − F‖ / ‖F‖"),
    (12.0, "‖UᵀU − I‖"),
    (12.0, "‖VᵀV − I‖"),
    (10.0, "|σ − exact| / σ₁"),
    (10.0, "‖compose − F‖ / ‖F‖"),
    (16.0, "‖RᵀR − I‖"),
    (10.0, "‖R S − F‖ / ‖F‖"),
    (10.0, "‖RᵀF − FᵀR‖ / ‖F‖"),
    (10.0, "|tr S − Σ σ| / ‖F‖"),
    (0.0, "order of the singular values"),
    (0.0, "sign of the determinants of U, V, R"),
    (0.0, "sign of the last singular value, symmetry of S"),
];

/// The decompositions of a batch.
struct Outcome<T, const D: usize> {
    u: Batch<T, D>,
    sigma: Vector<[T; BATCH], D>,
    v: Batch<T, D>,
    composed: Batch<T, D>,
    rotation: Batch<T, D>,
    stretch: Batch<T, D>,
}

impl<T: Number, const D: usize> Outcome<T, D> {
    fn new() -> Self {
        let zero = [T::from_f64(0.0); BATCH];
        let matrix = Matrix([Vector([zero; D]); D]);
        Self {
            u: matrix,
            sigma: Vector([zero; D]),
            v: matrix,
            composed: matrix,
            rotation: matrix,
            stretch: matrix,
        }
    }

    fn scalar(&mut self, f: &Batch<T, D>) {
        for k in 0..BATCH {
            let f = Matrix::<T, D>::from_fn(|i, j| f[(i, j)][k]);
            self.put(svd(f), polar(f), |x, slot| slot[k] = x);
        }
    }

    #[inline(never)]
    fn lanes_of(&mut self, level: Level, f: &Batch<T, D>) {
        dispatch!(level, simd => self.lanes(simd, f));
    }

    #[inline(always)]
    fn lanes<S: Simd>(&mut self, simd: S, f: &Batch<T, D>) {
        for k in (0..BATCH).step_by(T::WIDTH) {
            let f = load::<T, S, D>(simd, f, k);
            self.put(svd(f), polar(f), |x, slot| T::store::<S>(x, &mut slot[k..]));
        }
    }

    #[inline(always)]
    fn put<R: Real>(
        &mut self,
        svd: Svd<R, D>,
        polar: Polar<R, D>,
        store: impl Fn(R, &mut [T; BATCH]),
    ) {
        let composed = svd.compose();
        for j in 0..D {
            store(svd.sigma[j], &mut self.sigma[j]);
            for i in 0..D {
                store(svd.u[(i, j)], &mut self.u[(i, j)]);
                store(svd.v[(i, j)], &mut self.v[(i, j)]);
                store(composed[(i, j)], &mut self.composed[(i, j)]);
                store(polar.rotation[(i, j)], &mut self.rotation[(i, j)]);
                store(polar.stretch[(i, j)], &mut self.stretch[(i, j)]);
            }
        }
    }
}

#[inline(always)]
fn load<T: Lanes, S: Simd, const D: usize>(
    simd: S,
    m: &Batch<T, D>,
    k: usize,
) -> Matrix<T::Of<S>, D> {
    Matrix::from_fn(|i, j| T::load(simd, &m[(i, j)][k..]))
}

/// Converts to f64 and multiplies by a power of two per matrix.
fn wide<T: Number, const D: usize>(m: &Batch<T, D>, scale: &[f64; BATCH]) -> Batch<f64, D> {
    Matrix(m.0.map(|column| wide_vector(&column, scale)))
}

fn wide_vector<T: Number, const D: usize>(
    v: &Vector<[T; BATCH], D>,
    scale: &[f64; BATCH],
) -> Vector<[f64; BATCH], D> {
    Vector(v.0.map(|x| std::array::from_fn(|k| x[k].to_f64() * scale[k])))
}

/// Returns 1 for matrices whose last singular value is larger than the errors but has not the sign of det F; else 0.
#[inline(always)]
fn wrong_sign<R: Real, const D: usize>(
    f: Matrix<R, D>,
    sigma: Vector<R, D>,
    size: R,
    epsilon: f64,
) -> R {
    let (zero, one) = (size.zero(), size.one());
    let mut others = size;
    for i in 0..D - 1 {
        others *= sigma[i];
    }
    let mut cube = one.lit(8.0 * f64::EPSILON);
    for _ in 0..D {
        cube *= size;
    }
    let determinant = f.determinant();
    let resolved = determinant
        .abs()
        .gt(others * one.lit(CLAIMS[3].0 * epsilon) + cube);
    let wrong = (sigma[D - 1] * determinant).lt(zero) & resolved;
    R::select(wrong, one, zero)
}

/// Returns the error of each claim in units of `epsilon`, for one register of matrices.
#[inline(always)]
fn errors<S: Simd, const D: usize>(
    simd: S,
    f: &Batch<f64, D>,
    exact: &Vector<[f64; BATCH], D>,
    outcome: &Outcome<f64, D>,
    epsilon: f64,
    k: usize,
) -> [<f64 as Lanes>::Of<S>; CLAIMS.len()] {
    let f = load::<f64, S, D>(simd, f, k);
    let u = load::<f64, S, D>(simd, &outcome.u, k);
    let v = load::<f64, S, D>(simd, &outcome.v, k);
    let composed = load::<f64, S, D>(simd, &outcome.composed, k);
    let r = load::<f64, S, D>(simd, &outcome.rotation, k);
    let s = load::<f64, S, D>(simd, &outcome.stretch, k);
    let mut sigma = f.0[0];
    let mut known = f.0[0];
    for i in 0..D {
        sigma[i] = f64::load(simd, &outcome.sigma[i][k..]);
        known[i] = f64::load(simd, &exact[i][k..]);
    }

    let (zero, one) = (sigma[0].zero(), sigma[0].one());
    let unit = one.lit(epsilon);
    let identity = Matrix::<_, D>::identity(one);
    let size = f.squared_norm().sqrt();
    // The zero matrix must be decomposed without any error.
    let tiny = one.lit(1e-300);
    let relative =
        |e: Matrix<<f64 as Lanes>::Of<S>, D>| e.squared_norm().sqrt() / (size.max(tiny) * unit);
    let orthogonal = |m: Matrix<<f64 as Lanes>::Of<S>, D>| {
        (m.transpose() * m - identity).squared_norm().sqrt() / unit
    };
    let product = u * Matrix::from_diagonal(sigma) * v.transpose();
    let rf = r.transpose() * f;

    let mut sigma_error = zero;
    let mut sum = zero;
    let mut order = zero;
    for i in 0..D {
        sigma_error = sigma_error.max((sigma[i] - known[i]).abs());
        sum += sigma[i];
        if i + 1 < D {
            order = order.max(sigma[i + 1].abs() - sigma[i]);
        }
    }
    // Samples whose singular values are unknown have NaN here.
    let is_known = known[0].is_finite();
    let sigma_error = sigma_error / (known[0].abs().max(tiny) * unit);
    let sigma_error = <f64 as Lanes>::Of::<S>::select(is_known, sigma_error, zero);

    let mut smallest = u.determinant().min(v.determinant());
    smallest = smallest.min(r.determinant());
    let wrong = wrong_sign(f, sigma, size, epsilon);

    [
        relative(product - f),
        orthogonal(u),
        orthogonal(v),
        sigma_error,
        relative(composed - f),
        orthogonal(r),
        relative(r * s - f),
        relative(rf - rf.transpose()),
        (s.trace() - sum).abs() / (size.max(tiny) * unit),
        order,
        one.lit(0.5) - smallest,
        wrong + (s - s.transpose()).squared_norm(),
    ]
}

#[inline(never)]
fn judge<const D: usize>(
    f: &Batch<f64, D>,
    exact: &Vector<[f64; BATCH], D>,
    outcome: &Outcome<f64, D>,
    epsilon: f64,
    worst: &mut [f64; CLAIMS.len()],
) {
    dispatch!(Level::new(), simd => worst_of(simd, f, exact, outcome, epsilon, worst));
}

/// Raises `worst` to the errors of a batch; to infinity if an error is not finite.
#[inline(always)]
fn worst_of<S: Simd, const D: usize>(
    simd: S,
    f: &Batch<f64, D>,
    exact: &Vector<[f64; BATCH], D>,
    outcome: &Outcome<f64, D>,
    epsilon: f64,
    worst: &mut [f64; CLAIMS.len()],
) {
    for k in (0..BATCH).step_by(f64::WIDTH) {
        let errors = errors(simd, f, exact, outcome, epsilon, k);
        for (error, worst) in errors.into_iter().zip(&mut *worst) {
            if !error.is_finite().all() {
                *worst = f64::INFINITY;
            }
            for lane in 0..f64::WIDTH {
                *worst = worst.max(error.lane(lane));
            }
        }
    }
}

/// Random numbers and matrices for the samples.
trait Samples {
    /// A number from 0 to `n` − 1.
    fn below(&mut self, n: usize) -> usize;
    fn sign(&mut self) -> f64;
    /// Ten to the power of a number in `low .. high`.
    fn decades(&mut self, low: f64, high: f64) -> f64;
    fn normal(&mut self) -> f64;
    fn normal_matrix<const D: usize>(&mut self) -> Matrix<f64, D>;
    fn rotation<const D: usize>(&mut self) -> Matrix<f64, D>;
    /// A permutation of 0, 1, .., D − 1.
    fn order<const D: usize>(&mut self) -> [usize; D];
}

impl Samples for Random {
    fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 33) as usize % n
    }
    fn sign(&mut self) -> f64 {
        if self.bits() >> 63 == 0 { 1.0 } else { -1.0 }
    }
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.between(0.0, 1.0)).ln()).sqrt();
        radius * self.between(0.0, std::f64::consts::TAU).cos()
    }
    fn normal_matrix<const D: usize>(&mut self) -> Matrix<f64, D> {
        Matrix::from_fn(|_, _| self.normal())
    }
    fn rotation<const D: usize>(&mut self) -> Matrix<f64, D> {
        let mut q: [f64; 4] = std::array::from_fn(|_| self.between(-1.0, 1.0));
        if D == 2 {
            (q[1], q[2]) = (0.0, 0.0);
        }
        let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [w, x, y, z] = q.map(|x| x / norm);
        let rows = [
            [
                1.0 - 2.0 * (y * y + z * z),
                2.0 * (x * y - z * w),
                2.0 * (x * z + y * w),
            ],
            [
                2.0 * (x * y + z * w),
                1.0 - 2.0 * (x * x + z * z),
                2.0 * (y * z - x * w),
            ],
            [
                2.0 * (x * z - y * w),
                2.0 * (y * z + x * w),
                1.0 - 2.0 * (x * x + y * y),
            ],
        ];
        Matrix::from_fn(|i, j| rows[i][j])
    }
    fn order<const D: usize>(&mut self) -> [usize; D] {
        let mut order = std::array::from_fn(|i| i);
        for i in (1..D).rev() {
            order.swap(i, self.below(i + 1));
        }
        order
    }
}

/// A random matrix and, if they are known, its singular values in descending order; the last one has the sign of the
/// determinant.
struct Sample<const D: usize> {
    matrix: Matrix<f64, D>,
    sigma: Option<[f64; D]>,
}

impl<const D: usize> Sample<D> {
    fn unknown(matrix: Matrix<f64, D>) -> Self {
        let sigma = None;
        Self { matrix, sigma }
    }
    /// Returns left diag(values) rightᵀ; `left` and `right` must be rotations.
    fn of(left: Matrix<f64, D>, values: [f64; D], right: Matrix<f64, D>) -> Self {
        let negative = values.iter().product::<f64>() < 0.0;
        let mut sigma = values.map(f64::abs);
        sigma.sort_by(|a, b| b.total_cmp(a));
        if negative {
            sigma[D - 1] = -sigma[D - 1];
        }
        Self {
            matrix: left * Matrix::from_diagonal(Vector(values)) * right.transpose(),
            sigma: Some(sigma),
        }
    }

    /// Returns a singular matrix.
    fn singular(random: &mut Random) -> Self {
        match random.below(4) {
            0 => Self::unknown(Matrix::from_fn(|_, _| random.below(5) as f64 - 2.0)),
            1 => Self::unknown(Matrix::from_fn(|_, _| random.below(2) as f64)),
            2 => {
                let mut values = [0.0; D];
                values[random.below(D)] = random.between(0.0, 1.0);
                values[random.below(D)] = random.between(-1.0, 1.0);
                values[random.below(D)] = 0.0;
                Self::of(random.rotation(), values, random.rotation())
            }
            // A random matrix with a column or a row of zeros.
            _ => {
                let (zeroed, mut matrix) = (random.below(D), random.normal_matrix());
                matrix.0[zeroed] = Vector([0.0; D]);
                let sideways = random.below(2) == 0;
                Self::unknown(if sideways { matrix.transpose() } else { matrix })
            }
        }
    }

    /// Returns a matrix of any magnitude.
    fn scaled<T: Number>(random: &mut Random) -> Self {
        let inner = if random.below(2) == 0 {
            Kind::Gaussian
        } else {
            Kind::Ratios
        };
        let mut sample = Self::new::<T>(inner, random);
        let size = sample.sigma.map_or(1.0, |sigma| sigma[0].abs());
        let scale = random.decades(T::DECADES.0, T::DECADES.1);
        sample.matrix = sample.matrix * (1.0 / size) * scale;
        sample.sigma = sample.sigma.map(|sigma| sigma.map(|x| x / size * scale));
        sample
    }

    /// Returns a matrix of a kind.
    fn new<T: Number>(kind: Kind, random: &mut Random) -> Self {
        let identity = Matrix::<f64, D>::identity(1.0);
        match kind {
            Kind::Gaussian => Self::unknown(random.normal_matrix()),
            Kind::Ratios | Kind::Reflected => {
                let mut values: [f64; D] = std::array::from_fn(|_| random.decades(-T::DIGITS, 0.0));
                if matches!(kind, Kind::Reflected) {
                    values[random.below(D)] *= -1.0;
                }
                Self::of(random.rotation(), values, random.rotation())
            }
            Kind::Repeated => {
                let value = random.decades(-1.0, 1.0);
                let mut values = [value; D];
                for x in &mut values {
                    match random.below(4) {
                        0 | 1 => {}
                        2 => *x *= 1.0 + random.sign() * random.decades(-17.0, 0.0) * 0.5,
                        _ => *x = -*x,
                    }
                }
                if random.below(4) == 0 {
                    values[random.below(D)] = random.decades(-T::DIGITS, 0.0);
                }
                Self::of(random.rotation(), values, random.rotation())
            }
            Kind::Singular => Self::singular(random),
            Kind::NearIdentity => {
                Self::unknown(identity + random.normal_matrix() * random.decades(-17.0, -1.0))
            }
            Kind::Rotation => {
                let mut values = [random.decades(-2.0, 2.0); D];
                values[random.below(D)] *= random.sign();
                if random.below(2) == 0 {
                    Self::of(random.rotation(), values, random.rotation())
                } else {
                    let order = random.order::<D>();
                    Self::unknown(Matrix::from_fn(|i, j| {
                        if order[j] == i { random.sign() } else { 0.0 }
                    }))
                }
            }
            Kind::Diagonal => {
                let values =
                    std::array::from_fn(|_| random.sign() * random.decades(-T::DIGITS, 0.0));
                let mut sample = Self::of(identity, values, identity);
                if random.below(2) == 0 {
                    let order = random.order::<D>();
                    sample.matrix = Matrix(order.map(|j| sample.matrix.0[j]));
                    sample.sigma = None;
                }
                sample
            }
            Kind::Shear => {
                let mut matrix = identity;
                let i = random.below(D);
                let j = (i + 1 + random.below(D - 1)) % D;
                matrix[(i, j)] = random.sign() * random.decades(-T::DIGITS, 0.5 * T::DIGITS);
                Self::unknown(matrix)
            }
            Kind::Scaled => Self::scaled::<T>(random),
        }
    }
}

/// Returns the power of two that scales `x` to between 1 and 2; 1 for zero.
fn normalizer(x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    let exponent = (x.to_bits() >> 52) as i32 - 1023;
    2f64.powi(-exponent)
}

/// Returns the worst error of each claim over `SAMPLES` / 4 matrices of a kind.
fn worst<T: Number, const D: usize>(kind: Kind) -> [f64; CLAIMS.len()] {
    let epsilon = T::EPSILON;
    let mut random = Random(1);
    let mut worst = [0.0; CLAIMS.len()];
    let mut outcomes: [_; 3] = std::array::from_fn(|_| Outcome::<T, D>::new());
    let mut f: Batch<T, D> = outcomes[0].u;
    for batch in 0..SAMPLES / 4 / BATCH {
        let mut exact = Vector([[0.0; BATCH]; D]);
        let mut scale = [0.0; BATCH];
        for k in 0..BATCH {
            let sample = Sample::<D>::new::<T>(kind, &mut random);
            let mut largest = 0f64;
            for j in 0..D {
                for i in 0..D {
                    let x = T::from_f64(sample.matrix[(i, j)]);
                    f[(i, j)][k] = x;
                    largest = largest.max(x.to_f64().abs());
                }
            }
            scale[k] = normalizer(largest);
            for i in 0..D {
                exact[i][k] = sample.sigma.map_or(f64::NAN, |sigma| sigma[i] * scale[k]);
            }
        }

        denormals::flushed(batch % 2 == 1, || {
            let f = black_box(&f);
            let [scalar, native, baseline] = &mut outcomes;
            scalar.scalar(f);
            native.lanes_of(Level::new(), f);
            baseline.lanes_of(Level::baseline(), f);
            black_box(&mut outcomes);
        });

        let f = wide(&f, &scale);
        let ones = [1.0; BATCH];
        for outcome in &outcomes {
            let outcome = Outcome {
                u: wide(&outcome.u, &ones),
                sigma: wide_vector(&outcome.sigma, &scale),
                v: wide(&outcome.v, &ones),
                composed: wide(&outcome.composed, &scale),
                rotation: wide(&outcome.rotation, &ones),
                stretch: wide(&outcome.stretch, &scale),
            };
            judge(&f, &exact, &outcome, epsilon, &mut worst);
        }
    }
    worst
}

fn check(kind: Kind) {
    let cases = [
        ("2D f32", worst::<f32, 2>(kind)),
        ("2D f64", worst::<f64, 2>(kind)),
        ("3D f32", worst::<f32, 3>(kind)),
        ("3D f64", worst::<f64, 3>(kind)),
    ];
    let mut broken = Vec::new();
    for (case, worst) in cases {
        for ((bound, claim), error) in CLAIMS.into_iter().zip(worst) {
            if error.is_nan() || error > bound {
                broken.push(format!("{case}, {claim}: {error:.2} ε, not {bound} ε"));
            }
        }
    }
    assert!(broken.is_empty(), "{kind:?}: {broken:#?}");
}

macro_rules! kinds {
    ($($name:ident: $kind:ident,)*) => {
        $(
            #[test]
            fn $name() {
                check(Kind::$kind);
            }
        )*
    };
}

kinds! {
    gaussian: Gaussian,
    ratios_of_a_million_and_more: Ratios,
    negative_determinant: Reflected,
    repeated_singular_values: Repeated,
    singular_matrices: Singular,
    near_the_identity: NearIdentity,
    rotations_and_permutations: Rotation,
    diagonal: Diagonal,
    shear: Shear,
    extreme_scales: Scaled,
}

#[test]
fn zero_is_the_identity_times_zero() {
    fn case<T: Number, const D: usize>() {
        let zero = Matrix::<T, D>::scaled_identity(T::from_f64(0.0));
        let identity = Matrix::identity(T::from_f64(1.0));
        assert_eq!(polar(zero).rotation, identity);
        assert_eq!(polar(zero).stretch, zero);
        assert_eq!(svd(zero).sigma, zero.0[0]);
        assert_eq!(svd(zero).compose(), zero);
        assert_eq!(polar(identity).rotation, identity);
        assert_eq!(svd(identity).compose(), identity);
    }
    case::<f32, 2>();
    case::<f32, 3>();
    case::<f64, 2>();
    case::<f64, 3>();
}

#[test]
fn non_finite_matrices_have_non_finite_factors() {
    fn case<T: Number, const D: usize>() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for at in 0..D * D {
                let mut f = Matrix::<T, D>::identity(T::from_f64(1.0));
                f[(at % D, at / D)] = T::from_f64(bad);
                assert!(!svd(f).sigma.norm().is_finite());
                assert!(!polar(f).stretch.squared_norm().is_finite());
            }
        }
    }
    case::<f32, 2>();
    case::<f32, 3>();
    case::<f64, 2>();
    case::<f64, 3>();
}

#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "the control register has no safe interface")]
mod denormals {
    /// Flush results to zero, and read denormal operands as zero.
    const FLUSH: u32 = 1 << 15 | 1 << 6;

    /// Runs `work`, with denormal numbers flushed to zero if `flush` is set.
    pub(crate) fn flushed(flush: bool, work: impl FnOnce()) {
        let mut before = 0u32;
        // SAFETY: stores four bytes to `before`, which is four bytes long.
        unsafe { core::arch::asm!("stmxcsr [{}]", in(reg) &raw mut before, options(nostack)) };
        set(if flush { before | FLUSH } else { before });
        work();
        set(before);
    }

    fn set(control: u32) {
        // SAFETY: reads four bytes; only the flags of `FLUSH` change, so exceptions stay masked and the rounding
        // mode stays.
        unsafe { core::arch::asm!("ldmxcsr [{}]", in(reg) &raw const control, options(nostack)) };
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod denormals {
    /// Runs `work`; this machine has no such flag to set.
    pub(crate) fn flushed(_: bool, work: impl FnOnce()) {
        work();
    }
}
