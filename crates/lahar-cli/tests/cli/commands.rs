//! The binary as its users meet it: exit codes, what is on which stream, what is in the folder.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// The default scene, coarse enough for a test.
const COARSE: [&str; 4] = ["dam-break", "--set", "dx=0.05", "--threads=1"];

/// The program, in a folder and without a display.
fn program(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lahar"));
    command.current_dir(folder);
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command
}

fn lahar(folder: &Path, words: &[&str]) -> Output {
    (program(folder).args(words).output()).expect("the binary starts")
}

fn run(folder: &Path, words: &[&str]) -> Output {
    let words: Vec<&str> = ["run"]
        .iter()
        .chain(&COARSE)
        .chain(words)
        .copied()
        .collect();
    lahar(folder, &words)
}

fn here() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[track_caller]
fn code(output: &Output, expected: i32) {
    assert_eq!(
        output.status.code(),
        Some(expected),
        "{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[track_caller]
fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("standard output is one JSON document")
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_leaves_what_was_asked_for() {
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
    let arrays = lahar_io::npz::read(folder.join("frames/000003.npz")).unwrap();
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
fn taken_folders_are_numbered_refused_or_replaced() {
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
    assert_eq!(names(here.path()), ["broken.toml"], "nothing was made");
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

/// One clear error, exit code 2 and no panic, whatever the file is.
#[test]
fn broken_scenes_are_code_2() {
    let here = here();
    let file = |name: &str, bytes: &[u8]| {
        std::fs::write(here.path().join(name), bytes).unwrap();
        name.to_owned()
    };
    let good = String::from_utf8(lahar_io::builtin::starter().as_bytes().to_vec()).unwrap();
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
fn values_are_compared_side_by_side_and_plotted() {
    let here = here();
    let words = [
        "run",
        "spinning-jelly",
        "--frames=3",
        "--compare=transfer=pic,apic",
    ];
    code(&lahar(here.path(), &words), 0);
    let whole = here.path().join("out/spinning-jelly-compared");
    let own = names(&whole);
    for name in ["apic", "pic", "images", "plots", "video.gif"] {
        assert!(own.iter().any(|n| n == name), "{name} is not in {own:?}");
    }
    let record = |run: &str| {
        let text = std::fs::read_to_string(whole.join(run).join("run.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()
    };
    assert_eq!(record("pic")["scene"]["transfer"], "pic");
    assert_eq!(record("apic")["scene"]["transfer"], "apic");
    let picture = |path: &str| lahar_io::image::Picture::load_png(whole.join(path)).unwrap();
    let (one, both) = (
        picture("pic/images/000003.png"),
        picture("images/000003.png"),
    );
    assert!(both.width > 2 * one.width && both.height > one.height);
    let plot = std::fs::read_to_string(whole.join("plots/angular-momentum.svg")).unwrap();
    assert!(plot.contains("transfer = pic") && plot.contains("transfer = apic"));

    // Wrong before anything is run.
    let wrong = ["run", "spinning-jelly", "--compare=transfer=pic,apix"];
    let output = lahar(here.path(), &wrong);
    code(&output, 2);
    assert!(errors(&output).contains("apix"), "{}", errors(&output));
    assert_eq!(names(&here.path().join("out")).len(), 1);
}

#[test]
fn plots_of_one_run_and_of_several() {
    let here = here();
    for transfer in ["pic", "apic"] {
        let set = format!("--set=transfer={transfer}");
        let words = ["run", "spinning-jelly", "--frames=2", "--format=none", &set];
        code(
            &lahar(here.path(), &[&words[..], &["-o", transfer]].concat()),
            0,
        );
    }
    code(&lahar(here.path(), &["plot", "pic"]), 0);
    assert!(here.path().join("pic/plots/energy.svg").is_file());
    code(
        &lahar(here.path(), &["plot", "pic", "apic", "-o", "both"]),
        0,
    );
    let plot = std::fs::read_to_string(here.path().join("both/energy.svg")).unwrap();
    assert!(plot.contains(">\npic") || plot.contains("pic\n"), "{plot}");
    code(&lahar(here.path(), &["plot", "pic", "apic"]), 2);
    let output = lahar(here.path(), &["plot", "nowhere"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("diagnostics.csv"),
        "{}",
        errors(&output)
    );
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
    let mut child = Command::new(env!("CARGO_BIN_EXE_lahar"))
        .current_dir(here.path())
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
    // The first line says that it has begun.
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
        lahar_io::npz::read(folder.join("frames").join(frame)).unwrap();
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
    // 3 frames of 1/60 s at 500 readings a second, and the one at the start.
    assert_eq!(pressure.lines().count(), 1 + 1 + 25, "{pressure}");
    assert!(pressure.starts_with("time,pressure\n0.0,"));
    assert_eq!(text("with/probes/front.csv").lines().count(), 1 + 4);
    assert!(!here.path().join("without/probes").exists());
    code(&lahar(here.path(), &["plot", "with"]), 0);
    assert!(text("with/plots/probe-P1.svg").contains("pressure [Pa]"));
}

#[test]
fn validate_prints_a_table_or_json_and_leaves_a_report() {
    let here = here();
    let output = lahar(
        here.path(),
        &["validate", "k1", "E1", "--quick", "--json", "-o", "v"],
    );
    code(&output, 0);
    let findings = json(&output);
    let periods: Vec<&Value> = (findings.as_array().expect("a list").iter())
        .filter(|finding| finding["case"] == "E1")
        .collect();
    assert_eq!(periods.len(), 1, "{findings}");
    assert_eq!(periods[0]["reference"], 10.0);
    assert_eq!(periods[0]["pass"], true);
    let report = std::fs::read_to_string(here.path().join("v/validation.md")).expect("a report");
    assert!(report.contains("## E1: ") && report.contains("images/validation/e1-speed.svg"));
    assert!(
        here.path()
            .join("v/images/validation/e1-speed.svg")
            .exists()
    );
    // A bar that is far too soft misses: exit code 1.
    let soft = [
        "validate",
        "E1",
        "--quick",
        "--set",
        "materials.bar.youngs_modulus=50.0",
    ];
    let output = lahar(here.path(), &soft);
    code(&output, 1);
    assert!(String::from_utf8_lossy(&output.stdout).contains("MISS"));
    let output = lahar(here.path(), &["validate", "Z1"]);
    code(&output, 2);
    assert!(errors(&output).contains("there is no case \"Z1\""));
}

fn record(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("run.json")).unwrap()).unwrap()
}

/// Jelly with a step that is twice as long as it stands, coarse.
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
fn a_frame_that_fails_is_tried_again_with_a_shorter_step_and_recorded() {
    let here = here();
    let words = [TOO_LONG.as_slice(), &["--set=frame_rate=2.0"]].concat();
    let output = lahar(here.path(), &words);
    code(&output, 0);
    let said = errors(&output);
    for words in [
        "with 1/2 of the time step",
        "limited by fixed",
        "the scene fixes dt",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let record = record(&here.path().join("out"));
    let retries = record["retries"].as_array().expect("a list");
    assert!(!retries.is_empty());
    assert!(
        retries
            .iter()
            .all(|retry| said.contains(retry.as_str().expect("text")))
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
fn a_run_that_cannot_be_helped_keeps_the_frames_before() {
    let here = here();
    let words = [TOO_LONG.as_slice(), &["--set=frame_rate=60.0"]].concat();
    let output = lahar(here.path(), &words);
    code(&output, 1);
    let said = errors(&output);
    for words in [
        "material \"",
        "substep",
        "down to 1/64 of the time step",
        "limited by retry",
    ] {
        assert!(said.contains(words), "{said}");
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
fn phases_and_start_up_make_up_the_time() {
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
    // The rate is over all phases but output.
    let solving = all - phases["output"].as_f64().unwrap();
    let rate = number("particle_steps") / solving;
    assert!((number("particle_steps_per_second") / rate - 1.0).abs() < 1e-9);
    assert!(phases["volume"].as_f64().unwrap() > 0.0);
}

#[test]
fn bench_measures_compares_and_draws() {
    let here = here();
    let small = [
        "bench",
        "--case=dam-2d,jelly-3d",
        "--particles=3000",
        "--threads=1,2",
        "--runs=2",
    ];
    let words: Vec<&str> = small.iter().chain(&["--json"]).copied().collect();
    let output = lahar(here.path(), &words);
    code(&output, 0);
    let report = json(&output);
    let results = report["results"].as_array().unwrap();
    let cases: Vec<&str> = results
        .iter()
        .map(|m| m["case"].as_str().unwrap())
        .collect();
    assert_eq!(cases, ["dam-2d", "dam-2d", "jelly-3d", "jelly-3d"]);
    for measured in results {
        let number = |key: &str| measured[key].as_f64().unwrap();
        assert!(
            0.0 < number("min") && number("min") <= number("median"),
            "{measured}"
        );
        assert!(
            number("median") <= number("max") && number("sorts") >= 2.0,
            "{measured}"
        );
        assert!(
            (number("particles") / 3000.0 - 1.0).abs() < 0.1,
            "{measured}"
        );
    }
    std::fs::write(here.path().join("before.json"), &output.stdout).unwrap();
    let words: Vec<&str> = small
        .iter()
        .chain(&["--compare=before.json"])
        .copied()
        .collect();
    let output = lahar(here.path(), &words);
    code(&output, 0);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("to baseline"), "{text}");
    assert_eq!(
        text.lines().filter(|line| line.contains("dam-2d")).count(),
        2,
        "{text}"
    );

    let words = [
        "bench",
        "--case=dam-2d",
        "--growth=1000,4000",
        "--threads=1,2",
        "--runs=1",
        "-o",
        "plots",
    ];
    code(&lahar(here.path(), &words), 0);
    assert!(
        names(&here.path().join("plots"))
            .iter()
            .any(|name| name == "threads.svg")
    );
}

#[test]
fn bench_says_what_is_wrong() {
    let here = here();
    let output = lahar(here.path(), &["bench", "--case=dam"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("no case \"dam\"; there are dam-3d,"),
        "{}",
        errors(&output)
    );
    std::fs::write(here.path().join("no.json"), "{}").unwrap();
    let output = lahar(here.path(), &["bench", "--compare=no.json"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("no.json: it is not what"),
        "{}",
        errors(&output)
    );
}

#[test]
fn a_finished_run_is_drawn_and_told_of() {
    let here = here();
    code(
        &run(here.path(), &["--frames=3", "--format=npz", "-o", "r"]),
        0,
    );
    let words = ["render", "r", "--frames=1..3:2", "--video", "--size=64x48"];
    let output = lahar(here.path(), &words);
    code(&output, 0);
    assert!(errors(&output).contains("video: GIF by lahar"));
    let drawn = names(&here.path().join("r/render"));
    assert_eq!(drawn[..3], ["000001.png", "000003.png", "video.gif"]);

    assert!(errors(&output).contains("pictures by"));

    code(&lahar(here.path(), &["report", "r"]), 0);
    let page = std::fs::read_to_string(here.path().join("r/report.html")).unwrap();
    for part in [
        "<h1>Dam break</h1>",
        "data:image/png;base64,",
        "data:image/gif;base64,",
        "<svg",
        "particle-steps/s",
        "Retries",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // Nothing is fetched: the only addresses are names of XML's dialects.
    assert!(!page.contains("href=") && !page.contains("src=\"http"));

    for (words, what) in [
        (&["render", "r", "--frames=7"][..], "0 to 3"),
        (&["render", "r", "--color-by=smell"], "color_by"),
        (&["render", "nowhere"], "not a run's folder"),
        (&["report", "nowhere"], "not a run's folder"),
    ] {
        let output = lahar(here.path(), words);
        code(&output, 2);
        assert!(errors(&output).contains(what), "{}", errors(&output));
    }
    code(
        &run(here.path(), &["--frames=1", "--format=none", "-o", "bare"]),
        0,
    );
    let output = lahar(here.path(), &["render", "bare"]);
    code(&output, 2);
    assert!(errors(&output).contains("--format npz"));
    // There is still something to tell.
    code(&lahar(here.path(), &["report", "bare"]), 0);
}

/// A run is drawn by the window's renderer where there is an adapter, and by the processor where there is none: the same
/// water in the same place, on pictures of one size.
#[test]
fn the_window_s_renderer_and_the_processor_draw_the_same_water() {
    /// A backend that this system has not got.
    const NONE: &str = if cfg!(target_os = "macos") {
        "dx12"
    } else {
        "metal"
    };
    let here = here();
    // In 3D each has its own idea of how much air is around a scene.
    let camera = [
        "--camera=1,0.5,2",
        "--set=camera.center=[0.8,0.5,0.3]",
        "--set=camera.height=2",
        "--set=camera.field_of_view=40",
    ];
    for (name, scene, camera) in [
        ("flat", "dam-break", &[][..]),
        ("solid", "dam-break-3d", &camera),
    ] {
        let coarse = [
            "run",
            scene,
            "--set",
            "dx=0.1",
            "--frames=1",
            "--format=npz",
        ];
        code(
            &lahar(here.path(), &[&coarse[..], &["-o", name]].concat()),
            0,
        );
        let draw = |renderer: &str, words: &[&str], backend: Option<&str>| {
            let mut command = program(here.path());
            command.args(["render", name, "--frames=1", "--size=96x64", "-o", renderer]);
            command
                .args(["--renderer", renderer])
                .args(camera)
                .args(words);
            command.envs(backend.map(|backend| ("WGPU_BACKEND", backend)));
            let output = command.output().unwrap();
            let path = here.path().join(renderer).join("000001.png");
            (output, lahar_io::image::Picture::load_png(path))
        };

        let (output, picture) = draw("cpu", &[], None);
        code(&output, 0);
        assert!(errors(&output).contains("pictures by the processor\n"));
        let by_processor = picture.unwrap();

        let (output, _) = draw("gpu", &[], Some(NONE));
        code(&output, 1);
        assert!(
            errors(&output).contains("--renderer gpu: "),
            "{}",
            errors(&output)
        );
        let (output, picture) = draw("auto", &[], Some(NONE));
        code(&output, 0);
        assert!(errors(&output).contains("pictures by the processor: "));
        assert_eq!(picture.unwrap(), by_processor);

        let (output, picture) = draw("auto", &[], None);
        code(&output, 0);
        if !errors(&output).contains("pictures by the window's renderer on ") {
            continue;
        }
        let by_window = picture.unwrap();
        let size = |picture: &lahar_io::image::Picture| (picture.width, picture.height);
        assert_eq!(size(&by_window), size(&by_processor));
        let water = |picture: &lahar_io::image::Picture| {
            let (mut count, mut sums) = (0.0, [0.0; 2]);
            for (at, pixel) in picture.rgb.as_chunks::<3>().0.iter().enumerate() {
                // Bluer than the background and the lines.
                if pixel[2].saturating_sub(pixel[0]) > 0x40 {
                    let (row, column) = (at / picture.width as usize, at % picture.width as usize);
                    count += 1.0;
                    sums[0] += column as f64;
                    sums[1] += row as f64;
                }
            }
            (count, sums.map(|sum| sum / count))
        };
        let ((area, [x, y]), (window_area, [window_x, window_y])) =
            (water(&by_processor), water(&by_window));
        let ratio = window_area / area;
        assert!(
            (0.85..1.2).contains(&ratio),
            "{scene}: {window_area} {area}"
        );
        assert!(
            (x - window_x).abs() < 1.5 && (y - window_y).abs() < 1.5,
            "{scene}"
        );

        // Colours by body and by number, none of them the material's.
        for by in ["body", "speed"] {
            let (output, picture) = draw("auto", &["--color-by", by], None);
            code(&output, 0);
            assert_ne!(picture.unwrap(), by_window, "{by}");
        }
    }
}

#[cfg(feature = "mesh")]
#[test]
fn surfaces_are_a_folder_a_material() {
    let here = here();
    let words = ["run", "dam-break-3d", "--set", "dx=0.1", "--threads=1"];
    let more = ["--frames=1", "--format=npz", "-o", "r"];
    code(&lahar(here.path(), &[&words[..], &more].concat()), 0);
    let words = ["mesh", "r", "--format=ply,obj,vtk"];
    code(&lahar(here.path(), &words), 0);
    let meshes = here.path().join("r/meshes");
    assert_eq!(names(&meshes), ["water", "water.pvd"]);
    assert_eq!(
        names(&meshes.join("water")),
        [
            "000000.obj",
            "000000.ply",
            "000000.vtp",
            "000001.obj",
            "000001.ply",
            "000001.vtp"
        ]
    );
    code(
        &run(here.path(), &["--frames=0", "--format=npz", "-o", "flat"]),
        0,
    );
    for (words, what) in [
        (&["mesh", "flat"][..], "2D"),
        (&["mesh", "r", "--materials=wine"], "there are water"),
        (&["mesh", "r", "--format=stl"], "ply, obj, vtk"),
        (&["mesh", "r", "--cube=0"], "above 0"),
    ] {
        let output = lahar(here.path(), words);
        code(&output, 2);
        assert!(errors(&output).contains(what), "{}", errors(&output));
    }
}
