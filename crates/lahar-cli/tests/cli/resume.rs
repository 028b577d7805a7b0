//! Runs that are interrupted and resumed: their files equal those of an unbroken run to the byte.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

use crate::support::{code, errors, here, lahar, program};

/// Water and jelly, probes, a force that depends on starting positions, and a list of particles beside the scene.
const SCENE: &str = r#"
duration = 0.2
frame_rate = 60
dx = 0.025
gravity = [0.0, -9.81]
[domain]
min = [0.0, 0.0]
max = [1.0, 0.6]
[materials.water]
preset = "water"
sound_speed = 25.0
[materials.jelly]
preset = "jelly"
[[bodies]]
name = "column"
material = "water"
shape = { box = { min = [0.0, 0.0], max = [0.3, 0.4] } }
[[bodies]]
name = "list"
material = "jelly"
particles = "jelly.csv"
velocity = [-1.0, 0.0]
[[forces]]
acceleration = ["4*(X - x)", "0"]
[[probes]]
name = "wall"
pressure = { at = [1.0, 0.05] }
rate = 300
[[probes]]
name = "floor"
force = { on = "bottom" }
[output]
formats = ["npz", "vtk", "png", "gif"]
picture_size = [96, 64]
checkpoint_every = 3
"#;

/// Makes a folder with the scene and its list of particles.
pub(crate) fn with_scene() -> TempDir {
    let here = here();
    fs::write(here.path().join("scene.toml"), SCENE).unwrap();
    let places = (0..100).map(|i| {
        (
            0.6 + 0.01 * f64::from(i % 10),
            0.1 + 0.01 * f64::from(i / 10),
        )
    });
    let rows: String = places.map(|(x, y)| format!("{x},{y},1e-4\n")).collect();
    fs::write(here.path().join("jelly.csv"), format!("x,y,volume\n{rows}")).unwrap();
    here
}

/// Returns the files of a run by their paths: all but checkpoints/, and run.json without the entries that depend on the
/// clock.
pub(crate) fn files(run: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    fn walk(root: &Path, folder: &Path, into: &mut BTreeMap<PathBuf, Vec<u8>>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                walk(root, &path, into);
            } else {
                let bytes = fs::read(&path).expect("a file");
                into.insert(path.strip_prefix(root).expect("below it").into(), bytes);
            }
        }
    }
    let mut all = BTreeMap::new();
    walk(run, run, &mut all);
    all.retain(|path, _| !path.starts_with("checkpoints"));
    let record = all
        .remove(Path::new("run.json"))
        .expect("run.json is there");
    let mut record: Value = serde_json::from_slice(&record).expect("run.json is valid");
    for clock in [
        "seconds",
        "startup_seconds",
        "phase_seconds",
        "particle_steps_per_second",
        "threads",
    ] {
        record.as_object_mut().expect("a table").remove(clock);
    }
    all.insert("run.json".into(), record.to_string().into_bytes());
    all
}

#[track_caller]
fn assert_same(one: &Path, other: &Path) {
    let (one, other) = (files(one), files(other));
    assert_eq!(
        one.keys().collect::<Vec<_>>(),
        other.keys().collect::<Vec<_>>()
    );
    for (path, bytes) in &one {
        assert!(*bytes == other[path], "{} differs", path.display());
    }
}

pub(crate) fn checkpoints(run: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(run.join("checkpoints")).into_iter().flatten();
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut found: Vec<_> = paths
        .filter(|path| {
            path.extension()
                .is_some_and(|ending| ending == "checkpoint")
        })
        .collect();
    found.sort();
    found
}

/// Makes the unbroken run.
fn whole(here: &Path) -> PathBuf {
    code(
        &lahar(here, &["run", "scene.toml", "-o", "whole", "--threads=1"]),
        0,
    );
    here.join("whole")
}

/// Starts a run and waits until `reached` or its end; returns the process.
fn until(here: &Path, words: &[&str], reached: impl Fn() -> bool) -> Child {
    let mut child = program(here)
        .args(words)
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .expect("the binary starts");
    let end = Instant::now() + Duration::from_secs(120);
    while !reached() && child.try_wait().expect("a process").is_none() {
        assert!(
            Instant::now() < end,
            "the run never reached the wanted state"
        );
        std::thread::sleep(Duration::from_micros(200));
    }
    child
}

fn kill(mut child: Child) {
    drop(child.kill()); // an error if it has ended already
    child.wait().expect("a process");
}

/// Runs are killed before and after their first checkpoint, while they write, and again after they have been resumed.
#[test]
fn a_killed_run_is_resumed_to_the_same_files() {
    let here = with_scene();
    let here = here.path();
    let whole = whole(here);
    let frame = |run: &str, n: u32| here.join(run).join(format!("frames/{n:06}.npz"));
    let begun = |run: &'static str| {
        let path = here.join(run).join("checkpoints/start.json");
        move || path.exists()
    };
    let written = |run: &'static str, n: u32| {
        let path = frame(run, n);
        move || path.exists()
    };
    let run = |name: &'static str, threads: &'static str| {
        ["run", "scene.toml", "-o", name, "--threads", threads]
    };
    kill(until(here, &run("early", "2"), begun("early")));
    kill(until(here, &run("first", "1"), written("first", 1)));
    kill(until(here, &run("later", "2"), written("later", 7)));
    kill(until(here, &run("twice", "1"), written("twice", 4)));
    // The scene's own files are not needed any more.
    for file in ["scene.toml", "jelly.csv"] {
        fs::remove_file(here.join(file)).unwrap();
    }
    kill(until(here, &["resume", "twice"], written("twice", 9)));
    for run in ["early", "first", "later", "twice"] {
        code(&lahar(here, &["resume", run, "--threads=2"]), 0);
        assert_same(&whole, &here.join(run));
    }
    assert_eq!(checkpoints(&whole).len(), 2);
    // The pictures of the film stay, for a run that is extended.
    assert!(whole.join("checkpoints/film").exists());
    // A finished run stays finished.
    let output = lahar(here, &["resume", "later", "--json"]);
    code(&output, 0);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&report["status"], &report["frames"]),
        (&"done".into(), &13.into())
    );
}

/// Starts a run into the folder `r`, sends it SIGTERM after its third frame, and returns its output.
#[cfg(unix)]
fn terminated(here: &Path, words: &[&str]) -> Output {
    let mut child = program(here)
        .args(words)
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let third = here.join("r/frames/000002.npz");
    while !third.exists() {
        assert!(child.try_wait().unwrap().is_none() || third.exists());
        std::thread::sleep(Duration::from_millis(1));
    }
    // `kill` fails if the run is done.
    let _ = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status()
        .unwrap();
    child.wait_with_output().unwrap()
}

/// SIGTERM acts as Ctrl-C does: the run ends soon, with a checkpoint and a line on how to resume.
#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_a_checkpoint_and_is_resumed() {
    let here = with_scene();
    let here = here.path();
    let whole = whole(here);
    let words = [
        "run",
        "scene.toml",
        "-o",
        "r",
        "--threads=1",
        "--set",
        "output.checkpoint_every=0",
    ];
    let mut output = terminated(here, &words);
    // On a busy machine the run may be done before the signal arrives.
    for _ in 0..50 {
        if output.status.code() != Some(0) {
            break;
        }
        fs::remove_dir_all(here.join("r")).unwrap();
        output = terminated(here, &words);
    }
    code(&output, 130);
    assert!(
        errors(&output).contains("`lahar resume"),
        "{}",
        errors(&output)
    );
    assert_eq!(checkpoints(&here.join("r")).len(), 1);
    let output = lahar(here, &["run", "scene.toml", "-o", "r"]);
    code(&output, 2);
    assert!(errors(&output).contains("lahar resume") && errors(&output).contains("--overwrite"));
    code(&lahar(here, &["resume", "r"]), 0);
    let (mut one, mut other) = (files(&whole), files(&here.join("r")));
    // The scenes differ by the key that was set.
    one.remove(Path::new("run.json"));
    other.remove(Path::new("run.json"));
    assert!(one == other);
}

#[test]
fn a_run_is_extended_beyond_its_end() {
    let here = with_scene();
    let here = here.path();
    let whole = whole(here);
    let short = ["run", "scene.toml", "-o", "r", "--frames=5", "--format=npz"];
    code(&lahar(here, &short), 0);
    let output = lahar(here, &["resume", "r", "--frames=4"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("already goes to frame 5"),
        "{}",
        errors(&output)
    );
    let output = lahar(here, &["resume", "r", "--until=0.2"]);
    code(&output, 0);
    assert!(
        errors(&output).contains("from frame 5 of 12"),
        "{}",
        errors(&output)
    );
    for file in ["diagnostics.csv", "probes/wall.csv", "frames/000012.npz"] {
        let read = |run: &Path| fs::read(run.join(file)).unwrap();
        assert!(read(&whole) == read(&here.join("r")), "{file}");
    }
}

/// Makes a run that was killed after some frames and two checkpoints.
pub(crate) fn stopped(here: &Path, name: &str) -> PathBuf {
    let run = here.join(name);
    let words = ["run", "scene.toml", "-o", name, "--threads=1"];
    kill(until(here, &words, || checkpoints(&run).len() > 1));
    assert_eq!(checkpoints(&run).len(), 2);
    run
}

#[test]
fn damaged_files_are_reported_and_passed_over() {
    let here = with_scene();
    let here = here.path();
    let whole = whole(here);
    let run = stopped(here, "r");
    // The newest checkpoint is cut short, a frame is missing, and a partial file is left over.
    let newest = checkpoints(&run).pop().unwrap();
    let bytes = fs::read(&newest).unwrap();
    fs::write(&newest, &bytes[..bytes.len() / 2]).unwrap();
    fs::write(run.join("frames/000099.npz.partial"), "half").unwrap();
    let missing = run.join("frames/000001.npz");
    let frame = fs::read(&missing).unwrap();
    fs::remove_file(&missing).unwrap();
    let output = lahar(here, &["resume", "r"]);
    code(&output, 0);
    let message = errors(&output);
    assert!(
        message.contains("cut short") && message.contains("frames/000001.npz"),
        "{message}"
    );
    fs::write(&missing, frame).unwrap();
    assert_same(&whole, &run);

    // With an altered byte in both checkpoints, or an altered table, the run starts over.
    for damage in ["checkpoints", "diagnostics.csv"] {
        let run = stopped(here, damage);
        let damaged = match damage {
            "checkpoints" => checkpoints(&run),
            file => vec![run.join(file)],
        };
        for path in damaged {
            let mut bytes = fs::read(&path).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 4;
            fs::write(&path, bytes).unwrap();
        }
        let output = lahar(here, &["resume", damage]);
        code(&output, 0);
        let message = errors(&output);
        assert!(
            message.contains("altered") && message.contains("starts over"),
            "{message}"
        );
        assert_same(&whole, &run);
    }

    // Without the record of its start, a run cannot be resumed.
    fs::write(run.join("checkpoints/start.json"), "{").unwrap();
    let output = lahar(here, &["resume", "r"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("start.json: it is damaged"),
        "{}",
        errors(&output)
    );
    for folder in ["nowhere", "."] {
        let output = lahar(here, &["resume", folder]);
        code(&output, 2);
        let message = errors(&output);
        assert!(message.contains("there is no"), "{message}");
    }
}

#[test]
fn two_runs_do_not_share_a_folder() {
    let here = with_scene();
    let here = here.path();
    let run = here.join("r");
    let words = [
        "run",
        "scene.toml",
        "-o",
        "r",
        "--threads=1",
        "--frames=100000",
    ];
    let first = until(here, &words, || run.join("frames/000000.npz").exists());
    for words in [
        &["resume", "r"][..],
        &["run", "scene.toml", "-o", "r", "--overwrite"],
    ] {
        let output = lahar(here, words);
        code(&output, 2);
        let message = errors(&output);
        assert!(message.contains("another run is writing"), "{message}");
    }
    kill(first);
    code(
        &lahar(
            here,
            &["run", "scene.toml", "-o", "r", "--overwrite", "--frames=1"],
        ),
        0,
    );
}

/// A full disk gives an error that names the file, exit code 1, and a checkpoint from which the run can be resumed when
/// there is space again. A limit on the size of files stands for the disk: the film outgrows it.
#[cfg(unix)]
#[test]
fn a_full_disk_is_an_error_and_nothing_is_lost() {
    let here = with_scene();
    let here = here.path();
    let words = "run scene.toml --threads=1 --format=npz,gif --set output.picture_size=[640,360]";
    let run = |limits: &str, folder: &str| {
        let lahar = env!("CARGO_BIN_EXE_lahar");
        // The program inherits that the limit's signal is ignored.
        let script = format!("trap '' XFSZ; {limits} exec '{lahar}' {words} -o {folder}");
        let output = Command::new("sh")
            .current_dir(here)
            .args(["-c", &script])
            .output();
        output.expect("there is a shell")
    };
    code(&run("", "whole"), 0);
    // The unit is half a kilobyte.
    let output = run("ulimit -f 200;", "r");
    code(&output, 1);
    let message = errors(&output);
    assert!(
        message.contains("checkpoints/film: cannot write"),
        "{message}"
    );
    assert!(
        message.contains(".checkpoint") && message.contains("`lahar resume r`"),
        "{message}"
    );
    assert!(!checkpoints(&here.join("r")).is_empty());
    let output = lahar(here, &["resume", "r"]);
    code(&output, 0);
    assert!(
        errors(&output).contains("resumed from frame"),
        "{}",
        errors(&output)
    );
    assert_same(&here.join("whole"), &here.join("r"));
}

/// A run does not begin in a place that cannot be written to.
#[cfg(unix)]
#[test]
fn an_unwritable_place_is_named() {
    let here = with_scene();
    let output = lahar(here.path(), &["run", "scene.toml", "-o", "/dev/null/r"]);
    code(&output, 1);
    assert!(
        errors(&output).contains("/dev/null/r"),
        "{}",
        errors(&output)
    );
}
