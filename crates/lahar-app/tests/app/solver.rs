//! The solver behind the window, on its own.

use super::*;
use lahar::Field;
use lahar_app::scene_library::SceneLibrary;
use lahar_app::scenes::SceneContent;
use lahar_app::solver::Condition;
use lahar_scene::driver::Driver;
use lahar_scene::scene::Setting;

/// Opens a scene to run it without a window.
fn driver(source: &dyn SceneSource, scene: &str) -> Driver {
    match source.open(scene, &vec![]).unwrap().content {
        SceneContent::Simulation(driver) => *driver,
        SceneContent::Recording(_) => panic!("{scene} is a recording"),
    }
}

#[test]
fn a_scene_left_alone_has_the_same_bits_as_a_headless_run() {
    let mut driver = driver(&support::TestScenes, "dam-break");
    let headless = driver.simulation_mut();
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Fields(vec![Field::Velocity]));
    solver.order(Order::Speed(8.0));
    solver.order(open("dam-break"));
    let mut checked = 0;
    let mut frame = 0;
    while checked < 3 {
        let shown = wait(&mut solver, |shown| {
            let frames = first(shown).time * 60.0;
            first(shown).time > 0.0 && frames.fract().min(1.0 - frames.fract()) < 1e-9
        });
        let snapshot = &shown.sides[0].snapshot;
        while frame < (snapshot.time * 60.0).round() as u64 {
            frame += 1;
            headless.advance_to(frame as f64 / 60.0).unwrap();
        }
        let expected = headless.snapshot(&[Field::Position, Field::Velocity]);
        assert_eq!(first(&shown).substeps, headless.substeps());
        for field in [Field::Position, Field::Velocity] {
            assert!(
                snapshot.get(field) == expected.get(field),
                "{field:?} differs"
            );
        }
        checked += 1;
    }
}

#[test]
fn pause_stops_the_clock_and_a_substep_is_one_substep() {
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Pause(true));
    solver.order(open("dam-break"));
    let start = wait(&mut solver, |shown| shown.condition == Condition::Paused);
    assert_eq!(first(&start).substeps, 0);
    for substeps in 1..=3 {
        solver.order(Order::Substep);
        wait(&mut solver, |shown| first(shown).substeps == substeps);
    }
    solver.order(Order::Restart);
    let again = wait(&mut solver, |shown| shown.opened == 2);
    assert_eq!(
        (first(&again).substeps, again.condition),
        (0, Condition::Paused)
    );
}

#[test]
fn simulated_time_never_overtakes_real_time_times_speed() {
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Speed(0.1));
    solver.order(open("dam-break"));
    wait(&mut solver, |shown| shown.condition == Condition::Running);
    let start = Instant::now();
    let shown = wait(&mut solver, |shown| first(shown).time >= 0.045);
    let elapsed = start.elapsed().as_secs_f64();
    // A frame is computed as soon as its start is due.
    assert!(
        first(&shown).time <= 0.1 * elapsed + 1.5 / 60.0,
        "{} s in {elapsed} s",
        first(&shown).time
    );
}

#[test]
fn a_scene_that_cannot_be_opened_is_an_error_and_the_next_one_opens() {
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(open("broken"));
    let shown = wait(&mut solver, |shown| {
        matches!(shown.condition, Condition::Failed(_))
    });
    let mut state = AppState::new(support::TestScenes.list(), DEFAULT_SCENE, None);
    state.receive(shown);
    assert_eq!(state.failure(), Some("line 3: gravity: expected numbers"));
    solver.order(open("dam-break"));
    wait(&mut solver, |shown| shown.condition == Condition::Running);
}

#[test]
fn scenes_that_ship_open_with_a_color_for_every_body() {
    let library = SceneLibrary::default();
    let list = library.list();
    assert_eq!(list[0].name, DEFAULT_SCENE);
    for card in list {
        let opened = library
            .open(&card.name, &vec![])
            .unwrap_or_else(|why| panic!("{why}"));
        let info = opened.info;
        assert_eq!(info.dimension, card.dimension);
        assert!(!info.swatches.is_empty());
        let has = |key: &str| info.settings.iter().any(|setting| setting.key == key);
        assert!(
            has("dx") && has("transfer") && has("kernel"),
            "{:?}",
            info.settings
        );
        let of_material =
            |setting: &Setting| setting.key.starts_with("materials.") && setting.name == "density";
        assert!(info.settings.iter().any(of_material), "{:?}", info.settings);
        // The settings are accepted as they are offered.
        let all: Vec<_> = (info.settings.iter())
            .map(|setting| (setting.key.clone(), setting.value.to_toml()))
            .collect();
        library
            .open(&card.name, &all)
            .unwrap_or_else(|why| panic!("{why}"));
        assert!(info.body_swatches.iter().all(|&i| i < info.swatches.len()));
    }
    assert!(library.open("no-such-scene", &vec![]).is_err());
}
