//! Seconds since the program's start. The engine has no clock of its own; it is given this one.

use std::sync::LazyLock;
use std::time::Instant;

static START: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Sets the clock going: the first thing that the program does.
pub(crate) fn start() {
    LazyLock::force(&START);
}

/// Seconds since the program's start.
pub(crate) fn seconds() -> f64 {
    START.elapsed().as_secs_f64()
}
