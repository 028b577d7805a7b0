//! The keys: one table, from which come what they do, the hints in the window and on the terminal.

use eframe::egui::{Event, InputState, Key};

/// A direction of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Upwards.
    Up,
    /// Downwards.
    Down,
}

/// What a key or a button does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// The scene from its start.
    Restart,
    /// The default fluid scene.
    DefaultScene,
    /// The scene at this place of the list, from 0.
    Scene(usize),
    /// Shows or hides the list of scenes.
    SceneList,
    /// Turns gravity.
    Gravity(Direction),
    /// Stops or goes on.
    Pause,
    /// One substep.
    Substep,
    /// More simulated seconds a second.
    Faster,
    /// Fewer.
    Slower,
    /// The next thing to colour by.
    Colours,
    /// The whole scene in view.
    Fit,
    /// The window into a PNG file.
    Screenshot,
    /// Shows or hides the hints.
    Hints,
    /// Shows or hides the side panel.
    Panel,
    /// Closes the window.
    Leave,
}

/// A line of the hints.
#[derive(Clone, Copy, Debug)]
pub struct Hint {
    /// The keys, as written on them.
    pub keys: &'static str,
    /// What they do.
    pub does: &'static str,
}

/// Shift: must be held, must not, or does not matter.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shift {
    Held,
    Not,
    Any,
}

struct Binding {
    keys: &'static [Key],
    shift: Shift,
    /// Goes on while the key is held.
    repeats: bool,
    action: Action,
}

const fn key(keys: &'static [Key], action: Action) -> Binding {
    Binding {
        keys,
        shift: Shift::Any,
        repeats: false,
        action,
    }
}

const BINDINGS: &[Binding] = &[
    Binding {
        shift: Shift::Not,
        ..key(&[Key::R], Action::Restart)
    },
    Binding {
        shift: Shift::Held,
        ..key(&[Key::R], Action::DefaultScene)
    },
    key(&[Key::Num1], Action::Scene(0)),
    key(&[Key::Num2], Action::Scene(1)),
    key(&[Key::Num3], Action::Scene(2)),
    key(&[Key::Num4], Action::Scene(3)),
    key(&[Key::Num5], Action::Scene(4)),
    key(&[Key::Num6], Action::Scene(5)),
    key(&[Key::Num7], Action::Scene(6)),
    key(&[Key::Num8], Action::Scene(7)),
    key(&[Key::Num9], Action::Scene(8)),
    key(&[Key::L], Action::SceneList),
    key(&[Key::A, Key::ArrowLeft], Action::Gravity(Direction::Left)),
    key(
        &[Key::D, Key::ArrowRight],
        Action::Gravity(Direction::Right),
    ),
    key(&[Key::W, Key::ArrowUp], Action::Gravity(Direction::Up)),
    key(&[Key::S, Key::ArrowDown], Action::Gravity(Direction::Down)),
    key(&[Key::Space], Action::Pause),
    Binding {
        repeats: true,
        ..key(&[Key::Period], Action::Substep)
    },
    Binding {
        repeats: true,
        ..key(&[Key::Plus, Key::Equals], Action::Faster)
    },
    Binding {
        repeats: true,
        ..key(&[Key::Minus], Action::Slower)
    },
    key(&[Key::C], Action::Colours),
    key(&[Key::F, Key::Home], Action::Fit),
    key(&[Key::F12], Action::Screenshot),
    key(&[Key::H], Action::Hints),
    key(&[Key::P], Action::Panel),
    key(&[Key::Escape], Action::Leave),
];

/// The keys for people.
pub const KEY_HINTS: &[Hint] = &[
    hint("R", "restart (Shift+R: the default fluid scene)"),
    hint("1 to 9", "choose a scene, L: list of scenes"),
    hint("W A S D, arrows", "turn gravity"),
    hint("Space", "pause or go on, . one substep"),
    hint("+ -", "faster, slower"),
    hint("C", "colours: material, speed, pressure, density, J"),
    hint("F", "fit the view"),
    hint("P", "panel"),
    hint("F12", "screenshot"),
    hint("H", "show or hide these hints"),
    hint("Esc", "leave"),
];

/// The mouse for people, in 2D.
pub const MOUSE_HINTS_2D: &[Hint] = &[
    hint("left button", "attract"),
    hint("right button", "repel"),
    hint("Ctrl+drag", "drag along"),
    hint("wheel, middle-drag", "zoom, pan"),
];

/// The mouse for people, in 3D.
pub const MOUSE_HINTS_3D: &[Hint] = &[
    hint("drag", "orbit"),
    hint("wheel, middle-drag", "zoom, pan"),
    hint("Shift+left, right", "attract, repel"),
    hint("Ctrl+drag", "drag along"),
];

const fn hint(keys: &'static str, does: &'static str) -> Hint {
    Hint { keys, does }
}

/// The keys and the mouse, a line each, for a terminal.
pub fn key_help() -> String {
    let mut help = String::new();
    for (title, hints) in [
        ("Keys:", KEY_HINTS),
        ("Mouse in 2D:", MOUSE_HINTS_2D),
        ("Mouse in 3D:", MOUSE_HINTS_3D),
    ] {
        help.push_str(title);
        help.push('\n');
        for hint in hints {
            help.push_str(&format!("  {:<19} {}\n", hint.keys, hint.does));
        }
    }
    help
}

/// The actions asked for by keys in this frame. While a widget of the panel has the keyboard
/// (`focused`), what that widget may want stays its own.
pub fn actions(input: &InputState, focused: bool) -> Vec<Action> {
    let mut actions = vec![];
    for event in &input.events {
        let &Event::Key {
            key,
            pressed: true,
            repeat,
            modifiers,
            ..
        } = event
        else {
            continue;
        };
        if modifiers.ctrl || modifiers.alt || modifiers.mac_cmd {
            continue;
        }
        if focused && key != Key::F12 {
            continue;
        }
        let found = BINDINGS.iter().find(|binding| {
            binding.keys.contains(&key)
                && (binding.repeats || !repeat)
                && match binding.shift {
                    Shift::Any => true,
                    Shift::Held => modifiers.shift,
                    Shift::Not => !modifiers.shift,
                }
        });
        actions.extend(found.map(|binding| binding.action));
    }
    actions
}
