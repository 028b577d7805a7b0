//! Pictures, films, plots, pages and surfaces of runs.

use std::io;
use std::path::Path;
use std::process::Output;

use lahar_io::image::Picture;
use serde_json::Value;

use crate::support::{code, errors, here, lahar, names, program, run};

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
    let picture = |path: &str| Picture::load_png(whole.join(path)).unwrap();
    let (one, both) = (
        picture("pic/images/000003.png"),
        picture("images/000003.png"),
    );
    assert!(both.width > 2 * one.width && both.height > one.height);
    let plot = std::fs::read_to_string(whole.join("plots/angular-momentum.svg")).unwrap();
    assert!(plot.contains("transfer = pic") && plot.contains("transfer = apic"));

    // A wrong value is found before anything runs.
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
fn a_finished_run_is_drawn_and_reported() {
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

    assert!(errors(&output).contains("drawing "));

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
    // The page fetches nothing: its only addresses are XML namespaces.
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
    // A report of the totals is still possible.
    code(&lahar(here.path(), &["report", "bare"]), 0);
}

/// A graphics backend that this system does not have.
const NO_BACKEND: &str = if cfg!(target_os = "macos") {
    "dx12"
} else {
    "metal"
};

/// Draws frame 1 of the run `name` into the folder `renderer`, with a backend if one is given.
fn draw(
    folder: &Path,
    name: &str,
    renderer: &str,
    words: &[&str],
    backend: Option<&str>,
) -> (Output, io::Result<Picture>) {
    let mut command = program(folder);
    command.args(["render", name, "--frames=1", "--size=96x64", "-o", renderer]);
    command.args(["--renderer", renderer]).args(words);
    command.envs(backend.map(|backend| ("WGPU_BACKEND", backend)));
    let output = command.output().unwrap();
    let picture = Picture::load_png(folder.join(renderer).join("000001.png"));
    (output, picture)
}

/// Returns the number of pixels of water, and their mean column and row.
fn water(picture: &Picture) -> (f64, [f64; 2]) {
    let (mut count, mut sums) = (0.0, [0.0; 2]);
    for (at, pixel) in picture.rgb.as_chunks::<3>().0.iter().enumerate() {
        // Water is bluer than the background and the lines.
        if pixel[2].saturating_sub(pixel[0]) > 0x40 {
            let (row, column) = (at / picture.width as usize, at % picture.width as usize);
            count += 1.0;
            sums[0] += column as f64;
            sums[1] += row as f64;
        }
    }
    (count, sums.map(|sum| sum / count))
}

/// The window's renderer draws a run if there is a graphics adapter, else the processor does. Both draw the same water in
/// the same place, on pictures of the same size.
#[test]
fn the_window_s_renderer_and_the_processor_draw_the_same_water() {
    let here = here();
    // The two frame a 3D scene differently unless the camera is given.
    let camera = [
        "--camera=1,0.5,2",
        "--set=camera.center=[0.8,0.5,0.3]",
        "--set=camera.height=2",
        "--set=camera.field_of_view=40",
    ];
    let scenes = [
        ("flat", "dam-break", &[][..]),
        ("solid", "dam-break-3d", &camera),
    ];
    for (name, scene, camera) in scenes {
        let coarse = ["run", scene, "--set", "dx=0.1", "--frames=1"];
        let into = ["--format=npz", "-o", name];
        code(&lahar(here.path(), &[&coarse[..], &into].concat()), 0);

        let (output, picture) = draw(here.path(), name, "cpu", camera, None);
        code(&output, 0);
        assert!(errors(&output).contains("drawing on the processor\n"));
        let by_processor = picture.unwrap();

        let (output, _) = draw(here.path(), name, "gpu", camera, Some(NO_BACKEND));
        code(&output, 1);
        let message = errors(&output);
        assert!(message.contains("--renderer gpu: "), "{message}");
        let (output, picture) = draw(here.path(), name, "auto", camera, Some(NO_BACKEND));
        code(&output, 0);
        assert!(errors(&output).contains("drawing on the processor: "));
        assert_eq!(picture.unwrap(), by_processor);

        let (output, picture) = draw(here.path(), name, "auto", camera, None);
        code(&output, 0);
        if !errors(&output).contains("drawing by the window's renderer on ") {
            continue;
        }
        let by_window = picture.unwrap();
        let size = |picture: &Picture| (picture.width, picture.height);
        assert_eq!(size(&by_window), size(&by_processor));
        let (area, [x, y]) = water(&by_processor);
        let (window_area, [window_x, window_y]) = water(&by_window);
        let ratio = window_area / area;
        assert!(
            (0.85..1.2).contains(&ratio),
            "{scene}: {window_area} {area}"
        );
        assert!((x - window_x).abs() < 1.5, "{scene}: {x} {window_x}");
        assert!((y - window_y).abs() < 1.5, "{scene}: {y} {window_y}");

        // Colors by body and by speed differ from those by material.
        for by in ["body", "speed"] {
            let words = [camera, &["--color-by", by]].concat();
            let (output, picture) = draw(here.path(), name, "auto", &words, None);
            code(&output, 0);
            assert_ne!(picture.unwrap(), by_window, "{by}");
        }
    }
}

#[cfg(feature = "mesh")]
#[test]
fn surfaces_are_in_one_folder_per_material() {
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
