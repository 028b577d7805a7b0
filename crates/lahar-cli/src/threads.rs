//! Threads to compute with: their number, and the pool that runs them.

use crate::error::CliError;

/// The number of threads that an option asks for, or that this machine has.
pub(crate) fn count(option: Option<u16>) -> usize {
    option.map_or_else(
        || std::thread::available_parallelism().map_or(1, usize::from),
        usize::from,
    )
}

/// Starts so many threads.
pub(crate) fn pool(count: usize) -> Result<rayon::ThreadPool, CliError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .thread_name(|index| format!("lahar-{index}"))
        .build()
        .map_err(|error| CliError::Machine(format!("cannot start {count} threads: {error}")))
}
