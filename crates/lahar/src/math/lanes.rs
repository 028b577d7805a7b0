//! [`Real`] for vector registers: sixteen `f32` or eight `f64`, on whatever instruction set the
//! token `S` stands for. The widths are the same on all of them, so that the order of work, and
//! with it the result, does not depend on the machine.

use super::real::{Mask, Real, Scalar};
use fearless_simd::prelude::*;
use fearless_simd::{f32x16, f64x8, mask32x16, mask64x8};

/// Scalars that know their lane type on an instruction set.
pub trait Lanes: Scalar {
    /// The lane type on the instruction set `S`.
    type Of<S: Simd>: Real<Scalar = Self> + Copy;
    /// How many numbers a lane value holds.
    const WIDTH: usize;
    /// `WIDTH` numbers from the start of `slice`.
    fn load<S: Simd>(simd: S, slice: &[Self]) -> Self::Of<S>;
    /// Writes `WIDTH` numbers to the start of `slice`.
    fn store<S: Simd>(value: Self::Of<S>, slice: &mut [Self]);
    /// One number in every lane.
    fn broadcast<S: Simd>(simd: S, value: Self) -> Self::Of<S>;
}

macro_rules! lanes {
    ($scalar:ident, $vector:ident, $mask:ident, $width:literal) => {
        impl<S: Simd> Mask for $mask<S> {
            #[inline(always)]
            fn any(self) -> bool {
                self.any_true()
            }
            #[inline(always)]
            fn all(self) -> bool {
                self.all_true()
            }
        }

        impl<S: Simd> Real for $vector<S> {
            type Scalar = $scalar;
            type Mask = $mask<S>;
            const LANES: usize = $width;
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                SimdBase::splat(self.token(), value as $scalar)
            }
            #[inline(always)]
            fn splat(self, value: $scalar) -> Self {
                SimdBase::splat(self.token(), value)
            }
            #[inline(always)]
            fn lane(self, index: usize) -> $scalar {
                self.as_slice()[index]
            }
            #[inline(always)]
            fn map(self, f: impl Fn($scalar) -> $scalar) -> Self {
                let mut result = self;
                for x in result.as_mut_slice() {
                    *x = f(*x);
                }
                result
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                SimdFloat::mul_add(self, a, b)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                SimdBase::max(self, other)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                SimdBase::min(self, other)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                SimdFloat::copysign(self, sign)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                Select::select(mask, if_true, if_false)
            }
        }

        impl Lanes for $scalar {
            type Of<S: Simd> = $vector<S>;
            const WIDTH: usize = $width;
            #[inline(always)]
            fn load<S: Simd>(simd: S, slice: &[Self]) -> Self::Of<S> {
                $vector::from_slice(simd, &slice[..$width])
            }
            #[inline(always)]
            fn store<S: Simd>(value: Self::Of<S>, slice: &mut [Self]) {
                value.store_slice(&mut slice[..$width]);
            }
            #[inline(always)]
            fn broadcast<S: Simd>(simd: S, value: Self) -> Self::Of<S> {
                SimdBase::splat(simd, value)
            }
        }
    };
}

lanes!(f32, f32x16, mask32x16, 16);
lanes!(f64, f64x8, mask64x8, 8);
