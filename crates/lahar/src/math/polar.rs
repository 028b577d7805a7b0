//! The polar decomposition of a 2×2 or 3×3 matrix: the rotation that corotated laws compare a
//! deformation gradient with.
//!
//! 2D has a closed form, and `split.rs` reduces 3D to 2D. Unlike Newton's iteration (N. Higham,
//! "Computing the polar decomposition", SISSC 7, 1986) this works for reflections and for singular
//! matrices, and costs no more.

use super::matrix::Matrix;
use super::real::Real;
use super::split::{direction, dot, scaled, split, times, turn};
use super::vector::Vector;

/// The decomposition F = R S; made by [`polar`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polar<R, const D: usize> {
    /// R, a rotation.
    pub rotation: Matrix<R, D>,
    /// S, symmetric to the last bit, in the unit of F.
    pub stretch: Matrix<R, D>,
}

/// Returns the polar decomposition of `f`, 2×2 or 3×3 (any unit): R is the rotation nearest to F, and
/// S = RᵀF.
///
/// If det F is negative, R is still a rotation, and S has one negative eigenvalue, the one of least
/// magnitude. If several rotations are equally near, R is one of them; for the zero matrix it is
/// the identity.
///
/// Errors, with ε the distance from 1 to the next number and ‖·‖ the Frobenius norm, measured
/// rather than proven by `tests/decompositions.rs`:
/// ‖R S − F‖ and ‖RᵀF − FᵀR‖ ≤ 10 ε ‖F‖, ‖RᵀR − I‖ ≤ 16 ε.
///
/// These bounds hold with and without flushing of denormal numbers, for matrices whose largest entry is
/// between 1e-31 and 8e37 (f32), 1e-292 and 4e307 (f64). Below, digits underflow, and a matrix of
/// denormal numbers counts as zero.
///
/// ```
/// use lahar::math::{Matrix, Vector, polar};
/// // A quarter turn after a stretch by 2 along x.
/// let f = Matrix([Vector([0.0, 2.0]), Vector([-1.0, 0.0])]);
/// let polar = polar(f);
/// assert!((polar.rotation - Matrix([Vector([0.0, 1.0]), Vector([-1.0, 0.0])])).squared_norm() < 1e-30);
/// assert!((polar.stretch - Matrix::from_diagonal(Vector([2.0, 1.0]))).squared_norm() < 1e-30);
/// ```
#[inline(always)]
pub fn polar<R: Real, const D: usize>(f: Matrix<R, D>) -> Polar<R, D> {
    const { assert!(D == 2 || D == 3, "only 2×2 and 3×3 matrices") };
    let rotation = match D {
        2 => rotation_2d(f.resize()).resize(),
        _ => rotation_3d(f.resize()).resize(),
    };
    Polar {
        rotation,
        stretch: stretch(rotation, f),
    }
}

#[inline(always)]
fn rotation_2d<R: Real>(f: Matrix<R, 2>) -> Matrix<R, 2> {
    let (c, s) = angle(scaled(f).0);
    Matrix([Vector([c, s]), Vector([-s, c])])
}

#[inline(always)]
fn rotation_3d<R: Real>(f: Matrix<R, 3>) -> Matrix<R, 3> {
    let split = split(f);
    let [a, p, q] = split.left.0;
    let (x, y) = turn(p, q, angle(split.block));
    let (left, right) = (Matrix([a, x, y]), split.right.transpose());
    Matrix([
        times(left, right.0[0]),
        times(left, right.0[1]),
        times(left, right.0[2]),
    ])
}

/// Returns cosine and sine of the rotation nearest to a 2×2 matrix with entries of at most about 1.
#[inline(always)]
fn angle<R: Real>(f: Matrix<R, 2>) -> (R, R) {
    let (c, s, _) = direction(f[(0, 0)] + f[(1, 1)], f[(1, 0)] - f[(0, 1)]);
    (c, s)
}

/// Returns the symmetric part of RᵀF.
#[inline(always)]
fn stretch<R: Real, const D: usize>(rotation: Matrix<R, D>, f: Matrix<R, D>) -> Matrix<R, D> {
    let half = f[(0, 0)].lit(0.5);
    let mut result = f;
    for j in 0..D {
        result[(j, j)] = dot(rotation.0[j], f.0[j]);
        for i in 0..j {
            let mean = (dot(rotation.0[i], f.0[j]) + dot(rotation.0[j], f.0[i])) * half;
            result[(i, j)] = mean;
            result[(j, i)] = mean;
        }
    }
    result
}
