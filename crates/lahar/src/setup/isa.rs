//! Instruction sets that the engine can be told to run on.

use crate::dispatch;
use fearless_simd::Level;

/// Instruction sets. The same scene gives the same bits on one of them, and on
/// [`Isa::Portable`] on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// The compile target's baseline, without fused multiply-adds.
    Portable,
    /// AVX2 with FMA.
    Avx2,
    /// AVX-512 (Ice Lake and later).
    Avx512,
    /// AArch64's vectors.
    Neon,
}

impl Isa {
    /// The widest that this machine has.
    pub fn detect() -> Self {
        [Self::Avx512, Self::Avx2, Self::Neon]
            .into_iter()
            .find(|isa| isa.is_available())
            .unwrap_or(Self::Portable)
    }

    /// Whether this machine can run it.
    pub fn is_available(self) -> bool {
        self.level().is_some()
    }

    /// As written in scenes and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }

    /// All of them, whether this machine has them or not.
    pub const ALL: [Self; 4] = [Self::Portable, Self::Avx2, Self::Avx512, Self::Neon];

    /// The compiled level of this instruction set, if this machine has it.
    pub(crate) fn level(self) -> Option<Level> {
        match self {
            Isa::Portable => Some(dispatch::portable()),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Isa::Avx2 => Level::new().as_avx2().map(Level::Avx2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Isa::Avx512 => Level::new().as_avx512().map(Level::Avx512),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => Level::new().as_neon().map(Level::Neon),
            _ => None,
        }
    }
}
