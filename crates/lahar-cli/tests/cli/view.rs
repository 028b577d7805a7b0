//! `lahar view` where it cannot open a window: what is wrong is said before anything opens.

use std::path::Path;
use std::process::Command;

/// The exit code and what was said on standard error, without a display.
fn lahar(folder: &Path, words: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_lahar"))
        .current_dir(folder)
        .args(words)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("the binary starts");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), errors)
}

#[test]
fn what_is_wrong_with_a_scene_or_a_comparison_is_exit_code_2() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (words, expected) in [
        (&["view", "dam-brake"][..], "did you mean \"dam-break\"?"),
        (&["view", "dam-break", "--set", "dx=fine"], "dx"),
        (
            &["view", "dam-break", "--compare", "transfer=pic"],
            "nothing to compare",
        ),
        (
            &["view", "dam-break", "--compare", "transfer=pic,magic"],
            "magic",
        ),
        (
            &["view", "dam-break", "--compare", "trasnfer=pic,apic"],
            "did you mean \"transfer\"?",
        ),
        (
            &["view", "dam-break", "--compare", "seed=1,2,3,4,5"],
            "at most 4",
        ),
        (&["view", "."], "not a run's folder"),
    ] {
        let (code, errors) = lahar(folder.path(), words);
        assert_eq!(code, Some(2), "{words:?}: {errors}");
        assert!(errors.contains(expected), "{words:?}: {errors}");
    }
}

#[test]
fn a_run_can_be_replayed_but_not_changed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = |format: &str, to: &str| {
        let words = [
            "run",
            "dam-break",
            "--set",
            "dx=0.05",
            "--frames",
            "2",
            "-o",
            to,
        ];
        lahar(folder.path(), &[&words[..], &["--format", format]].concat())
    };
    assert_eq!(run("npz", "whole").0, Some(0));
    assert_eq!(run("none", "empty").0, Some(0));

    // All is well but that there is no display.
    for words in [
        &["view", "whole"][..],
        &["view", "whole/run.json"],
        &["view", "dam-break"],
    ] {
        let (code, errors) = lahar(folder.path(), words);
        assert_eq!(code, Some(1), "{words:?}: {errors}");
        assert!(errors.contains("no window"), "{errors}");
        assert!(errors.contains("lahar run"), "{errors}");
    }
    for (words, expected) in [
        (&["view", "empty"][..], "--format npz"),
        (&["view", "whole", "--set", "dx=0.1"], "finished run"),
        (
            &["view", "whole", "--compare", "dx=0.1,0.2"],
            "finished run",
        ),
    ] {
        let (code, errors) = lahar(folder.path(), words);
        assert_eq!(code, Some(2), "{words:?}: {errors}");
        assert!(errors.contains(expected), "{words:?}: {errors}");
    }
    let frame = folder.path().join("whole/frames/000000.npz");
    std::fs::write(frame, "cut").expect("written");
    let (code, errors) = lahar(folder.path(), &["view", "whole"]);
    assert_eq!(code, Some(2), "{errors}");
    assert!(errors.contains("000000.npz"), "{errors}");
}
