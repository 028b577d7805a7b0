//! The clock: seconds since the program's start. The engine has no clock of its own and is given this one.

use std::sync::LazyLock;
use std::time::Instant;

static START: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Starts the clock. The program calls this first.
pub(crate) fn start() {
    LazyLock::force(&START);
}

/// Seconds since the program's start.
pub(crate) fn seconds() -> f64 {
    START.elapsed().as_secs_f64()
}
