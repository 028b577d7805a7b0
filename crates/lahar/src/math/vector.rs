//! A vector of `D` reals.

use super::real::Real;
use core::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

/// A vector of `D` components; in lanes, of `D` registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<R, const D: usize>(pub [R; D]);

impl<R: Real, const D: usize> Vector<R, D> {
    /// Creates the vector whose component `i` is `f(i)`.
    ///
    /// It is a plain loop, because `core::array::from_fn` leaves closures over lanes as calls of
    /// functions without the instruction set, in which every operation is one more call (measured: 7 to
    /// 12 times slower).
    #[inline(always)]
    #[expect(
        clippy::needless_range_loop,
        reason = "unrolls; iterators' adaptors were slower"
    )]
    pub fn from_fn(mut f: impl FnMut(usize) -> R) -> Self {
        let mut result = [f(0); D];
        for i in 1..D {
            result[i] = f(i);
        }
        Self(result)
    }
    /// Returns the scalar product Σ aᵢ bᵢ.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        let mut sum = self[0] * other[0];
        for i in 1..D {
            sum += self[i] * other[i];
        }
        sum
    }
    /// Returns the Euclidean length.
    #[inline(always)]
    pub fn norm(self) -> R {
        self.dot(self).sqrt()
    }
}

impl<R, const D: usize> Index<usize> for Vector<R, D> {
    type Output = R;
    #[inline(always)]
    fn index(&self, i: usize) -> &R {
        &self.0[i]
    }
}
impl<R, const D: usize> IndexMut<usize> for Vector<R, D> {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut R {
        &mut self.0[i]
    }
}
impl<R: Real, const D: usize> Add for Vector<R, D> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for i in 0..D {
            self[i] += other[i];
        }
        self
    }
}
impl<R: Real, const D: usize> Sub for Vector<R, D> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for i in 0..D {
            self[i] -= other[i];
        }
        self
    }
}
impl<R: Real, const D: usize> Neg for Vector<R, D> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        for i in 0..D {
            self[i] = -self[i];
        }
        self
    }
}
/// Multiplies by a number.
impl<R: Real, const D: usize> Mul<R> for Vector<R, D> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, factor: R) -> Self {
        for i in 0..D {
            self[i] *= factor;
        }
        self
    }
}
impl<R: Real, const D: usize> AddAssign for Vector<R, D> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<R: Real, const D: usize> SubAssign for Vector<R, D> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
