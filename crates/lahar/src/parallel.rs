//! Parallel work: two halves at the same time, where threads are compiled in.
//!
//! All parallel work in this crate is divided by halving lists of blocks, so that each half owns its slices. How far it is
//! divided depends on the number of threads; results do not.

/// Runs `a` and `b`, perhaps at the same time.
#[cfg(feature = "threads")]
pub(crate) fn join<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(a, b)
}

/// Runs `a` and then `b`.
#[cfg(not(feature = "threads"))]
pub(crate) fn join<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    (a(), b())
}

/// Pieces per thread, so that other threads can help one that is late.
const PIECES_PER_THREAD: usize = 8;

/// Returns the size of the pieces that `total` is divided into: at least `smallest`.
pub(crate) fn grain(total: usize, smallest: usize) -> usize {
    match threads() {
        1 => usize::MAX,
        threads => (total / (threads * PIECES_PER_THREAD)).max(smallest),
    }
}

/// Returns the number of threads that [`join`] may use.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "threads")]
    {
        rayon::current_num_threads()
    }
    #[cfg(not(feature = "threads"))]
    1
}

/// Calls `work(first, piece)` on pieces of whole chunks of `data`; the index of the piece's first chunk is `first`.
pub(crate) fn for_chunks<T: Send>(
    data: &mut [T],
    chunk: usize,
    first: usize,
    grain_chunks: usize,
    work: &(impl Fn(usize, &mut [T]) + Sync),
) {
    let chunks = data.len() / chunk;
    if chunks <= grain_chunks.max(1) {
        work(first, data);
        return;
    }
    let half = chunks / 2;
    let (low, high) = data.split_at_mut(half * chunk);
    join(
        || for_chunks(low, chunk, first, grain_chunks, work),
        || for_chunks(high, chunk, first + half, grain_chunks, work),
    );
}
