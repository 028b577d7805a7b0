//! Prefetching of rows before they are needed. A substep walks along some twenty columns at once, more than processors
//! foresee by themselves.
#![expect(
    unsafe_code,
    reason = "the instruction takes an address; measured in docs/performance.md"
)]

use crate::particles::Rows;

/// Bytes of a line of the cache.
const LINE: usize = 64;

/// Prefetches rows `start .. start + CHUNK` of each column that has them. Changes nothing.
#[inline(always)]
pub(crate) fn prefetch_chunk<T>(columns: &[impl core::ops::Deref<Target = [T]>], start: usize) {
    for column in columns {
        if let Some(rows) = column.get(start..).and_then(|rows| rows.first_chunk()) {
            let rows: &Rows<T> = rows;
            for line in rows.chunks(LINE / size_of::<T>()) {
                prefetch_line(line);
            }
        }
    }
}

/// Prefetches `numbers`. Changes nothing.
#[inline(always)]
pub(crate) fn prefetch<T>(numbers: &[T]) {
    for line in numbers.chunks(LINE / size_of::<T>()) {
        prefetch_line(line);
    }
}

/// Prefetches the line of the cache in which `numbers` begins.
#[inline(always)]
fn prefetch_line<T>(numbers: &[T]) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: the address is that of a slice; the instruction reads nothing that the program could see, and
    // is part of every x86-64 processor.
    unsafe {
        core::arch::x86_64::_mm_prefetch::<{ core::arch::x86_64::_MM_HINT_T0 }>(
            numbers.as_ptr().cast(),
        );
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = numbers;
}

#[cfg(test)]
mod tests {
    use super::{prefetch, prefetch_chunk};

    #[test]
    fn rows_that_do_not_exist_are_skipped() {
        let columns = [vec![1.0_f32; 100], Vec::new(), vec![2.0; 3]];
        for start in [0, 90, 99, 100, 1000] {
            prefetch_chunk(&columns, start);
        }
        let none: [&mut [f64]; 0] = [];
        prefetch_chunk(&none, 0);
        for count in [0, 3, 16, 100] {
            prefetch(&columns[0][..count]);
        }
    }
}
