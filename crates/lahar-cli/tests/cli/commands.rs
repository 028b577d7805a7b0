//! Commands as their users start them: exit codes, the output on each stream, and the files in the folder.

use std::process::Command;

use serde_json::Value;

use crate::support::{code, errors, here, json, lahar, names, program, record, run};

#[test]
fn a_run_writes_what_was_asked_for() {
    let here = here();
    let words = ["--frames=3", "--format=npz,png,gif", "-o", "r"];
    let output = run(here.path(), &words);
    code(&output, 0);
    let folder = here.path().join("r");
    assert_eq!(
        names(&folder),
        [
            "checkpoints",
            "diagnostics.csv",
            "frames",
            "images",
            "run.json",
            "video.gif"
        ]
    );
    assert_eq!(
        names(&folder.join("frames")),
        ["000000.npz", "000001.npz", "000002.npz", "000003.npz"]
    );
    assert_eq!(names(&folder.join("images")).len(), 4);
    let csv = std::fs::read_to_string(folder.join("diagnostics.csv")).unwrap();
    assert_eq!(csv.lines().count(), 5);
    let record: Value = record(&folder);
    assert_eq!(record["status"], "done");
    assert_eq!(record["frames"], 4);
    assert_eq!(record["threads"], 1);
    assert!(record["particle_steps_per_second"].as_f64().unwrap() > 0.0);
    let arrays = lahar_scene::npz::read(folder.join("frames/000003.npz")).unwrap();
    let find = |name: &str| arrays.iter().find(|array| array.name == name).expect(name);
    let n = find("id").shape[0];
    assert_eq!(find("position").shape, [n, 2]);
    assert_eq!(find("affine").shape, [n, 2, 2]);
    assert!(find("id").data.to_f64().is_sorted());
    assert!((find("time").data.to_f64()[0] - 0.05).abs() < 1e-12);
}

#[test]
fn json_is_one_document_and_nothing_else() {
    let here = here();
    let output = run(here.path(), &["--frames=1", "--format=none", "--json"]);
    code(&output, 0);
    let report = json(&output);
    assert_eq!(report["status"], "done");
    assert_eq!(report["frames"], 2);
    assert_eq!(
        names(here.path().join("out/dam-break").as_path()),
        ["checkpoints", "diagnostics.csv", "run.json"]
    );

    let output = lahar(here.path(), &["list", "--json"]);
    code(&output, 0);
    assert_eq!(json(&output)[0]["name"], "dam-break");

    let output = lahar(here.path(), &["show", "dam-break", "--json"]);
    code(&output, 0);
    let shown = json(&output);
    for key in ["particles", "nodes", "memory_bytes", "sound_speed", "dt"] {
        assert!(shown[key].as_f64().unwrap() > 0.0, "{key}: {shown}");
    }
    assert!(shown["dt_limit"].is_string());

    let output = run(here.path(), &["--set", "gravty=1", "--json"]);
    code(&output, 2);
    assert_eq!(json(&output)["status"], "failed");
}

#[test]
fn folders_in_use_are_numbered_refused_or_replaced() {
    let here = here();
    for _ in 0..2 {
        code(&run(here.path(), &["--frames=1", "--format=none"]), 0);
    }
    assert_eq!(
        names(&here.path().join("out")),
        ["dam-break", "dam-break-2"]
    );

    let again = ["--frames=1", "--format=none", "-o", "out/dam-break"];
    let output = run(here.path(), &again);
    code(&output, 2);
    assert!(errors(&output).contains("resume") && errors(&output).contains("--overwrite"));
    let replaced: Vec<&str> = again.iter().chain(&["--overwrite"]).copied().collect();
    code(&run(here.path(), &replaced), 0);
}

#[test]
fn wrong_commands_and_scenes_are_code_2() {
    let here = here();
    std::fs::write(
        here.path().join("broken.toml"),
        "dimension = 2\ndx = \"wide\"\n",
    )
    .unwrap();
    for words in [
        &["run", "no-such-scene"][..],
        &["run", "broken.toml"],
        &["run", "dam-break", "--format=exr"],
        &["run", "dam-break", "--frames=1", "--until=1"],
        &["run", "dam-break", "--isa=sse9"],
        &["run", "dam-break", "--set", "dx"],
        &["run", "dam-break", "--threads=0"],
        &["nonsense"],
    ] {
        let output = lahar(here.path(), words);
        code(&output, 2);
        assert!(output.stdout.is_empty(), "{words:?}");
        assert!(!output.stderr.is_empty(), "{words:?}");
    }
    assert_eq!(names(here.path()), ["broken.toml"], "nothing was written");
    let shown = errors(&lahar(here.path(), &["run", "broken.toml"]));
    assert!(shown.contains("broken.toml:2:6"), "{shown}");
}

#[test]
fn a_folder_that_cannot_be_made_is_code_1_and_named() {
    let here = here();
    std::fs::write(here.path().join("file"), "").unwrap();
    let output = run(here.path(), &["--frames=1", "-o", "file/below"]);
    code(&output, 1);
    assert!(
        errors(&output).contains("file/below"),
        "{}",
        errors(&output)
    );
}

#[test]
fn a_dry_run_writes_nothing() {
    let here = here();
    let output = run(here.path(), &["--dry-run", "--until=0.1", "--json"]);
    code(&output, 0);
    assert_eq!(json(&output)["frames"], 6);
    assert!(names(here.path()).is_empty());
}

#[test]
fn a_new_scene_runs_and_is_never_overwritten() {
    let here = here();
    code(&lahar(here.path(), &["new", "my.toml"]), 0);
    let words = [
        "run",
        "my.toml",
        "--frames=1",
        "--format=none",
        "--set",
        "dx=0.1",
    ];
    code(&lahar(here.path(), &words), 0);
    std::fs::write(here.path().join("my.toml"), "mine").unwrap();
    let again = lahar(here.path(), &["new", "my.toml"]);
    code(&again, 2);
    assert!(errors(&again).contains("left as it is"));
    assert_eq!(std::fs::read(here.path().join("my.toml")).unwrap(), b"mine");
    code(&lahar(here.path(), &["new", "no/such/my.toml"]), 2);
    code(&lahar(here.path(), &["new"]), 2);
    code(&lahar(here.path(), &["new", "."]), 2);
}

/// A built-in scene becomes a file, with the files that it names, and is the same scene.
#[test]
fn a_built_in_scene_is_printed_and_copied() {
    let here = here();
    let printed = lahar(here.path(), &["show", "dam-break", "--toml"]);
    code(&printed, 0);
    code(
        &lahar(here.path(), &["new", "my.toml", "--from", "dam-break"]),
        0,
    );
    let path = here.path().join("my.toml");
    assert_eq!(std::fs::read(&path).unwrap(), printed.stdout);
    let copied = lahar(here.path(), &["show", "my.toml", "--toml"]);
    assert_eq!(copied.stdout, printed.stdout);

    let words = ["new", "knot.toml", "--from", "knot-3d"];
    code(&lahar(here.path(), &words), 0);
    assert!(here.path().join("knot-3d.obj").is_file());
    let words = ["show", "knot.toml", "--json"];
    let own = json(&lahar(here.path(), &words));
    let built_in = json(&lahar(here.path(), &["show", "knot-3d", "--json"]));
    assert_eq!(own["particles"], built_in["particles"]);

    // Neither the scene's file nor one that it names is overwritten.
    std::fs::write(here.path().join("knot-3d.obj"), "mine").unwrap();
    let again = lahar(here.path(), &["new", "again.toml", "--from", "knot-3d"]);
    code(&again, 2);
    assert!(errors(&again).contains("knot-3d.obj already exists"));
    assert!(!here.path().join("again.toml").exists());
    code(
        &lahar(here.path(), &["new", "x.toml", "--from", "nothing"]),
        2,
    );
}

/// Any broken file gives one clear error, exit code 2 and no panic.
#[test]
fn broken_scenes_are_code_2() {
    let here = here();
    let file = |name: &str, bytes: &[u8]| {
        std::fs::write(here.path().join(name), bytes).unwrap();
        name.to_owned()
    };
    let good = String::from_utf8(lahar_scene::builtin::starter().as_bytes().to_vec()).unwrap();
    let with = |name: &str, from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        file(name, good.replacen(from, to, 1).as_bytes())
    };
    let mut scenes = vec![
        file("empty.toml", b""),
        file("junk.toml", &[0x80, 0xff, 0, 7, 7]),
        file("half.toml", &good.as_bytes()[..good.len() * 2 / 3]),
        with("key.toml", "duration", "durration"),
        with("dx.toml", "dx = 0.02", "dx = -0.02"),
        with("many.toml", "dx = 0.02", "dx = 2e-7"),
        with(
            "formula.toml",
            "velocity = [-1.0, 0.0]",
            "velocity = [\"1 +\", 0.0]",
        ),
        with("outside.toml", "center = [1.5, 0.5]", "center = [9.5, 0.5]"),
        with(
            "list.toml",
            "shape = { ball = { center = [1.5, 0.5], radius = 0.2 } }",
            "particles = \"none.ply\"",
        ),
        ".".to_owned(),
        "no-such-scene".to_owned(),
        String::new(),
    ];
    if cfg!(unix) {
        scenes.push("/dev/zero".to_owned());
        scenes.push("/dev/null".to_owned());
    }
    for scene in &scenes {
        for words in [
            &["show", scene][..],
            &["show", "--json", scene],
            &["run", "--dry-run", scene],
            &["run", "-o", "never", scene],
        ] {
            let output = lahar(here.path(), words);
            code(&output, 2);
            let errors = errors(&output);
            assert!(errors.starts_with("error: "), "{scene}: {errors}");
            assert_eq!(errors.matches("error: ").count(), 1, "{scene}: {errors}");
            assert!(!errors.contains("panicked"), "{scene}: {errors}");
            if words.contains(&"--json") {
                assert!(json(&output)["error"].is_string());
            }
        }
    }
    assert!(!here.path().join("never").exists());
}

#[test]
fn the_same_run_gives_the_same_files() {
    let here = here();
    for (folder, threads) in [("a", "--threads=1"), ("b", "--threads=3")] {
        let words = [
            "run",
            "dam-break",
            "--set",
            "dx=0.05",
            threads,
            "--frames=4",
            "--format=npz",
            "-o",
            folder,
        ];
        code(&lahar(here.path(), &words), 0);
    }
    for file in ["diagnostics.csv", "frames/000000.npz", "frames/000004.npz"] {
        let [a, b] =
            ["a", "b"].map(|folder| std::fs::read(here.path().join(folder).join(file)).unwrap());
        assert!(a == b, "{file} depends on the number of threads");
    }
}

#[test]
fn lists_help_and_completions() {
    let here = here();
    let output = lahar(here.path(), &["list"]);
    code(&output, 0);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("dam-break "), "{text}");
    for line in text.lines() {
        let name = line.split_whitespace().next().unwrap();
        code(&lahar(here.path(), &["show", name]), 0);
    }
    code(&lahar(here.path(), &["--help"]), 0);
    code(&lahar(here.path(), &["--version"]), 0);
    let output = lahar(here.path(), &["completions", "bash"]);
    code(&output, 0);
    assert!(String::from_utf8_lossy(&output.stdout).contains("_lahar"));
    let output = lahar(here.path(), &["schema"]);
    code(&output, 0);
    assert!(json(&output).is_object());
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_after_the_frame_with_130_and_whole_files() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;

    let here = here();
    let mut child = program(here.path())
        .args([
            "run",
            "dam-break",
            "--threads=1",
            "--format=npz",
            "--frames=100000",
            "--json",
            "-o",
            "r",
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The first line says that the run has begun.
    let mut line = String::new();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    stderr.read_line(&mut line).unwrap();
    while !here.path().join("r/frames/000001.npz").exists() {
        assert!(child.try_wait().unwrap().is_none(), "{line}");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    code(&output, 130);
    assert_eq!(json(&output)["status"], "interrupted");
    let folder = here.path().join("r");
    let rows = std::fs::read_to_string(folder.join("diagnostics.csv"))
        .unwrap()
        .lines()
        .count()
        - 1;
    let frames = names(&folder.join("frames"));
    assert_eq!(frames.len(), rows);
    for frame in frames {
        lahar_scene::npz::read(folder.join("frames").join(frame)).unwrap();
    }
}

#[test]
fn probes_are_written_and_plotted_and_change_nothing() {
    let here = here();
    let probes = r#"probes=[{name="P1",rate=500.0,pressure={at=[0.0,0.0]}},{name="front",front={depth=0.05}}]"#;
    code(
        &run(
            here.path(),
            &["--frames=3", "-o", "with", "--format=none", "--set", probes],
        ),
        0,
    );
    code(
        &run(
            here.path(),
            &["--frames=3", "-o", "without", "--format=none"],
        ),
        0,
    );
    let text = |name: &str| std::fs::read_to_string(here.path().join(name)).expect(name);
    assert_eq!(
        text("with/diagnostics.csv"),
        text("without/diagnostics.csv")
    );
    let pressure = text("with/probes/P1.csv");
    // 3 frames of 1/60 s at 500 readings per second, and the reading at the start.
    assert_eq!(pressure.lines().count(), 1 + 1 + 25, "{pressure}");
    assert!(pressure.starts_with("time,pressure\n0.0,"));
    assert_eq!(text("with/probes/front.csv").lines().count(), 1 + 4);
    assert!(!here.path().join("without/probes").exists());
    code(&lahar(here.path(), &["plot", "with"]), 0);
    assert!(text("with/plots/probe-P1.svg").contains("pressure [Pa]"));
}

/// A coarse scene of jelly with twice the longest stable time step.
const TOO_LONG: [&str; 8] = [
    "run",
    "jelly-drop",
    "--set=dx=0.05",
    "--set=dt=6.0e-3",
    "--set=duration=1.0",
    "--threads=1",
    "--format=npz",
    "-oout",
];

#[test]
fn a_frame_that_fails_is_retried_with_a_shorter_step_and_recorded() {
    let here = here();
    let words = [TOO_LONG.as_slice(), &["--set=frame_rate=2.0"]].concat();
    let output = lahar(here.path(), &words);
    code(&output, 0);
    let message = errors(&output);
    for words in [
        "with 1/2 of the time step",
        "limited by fixed",
        "the scene fixes dt",
    ] {
        assert!(message.contains(words), "{message}");
    }
    let record = record(&here.path().join("out"));
    let retries = record["retries"].as_array().expect("a list");
    assert!(!retries.is_empty());
    assert!(
        retries
            .iter()
            .all(|retry| message.contains(retry.as_str().expect("text")))
    );
    assert_eq!(
        (&record["status"], &record["frames"]),
        (&"done".into(), &3.into())
    );
    let diagnostics =
        std::fs::read_to_string(here.path().join("out/diagnostics.csv")).expect("written");
    let second = diagnostics.lines().nth(2).expect("a frame");
    assert!(second.contains(",retry,"), "{second}");
}

#[test]
fn a_run_that_fails_for_good_keeps_the_frames_before() {
    let here = here();
    let words = [TOO_LONG.as_slice(), &["--set=frame_rate=60.0"]].concat();
    let output = lahar(here.path(), &words);
    code(&output, 1);
    let message = errors(&output);
    for words in [
        "material \"",
        "substep",
        "down to 1/64 of the time step",
        "limited by retry",
    ] {
        assert!(message.contains(words), "{message}");
    }
    let record = record(&here.path().join("out"));
    assert_eq!(record["status"], "failed");
    assert!(
        record["retries"]
            .as_array()
            .is_some_and(|retries| retries.len() >= 6)
    );
    let frames = record["frames"].as_u64().expect("a number");
    assert!(frames >= 1);
    for frame in 0..frames {
        assert!(
            here.path()
                .join(format!("out/frames/{frame:06}.npz"))
                .is_file()
        );
    }
    assert!(
        !here
            .path()
            .join(format!("out/frames/{frames:06}.npz"))
            .exists()
    );
}

#[test]
fn phases_and_startup_add_up_to_the_time() {
    let here = here();
    let output = run(
        here.path(),
        &["--frames=4", "--format=npz", "-o", "r", "--json"],
    );
    code(&output, 0);
    let record = json(&output);
    let number = |key: &str| record[key].as_f64().unwrap();
    let phases = record["phase_seconds"].as_object().unwrap();
    let all: f64 = phases
        .values()
        .map(|seconds| seconds.as_f64().unwrap())
        .sum();
    let whole = number("seconds");
    assert!(number("startup_seconds") > 0.0);
    assert!(
        (number("startup_seconds") + all - whole).abs() < 0.02 * whole + 0.01,
        "{record}"
    );
    // The rate leaves out the time of output.
    let solving = all - phases["output"].as_f64().unwrap();
    let rate = number("particle_steps") / solving;
    assert!((number("particle_steps_per_second") / rate - 1.0).abs() < 1e-9);
    assert!(phases["volume"].as_f64().unwrap() > 0.0);
}
