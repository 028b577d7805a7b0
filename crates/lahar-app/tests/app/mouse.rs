//! The actions of the mouse in the scene.

use super::*;
use eframe::egui::{self, Modifiers, PointerButton, pos2};
use lahar::{Command, Pointer, PointerAction};
use lahar_app::pointer::PointerMode;

fn press(harness: &Harness<'_, AppState>, pos: egui::Pos2, button: PointerButton, pressed: bool) {
    harness.event(egui::Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers: Modifiers::NONE,
    });
}

/// Presses `button` at `at` and returns the pointer that the simulation is told of.
fn pressed(harness: &mut Harness<'_, AppState>, at: egui::Pos2, button: PointerButton) -> Pointer {
    harness.hover_at(at);
    press(harness, at, button, true);
    harness.run();
    let orders_now = orders(harness);
    let Some(Order::Command(Command::Pointer(Some(pointer)))) = orders_now.last() else {
        panic!("{orders_now:?}");
    };
    *pointer
}

#[test]
fn the_left_button_attracts_and_the_right_repels_until_released() {
    let mut harness = harness("dam-break");
    for (button, sign) in [
        (PointerButton::Primary, 1.0),
        (PointerButton::Secondary, -1.0),
    ] {
        let at = pos2(700.0, 400.0);
        let pointer = pressed(&mut harness, at, button);
        // The domain is 2 m × 1.2 m, and the whole of it is in view.
        assert!((0.0..2.0).contains(&pointer.position[0]), "{pointer:?}");
        assert!((0.0..1.2).contains(&pointer.position[1]), "{pointer:?}");
        let PointerAction::Attract(pull) = pointer.action else {
            panic!("{pointer:?}");
        };
        assert!(pull * sign > 9.81, "{pointer:?}");
        press(&harness, at, button, false);
        harness.run();
        let orders_now = orders(&mut harness);
        assert_eq!(
            orders_now.last(),
            Some(&Order::Command(Command::Pointer(None)))
        );
    }
}

#[test]
fn in_a_scene_that_pushes_the_left_button_pushes_and_the_right_pulls() {
    let mut harness = harness("pushed");
    for (button, push) in [
        (PointerButton::Primary, 5.0),
        (PointerButton::Secondary, -5.0),
    ] {
        let at = pos2(700.0, 400.0);
        let pointer = pressed(&mut harness, at, button);
        let expected = PointerAction::Push {
            acceleration: push,
            power: 4.0,
        };
        assert_eq!((pointer.radius, pointer.action), (0.25, expected));
        press(&harness, at, button, false);
        harness.run();
        orders(&mut harness);
    }
}

#[test]
fn in_3d_a_drag_orbits_and_the_pointer_acts_on_the_nearest_water() {
    let mut harness = harness("dam-break-3d");
    let at = pos2(700.0, 400.0);
    let yaw = harness.state().camera.as_ref().unwrap().yaw;
    harness.hover_at(at);
    press(&harness, at, PointerButton::Primary, true);
    harness.run();
    harness.hover_at(at + Vec2::new(60.0, 0.0));
    harness.run();
    press(&harness, at, PointerButton::Primary, false);
    harness.run();
    assert!(harness.state().camera.as_ref().unwrap().yaw < yaw);
    assert_eq!(orders(&mut harness), []);

    let state = harness.state_mut();
    let camera = state.camera.clone().unwrap();
    let middle = [0.5, 0.5, 0.5];
    let at = camera.project(middle, state.aspect).unwrap();
    state.press_pointer(0, at, PointerMode::Attract, [0.0; 2]);
    let (position, _) = state.pressed.unwrap();
    let nearer: f64 = (0..3)
        .map(|i| (position[i] - middle[i]) * camera.axes()[2][i])
        .sum();
    assert!(
        nearer > 0.2,
        "on the front of the block, not inside: {nearer}"
    );
}
