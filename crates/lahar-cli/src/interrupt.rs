//! Ctrl-C and SIGTERM. The first asks the run to write a checkpoint and stop; the second ends the program at once.

use std::sync::Once;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::{CliError, INTERRUPTED};
use crate::terminal;

static SIGNALS: AtomicU32 = AtomicU32::new(0);
static WATCH: Once = Once::new();

/// Counts signals from now on; without this call they end the program.
pub(crate) fn watch() -> Result<(), CliError> {
    let mut result = Ok(());
    WATCH.call_once(|| result = ctrlc::set_handler(count_signal));
    result.map_err(|error| CliError::Machine(format!("cannot watch for Ctrl-C: {error}")))
}

#[expect(
    clippy::exit,
    reason = "a second Ctrl-C asks to leave at once, and files are complete at any moment"
)]
fn count_signal() {
    if SIGNALS.fetch_add(1, Ordering::Relaxed) > 0 {
        std::process::exit(i32::from(INTERRUPTED));
    }
    terminal::note("stopping; press Ctrl-C again to stop at once, without a checkpoint");
}

/// Returns true after the first signal.
pub(crate) fn asked_to_stop() -> bool {
    SIGNALS.load(Ordering::Relaxed) > 0
}
