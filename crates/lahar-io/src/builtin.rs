//! Scenes that ship with the program.

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// What it is called on the command line.
    pub name: &'static str,
    /// A few words.
    pub title: &'static str,
    /// What one sees, in one sentence.
    pub summary: &'static str,
    /// 2 or 3.
    pub dimension: usize,
    /// The scene file.
    pub text: &'static str,
    /// Files that it names, by name.
    pub files: &'static [(&'static str, &'static str)],
}

macro_rules! scenes {
    ($($name:literal $dimension:literal $title:literal $summary:literal;)*) => {
        &[$(Builtin {
            name: $name,
            title: $title,
            summary: $summary,
            dimension: $dimension,
            text: include_str!(concat!("../scenes/", $name, ".toml")),
            files: &[],
        }),*]
    };
}

const SCENES: &[Builtin] = scenes! {
    "dam-break" 2 "Dam break" "A column of water collapses, runs along the floor and climbs the far wall.";
    "dam-break-3d" 3 "Dam break in 3D" "The same in a tank: a sheet of water shoots up the far wall and falls back.";
    "double-dam" 2 "Double dam" "Two dyed columns of water run towards each other and throw up a jet where they meet.";
    "water-jelly-snow" 2 "Water, jelly and snow" "A block of each falls into a pool: water splashes, jelly floats, snow breaks up.";
    "water-jelly-snow-3d" 3 "Water, jelly and snow in 3D" "Cubes of water and jelly and a ball of snow fall into a pool.";
    "jelly-drop" 2 "Jelly drop" "Jellies of three firmnesses fall: the soft one spreads, the firm one jumps.";
    "snowball" 2 "Snowball" "A thrown snowball bursts on a wall.";
    "mpm88" 2 "mpm88" "The fluid square of Taichi's mpm88.py, with its constants, walls and time step.";
};

/// Scenes with published numbers to compare with; not listed, but found by name.
const VALIDATION: &[Builtin] = &[Builtin {
    name: "k7-mpm88-regression",
    title: "mpm88, the regression of the Taichi project",
    summary: "64 x 64 particles of mpm88's fluid on given places; moments of their positions are known at substep 500.",
    dimension: 2,
    text: include_str!("../scenes/validation/k7-mpm88-regression.toml"),
    files: &[(
        "k7-mpm88-regression.csv",
        include_str!("../scenes/validation/k7-mpm88-regression.csv"),
    )],
}];

/// The scenes to show, the default first.
pub fn list() -> &'static [Builtin] {
    SCENES
}

/// The scenes to validate by.
pub fn validation() -> &'static [Builtin] {
    VALIDATION
}

/// The built-in scene called `name`.
pub fn find(name: &str) -> Option<&'static Builtin> {
    SCENES
        .iter()
        .chain(VALIDATION)
        .find(|scene| scene.name == name)
}
