//! The singular value decomposition of a 2×2 or 3×3 matrix: plastic models such as snow need it of the
//! deformation gradient. It works in lanes, at the price of a few square roots.
//!
//! Neither dimension iterates to convergence. 2×2 has a closed form, J. Blinn, "Consider the lowly
//! 2×2 matrix", IEEE CG&A 16 (1996); `split.rs` reduces 3×3 to 2×2. The conventions
//! (rotations, and the sign on the last singular value) are those of A. McAdams et al., "Computing
//! the singular value decomposition of 3×3 matrices with minimal branching and elementary floating
//! point operations", UW-Madison TR1690 (2011), but there are no Jacobi sweeps.

use super::matrix::Matrix;
use super::real::Real;
use super::split::{direction, dot, scaled, select, split, turn};
use super::vector::Vector;

/// The decomposition F = U diag(σ) Vᵀ; made by [`svd`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Svd<R, const D: usize> {
    /// U, a rotation.
    pub u: Matrix<R, D>,
    /// σ, in descending order of magnitude, in the unit of F. Only the last can be negative.
    pub sigma: Vector<R, D>,
    /// V (not its transpose), a rotation.
    pub v: Matrix<R, D>,
}

impl<R: Real, const D: usize> Svd<R, D> {
    /// Returns U diag(σ) Vᵀ, for use after a change of `sigma`.
    #[inline(always)]
    pub fn compose(self) -> Matrix<R, D> {
        let (rows, columns) = (self.u.transpose(), self.v.transpose());
        let mut scaled = rows;
        for i in 0..D {
            scaled.0[i] = Vector::from_fn(|k| rows.0[i][k] * self.sigma[k]);
        }
        Matrix::from_fn(|i, j| dot(scaled.0[i], columns.0[j]))
    }

    #[inline(always)]
    fn resize<const E: usize>(self) -> Svd<R, E> {
        Svd {
            u: self.u.resize(),
            sigma: Vector::from_fn(|i| self.sigma[i]),
            v: self.v.resize(),
        }
    }
}

/// Returns the singular value decomposition of `f`, 2×2 or 3×3 (any unit).
///
/// U and V are rotations, σ₁ ≥ … ≥ |σ_D|, and the last σ has the sign of det F. Where singular
/// values coincide, U and V are one choice of many. The zero matrix gives rotations and zeros.
///
/// Errors, with ε the distance from 1 to the next number and ‖·‖ the Frobenius norm:
///
/// | of the product | of a singular value | of the rotations |
/// |---|---|---|
/// | ‖U diag(σ) Vᵀ − F‖ ≤ 10 ε ‖F‖ | \|σᵢ − exact\| ≤ 10 ε σ₁ | ‖UᵀU − I‖, ‖VᵀV − I‖ ≤ 12 ε |
///
/// The bounds are measured by `tests/lahar/decompositions.rs`, not proven. A singular value below ε σ₁,
/// and its sign, is thus a rounding error. More accuracy would take one-sided Jacobi (J. Demmel &
/// K. Veselić, "Jacobi's method is more accurate than QR", SIMAX 13, 1992).
///
/// These bounds hold with and without flushing of denormal numbers, for matrices whose largest entry is
/// between 1e-31 and 8e37 (f32), 1e-292 and 4e307 (f64). Below, digits underflow, and a matrix of
/// denormal numbers counts as zero.
///
/// ```
/// use lahar::math::{Matrix, Vector, svd};
/// let shear = Matrix([Vector([1.0_f64, 0.0]), Vector([1.5, 1.0])]);
/// let svd = svd(shear);
/// assert!((svd.sigma[0] - 2.0).abs() < 1e-15 && (svd.sigma[1] - 0.5).abs() < 1e-15);
/// assert!((svd.compose() - shear).squared_norm() < 1e-30);
/// ```
#[inline(always)]
pub fn svd<R: Real, const D: usize>(f: Matrix<R, D>) -> Svd<R, D> {
    const { assert!(D == 2 || D == 3, "only 2×2 and 3×3 matrices") };
    match D {
        2 => svd_2d(f.resize()).resize(),
        _ => svd_3d(f.resize()).resize(),
    }
}

#[inline(always)]
fn svd_2d<R: Real>(f: Matrix<R, 2>) -> Svd<R, 2> {
    let (f, scale) = scaled(f);
    let closed = Closed::new(f);
    Svd {
        u: turned(closed.u),
        sigma: closed.sigma * scale,
        v: turned(closed.v),
    }
}

#[inline(always)]
fn svd_3d<R: Real>(f: Matrix<R, 3>) -> Svd<R, 3> {
    let split = split(f);
    let closed = Closed::new(split.block);
    let (s, [large, small]) = (split.value, closed.sigma.0);
    let first = split.is_largest;

    // Equal singular values may be in the wrong order by a rounding error.
    let sigma_1 = R::select(first, s, large);
    let sigma_2 = R::select(first, large, small).min(sigma_1);
    let sigma_3 = R::select(first, small, s);
    let sigma_3 = sigma_3.abs().min(sigma_2).copysign(sigma_3);
    Svd {
        u: ordered(first, split.left, closed.u),
        sigma: Vector([sigma_1, sigma_2, sigma_3]) * split.scale,
        v: ordered(first, split.right, closed.v),
    }
}

/// Returns the columns of U or V in order. The column that `split` has taken off comes first where its
/// singular value is the largest, else last. That is a cyclic permutation, so that a rotation stays a
/// rotation.
#[inline(always)]
fn ordered<R: Real>(first: R::Mask, basis: Matrix<R, 3>, angle: (R, R)) -> Matrix<R, 3> {
    let [a, p, q] = basis.0;
    let (x, y) = turn(p, q, angle);
    Matrix([
        select(first, a, x),
        select(first, x, y),
        select(first, y, a),
    ])
}

/// Returns the rotation by the angle with this cosine and sine.
#[inline(always)]
fn turned<R: Real>((c, s): (R, R)) -> Matrix<R, 2> {
    Matrix([Vector([c, s]), Vector([-s, c])])
}

/// The closed form of a 2×2 matrix with entries of at most about 1: the cosines and sines of the
/// angles of U and V.
struct Closed<R> {
    u: (R, R),
    sigma: Vector<R, 2>,
    v: (R, R),
}

impl<R: Real> Closed<R> {
    /// F is a multiple of the rotation by α plus a multiple of the reflection at the axis of angle β/2.
    /// The sum and the difference of the two factors are σ; U rotates by (β + α)/2, V by (β − α)/2.
    #[inline(always)]
    fn new(f: Matrix<R, 2>) -> Self {
        let half = f[(0, 0)].lit(0.5);
        let one = half.one();
        let (e, h) = (f[(0, 0)] + f[(1, 1)], f[(1, 0)] - f[(0, 1)]);
        let (d, g) = (f[(0, 0)] - f[(1, 1)], f[(1, 0)] + f[(0, 1)]);
        let (cos_alpha, sin_alpha, turned) = direction(e, h);
        let (cos_beta, sin_beta, mirrored) = direction(d, g);

        // Half of β − α, between −π/2 and π/2, without cancellation.
        let cos_twice = cos_beta.mul_add(cos_alpha, sin_beta * sin_alpha);
        let sin_twice = sin_beta.mul_add(cos_alpha, -(cos_beta * sin_alpha));
        let x = one + cos_twice.abs();
        let inverse = one / x.mul_add(x, sin_twice * sin_twice).sqrt();
        let (near, far) = (x * inverse, sin_twice.abs() * inverse);
        let acute = cos_twice.ge(cos_twice.zero());
        let c = R::select(acute, near, far);
        let s = R::select(acute, far, near).copysign(sin_twice);
        Self {
            u: (
                cos_alpha.mul_add(c, -(sin_alpha * s)),
                sin_alpha.mul_add(c, cos_alpha * s),
            ),
            sigma: Vector([turned + mirrored, turned - mirrored]) * half,
            v: (c, s),
        }
    }
}
