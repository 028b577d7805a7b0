//! Flush-to-zero and denormals-are-zero while computing. Resting fluid makes denormal numbers, which cost a factor of
//! five.
//!
//! Rust's own semantics assume the default mode. The guard lives only around the solver's loops, whose results it changes
//! in the same way on every thread.
#![expect(
    unsafe_code,
    reason = "the control register has no safe access; the deprecated intrinsics have no successor"
)]

/// Keeps the mode on for the thread that has made it, and restores the old mode when dropped.
pub(crate) struct FlushToZero {
    #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
    before: u64,
    // Not to be sent to another thread: the mode belongs to this one.
    marker: core::marker::PhantomData<*const ()>,
}

#[cfg(target_arch = "x86_64")]
mod control {
    use core::arch::asm;

    /// Flush-to-zero (bit 15) and denormals-are-zero (bit 6) of MXCSR.
    pub(super) const FLUSH: u64 = 0x8040;

    pub(super) fn read() -> u64 {
        let mut value: u32 = 0;
        // SAFETY: stmxcsr writes four bytes to the address given, that of a local u32.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
        u64::from(value)
    }

    pub(super) fn write(value: u64) {
        let value = value as u32;
        // SAFETY: the value is one that stmxcsr gave, with only the two flush bits changed: no
        // reserved bit is set and no exception unmasked.
        unsafe {
            asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags, readonly))
        };
    }
}

#[cfg(target_arch = "aarch64")]
mod control {
    use core::arch::asm;

    /// Flush-to-zero (bit 24) of FPCR; it covers inputs too.
    pub(super) const FLUSH: u64 = 1 << 24;

    pub(super) fn read() -> u64 {
        let value: u64;
        // SAFETY: reading FPCR has no effect.
        unsafe { asm!("mrs {}, fpcr", out(reg) value, options(nomem, nostack, preserves_flags)) };
        value
    }

    pub(super) fn write(value: u64) {
        // SAFETY: the value is one that was read, with only the flush bit changed.
        unsafe { asm!("msr fpcr, {}", in(reg) value, options(nostack, preserves_flags)) };
    }
}

impl FlushToZero {
    /// Turns the mode on for this thread.
    pub(crate) fn enter() -> Self {
        #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
        {
            let before = control::read();
            if before & control::FLUSH != control::FLUSH {
                control::write(before | control::FLUSH);
            }
            Self {
                before,
                marker: core::marker::PhantomData,
            }
        }
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        Self {
            marker: core::marker::PhantomData,
        }
    }
}

impl Drop for FlushToZero {
    fn drop(&mut self) {
        #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
        if self.before & control::FLUSH != control::FLUSH {
            control::write((control::read() & !control::FLUSH) | (self.before & control::FLUSH));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::FlushToZero;
    use core::hint::black_box;

    #[test]
    fn denormals_flush_inside_and_come_back_outside() {
        let tiny = black_box(f32::MIN_POSITIVE);
        {
            let _guard = FlushToZero::enter();
            let _nested = FlushToZero::enter();
            if cfg!(any(target_arch = "x86_64", target_arch = "aarch64")) {
                assert_eq!(black_box(tiny * black_box(0.5)), 0.0);
            }
        }
        assert!(black_box(tiny * black_box(0.5)) > 0.0);
    }
}
