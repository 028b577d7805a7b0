//! Dispatch: from an instruction set to the code that is compiled for it.

use fearless_simd::Level;

/// Returns the level that never fuses a multiply and an add: SSE2 where that is the baseline, else plain scalars.
pub(crate) fn portable() -> Level {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        Level::baseline()
    }
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    {
        Level::fallback()
    }
}

/// Runs an expression with `$simd` bound to the token of the given level, compiled for that
/// level's instructions. It has only the levels of [`Isa`](crate::setup::Isa), unlike the library's own `dispatch!`, since
/// each level is a copy of the code.
macro_rules! on_level {
    ($level:expr, $simd:ident => $body:expr) => {{
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        match $level {
            fearless_simd::Level::Avx512($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            fearless_simd::Level::Avx2($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            _ => $crate::dispatch::on_portable!($simd => $body),
        }
        #[cfg(target_arch = "aarch64")]
        match $level {
            fearless_simd::Level::Neon($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            _ => $crate::dispatch::on_portable!($simd => $body),
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
        {
            let _ = $level;
            $crate::dispatch::on_portable!($simd => $body)
        }
    }};
}

/// Runs an expression with `$simd` bound to the portable token.
macro_rules! on_portable {
    ($simd:ident => $body:expr) => {
        match $crate::dispatch::portable() {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            fearless_simd::Level::Sse2($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
            fearless_simd::Level::Fallback($simd) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            // The target's own baseline is above the portable one: its first level will do.
            _ => unreachable!("the portable level is always there"),
        }
    };
}

pub(crate) use {on_level, on_portable};
