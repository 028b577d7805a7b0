//! The actions of the panel's widgets.

use super::*;
use eframe::egui::Key;
use egui_kittest::kittest::Queryable;
use lahar::Command;
use lahar_scene::scene::SettingValue;

#[test]
fn buttons_do_what_their_keys_do() {
    let mut harness = harness("dam-break");
    for (label, order) in [
        ("Restart", Order::Restart),
        ("Pause", Order::Pause(true)),
        ("Substep", Order::Substep),
        ("Go on", Order::Pause(false)),
        ("None", Order::Command(Command::Gravity([0.0; 3]))),
        (
            "Scene's",
            Order::Command(Command::Gravity([0.0, -9.81, 0.0])),
        ),
    ] {
        harness.get_by_label(label).click();
        harness.run();
        assert_eq!(orders(&mut harness), [order], "{label}");
    }
    harness.get_by_label("List").click();
    harness.run();
    harness.get_by_label("Double dam").click();
    harness.run();
    assert_eq!(orders(&mut harness), [open("double-dam")]);
    assert!(!harness.state().show_scenes);
}

#[test]
fn settings_are_applied_with_a_restart_and_forgotten_with_another_scene() {
    let mut harness = harness("dam-break");
    let state = harness.state_mut();
    state.settings[0].value = SettingValue::Number(0.25);
    state.apply_settings();
    let change = vec![("materials.water.viscosity".to_owned(), "0.25".to_owned())];
    assert_eq!(
        orders(&mut harness),
        [Order::Open(SceneRequest {
            scene: "dam-break".into(),
            changes: change,
            comparison: None
        })]
    );
    assert!(harness.state().has_changes());
    harness.key_press(Key::Num1);
    harness.run();
    assert_eq!(orders(&mut harness), [open("dam-break")]);
    assert!(!harness.state().has_changes());
}

#[test]
fn a_widget_with_the_keyboard_keeps_it_and_escape_gives_it_back() {
    let mut harness = harness("dam-break");
    harness.get_by_label("Restart").focus();
    harness.run();
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(
        orders(&mut harness),
        [Order::Restart],
        "the button, not the pause"
    );
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(harness.state_mut().take_effects(), [], "the window stays");
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(orders(&mut harness), [Order::Pause(true)]);
}

#[test]
fn tab_reaches_every_widget_of_the_panel() {
    let mut harness = harness("dam-break-3d");
    for folded in ["Compare", "Settings of the scene"] {
        harness.get_by_label(folded).click();
        harness.run();
    }
    let buttons = [
        "List",
        "Restart",
        "Pause",
        "Substep",
        "None",
        "Scene's",
        "Apply",
        "Side by side",
    ];
    let mut reached = std::collections::HashSet::new();
    let mut missing: Vec<_> = buttons.to_vec();
    for _ in 0..60 {
        harness.key_press(Key::Tab);
        harness.run();
        reached.extend(harness.ctx.memory(|memory| memory.focused()));
        missing.retain(|label| {
            let mut nodes = harness.query_all_by_label(label);
            !nodes.any(|node| node.is_focused())
        });
    }
    assert_eq!(missing, [""; 0]);
    // Sliders with their numbers, colors and choices are reached too.
    assert!(reached.len() >= 30, "{}", reached.len());
}
