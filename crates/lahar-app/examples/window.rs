//! Opens the window on a scene given by name or path: `cargo run --release -p lahar-app --example window -- SCENE`.

#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program, not a library"
)]

use std::process::ExitCode;

fn main() -> ExitCode {
    let options = lahar_app::Options {
        scene: std::env::args().nth(1),
        ..lahar_app::Options::default()
    };
    println!("{}", lahar_app::key_help());
    match lahar_app::run(options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
