//! From the name of an instruction set to the token that proves it is there.

use crate::setup::Isa;
use fearless_simd::Level;

/// The level of `isa`, if this machine has it.
pub(crate) fn level(isa: Isa) -> Option<Level> {
    match isa {
        Isa::Portable => Some(Level::baseline()),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Isa::Avx2 => Level::new().as_avx2().map(Level::Avx2),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Isa::Avx512 => Level::new().as_avx512().map(Level::Avx512),
        #[cfg(target_arch = "aarch64")]
        Isa::Neon => Level::new().as_neon().map(Level::Neon),
        _ => None,
    }
}
