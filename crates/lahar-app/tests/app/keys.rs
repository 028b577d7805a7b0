//! The actions of the keys.

use super::*;
use eframe::egui::{Event, Key, Modifiers};
use lahar::Command;
use lahar_app::color;
use lahar_scene::scene::ColorBy;

fn gravity(harness: &mut Harness<'_, AppState>, key: Key) -> [f64; 3] {
    harness.key_press(key);
    harness.run();
    match orders(harness)[..] {
        [Order::Command(Command::Gravity(gravity))] => gravity,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn the_default_scene_opens_first_and_shift_r_comes_back_to_it() {
    let mut state = AppState::new(support::TestScenes.list(), DEFAULT_SCENE, None);
    assert_eq!(state.take_effects(), [Effect::Order(open("dam-break"))]);
    let mut harness = harness("double-dam");
    harness.key_press_modifiers(Modifiers::SHIFT, Key::R);
    harness.run();
    assert_eq!(orders(&mut harness), [open("dam-break")]);
    harness.key_press(Key::R);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Restart]);
}

#[test]
fn number_keys_choose_scenes_and_numbers_without_one_do_nothing() {
    let mut harness = harness("dam-break");
    harness.key_press(Key::Num2);
    harness.run();
    assert_eq!(orders(&mut harness), [open("double-dam")]);
    harness.key_press(Key::Num9);
    harness.run();
    assert_eq!(orders(&mut harness), []);
}

#[test]
fn keys_turn_gravity_at_the_scenes_magnitude() {
    let mut harness = harness("dam-break");
    for (key, expected) in [
        (Key::A, [-9.81, 0.0, 0.0]),
        (Key::ArrowLeft, [-9.81, 0.0, 0.0]),
        (Key::D, [9.81, 0.0, 0.0]),
        (Key::ArrowRight, [9.81, 0.0, 0.0]),
        (Key::W, [0.0, 9.81, 0.0]),
        (Key::ArrowUp, [0.0, 9.81, 0.0]),
        (Key::S, [0.0, -9.81, 0.0]),
        (Key::ArrowDown, [0.0, -9.81, 0.0]),
    ] {
        let gravity = gravity(&mut harness, key);
        for axis in 0..3 {
            assert!(
                (gravity[axis] - expected[axis]).abs() < 1e-12,
                "{key:?}: {gravity:?}"
            );
        }
        assert_eq!(
            harness.state().gravity,
            gravity,
            "it keeps its last direction"
        );
    }
}

#[test]
fn in_3d_gravity_follows_the_window_however_the_camera_stands() {
    let mut harness = harness("dam-break-3d");
    assert_eq!(gravity(&mut harness, Key::D), [9.81, 0.0, 0.0]);
    let camera = harness.state_mut().camera.as_mut().unwrap();
    camera.yaw += std::f64::consts::PI;
    assert_eq!(
        gravity(&mut harness, Key::D).map(|c| c + 0.0),
        [-9.81, 0.0, 0.0]
    );
    assert_eq!(
        gravity(&mut harness, Key::S).map(|c| c + 0.0),
        [0.0, -9.81, 0.0]
    );
}

#[test]
fn space_pauses_period_steps_plus_and_minus_change_speed() {
    let mut harness = harness("dam-break");
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(true)]);
    harness.key_press(Key::Period);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Substep]);
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(false)]);
    harness.key_press(Key::Period);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(true), Order::Substep]);
    harness.key_press(Key::Plus);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Speed(1.5)]);
    harness.key_press(Key::Minus);
    harness.run();
    harness.key_press(Key::Minus);
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Speed(1.0), Order::Speed(0.75)]
    );
}

#[test]
fn c_goes_through_the_colors_and_asks_for_their_fields() {
    let mut harness = harness("dam-break");
    for by in [
        ColorBy::Body,
        ColorBy::Speed,
        ColorBy::Pressure,
        ColorBy::Density,
        ColorBy::Jacobian,
        ColorBy::Material,
    ] {
        harness.key_press(Key::C);
        harness.run();
        assert_eq!(harness.state().color_by, by);
        assert_eq!(orders(&mut harness), [Order::Fields(color::fields(by))]);
    }
}

#[test]
fn h_p_and_l_show_and_hide_f12_takes_a_picture_and_escape_leaves() {
    let mut harness = harness("dam-break");
    harness.key_press(Key::H);
    harness.key_press(Key::P);
    harness.key_press(Key::L);
    harness.run();
    let state = harness.state_mut();
    assert!(!state.show_hints && !state.show_panel && state.show_scenes);
    assert_eq!(state.take_effects(), [Effect::Thumbnails]);
    harness.key_press(Key::F12);
    harness.run();
    assert_eq!(harness.state_mut().take_effects(), [Effect::Screenshot]);
    harness.key_press(Key::Escape);
    harness.run();
    assert!(!harness.state().show_scenes, "the list closes first");
    assert_eq!(harness.state_mut().take_effects(), []);
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state_mut().take_effects(), [Effect::Close]);
}

#[test]
fn the_list_reaches_every_scene_by_keys() {
    for (typed, downs, scene) in [
        ("", 0, "held"),
        ("", 1, "pushed"),
        ("3d", 0, "dam-break-3d"),
        ("  DAM  double", 0, "double-dam"),
        ("dam", 2, "dam-break-3d"),
        ("dam", 99, "dam-break-3d"),
        ("held", 0, "held"),
    ] {
        let mut harness = harness("held");
        harness.event(Event::Text("l".into()));
        harness.key_press(Key::L);
        harness.run();
        assert_eq!(
            harness.state().search.text,
            "",
            "the L that opened it is not typed"
        );
        if !typed.is_empty() {
            harness.event(Event::Text(typed.into()));
            harness.run();
        }
        for _ in 0..downs {
            harness.key_press(Key::ArrowDown);
            harness.run();
        }
        orders(&mut harness);
        harness.key_press(Key::Enter);
        harness.run();
        assert_eq!(harness.state().scene, scene, "{typed:?} {downs}");
        assert!(!harness.state().show_scenes);
        assert!(
            matches!(orders(&mut harness)[..], [Order::Open(..)]),
            "and nothing else"
        );
    }
}

#[test]
fn a_scene_may_have_gravity_only_while_a_key_is_down() {
    let mut harness = harness("held");
    let told = |harness: &mut Harness<'_, AppState>| match orders(harness)[..] {
        [Order::Command(Command::Gravity(gravity))] => gravity,
        ref other => panic!("{other:?}"),
    };
    assert_eq!(
        orders(&mut harness),
        [],
        "the scene's own, until a key is pressed"
    );
    harness.key_down(Key::A);
    harness.run();
    assert_eq!(told(&mut harness), [-30.0, 0.0, 0.0]);
    harness.run();
    assert_eq!(orders(&mut harness), [], "held: nothing new");
    harness.key_down(Key::ArrowUp);
    harness.run();
    assert_eq!(
        told(&mut harness),
        [0.0, 30.0, 0.0],
        "the latest key counts"
    );
    harness.key_up(Key::ArrowUp);
    harness.run();
    assert_eq!(told(&mut harness), [-30.0, 0.0, 0.0], "the one still held");
    harness.key_up(Key::A);
    harness.run();
    assert_eq!(told(&mut harness), [0.0; 3]);
}

#[test]
fn the_speed_and_the_pointer_tool_of_a_scene_are_adopted() {
    let harness = harness("held");
    let state = harness.state();
    assert_eq!(state.speed, 0.5);
    assert_eq!(
        (state.pointer_tool.pull, state.pointer_tool.reach),
        (100.0, f64::INFINITY)
    );
}

#[test]
fn arrows_with_shift_and_ctrl_and_the_page_keys_move_the_view() {
    for scene in ["dam-break", "dam-break-3d"] {
        let mut harness = harness(scene);
        let fitted = harness.state().camera.clone().unwrap();
        let mut press = |modifiers, key| {
            harness.key_press_modifiers(modifiers, key);
            harness.run();
            assert_eq!(orders(&mut harness), [], "gravity stays");
            harness.state().camera.clone().unwrap()
        };
        let turned = press(Modifiers::SHIFT, Key::ArrowRight);
        assert_eq!(turned.yaw != fitted.yaw, scene == "dam-break-3d");
        assert_eq!(turned.target != fitted.target, scene == "dam-break");
        let moved = press(Modifiers::CTRL, Key::ArrowUp);
        assert!(moved.target[1] > turned.target[1]);
        let nearer = press(Modifiers::NONE, Key::PageUp);
        assert!(nearer.half_height < moved.half_height);
        let farther = press(Modifiers::NONE, Key::PageDown);
        assert!((farther.half_height - moved.half_height).abs() < 1e-9);
        assert_eq!(press(Modifiers::NONE, Key::Home), fitted);
    }
}
