//! Iterators over pieces of slices, on all threads where threads are compiled in.
//!
//! Code is written against rayon's names. Without the feature `threads` the same names give iterators of the
//! standard library, which do the same work in order: results do not depend on it.

#[cfg(feature = "threads")]
pub(crate) use rayon::prelude::{
    IndexedParallelIterator, ParallelIterator, ParallelSlice, ParallelSliceMut,
};

#[cfg(feature = "threads")]
pub(crate) use rayon::prelude::{IntoParallelRefIterator, IntoParallelRefMutIterator};

#[cfg(not(feature = "threads"))]
pub(crate) use serial::{ParallelSlice, ParallelSliceMut, Pieces};

#[cfg(not(feature = "threads"))]
mod serial {
    use core::slice::{Chunks, ChunksMut, Iter, IterMut};

    /// Iterators that read a slice.
    pub(crate) trait ParallelSlice<T> {
        /// One element after the other.
        fn par_iter(&self) -> Iter<'_, T>;
        /// Pieces of `size` elements; the last may be shorter.
        fn par_chunks(&self, size: usize) -> Chunks<'_, T>;
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_iter(&self) -> Iter<'_, T> {
            self.iter()
        }
        fn par_chunks(&self, size: usize) -> Chunks<'_, T> {
            self.chunks(size)
        }
    }

    /// Iterators that write a slice.
    pub(crate) trait ParallelSliceMut<T> {
        /// One element after the other.
        fn par_iter_mut(&mut self) -> IterMut<'_, T>;
        /// Pieces of `size` elements; the last may be shorter.
        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T>;
    }

    impl<T> ParallelSliceMut<T> for [T] {
        fn par_iter_mut(&mut self) -> IterMut<'_, T> {
            self.iter_mut()
        }
        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T> {
            self.chunks_mut(size)
        }
    }

    /// The least number of elements that one thread takes.
    pub(crate) trait Pieces: Sized {
        /// Returns the iterator as it is: there is one thread.
        fn with_min_len(self, _: usize) -> Self {
            self
        }
    }

    impl<I: Iterator> Pieces for I {}
}
