//! The step that `svd` and `polar` share: in 3D, take one singular triple off and leave a 2×2 matrix,
//! for which both have a closed form.
//!
//! ```text
//!   F = scale · [ a | p q ] ⎡ s     ⎤ [ v | u w ]ᵀ
//!                           ⎣   G   ⎦
//! ```
//!
//! The triple (a, s, v) taken off is the largest or the smallest of F, whichever is further from
//! the one in the middle. Then v is an eigenvector of C = FᵀF with a gap of at least half the
//! spread of the eigenvalues, so that a direct formula finds it to a few roundings of ‖C‖. The
//! neglected remainders of aᵀF and of F v have that size divided by σ₁ when the largest triple is
//! taken off, and by σ₂ ≥ σ₁/√2 when the smallest is: a few roundings of ‖F‖. No singular value is
//! computed as the root of an eigenvalue, which would leave an error of √ε ‖F‖ in the small ones.
//!
//! It is written for lanes: there is no branch, and no loop but one or two Newton steps on a scalar.
//!
//! Sources: the eigenvalue that stands apart, O. K. Smith, "Eigenvalues of a symmetric 3×3
//! matrix", CACM 4 (1961); deflating by it, D. Eberly, "A robust eigensolver for 3×3 symmetric
//! matrices", Geometric Tools (2014); the basis of a plane, T. Duff et al., "Building an
//! orthonormal basis, revisited", JCGT 6 (2017).

use super::matrix::Matrix;
use super::real::Real;
use super::vector::Vector;

/// The factors of F in the picture above.
pub(super) struct Split<R: Real> {
    /// The magnitude of the largest entry of F; 0 for the zero matrix.
    pub(super) scale: R,
    /// a, p, q: a rotation.
    pub(super) left: Matrix<R, 3>,
    /// v, u, w: a rotation.
    pub(super) right: Matrix<R, 3>,
    /// s: not negative where it is the largest; else with the sign of det F.
    pub(super) value: R,
    /// The remaining block G.
    pub(super) block: Matrix<R, 2>,
    /// The lanes in which s is the largest singular value; in the others it is the smallest.
    pub(super) is_largest: R::Mask,
}

/// Splits `f` into its factors.
#[inline(always)]
pub(super) fn split<R: Real>(f: Matrix<R, 3>) -> Split<R> {
    let (mut f, scale) = scaled(f);
    // The zero matrix is treated as diag(1, 0, 0); multiplying by the scale gives its zeros back.
    f[(0, 0)] = R::select(scale.gt(scale.zero()), f[(0, 0)], scale.one());

    let (direction, is_largest) = eigenvector_apart(f);
    let right = frame(direction);
    let images = [
        times(f, right.0[0]),
        times(f, right.0[1]),
        times(f, right.0[2]),
    ];
    // The image of the largest gives the direction a. The image of the smallest may be nothing but
    // rounding errors; then a is perpendicular to the images of the other two.
    let across = cross(images[1], images[2]);
    let left = frame(select(is_largest, images[0], across));
    let [a, p, q] = left.0;
    Split {
        scale,
        left,
        right,
        value: dot(a, images[0]),
        block: Matrix([
            Vector([dot(p, images[1]), dot(q, images[1])]),
            Vector([dot(p, images[2]), dot(q, images[2])]),
        ]),
        is_largest,
    }
}

/// Returns `f` divided by the magnitude of its largest entry, and that magnitude; both are 0 if it is
/// too small to divide by.
#[inline(always)]
pub(super) fn scaled<R: Real, const D: usize>(f: Matrix<R, D>) -> (Matrix<R, D>, R) {
    // Column by column, so that the comparisons do not wait for each other.
    let mut largest = f[(0, 0)].zero();
    for column in f.0 {
        let mut of_column = column[0].abs();
        for i in 1..D {
            of_column = of_column.max(column[i].abs());
        }
        largest = largest.max(of_column);
    }
    let inverse = largest.one() / largest;
    let usable = inverse.is_finite();
    let zero = largest.zero();
    (
        f * R::select(usable, inverse, zero),
        R::select(usable, largest, zero),
    )
}

/// Returns cosine and sine of the direction of (x, y), and its length. Where the length is below ε², the
/// direction is (1, 0).
#[inline(always)]
pub(super) fn direction<R: Real>(x: R, y: R) -> (R, R, R) {
    let epsilon = R::EPSILON;
    let squared = x.mul_add(x, y * y);
    let length = squared.sqrt();
    let inverse = x.one() / length;
    let known = squared.gt(x.lit(epsilon.powi(4)));
    (
        R::select(known, x * inverse, x.one()),
        R::select(known, y * inverse, x.zero()),
        length,
    )
}

/// Returns an eigenvector of fᵀf, of any length, for its largest or its smallest eigenvalue, whichever is
/// further from the middle one, and a mask of the lanes in which it is the largest. The largest entry
/// of `f` is 1.
#[inline(always)]
fn eigenvector_apart<R: Real>(f: Matrix<R, 3>) -> (Vector<R, 3>, R::Mask) {
    let [x, y, z] = f.0;
    let (c00, c11, c22) = (dot(x, x), dot(y, y), dot(z, z));
    let (m01, m02, m12) = (dot(x, y), dot(x, z), dot(y, z));

    // C minus a third of its trace, from differences, so that as little as possible is rounded.
    let third = c00.lit(1.0 / 3.0);
    let (d01, d12, d20) = (c00 - c11, c11 - c22, c22 - c00);
    let (m00, m11, m22) = (
        (d01 - d20) * third,
        (d12 - d01) * third,
        (d20 - d12) * third,
    );

    // Its eigenvalues are p times the roots of t³ − 3t = 2h, with 6p² the sum of its squares and
    // 2hp³ its determinant. The root of largest magnitude has the sign of h.
    let sum = dot(Vector([m00, m11, m22]), Vector([m00, m11, m22]));
    let cross_sum = dot(Vector([m01, m02, m12]), Vector([m01, m02, m12]));
    let p_squared = cross_sum.mul_add(sum.lit(2.0), sum) * sum.lit(1.0 / 6.0);
    let inverse_p = sum.one() / p_squared.sqrt();
    let p = p_squared * inverse_p;
    let (a00, a01, a02) = (
        minor(m11, m22, m12, m12),
        minor(m02, m12, m01, m22),
        minor(m01, m12, m02, m11),
    );
    let determinant = m00.mul_add(a00, m01.mul_add(a01, m02 * a02));
    let half = sum.lit(0.5);
    let h = determinant * half * (inverse_p * inverse_p * inverse_p);
    // If C is a multiple of the identity up to rounding errors, any direction will do.
    let epsilon = R::EPSILON;
    let apart = p_squared.gt(sum.lit((0.25 * epsilon).powi(2)));
    let shift = R::select(apart, (p * largest_root(h.abs())).copysign(h), sum.one());

    // The adjugate of C minus its eigenvalue is a multiple of v vᵀ. Its longest column is taken.
    let (m00, m11, m22) = (m00 - shift, m11 - shift, m22 - shift);
    let (a00, a11, a22) = (
        minor(m11, m22, m12, m12),
        minor(m00, m22, m02, m02),
        minor(m00, m11, m01, m01),
    );
    let (a01, a02, a12) = (
        minor(m02, m12, m01, m22),
        minor(m01, m12, m02, m11),
        minor(m01, m02, m12, m00),
    );
    let second = a11.gt(a00);
    let column = Vector([
        R::select(second, a01, a00),
        R::select(second, a11, a01),
        R::select(second, a12, a02),
    ]);
    let third = a22.gt(a00.max(a11));
    let column = Vector([
        R::select(third, a02, column[0]),
        R::select(third, a12, column[1]),
        R::select(third, a22, column[2]),
    ]);
    (column, shift.ge(shift.zero()))
}

/// Returns the largest root 2 cos(⅓ arccos h) of t³ − 3t = 2h, for h from 0 to 1: a polynomial with an
/// error of 1e-4, then one Newton step for f32 (6e-9), two for f64.
#[inline(always)]
fn largest_root<R: Real>(h: R) -> R {
    let mut t = h
        .mul_add(h.lit(0.018_639_368), h.lit(-0.081_382_395))
        .mul_add(h, h.lit(0.330_660_7))
        .mul_add(h, h.lit(1.732_132_66));
    let three = h.lit(3.0);
    let steps = if R::EPSILON > 1e-10 { 1 } else { 2 };
    for _ in 0..steps {
        let square = t * t;
        let value = t.mul_add(square - three, -(h + h));
        t -= value / square.mul_add(three, -three);
    }
    t
}

/// Returns a rotation whose first column has the direction of `n`, which is not zero.
#[inline(always)]
fn frame<R: Real>(n: Vector<R, 3>) -> Matrix<R, 3> {
    let length = dot(n, n).sqrt();
    // From n rather than from the unit vector, so that the two divisions run side by side.
    let a = -(length / (length.copysign(n[2]) + n[2]));
    let one = length.one();
    let sign = one.copysign(n[2]);
    let n = n * (one / length);
    let [x, y, _] = n.0;
    let b = x * y * a;
    Matrix([
        n,
        Vector([(sign * x).mul_add(x * a, one), sign * b, -(sign * x)]),
        Vector([b, y.mul_add(y * a, sign), -y]),
    ])
}

/// Returns `if_true` where the mask is true, else `if_false`.
#[inline(always)]
pub(super) fn select<R: Real>(
    mask: R::Mask,
    if_true: Vector<R, 3>,
    if_false: Vector<R, 3>,
) -> Vector<R, 3> {
    Vector::from_fn(|i| R::select(mask, if_true[i], if_false[i]))
}

/// Rotates the directions `p` and `q` in their plane, from `p` towards `q`, by the angle with the given
/// cosine and sine.
#[inline(always)]
pub(super) fn turn<R: Real>(
    p: Vector<R, 3>,
    q: Vector<R, 3>,
    (cosine, sine): (R, R),
) -> (Vector<R, 3>, Vector<R, 3>) {
    (
        add_scaled(q * sine, p, cosine),
        add_scaled(p * -sine, q, cosine),
    )
}

/// Returns sum + x factor, fused where the instruction set fuses.
#[inline(always)]
pub(super) fn add_scaled<R: Real>(
    mut sum: Vector<R, 3>,
    x: Vector<R, 3>,
    factor: R,
) -> Vector<R, 3> {
    for i in 0..3 {
        sum[i] = x[i].mul_add(factor, sum[i]);
    }
    sum
}

/// Returns Σ aᵢ bᵢ, fused where the instruction set fuses.
#[inline(always)]
pub(super) fn dot<R: Real, const D: usize>(a: Vector<R, D>, b: Vector<R, D>) -> R {
    let mut sum = a[D - 1] * b[D - 1];
    for i in (0..D - 1).rev() {
        sum = a[i].mul_add(b[i], sum);
    }
    sum
}

/// Returns `m` times `x`, fused where the instruction set fuses.
#[inline(always)]
pub(super) fn times<R: Real>(m: Matrix<R, 3>, x: Vector<R, 3>) -> Vector<R, 3> {
    add_scaled(add_scaled(m.0[2] * x[2], m.0[1], x[1]), m.0[0], x[0])
}

/// Returns the vector product a × b.
#[inline(always)]
fn cross<R: Real>(a: Vector<R, 3>, b: Vector<R, 3>) -> Vector<R, 3> {
    Vector([
        minor(a[1], b[2], a[2], b[1]),
        minor(a[2], b[0], a[0], b[2]),
        minor(a[0], b[1], a[1], b[0]),
    ])
}

/// Returns a b − c d.
#[inline(always)]
fn minor<R: Real>(a: R, b: R, c: R, d: R) -> R {
    a.mul_add(b, -(c * d))
}
