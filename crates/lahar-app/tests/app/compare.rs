//! Comparisons: a scene with several settings side by side.

use super::*;
use eframe::egui::{Key, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;
use lahar::Field;
use lahar_app::solver::Condition;
use lahar_scene::scene::Comparison;

fn transfers() -> Comparison {
    "transfer=apic,pic".parse().unwrap()
}

fn compared(scene: &str) -> SceneRequest {
    SceneRequest {
        comparison: Some(transfers()),
        ..alone(scene)
    }
}

#[test]
fn v_runs_two_settings_and_v_again_the_scene_alone() {
    let mut harness = harness("dam-break");
    let transfer = harness.state().settings[1].clone();
    harness.state_mut().draft.choose(&transfer);
    harness.key_press(Key::V);
    harness.run();
    let asked = SceneRequest {
        comparison: Some(r#"transfer="apic","pic""#.parse().unwrap()),
        ..alone("dam-break")
    };
    assert_eq!(orders(&mut harness), [Order::Open(asked)]);
    harness.key_press(Key::V);
    harness.run();
    assert_eq!(orders(&mut harness), [open("dam-break")]);
}

#[test]
fn the_panel_compares_numbers_too() {
    let mut harness = harness("dam-break");
    harness.get_by_label("Compare").click();
    harness.run();
    let viscosity = harness.state().settings[0].clone();
    harness.state_mut().draft.choose(&viscosity);
    harness.run();
    harness.get_by_label("One more").click();
    harness.run();
    harness.get_by_label("Side by side").click();
    harness.run();
    let comparison = "materials.water.viscosity=0.001,0.002,0.004"
        .parse()
        .unwrap();
    assert_eq!(harness.state().comparison(), Some(&comparison));
    harness.get_by_label("Alone").click();
    harness.run();
    assert_eq!(harness.state().comparison(), None);
}

#[test]
fn sides_run_in_step_and_each_has_the_bits_of_a_run_alone() {
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Fields(vec![Field::Velocity]));
    solver.order(Order::Open(compared("dam-break")));
    let shown = wait(&mut solver, |shown| {
        shown.sides.iter().all(|side| side.readouts.time > 0.04)
            && shown.sides.len() == 2
            && shown.sides[0].readouts.time == shown.sides[1].readouts.time
    });
    let titles: Vec<_> = shown.sides.iter().map(|side| side.title.as_str()).collect();
    assert_eq!(titles, ["transfer = apic", "transfer = pic"]);
    let velocities: Vec<_> = (shown.sides.iter())
        .map(|side| side.snapshot.get(Field::Velocity).unwrap())
        .collect();
    assert!(
        velocities[0] != velocities[1],
        "the transfers do not differ"
    );

    // The second side alone, to the same frame.
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Fields(vec![Field::Velocity]));
    solver.order(Order::Open(SceneRequest {
        changes: vec![("transfer".into(), "pic".into())],
        ..alone("dam-break")
    }));
    let time = first(&shown).time;
    let frame = (time * 60.0).round() / 60.0;
    assert!(
        (time - frame).abs() < 1e-9,
        "{time} is not the end of a frame"
    );
    solver.order(Order::Speed(0.2));
    let lone = wait(&mut solver, |shown| {
        (first(shown).time - time).abs() < 1e-12
    });
    assert!(lone.sides[0].snapshot.get(Field::Velocity) == Some(velocities[1]));
}

#[test]
fn a_substep_keeps_the_sides_together() {
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Pause(true));
    solver.order(Order::Open(compared("dam-break")));
    for _ in 0..3 {
        solver.order(Order::Substep);
    }
    let shown = wait(&mut solver, |shown| first(shown).substeps == 3);
    let [a, b] = [0, 1].map(|i| shown.sides[i].readouts);
    assert!((a.time - b.time).abs() < a.dt, "{} and {}", a.time, b.time);
}

#[test]
fn a_side_that_cannot_be_opened_ends_the_comparison() {
    let mut solver = Solver::start(Arc::new(support::TestScenes), 1).unwrap();
    solver.order(Order::Open(SceneRequest {
        comparison: Some("transfer=apic,magic".parse().unwrap()),
        ..alone("dam-break")
    }));
    let shown = wait(&mut solver, |shown| shown.opened == 1);
    let Condition::Failed(why) = shown.condition else {
        panic!("{:?}", shown.condition);
    };
    assert_eq!(why, "transfer cannot be magic");
}

#[test]
fn sides_fill_the_window_as_large_as_possible() {
    let room = Rect::from_min_size(pos2(10.0, 20.0), vec2(800.0, 600.0));
    assert_eq!(view::cells(room, 1, 1.0), [room]);
    // Wide scenes stand one above the other, tall ones beside each other, four in a square.
    let wide = view::cells(room, 2, 3.0);
    assert_eq!(
        wide[1],
        Rect::from_min_size(pos2(10.0, 320.0), vec2(800.0, 300.0))
    );
    let tall = view::cells(room, 2, 0.5);
    assert_eq!(
        tall[1],
        Rect::from_min_size(pos2(410.0, 20.0), vec2(400.0, 600.0))
    );
    let four = view::cells(room, 4, 1.3);
    assert_eq!(
        four[3],
        Rect::from_min_size(pos2(410.0, 320.0), vec2(400.0, 300.0))
    );
}
