//! Run folders: no command writes, empties or reads a file outside of one, and none replaces more than lahar wrote.

use std::fs;
use std::path::Path;

use crate::resume::{checkpoints, files, stopped, with_scene};
use crate::support::{code, errors, here, lahar, names};

/// A finished run with a film is extended: its film shows all frames, and no frame is computed twice.
#[test]
fn a_finished_run_with_a_film_is_extended() {
    let here = with_scene();
    let here = here.path();
    let short = ["run", "scene.toml", "-o", "r", "--frames=6", "--format=gif"];
    code(&lahar(here, &short), 0);
    let film = |run: &str| fs::read(here.join(run).join("video.gif")).unwrap();
    let short_film = film("r");
    copy_folder(&here.join("r"), &here.join("lost"));
    copy_folder(&here.join("r"), &here.join("damaged"));

    let output = lahar(here, &["resume", "r", "--frames=9"]);
    code(&output, 0);
    let message = errors(&output);
    assert!(message.contains("from frame 6 of 9"), "{message}");
    assert!(film("r").len() > short_film.len());

    // Without the pictures so far the film begins later, and the old film is kept.
    fs::remove_file(here.join("lost/checkpoints/film")).unwrap();
    let output = lahar(here, &["resume", "lost", "--frames=9"]);
    code(&output, 0);
    let message = errors(&output);
    assert!(
        message.contains("from frame 6 of 9") && message.contains("video-to-000006.gif"),
        "{message}"
    );
    assert!(fs::read(here.join("lost/video-to-000006.gif")).unwrap() == short_film);

    // A finished run without a usable checkpoint is not replaced.
    for checkpoint in checkpoints(&here.join("damaged")) {
        fs::write(checkpoint, "x").unwrap();
    }
    let before = files(&here.join("damaged"));
    let output = lahar(here, &["resume", "damaged", "--frames=9"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("is finished"),
        "{}",
        errors(&output)
    );
    assert!(files(&here.join("damaged")) == before);
    code(&lahar(here, &["resume", "damaged"]), 0);
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let copy = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_folder(&path, &copy);
        } else {
            fs::copy(&path, &copy).unwrap();
        }
    }
}

/// The targets of links to files stay as they are, whatever command replaces the links.
#[cfg(unix)]
#[test]
fn links_to_files_are_replaced() {
    use std::os::unix::fs::symlink;
    let here = with_scene();
    let here = here.path();
    stopped(here, "r");
    let precious = here.join("precious");
    fs::write(&precious, "precious").unwrap();
    let render: &[&str] = &["render", "--renderer=cpu", "--frames=0", "--video"];
    let links: [(&str, &[&str]); 7] = [
        ("diagnostics.csv", &["resume"]),
        ("checkpoints/film", &["resume"]),
        ("run.json.partial", &["resume"]),
        ("report.html", &["report"]),
        ("plots/energy.svg", &["plot"]),
        ("render/000000.png", render),
        ("render/video.gif", render),
    ];
    for (link, words) in links {
        let run = here.join("copy");
        copy_folder(&here.join("r"), &run);
        let path = run.join(link);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        drop(fs::remove_file(&path));
        symlink(&precious, &path).unwrap();
        code(&lahar(here, &[words, &["copy"]].concat()), 0);
        assert_eq!(fs::read(&precious).unwrap(), b"precious", "{link}");
        fs::remove_dir_all(&run).unwrap();
    }
}

/// Links to folders are refused.
#[cfg(unix)]
#[test]
fn links_to_folders_are_refused() {
    use std::os::unix::fs::symlink;
    let here = with_scene();
    let here = here.path();
    stopped(here, "r");
    let outside = here.join("outside");
    fs::create_dir(&outside).unwrap();
    fs::write(outside.join("notes.partial"), "precious").unwrap();
    let resume: &[&str] = &["resume", "copy"];
    let overwrite: &[&str] = &["run", "scene.toml", "-o", "copy", "--overwrite"];
    let cases: [(&str, &[&[&str]]); 6] = [
        ("frames", &[resume, overwrite, &["render", "copy"]]),
        ("probes", &[resume, overwrite]),
        ("checkpoints", &[resume, overwrite]),
        ("checkpoints/files", &[resume, overwrite]),
        ("plots", &[overwrite, &["plot", "copy"]]),
        ("render", &[overwrite, &["render", "copy"]]),
    ];
    for (folder, commands) in cases {
        let run = here.join("copy");
        copy_folder(&here.join("r"), &run);
        drop(fs::remove_dir_all(run.join(folder)));
        symlink(&outside, run.join(folder)).unwrap();
        for words in commands {
            let output = lahar(here, words);
            code(&output, 2);
            assert!(errors(&output).contains("is a link"), "{}", errors(&output));
        }
        assert_eq!(names(&outside), ["notes.partial"], "{folder}");
        fs::remove_dir_all(&run).unwrap();
    }
}

/// A folder with a run.json of another program is not lahar's to overwrite.
#[test]
fn a_folder_of_another_program_is_refused() {
    let here = with_scene();
    let project = here.path().join("project");
    fs::create_dir_all(project.join("images")).unwrap();
    fs::write(project.join("images/holiday.jpg"), "x").unwrap();
    fs::write(project.join("run.json"), "{\"scripts\": {}}").unwrap();
    for words in [
        &["run", "scene.toml", "-o", "project", "--overwrite"][..],
        &["resume", "project"],
    ] {
        let output = lahar(here.path(), words);
        code(&output, 2);
        assert!(
            errors(&output).contains("not lahar's"),
            "{}",
            errors(&output)
        );
    }
    let compare = [
        "run",
        "scene.toml",
        "--compare",
        "cfl=0.3,0.4",
        "-o",
        "project",
        "--overwrite",
    ];
    code(&lahar(here.path(), &compare), 2);
    assert_eq!(names(&project), ["images", "run.json"]);
    assert_eq!(names(&project.join("images")), ["holiday.jpg"]);
}

/// The name of a material names a folder in `meshes/` and no other.
#[cfg(feature = "mesh")]
#[test]
fn names_of_materials_do_not_lead_out_of_a_run() {
    let here = here();
    let scene = r#"
dimension = 3
duration = 0.1
dx = 0.1
[domain]
min = [0.0, 0.0, 0.0]
max = [1.0, 1.0, 1.0]
[materials."../../escaped"]
preset = "water"
[[bodies]]
name = "../body"
material = "../../escaped"
shape = { box = { min = [0.0, 0.0, 0.0], max = [0.4, 0.4, 0.4] } }
"#;
    let below = here.path().join("a/b");
    fs::create_dir_all(&below).unwrap();
    fs::write(below.join("scene.toml"), scene).unwrap();
    let run = ["run", "scene.toml", "--frames=1", "--format=npz", "-o", "r"];
    code(&lahar(&below, &run), 0);
    code(&lahar(&below, &["mesh", "r", "--format=ply,vtk"]), 0);
    let name = "%2E.%2F..%2Fescaped";
    assert_eq!(
        names(&below.join("r/meshes")),
        [name.to_owned(), format!("{name}.pvd")]
    );
    assert_eq!(names(here.path()), ["a"]);
    assert_eq!(names(&here.path().join("a")), ["b"]);
    code(
        &lahar(
            &below,
            &["run", "scene.toml", "--frames=0", "-o", "r", "--overwrite"],
        ),
        0,
    );
    assert!(!below.join("r/meshes").exists());
}
