//! One name for "a real number": a scalar, or a SIMD register full of them.
//!
//! Every formula of the method is written once, generic over [`Real`], and instantiated for `f64`
//! (the oracle), `f32`, and the lanes of the machine's vector registers ([`super::lanes`]).
//!
//! A lane type can only be made from another one (the token that proves that the instruction set
//! is there travels inside the values), so constants are made from a value at hand: `x.lit(0.5)`.
//! `a * b + c` is never contracted; a fused multiply-add is asked for by [`Real::mul_add`], and is
//! given only on instruction sets that are not the portable one.

use core::fmt::Debug;
use core::ops::{
    Add, AddAssign, BitAnd, BitOr, Div, DivAssign, Mul, MulAssign, Neg, Not, Sub, SubAssign,
};

/// A truth value a lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether any lane is true.
    fn any(self) -> bool;
    /// Whether every lane is true.
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

/// A real number, or a register of them; see the module's page.
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
    /// `f32` or `f64`.
    type Scalar: Scalar;
    /// What a comparison gives.
    type Mask: Mask;
    /// Numbers in one value: 1 for scalars.
    const LANES: usize;

    /// The constant `value`, rounded to the scalar type, in every lane.
    fn lit(self, value: f64) -> Self;
    /// The scalar `value` in every lane.
    fn splat(self, value: Self::Scalar) -> Self;
    /// The number in lane `index`.
    fn lane(self, index: usize) -> Self::Scalar;
    /// `f` of each lane; for what has no vector instruction (exp, ln, pow).
    fn map(self, f: impl Fn(Self::Scalar) -> Self::Scalar) -> Self;

    /// `self * a + b`: fused where the instruction set fuses, two roundings on the portable one.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The largest integer not above.
    fn floor(self) -> Self;
    /// The larger of two; unspecified if one is not a number.
    fn max(self, other: Self) -> Self;
    /// The smaller of two; unspecified if one is not a number.
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
    /// e to the power self.
    #[inline(always)]
    fn exp(self) -> Self {
        self.map(Scalar::exp_scalar)
    }
    /// Natural logarithm.
    #[inline(always)]
    fn ln(self) -> Self {
        self.map(Scalar::ln_scalar)
    }
    /// `self` to the power `exponent`: by multiplications if that is a small whole number.
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
            self.map(|x| x.pow_scalar(exponent))
        }
    }
    /// Whether each lane is a finite number.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().le(self.splat(Self::Scalar::MAX))
    }
}

/// `f32` or `f64`: a [`Real`] with one lane, and what storage needs of it.
pub trait Scalar:
    Real<Scalar = Self, Mask = bool> + PartialOrd + Default + Send + Sync + 'static + core::iter::Sum
{
    /// The largest finite number.
    const MAX: Self;
    /// The distance from 1 to the next number.
    const EPSILON: Self;
    /// "f32" or "f64".
    const NAME: &'static str;
    /// The nearest number to `value`.
    fn from_f64(value: f64) -> Self;
    /// Exact.
    fn to_f64(self) -> f64;
    /// As a column of a snapshot.
    fn data(values: Vec<Self>) -> crate::array::Data;
    /// As an array of a checkpoint.
    fn values(values: Vec<Self>) -> crate::array::Values;
    /// From an array of a checkpoint, if it is of this type.
    fn from_values(values: crate::array::Values) -> Option<Vec<Self>>;
    /// e to the power self, the same bits on every machine.
    fn exp_scalar(self) -> Self;
    /// Natural logarithm, the same bits on every machine.
    fn ln_scalar(self) -> Self;
    /// Power, the same bits on every machine.
    fn pow_scalar(self, exponent: f64) -> Self;
}

macro_rules! scalar {
    ($t:ident, $variant:ident, $exp:path, $ln:path, $pow:path) => {
        impl Real for $t {
            type Scalar = $t;
            type Mask = bool;
            const LANES: usize = 1;
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn splat(self, value: $t) -> Self {
                value
            }
            #[inline(always)]
            fn lane(self, _: usize) -> $t {
                self
            }
            #[inline(always)]
            fn map(self, f: impl Fn($t) -> $t) -> Self {
                f(self)
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
        }

        impl Scalar for $t {
            const MAX: Self = <$t>::MAX;
            const EPSILON: Self = <$t>::EPSILON;
            const NAME: &'static str = stringify!($t);
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn data(values: Vec<Self>) -> crate::array::Data {
                crate::array::Data::$variant(values)
            }
            fn values(values: Vec<Self>) -> crate::array::Values {
                crate::array::Values::$variant(values)
            }
            fn from_values(values: crate::array::Values) -> Option<Vec<Self>> {
                match values {
                    crate::array::Values::$variant(values) => Some(values),
                    _ => None,
                }
            }
            #[inline]
            fn exp_scalar(self) -> Self {
                $exp(self)
            }
            #[inline]
            fn ln_scalar(self) -> Self {
                $ln(self)
            }
            #[inline]
            fn pow_scalar(self, exponent: f64) -> Self {
                $pow(self, exponent as $t)
            }
        }
    };
}

scalar!(f32, F32, libm::expf, libm::logf, libm::powf);
scalar!(f64, F64, libm::exp, libm::log, libm::pow);
