//! Functions of 1 + e, from e.
//!
//! Particles store the difference from rest, J − 1 and F − I, because small strains would drown in the
//! rounding of the 1. These functions preserve them too: near e = 0 each is accurate to a few units in
//! the last place of its *result*.

use super::real::{Mask, Real};

/// Returns ln(1 + e), for e > −1. Relative error: 3 ε.
///
/// Within |e| ≤ ½ it sums the series of 2 artanh(e / (2 + e)), in lanes; beyond, it works number by
/// number.
#[inline(always)]
pub fn ln_1p<R: Real>(e: R) -> R {
    let (s, tail) = logarithm_series(e);
    near_or(e, s + s + tail, R::ln_1p_by_number)
}

/// Returns e − ln(1 + e), for e > −1, which is about ½e² near 0. Relative error: 4 ε.
#[inline(always)]
pub fn minus_ln_1p<R: Real>(e: R) -> R {
    // e − 2s = e s
    let (s, tail) = logarithm_series(e);
    near_or(e, e * s - tail, R::minus_ln_1p_by_number)
}

/// ln(1 + e) = 2s + tail with s = e / (2 + e), the tail being of third order; for |e| ≤ ½.
#[inline(always)]
fn logarithm_series<R: Real>(e: R) -> (R, R) {
    // s² ≤ 1/9: the terms that are cut off are below 9^−terms of the sum.
    let terms = if R::EPSILON > 1e-10 { 8 } else { 16 };
    let s = e / (e + e.lit(2.0));
    let square = s * s;
    let mut sum = e.lit(2.0 / (2 * terms + 1) as f64);
    for k in (1..terms).rev() {
        sum = sum.mul_add(square, e.lit(2.0 / (2 * k + 1) as f64));
    }
    (s, s * square * sum)
}

/// Returns `near` where |e| ≤ ½, else `far(e)`. The result of a lane depends on that lane alone.
#[inline(always)]
fn near_or<R: Real>(e: R, near: R, far: impl FnOnce(R) -> R) -> R {
    let is_far = e.abs().gt(e.lit(0.5));
    if is_far.any() {
        R::select(is_far, far(e), near)
    } else {
        near
    }
}

/// Returns (1 + e)^`exponent` − 1, for e > −1. Relative error: about 2 `|exponent|` ε.
///
/// It multiplies if the exponent is a whole number from −16 to 16, else it works number by number.
#[inline(always)]
pub fn power_minus_one<R: Real>(e: R, exponent: f64) -> R {
    if exponent.fract() != 0.0 || exponent.abs() > 16.0 {
        return e.power_minus_one_by_number(exponent);
    }
    // (1 + a)(1 + b) − 1 = a + b (1 + a): both terms have one sign if a and b have.
    let times = |a: R, b: R| a + b * (a + a.one());
    let mut n = exponent.abs() as u32;
    let mut base = if exponent < 0.0 {
        -e / (e + e.one()) // 1 / (1 + e) − 1
    } else {
        e
    };
    let mut result = e.zero();
    while n > 0 {
        if n & 1 == 1 {
            result = times(base, result);
        }
        n >>= 1;
        if n > 0 {
            base = times(base, base);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::super::real::Scalar;
    use super::*;

    /// Numbers from just above −1 to 100, dense around 0, of both signs.
    fn samples() -> impl Iterator<Item = f64> {
        let small = (-80..=-1).map(|k| 10f64.powf(0.25 * f64::from(k)));
        small.flat_map(|e| [e, -e]).chain([
            0.5, -0.5, 0.500_001, -0.500_001, -0.9, -0.99, 1.0, 3.0, 100.0,
        ])
    }

    /// Returns the largest relative error of `ours`, in units of ε.
    fn worst<T: Scalar>(ours: impl Fn(T) -> T, exact: impl Fn(f64) -> f64) -> f64 {
        let error = samples().map(|e| {
            let e = T::from_f64(e);
            let exact = exact(e.to_f64());
            if exact.abs() < 1e-30 {
                return 0.0; // a denormal f32 has fewer digits
            }
            (ours(e).to_f64() - exact).abs() / exact.abs()
        });
        error.fold(0.0, f64::max) / T::EPSILON
    }

    #[test]
    fn logarithm_is_accurate_relative_to_itself() {
        assert_eq!(ln_1p(0.0f64), 0.0);
        let single = worst(ln_1p::<f32>, libm::log1p);
        let double = worst(ln_1p::<f64>, libm::log1p);
        assert!(single < 3.0 && double < 3.0, "{single} {double}");
    }

    #[test]
    fn remainder_of_the_logarithm_is_accurate_relative_to_itself() {
        assert_eq!(minus_ln_1p(0.0f64), 0.0);
        // The alternating series where the difference would cancel.
        let exact = |e: f64| match e.abs() {
            small if small < 1e-3 => (2..12).map(|k| (-e).powi(k) / f64::from(k)).sum(),
            _ => e - libm::log1p(e),
        };
        let single = worst(minus_ln_1p::<f32>, exact);
        assert!(single < 4.0, "{single}");
        let double = worst(minus_ln_1p::<f64>, exact);
        // The reference itself loses three digits at 1e-3.
        assert!(double < 5e3, "{double}");
    }

    #[test]
    fn powers_are_accurate_relative_to_themselves() {
        for exponent in [1.0, 2.0, 7.0, -1.0, -6.0, -7.0, 16.0, 0.5, 1.0 / 3.0, -1.4] {
            let exact = |e: f64| libm::expm1(exponent * libm::log1p(e));
            assert_eq!(power_minus_one(0.0f64, exponent), 0.0);
            let single = worst(|e: f32| power_minus_one(e, exponent), exact);
            let bound = 2.0 * exponent.abs() + 4.0;
            assert!(single < bound, "f32, {exponent}: {single}");
            // The reference itself is off by |exponent ln(1 + e)| ε.
            let double = worst(|e: f64| power_minus_one(e, exponent), exact);
            assert!(double < bound * 10.0, "f64, {exponent}: {double}");
        }
    }
}
