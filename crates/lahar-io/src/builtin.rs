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
};

/// All of them, the default first.
pub fn list() -> &'static [Builtin] {
    SCENES
}

/// The built-in scene called `name`, validation scenes included.
pub fn find(name: &str) -> Option<&'static Builtin> {
    SCENES.iter().find(|scene| scene.name == name)
}
