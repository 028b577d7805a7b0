//! `lahar view` without a display: errors are found before a window opens.

use crate::support::{code, errors, here, lahar};

#[test]
fn a_wrong_scene_or_comparison_is_exit_code_2() {
    let here = here();
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
        let output = lahar(here.path(), words);
        code(&output, 2);
        let errors = errors(&output);
        assert!(errors.contains(expected), "{words:?}: {errors}");
    }
}

#[test]
fn a_run_can_be_replayed_but_not_changed() {
    let here = here();
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
        lahar(here.path(), &[&words[..], &["--format", format]].concat())
    };
    code(&run("npz", "whole"), 0);
    code(&run("none", "empty"), 0);

    // Only the display is missing here.
    for words in [
        &["view", "whole"][..],
        &["view", "whole/run.json"],
        &["view", "dam-break"],
    ] {
        let output = lahar(here.path(), words);
        code(&output, 1);
        let errors = errors(&output);
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
        let output = lahar(here.path(), words);
        code(&output, 2);
        let errors = errors(&output);
        assert!(errors.contains(expected), "{words:?}: {errors}");
    }
    let frame = here.path().join("whole/frames/000000.npz");
    std::fs::write(frame, "cut").expect("written");
    let output = lahar(here.path(), &["view", "whole"]);
    code(&output, 2);
    let errors = errors(&output);
    assert!(errors.contains("000000.npz"), "{errors}");
}
