//! The keys: one table, from which come what they do, the hints in the window and on the terminal.

use eframe::egui::{Event, InputState, Key, Modifiers};

/// A direction of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Upward.
    Up,
    /// Downward.
    Down,
}

impl Direction {
    /// To the right and up, in −1..1.
    pub fn step(self) -> [f64; 2] {
        match self {
            Self::Left => [-1.0, 0.0],
            Self::Right => [1.0, 0.0],
            Self::Up => [0.0, 1.0],
            Self::Down => [0.0, -1.0],
        }
    }
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
    /// Turns gravity; in a recording, to another frame.
    Gravity(Direction),
    /// Stops or goes on.
    Pause,
    /// One substep; in a recording, one frame.
    Substep,
    /// In a recording, one frame back.
    Back,
    /// Several values of a setting side by side, or the scene alone again.
    Compare,
    /// More simulated seconds a second.
    Faster,
    /// Fewer.
    Slower,
    /// The next thing to color by.
    Colors,
    /// The whole scene in view.
    Fit,
    /// Orbits; in 2D, moves the view.
    Turn(Direction),
    /// Moves the view.
    Move(Direction),
    /// Enlarges.
    Nearer,
    /// Makes smaller.
    Farther,
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

/// What must be held beside the key.
#[derive(Clone, Copy, PartialEq, Eq)]
enum With {
    /// Nothing, or Shift: some keyboards need it for + and the like.
    Any,
    Nothing,
    Shift,
    Ctrl,
}

impl With {
    fn agrees(self, held: Modifiers) -> bool {
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
    with: With,
    /// Goes on while the key is held.
    repeats: bool,
    action: Action,
}

const fn key(keys: &'static [Key], action: Action) -> Binding {
    Binding {
        keys,
        with: With::Any,
        repeats: false,
        action,
    }
}

const fn with(with: With, keys: &'static [Key], action: Action) -> Binding {
    Binding {
        with,
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
    repeating(with(With::Shift, key, Action::Turn(direction)))
}

const fn shift_view(key: &'static [Key], direction: Direction) -> Binding {
    repeating(with(With::Ctrl, key, Action::Move(direction)))
}

const fn gravity(keys: &'static [Key], direction: Direction) -> Binding {
    with(With::Nothing, keys, Action::Gravity(direction))
}

const BINDINGS: &[Binding] = &[
    with(With::Nothing, &[Key::R], Action::Restart),
    with(With::Shift, &[Key::R], Action::DefaultScene),
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

/// Keys of a simulation.
const LIVE: &[Hint] = &[
    hint("R", "restart (Shift+R: the default fluid scene)"),
    hint("Space", "pause or go on, . one substep"),
    hint("W A S D, arrows", "turn gravity"),
    hint("V", "compare: one scene, two settings"),
];

/// Keys of a recording.
const REPLAY: &[Hint] = &[
    hint("R", "from its start (Shift+R: the default fluid scene)"),
    hint("Space", "pause or go on"),
    hint(", .", "one frame back, on"),
    hint("arrows", "one frame, ten frames"),
];

/// Keys of both.
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

const HAND_2D: &[Hint] = &[
    hint("left, right button", "attract, repel"),
    hint("Ctrl+drag", "drag along"),
];

const PUSH_2D: &[Hint] = &[
    hint("left, right button", "push, pull"),
    hint("Ctrl+drag", "drag along"),
];

const HAND_3D: &[Hint] = &[
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

/// The keys and the mouse for people, for what is in sight: a recording or a simulation, and a hand
/// that `pushes` or attracts.
pub fn hints(recorded: bool, dimension: usize, pushes: bool) -> Vec<Hint> {
    let (hand, view) = match (dimension, pushes) {
        (3, false) => (HAND_3D, VIEW_3D),
        (3, true) => (PUSH_3D, VIEW_3D),
        (_, false) => (HAND_2D, VIEW_2D),
        (_, true) => (PUSH_2D, VIEW_2D),
    };
    if recorded {
        [REPLAY, ALWAYS, view].concat()
    } else {
        [LIVE, ALWAYS, hand, view].concat()
    }
}

const fn hint(keys: &'static str, does: &'static str) -> Hint {
    Hint { keys, does }
}

/// The keys and the mouse, a line each, for a terminal.
pub fn key_help() -> String {
    let mut help = String::new();
    for (title, lists) in [
        ("Keys:", &[LIVE, ALWAYS][..]),
        ("Mouse in 2D:", &[HAND_2D, VIEW_2D]),
        ("Mouse in 3D:", &[HAND_3D, VIEW_3D]),
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
    (BINDINGS.iter()).find(|binding| binding.keys.contains(&key) && binding.with.agrees(held))
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
        if focused && key != Key::F12 {
            continue;
        }
        let found = binding(key, modifiers).filter(|binding| binding.repeats || !repeat);
        actions.extend(found.map(|binding| binding.action));
    }
    actions
}

/// The direction whose key is down: `before` as long as it is.
pub fn held_direction(input: &InputState, before: Option<Direction>) -> Option<Direction> {
    let is_held = |binding: &&Binding| {
        binding.with.agrees(input.modifiers)
            && binding.keys.iter().any(|key| input.keys_down.contains(key))
    };
    let held = (BINDINGS.iter().filter(is_held)).filter_map(|binding| match binding.action {
        Action::Gravity(direction) => Some(direction),
        _ => None,
    });
    let held: Vec<Direction> = held.collect();
    (before.filter(|before| held.contains(before))).or(held.first().copied())
}
