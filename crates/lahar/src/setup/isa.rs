//! Instruction sets that the engine can run on.

use crate::dispatch;
use fearless_simd::Level;

/// An instruction set. On one instruction set, the same scene gives the same bits; on [`Isa::Portable`], it does so
/// on every machine.
///
/// ```
/// use lahar::Isa;
///
/// assert!(Isa::Portable.is_available());
/// assert!(Isa::detect().is_available());
/// assert_eq!(Isa::Avx2.name(), "avx2");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// The compile target's baseline, without fused multiply-adds.
    Portable,
    /// AVX2 with FMA, on x86.
    Avx2,
    /// AVX-512 of Ice Lake and later, on x86.
    Avx512,
    /// Advanced SIMD of AArch64.
    Neon,
}

impl Isa {
    /// All instruction sets, also those that this machine lacks.
    pub const ALL: [Self; 4] = [Self::Portable, Self::Avx2, Self::Avx512, Self::Neon];

    /// Finds the widest instruction set of this machine.
    pub fn detect() -> Self {
        [Self::Avx512, Self::Avx2, Self::Neon]
            .into_iter()
            .find(|isa| isa.is_available())
            .unwrap_or(Self::Portable)
    }

    /// Returns true if this machine has it.
    pub fn is_available(self) -> bool {
        self.level().is_some()
    }

    /// The name in scenes and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }

    /// Returns the token that code for this instruction set is entered with, if this machine has it.
    pub(crate) fn level(self) -> Option<Level> {
        match self {
            Self::Portable => Some(dispatch::portable()),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2 => Level::new().as_avx2().map(Level::Avx2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512 => Level::new().as_avx512().map(Level::Avx512),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => Level::new().as_neon().map(Level::Neon),
            _ => None,
        }
    }
}
