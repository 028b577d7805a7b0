//! Replays of finished runs.

use super::*;
use eframe::egui::Key;
use egui_kittest::kittest::Queryable;
use lahar::{Data, Field, Snapshot};
use lahar_app::scene_library::SceneLibrary;
use lahar_app::solver::Condition;
use lahar_io::export::Format;
use lahar_io::output::{PhaseSeconds, Record, Status, frame_name, write_frame};

/// Makes the folder of a run with this number of frames.
fn record(folder: &std::path::Path, frames: u64) {
    let record = Record {
        version: "0".into(),
        status: Status::Done,
        failure: None,
        scene_name: "drop.toml".into(),
        scene: serde_json::json!({
            "title": "Drop",
            "dx": 0.1,
            "gravity": [0.0, -9.81],
            "domain": { "min": [0.0, 0.0], "max": [2.0, 1.0] },
            "materials": {
                "water": { "model": "fluid", "color": "#3d9be9" },
                "air": { "model": "none" },
            },
            "bodies": [{ "material": "water" }, { "material": "water", "name": "dyed", "color": "#ff8000" }],
            "camera": { "background": "#000010", "particle_radius": 0.02 },
            "computed": { "frame_rate": 10.0 },
        }),
        seed: 0,
        dimension: 2,
        precision: "f32".into(),
        isa: "portable".into(),
        threads: 1,
        frames,
        time: 0.1 * frames as f64,
        substeps: 10,
        particles: 2,
        particle_steps: 20,
        particle_steps_per_second: 1.0,
        startup_seconds: 0.5,
        seconds: 1.0,
        phase_seconds: PhaseSeconds::default(),
        sorts: 1,
        warnings: vec![],
        retries: vec![],
    };
    record.write(&folder.join("run.json")).unwrap();
    std::fs::create_dir(folder.join("frames")).unwrap();
    for frame in 0..frames {
        let x = 0.5 + 0.1 * frame as f64;
        let snapshot = Snapshot {
            time: 0.1 * frame as f64,
            dimension: 2,
            count: 2,
            columns: vec![
                (Field::Position, Data::F64(vec![x, 0.5, x, 0.6])),
                (Field::Body, Data::U32(vec![0, 1])),
            ],
        };
        let path = folder.join("frames").join(frame_name(frame, "npz"));
        write_frame(&path, &snapshot, Format::Npz).unwrap();
    }
}

fn solver(folder: &std::path::Path, paused: bool) -> Solver {
    let solver = Solver::start(Arc::new(SceneLibrary::default()), 1).unwrap();
    solver.order(Order::Pause(paused));
    solver.order(open(&folder.display().to_string()));
    solver
}

fn position(shown: &SolverState) -> f64 {
    let position = shown.sides[0].snapshot.get(Field::Position);
    position.unwrap().to_f64()[0]
}

#[test]
fn a_run_plays_at_its_own_pace_to_its_end_and_again_from_its_start() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), 4);
    let start = Instant::now();
    let mut solver = solver(folder.path(), false);
    let shown = wait(&mut solver, |shown| shown.condition == Condition::Ended);
    // There are three frames of a tenth of a second.
    assert!(start.elapsed().as_secs_f64() > 0.29);
    assert_eq!((first(&shown).frame, position(&shown)), (3, 0.8));
    let info = shown.info.unwrap();
    assert_eq!((info.card.title.as_str(), info.frames), ("Drop", Some(4)));
    assert_eq!(info.domain, Some(([0.0; 3], [2.0, 1.0, 0.0])));
    let names: Vec<_> = info
        .swatches
        .iter()
        .map(|swatch| swatch.name.as_str())
        .collect();
    assert_eq!(names, ["water", "dyed"], "air has no particle");
    solver.order(Order::Restart);
    wait(&mut solver, |shown| first(shown).frame == 0);
    wait(&mut solver, |shown| shown.condition == Condition::Ended);
}

#[test]
fn any_frame_can_be_gone_to_and_stepped_from() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), 6);
    let mut solver = solver(folder.path(), true);
    wait(&mut solver, |shown| shown.condition == Condition::Paused);
    for (order, frame) in [
        (Order::Seek(3), 3),
        (Order::Substep, 4),
        (Order::Seek(2), 2),
        (Order::Seek(99), 5),
    ] {
        solver.order(order.clone());
        let shown = wait(&mut solver, |shown| first(shown).frame == frame);
        assert!(
            (position(&shown) - 0.5 - 0.1 * frame as f64).abs() < 1e-12,
            "{order:?}"
        );
    }
}

#[test]
fn a_run_without_particles_and_a_folder_without_a_run_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    for expected in ["not a run's folder", "--format npz"] {
        let mut solver = solver(folder.path(), false);
        let shown = wait(&mut solver, |shown| shown.opened == 1);
        let Condition::Failed(why) = shown.condition else {
            panic!("{:?}", shown.condition);
        };
        assert!(why.contains(expected), "{why}");
        record(folder.path(), 0);
        std::fs::remove_dir(folder.path().join("frames")).unwrap();
    }
}

#[test]
fn a_run_has_a_player_and_no_gravity() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), 20);
    let mut solver = solver(folder.path(), true);
    let shown = wait(&mut solver, |shown| shown.condition == Condition::Paused);
    let mut harness = harness_of(shown);
    for (key, frame) in [
        (Key::ArrowRight, 1),
        (Key::ArrowUp, 10),
        (Key::Comma, 0),
        (Key::ArrowLeft, 0),
    ] {
        harness.key_press(key);
        harness.run();
        let asked = orders(&mut harness);
        assert_eq!(asked.last(), Some(&Order::Seek(frame)), "{key:?}");
    }
    assert!(harness.query_by_label("Settings of the scene").is_none());
    assert!(
        harness
            .query_by_label("frame 0 of 19  ·  0.000 s")
            .is_some()
    );
    harness.get_by_label("Play").click();
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(false)]);
    let background = harness.state().background;
    assert_eq!(background.to_array(), [0, 0, 0x10, 255]);
}
