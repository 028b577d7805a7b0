//! The keys: a table of key bindings, and the hints for window and terminal.

use eframe::egui::{Event, InputState, Key, Modifiers};

/// A direction of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the left of the window.
    Left,
    /// To the right of the window.
    Right,
    /// To the top of the window.
    Up,
    /// To the bottom of the window.
    Down,
}

impl Direction {
    /// The steps to the right and up, each −1, 0 or 1.
    pub fn step(self) -> [f64; 2] {
        match self {
            Self::Left => [-1.0, 0.0],
            Self::Right => [1.0, 0.0],
            Self::Up => [0.0, 1.0],
            Self::Down => [0.0, -1.0],
        }
    }
}

/// The action of a key or a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Restarts the scene.
    Restart,
    /// Opens the default fluid scene.
    DefaultScene,
    /// Opens the scene at this place of the list, counted from 0.
    Scene(usize),
    /// Shows or hides the list of scenes.
    SceneList,
    /// Turns gravity; in a recording, goes to another frame.
    Gravity(Direction),
    /// Pauses or continues.
    Pause,
    /// Takes one substep; in a recording, goes one frame on.
    Substep,
    /// In a recording, goes one frame back.
    Back,
    /// Runs several values of a setting side by side, or the scene alone again.
    Compare,
    /// Simulates more seconds per second.
    Faster,
    /// Simulates fewer seconds per second.
    Slower,
    /// Colors particles by the next quantity.
    Colors,
    /// Fits the view to the scene.
    Fit,
    /// Orbits the camera; in 2D, moves the view.
    Turn(Direction),
    /// Moves the view in this direction.
    Move(Direction),
    /// Enlarges the scene.
    Nearer,
    /// Makes the scene smaller.
    Farther,
    /// Saves the window as a PNG file.
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
    /// The names of the keys.
    pub keys: &'static str,
    /// Their action, in a few words.
    pub does: &'static str,
}

/// The modifier keys that must be down with a key.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ModifierRule {
    /// None or Shift, which some keyboards need for + and the like.
    Any,
    Nothing,
    Shift,
    Ctrl,
}

impl ModifierRule {
    fn allows(self, held: Modifiers) -> bool {
        let ctrl = held.ctrl || held.mac_cmd;
        !held.alt
            && match self {
                Self::Any => !ctrl,
                Self::Nothing => !ctrl && !held.shift,
                Self::Shift => !ctrl && held.shift,
                Self::Ctrl => ctrl && !held.shift,
            }
    }
}

struct Binding {
    keys: &'static [Key],
    modifiers: ModifierRule,
    /// True if the action repeats while the key is down.
    repeats: bool,
    action: Action,
}

const fn key(keys: &'static [Key], action: Action) -> Binding {
    Binding {
        keys,
        modifiers: ModifierRule::Any,
        repeats: false,
        action,
    }
}

const fn with(modifiers: ModifierRule, keys: &'static [Key], action: Action) -> Binding {
    Binding {
        modifiers,
        ..key(keys, action)
    }
}

const fn repeating(binding: Binding) -> Binding {
    Binding {
        repeats: true,
        ..binding
    }
}

const fn turn(key: &'static [Key], direction: Direction) -> Binding {
    repeating(with(ModifierRule::Shift, key, Action::Turn(direction)))
}

const fn shift_view(key: &'static [Key], direction: Direction) -> Binding {
    repeating(with(ModifierRule::Ctrl, key, Action::Move(direction)))
}

const fn gravity(keys: &'static [Key], direction: Direction) -> Binding {
    with(ModifierRule::Nothing, keys, Action::Gravity(direction))
}

const BINDINGS: &[Binding] = &[
    with(ModifierRule::Nothing, &[Key::R], Action::Restart),
    with(ModifierRule::Shift, &[Key::R], Action::DefaultScene),
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
    gravity(&[Key::A, Key::ArrowLeft], Direction::Left),
    gravity(&[Key::D, Key::ArrowRight], Direction::Right),
    gravity(&[Key::W, Key::ArrowUp], Direction::Up),
    gravity(&[Key::S, Key::ArrowDown], Direction::Down),
    turn(&[Key::ArrowLeft], Direction::Left),
    turn(&[Key::ArrowRight], Direction::Right),
    turn(&[Key::ArrowUp], Direction::Up),
    turn(&[Key::ArrowDown], Direction::Down),
    shift_view(&[Key::ArrowLeft], Direction::Left),
    shift_view(&[Key::ArrowRight], Direction::Right),
    shift_view(&[Key::ArrowUp], Direction::Up),
    shift_view(&[Key::ArrowDown], Direction::Down),
    repeating(key(&[Key::PageUp], Action::Nearer)),
    repeating(key(&[Key::PageDown], Action::Farther)),
    key(&[Key::F, Key::Home], Action::Fit),
    key(&[Key::Space], Action::Pause),
    repeating(key(&[Key::Period], Action::Substep)),
    repeating(key(&[Key::Comma], Action::Back)),
    repeating(key(&[Key::Plus, Key::Equals], Action::Faster)),
    repeating(key(&[Key::Minus], Action::Slower)),
    key(&[Key::C], Action::Colors),
    key(&[Key::V], Action::Compare),
    key(&[Key::F12], Action::Screenshot),
    key(&[Key::H], Action::Hints),
    key(&[Key::P], Action::Panel),
    key(&[Key::Escape], Action::Leave),
];

/// Keys while a simulation runs.
const LIVE: &[Hint] = &[
    hint("R", "restart (Shift+R: the default fluid scene)"),
    hint("Space", "pause or go on, . one substep"),
    hint("W A S D, arrows", "turn gravity"),
    hint("V", "compare: one scene, two settings"),
];

/// Keys while a recording is replayed.
const REPLAY: &[Hint] = &[
    hint("R", "from its start (Shift+R: the default fluid scene)"),
    hint("Space", "pause or go on"),
    hint(", .", "one frame back, on"),
    hint("arrows", "one frame, ten frames"),
];

/// Keys that work in both cases.
const ALWAYS: &[Hint] = &[
    hint("1 to 9", "choose a scene, L: any of them, by typing"),
    hint("+ -", "faster, slower"),
    hint("C", "colors: material, body, speed, pressure, density, J"),
    hint("Shift, Ctrl+arrows", "orbit, move the view"),
    hint("Page Up, Down", "zoom, F: fit the view"),
    hint("Tab, Esc", "into the panel, out of it; Esc: leave"),
    hint("P, H", "panel, these hints"),
    hint("F12", "screenshot"),
];

const ATTRACT_2D: &[Hint] = &[
    hint("left, right button", "attract, repel"),
    hint("Ctrl+drag", "drag along"),
];

const PUSH_2D: &[Hint] = &[
    hint("left, right button", "push, pull"),
    hint("Ctrl+drag", "drag along"),
];

const ATTRACT_3D: &[Hint] = &[
    hint("Shift+left, right", "attract, repel"),
    hint("Ctrl+drag", "drag along"),
];

const PUSH_3D: &[Hint] = &[
    hint("Shift+left, right", "push, pull"),
    hint("Ctrl+drag", "drag along"),
];

const VIEW_2D: &[Hint] = &[hint("wheel, middle-drag", "zoom, pan")];

const VIEW_3D: &[Hint] = &[
    hint("drag", "orbit"),
    hint("wheel, middle-drag", "zoom, pan"),
];

/// The key and mouse hints for a recording or a simulation. In the latter the pointer attracts nodes, or pushes
/// particles if `pushes` is true.
pub fn hints(recorded: bool, dimension: usize, pushes: bool) -> Vec<Hint> {
    let (pointer, view) = match (dimension, pushes) {
        (3, false) => (ATTRACT_3D, VIEW_3D),
        (3, true) => (PUSH_3D, VIEW_3D),
        (_, false) => (ATTRACT_2D, VIEW_2D),
        (_, true) => (PUSH_2D, VIEW_2D),
    };
    if recorded {
        [REPLAY, ALWAYS, view].concat()
    } else {
        [LIVE, ALWAYS, pointer, view].concat()
    }
}

const fn hint(keys: &'static str, does: &'static str) -> Hint {
    Hint { keys, does }
}

/// The key and mouse hints, one per line, for a terminal.
pub fn key_help() -> String {
    let mut help = String::new();
    for (title, lists) in [
        ("Keys:", &[LIVE, ALWAYS][..]),
        ("Mouse in 2D:", &[ATTRACT_2D, VIEW_2D]),
        ("Mouse in 3D:", &[ATTRACT_3D, VIEW_3D]),
        ("Keys of a recording:", &[REPLAY]),
    ] {
        help.push_str(title);
        help.push('\n');
        for hint in lists.concat() {
            help.push_str(&format!("  {:<19} {}\n", hint.keys, hint.does));
        }
    }
    help
}

fn binding(key: Key, held: Modifiers) -> Option<&'static Binding> {
    (BINDINGS.iter()).find(|binding| binding.keys.contains(&key) && binding.modifiers.allows(held))
}

/// The actions of the keys pressed in this frame. While a widget of the panel has the keyboard (`focused`), only F12
/// acts, and all other keys are the widget's.
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
        if focused && key != Key::F12 {
            continue;
        }
        let found = binding(key, modifiers).filter(|binding| binding.repeats || !repeat);
        actions.extend(found.map(|binding| binding.action));
    }
    actions
}

/// The gravity key that is down. If several are, it is `before` as long as that one is down, and else the first.
pub fn held_direction(input: &InputState, before: Option<Direction>) -> Option<Direction> {
    let is_held = |binding: &&Binding| {
        binding.modifiers.allows(input.modifiers)
            && binding.keys.iter().any(|key| input.keys_down.contains(key))
    };
    let held = (BINDINGS.iter().filter(is_held)).filter_map(|binding| match binding.action {
        Action::Gravity(direction) => Some(direction),
        _ => None,
    });
    let held: Vec<Direction> = held.collect();
    (before.filter(|before| held.contains(before))).or(held.first().copied())
}
