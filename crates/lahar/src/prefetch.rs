//! Asking memory for rows before they are needed: a substep walks along some twenty columns at once, more
//! than processors foresee by themselves.
#![expect(
    unsafe_code,
    reason = "the instruction takes an address; measured in docs/performance.md"
)]

/// Bytes that memory is asked for at a time.
const LINE: usize = 64;

/// Asks for rows `start .. start + count` of each column that has them. Changes nothing.
#[inline(always)]
pub(crate) fn prefetch<T>(
    columns: &[impl core::ops::Deref<Target = [T]>],
    start: usize,
    count: usize,
) {
    #[cfg(target_arch = "x86_64")]
    for column in columns {
        let rows = column.get(start..start + count).unwrap_or_default();
        for line in rows.chunks(LINE / size_of::<T>()) {
            // SAFETY: the address is that of a number in the slice; the instruction reads nothing that
            // the program could see, and is part of every x86-64 processor.
            unsafe {
                core::arch::x86_64::_mm_prefetch::<{ core::arch::x86_64::_MM_HINT_T0 }>(
                    line.as_ptr().cast(),
                );
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (columns, start, count);
}

#[cfg(test)]
mod tests {
    use super::prefetch;

    #[test]
    fn it_asks_for_what_is_there_only() {
        let columns = [vec![1.0_f32; 100], Vec::new(), vec![2.0; 3]];
        for start in [0, 90, 99, 100, 1000] {
            prefetch(&columns, start, 32);
        }
        let slices: Vec<&mut [f64]> = Vec::new();
        prefetch(&slices, 0, 8);
    }
}
