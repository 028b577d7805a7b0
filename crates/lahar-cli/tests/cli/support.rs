//! Helpers that start the program and read its output.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// The default scene, coarse enough for a test.
const COARSE: [&str; 4] = ["dam-break", "--set", "dx=0.05", "--threads=1"];

/// Returns a command that starts the program in a folder and without a display.
pub(crate) fn program(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lahar"));
    command.current_dir(folder);
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command
}

/// Starts the program with these arguments and waits for its end.
pub(crate) fn lahar(folder: &Path, words: &[&str]) -> Output {
    let output = program(folder).args(words).output();
    output.expect("the binary starts")
}

/// Runs the coarse default scene with further arguments.
pub(crate) fn run(folder: &Path, words: &[&str]) -> Output {
    lahar(folder, &[&["run"], &COARSE[..], words].concat())
}

/// Makes a folder that is deleted at the end of the test.
pub(crate) fn here() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Checks the exit code, and shows all output if it is another.
#[track_caller]
pub(crate) fn code(output: &Output, expected: i32) {
    assert_eq!(
        output.status.code(),
        Some(expected),
        "{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Returns standard output as the JSON document that it is.
#[track_caller]
pub(crate) fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("standard output is one JSON document")
}

/// Returns the text on standard error.
pub(crate) fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Returns the names in a folder, sorted.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        let name = entry.expect("an entry").file_name();
        name.to_string_lossy().into_owned()
    };
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

/// Returns the `run.json` of a run's folder.
pub(crate) fn record(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("run.json")).unwrap()).unwrap()
}
