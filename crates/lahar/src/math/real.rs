//! Real numbers: the arithmetic that formulas are written with, and scalars.
//!
//! Every formula of the method is written once, generic over [`Real`], and instantiated for `f64`
//! (the oracle), for `f32`, and for the vector registers of the machine ([`super::lanes`]).
//! [`Real`] has arithmetic only. A type that records operations in place of computing them, in order
//! to print a formula in another language, can implement it. Access to the numbers inside a register
//! is a separate trait, [`Register`], which formulas do not use.
//!
//! A register can only be made from another one, because the proof that the machine has the
//! instruction set travels inside the value. Constants are therefore made from a value at hand:
//! `x.lit(0.5)`. The product in `a * b + c` is always rounded; [`Real::mul_add`] asks for a fused
//! multiply-add, and gets one on every instruction set but the portable one.

use super::near_one::power_minus_one;
use core::fmt::Debug;
use core::ops::{
    Add, AddAssign, BitAnd, BitOr, Div, DivAssign, Mul, MulAssign, Neg, Not, Sub, SubAssign,
};

/// The result of a comparison: one truth value per lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Returns true if any lane is true. A recording mask returns true.
    fn any(self) -> bool;
    /// Returns true if every lane is true. A recording mask returns false.
    fn all(self) -> bool;
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

/// A real number, or a register of them, with the operations that formulas may use.
///
/// ```
/// use lahar::math::Real;
///
/// /// The pressure of a perfect gas, once for every kind of number.
/// fn pressure<R: Real>(density: R) -> R {
///     density * density.lit(287.0 * 293.0) // R T
/// }
/// assert_eq!(pressure(2.0_f64), 168_182.0);
/// assert_eq!(pressure(2.0_f32), 168_182.0);
/// ```
///
/// Methods ending in `_by_number` have no vector instruction: a register computes them lane by lane.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// The result of a comparison.
    type Mask: Mask;
    /// The distance from 1 to the next larger number.
    const EPSILON: f64;
    /// The largest finite number.
    const LARGEST: f64;

    /// The constant `value`, rounded to the precision of this type, in every lane.
    fn lit(self, value: f64) -> Self;

    /// `self * a + b`: fused where the instruction set fuses, two roundings on the portable one.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Returns the square root.
    fn sqrt(self) -> Self;
    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// The largest integer that is not above `self`.
    fn floor(self) -> Self;
    /// The larger of two numbers; unspecified if one is NaN.
    fn max(self, other: Self) -> Self;
    /// The smaller of two numbers; unspecified if one is NaN.
    fn min(self, other: Self) -> Self;
    /// `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;

    /// `self < other`, lane by lane.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`, lane by lane.
    fn le(self, other: Self) -> Self::Mask;
    /// `self > other`, lane by lane.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`, lane by lane.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// `if_true` where the mask is true, else `if_false`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;

    /// e to the power `self`, with the same bits on every machine.
    fn exp(self) -> Self;
    /// Natural logarithm, with the same bits on every machine.
    fn ln(self) -> Self;
    /// `self` to the power `exponent`, with the same bits on every machine.
    fn power_by_number(self, exponent: f64) -> Self;
    /// ln(1 + `self`), computed in `f64`. Formulas call [`super::near_one::ln_1p`].
    fn ln_1p_by_number(self) -> Self;
    /// `self` − ln(1 + `self`), computed in `f64`. Formulas call [`super::near_one::minus_ln_1p`].
    fn minus_ln_1p_by_number(self) -> Self;
    /// (1 + `self`)^`exponent` − 1, computed in `f64`. Formulas call
    /// [`super::near_one::power_minus_one`].
    fn power_minus_one_by_number(self, exponent: f64) -> Self;
    /// `self` − ((1 + `self`)^`exponent` − 1)/`exponent`, computed in `f64`; `exponent` is not 0. Of
    /// second order in `self`, so that in `f32` the difference would lose its digits.
    fn minus_power_by_number(self, exponent: f64) -> Self;

    /// Zero in every lane.
    #[inline(always)]
    fn zero(self) -> Self {
        self.lit(0.0)
    }
    /// One in every lane.
    #[inline(always)]
    fn one(self) -> Self {
        self.lit(1.0)
    }
    /// `self` to the power `exponent`: by multiplications if the exponent is a whole number from −16
    /// to 16, else number by number.
    #[inline(always)]
    fn power(self, exponent: f64) -> Self {
        if exponent.fract() == 0.0 && exponent.abs() <= 16.0 {
            let mut n = exponent.abs() as u32;
            let (mut base, mut result) = (self, self.one());
            while n > 0 {
                if n & 1 == 1 {
                    result *= base;
                }
                base *= base;
                n >>= 1;
            }
            if exponent < 0.0 {
                self.one() / result
            } else {
                result
            }
        } else {
            self.power_by_number(exponent)
        }
    }
    /// True in the lanes that hold a finite number.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().le(self.lit(Self::LARGEST))
    }
}

/// A [`Real`] whose numbers can be read and written: a scalar, or a vector register.
pub trait Register: Real {
    /// The type of one lane, `f32` or `f64`.
    type Scalar: Scalar;
    /// The number of lanes: 1 for scalars.
    const LANES: usize;
    /// Returns a register with `value` in every lane.
    fn splat(self, value: Self::Scalar) -> Self;
    /// Returns the number in lane `index`.
    fn lane(self, index: usize) -> Self::Scalar;
}

/// `f32` or `f64`: a [`Register`] of one lane that storage is made of.
pub trait Scalar:
    Register<Scalar = Self, Mask = bool>
    + PartialOrd
    + Default
    + Send
    + Sync
    + 'static
    + core::iter::Sum
{
    /// "f32" or "f64".
    const NAME: &'static str;
    /// Rounds `value` to the nearest number of this type.
    fn from_f64(value: f64) -> Self;
    /// Converts to `f64`, exactly.
    fn to_f64(self) -> f64;
}

macro_rules! scalar {
    ($t:ident, $exp:path, $ln:path, $pow:path) => {
        impl Real for $t {
            type Mask = bool;
            const EPSILON: f64 = <$t>::EPSILON as f64;
            const LARGEST: f64 = <$t>::MAX as f64;
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                self * a + b
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                <$t>::floor(self)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                <$t>::copysign(self, sign)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
            #[inline]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline]
            fn ln(self) -> Self {
                $ln(self)
            }
            #[inline]
            fn power_by_number(self, exponent: f64) -> Self {
                $pow(self, exponent as $t)
            }
            #[inline(always)]
            fn ln_1p_by_number(self) -> Self {
                libm::log1p(f64::from(self)) as $t
            }
            #[inline(always)]
            fn minus_ln_1p_by_number(self) -> Self {
                let e = f64::from(self);
                (e - libm::log1p(e)) as $t
            }
            #[inline(always)]
            fn power_minus_one_by_number(self, exponent: f64) -> Self {
                libm::expm1(exponent * libm::log1p(f64::from(self))) as $t
            }
            #[inline(always)]
            fn minus_power_by_number(self, exponent: f64) -> Self {
                let e = f64::from(self);
                (e - power_minus_one(e, exponent) / exponent) as $t
            }
        }

        impl Register for $t {
            type Scalar = $t;
            const LANES: usize = 1;
            #[inline(always)]
            fn splat(self, value: $t) -> Self {
                value
            }
            #[inline(always)]
            fn lane(self, _: usize) -> $t {
                self
            }
        }

        impl Scalar for $t {
            const NAME: &'static str = stringify!($t);
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }
    };
}

scalar!(f32, libm::expf, libm::logf, libm::powf);
scalar!(f64, libm::exp, libm::log, libm::pow);
