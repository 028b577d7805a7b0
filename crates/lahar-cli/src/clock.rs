//! Seconds since the first look at the clock. The engine has no clock of its own; it is given this one.

use std::sync::LazyLock;
use std::time::Instant;

static START: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Seconds since the first call.
pub(crate) fn seconds() -> f64 {
    START.elapsed().as_secs_f64()
}
