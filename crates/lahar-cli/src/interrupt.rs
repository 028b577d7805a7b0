//! Ctrl-C and SIGTERM: the first asks the run to keep a checkpoint and stop, the second stops at once.

use std::sync::Once;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::{CliError, INTERRUPTED};
use crate::terminal;

static ASKED: AtomicU32 = AtomicU32::new(0);
static WATCH: Once = Once::new();

/// From now on signals are counted instead of ending the program.
pub(crate) fn watch() -> Result<(), CliError> {
    let mut result = Ok(());
    WATCH.call_once(|| result = ctrlc::set_handler(asked));
    result.map_err(|error| CliError::Machine(format!("cannot watch for Ctrl-C: {error}")))
}

#[expect(
    clippy::exit,
    reason = "who presses Ctrl-C twice wants to leave now; files are whole at any moment"
)]
fn asked() {
    if ASKED.fetch_add(1, Ordering::Relaxed) > 0 {
        std::process::exit(i32::from(INTERRUPTED));
    }
    terminal::note("stopping; once more to stop at once, without a checkpoint");
}

/// Whether to stop.
pub(crate) fn asked_to_stop() -> bool {
    ASKED.load(Ordering::Relaxed) > 0
}
