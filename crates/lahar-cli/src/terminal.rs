//! The only lines that print. A reader that has gone away (`lahar list | head -1`) is no error.

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

/// Whether standard error takes colours.
pub(crate) fn colours() -> bool {
    stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Whether someone is looking at standard error.
pub(crate) fn watched() -> bool {
    stderr().is_terminal()
}
