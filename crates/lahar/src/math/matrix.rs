//! A square matrix of `D × D` reals, `m[(i, j)]` being row `i`, column `j`.

use super::real::Real;
use super::vector::Vector;
use core::ops::{Add, AddAssign, Index, IndexMut, Mul, Sub, SubAssign};

/// A matrix, stored by columns: column `j` is the vector `self.0[j]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<R, const D: usize>(pub [Vector<R, D>; D]);

impl<R: Real, const D: usize> Matrix<R, D> {
    /// Creates the matrix whose entry in row `i`, column `j` is `f(i, j)`.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(usize, usize) -> R) -> Self {
        let mut m = Self([Vector([f(0, 0); D]); D]);
        for j in 0..D {
            for i in 0..D {
                if (i, j) != (0, 0) {
                    m[(i, j)] = f(i, j);
                }
            }
        }
        m
    }
    /// Returns `value` times the identity.
    #[inline(always)]
    pub fn scaled_identity(value: R) -> Self {
        let zero = value.zero();
        Self::from_fn(|i, j| if i == j { value } else { zero })
    }
    /// Returns the identity, in the lanes of `like`.
    #[inline(always)]
    pub fn identity(like: R) -> Self {
        Self::scaled_identity(like.one())
    }
    /// Returns the matrix with `diagonal` on its diagonal and zeros elsewhere.
    #[inline(always)]
    pub fn from_diagonal(diagonal: Vector<R, D>) -> Self {
        let zero = diagonal[0].zero();
        Self::from_fn(|i, j| if i == j { diagonal[i] } else { zero })
    }
    /// Returns the transpose.
    #[inline(always)]
    pub fn transpose(self) -> Self {
        Self::from_fn(|i, j| self[(j, i)])
    }
    /// Returns the trace, the sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> R {
        let mut sum = self[(0, 0)];
        for i in 1..D {
            sum += self[(i, i)];
        }
        sum
    }
    /// Returns the determinant, for `D` = 1, 2 or 3.
    #[inline(always)]
    pub fn determinant(self) -> R {
        let m = |i, j| self[(i, j)];
        match D {
            1 => m(0, 0),
            2 => m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0),
            _ => {
                m(0, 0) * (m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1))
                    - m(0, 1) * (m(1, 0) * m(2, 2) - m(1, 2) * m(2, 0))
                    + m(0, 2) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0))
            }
        }
    }
    /// Returns det(I + A) − 1 for this matrix A, for `D` = 1, 2 or 3. It is computed as the sum of the
    /// principal invariants of A, without the cancellation of forming I + A.
    #[inline(always)]
    pub fn determinant_of_identity_plus_minus_one(self) -> R {
        let m = |i, j| self[(i, j)];
        match D {
            1 => m(0, 0),
            2 => self.trace() + self.determinant(),
            _ => {
                let minor = |i, j| m(i, i) * m(j, j) - m(i, j) * m(j, i);
                self.trace() + (minor(0, 1) + minor(0, 2) + minor(1, 2)) + self.determinant()
            }
        }
    }
    /// Returns the sum of the squares of all entries.
    #[inline(always)]
    pub fn squared_norm(self) -> R {
        let mut sum = self.0[0].dot(self.0[0]);
        for j in 1..D {
            sum += self.0[j].dot(self.0[j]);
        }
        sum
    }
    /// Returns the same matrix with its dimension under another name, for code that has matched on `D`.
    #[inline(always)]
    pub fn resize<const E: usize>(self) -> Matrix<R, E> {
        Matrix::from_fn(|i, j| self[(i, j)])
    }
}

impl<R, const D: usize> Index<(usize, usize)> for Matrix<R, D> {
    type Output = R;
    #[inline(always)]
    fn index(&self, (i, j): (usize, usize)) -> &R {
        &self.0[j].0[i]
    }
}
impl<R, const D: usize> IndexMut<(usize, usize)> for Matrix<R, D> {
    #[inline(always)]
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut R {
        &mut self.0[j].0[i]
    }
}
impl<R: Real, const D: usize> Add for Matrix<R, D> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for j in 0..D {
            self.0[j] += other.0[j];
        }
        self
    }
}
impl<R: Real, const D: usize> Sub for Matrix<R, D> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for j in 0..D {
            self.0[j] -= other.0[j];
        }
        self
    }
}
impl<R: Real, const D: usize> AddAssign for Matrix<R, D> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<R: Real, const D: usize> SubAssign for Matrix<R, D> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
/// Multiplies by a number.
impl<R: Real, const D: usize> Mul<R> for Matrix<R, D> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, factor: R) -> Self {
        for j in 0..D {
            self.0[j] = self.0[j] * factor;
        }
        self
    }
}
impl<R: Real, const D: usize> Mul<Vector<R, D>> for Matrix<R, D> {
    type Output = Vector<R, D>;
    #[inline(always)]
    fn mul(self, v: Vector<R, D>) -> Vector<R, D> {
        let mut sum = self.0[0] * v[0];
        for j in 1..D {
            sum += self.0[j] * v[j];
        }
        sum
    }
}
impl<R: Real, const D: usize> Mul for Matrix<R, D> {
    type Output = Self;
    #[inline(always)]
    #[expect(
        clippy::needless_range_loop,
        reason = "unrolls; iterators' adaptors were slower"
    )]
    fn mul(self, other: Self) -> Self {
        let mut columns = [self * other.0[0]; D];
        for j in 1..D {
            columns[j] = self * other.0[j];
        }
        Self(columns)
    }
}
