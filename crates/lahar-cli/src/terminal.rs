//! The only functions that print. A closed pipe, as in `lahar list | head -1`, is not an error.

use std::io::{IsTerminal, Write, stderr, stdout};

use serde_json::Value;

/// Writes to standard output.
pub(crate) fn print(text: &str) {
    let mut out = stdout().lock();
    drop(out.write_all(text.as_bytes()).and_then(|()| out.flush()));
}

/// Writes the one document of `--json` to standard output.
pub(crate) fn print_json(value: &Value) {
    print(&format!("{value:#}\n"));
}

/// Writes a line to standard error.
pub(crate) fn note(text: &str) {
    drop(writeln!(stderr().lock(), "{text}"));
}

/// Returns true if standard error shows colors.
pub(crate) fn shows_colors() -> bool {
    stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Returns true if standard error is a terminal, where a progress bar can be seen.
pub(crate) fn is_watched() -> bool {
    stderr().is_terminal()
}
