//! Keys of scene files: names, kinds, units and defaults. The tables of keys are made of these.

use super::formula::Variables;

/// A table of a scene file.
#[derive(Debug)]
pub(crate) struct Section {
    /// The name in the documentation: "scene", "domain", "material: fluid".
    pub(crate) name: &'static str,
    /// The spelling in scene files: "[domain]".
    pub(crate) header: &'static str,
    /// The keys, in the order of the documentation.
    pub(crate) keys: &'static [&'static [Key]],
}

impl Section {
    pub(crate) fn keys(&self) -> impl Iterator<Item = &'static Key> {
        self.keys.iter().flat_map(|keys| keys.iter())
    }

    pub(crate) fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys().find(|key| key.name == name)
    }
}

/// A key of a table.
#[derive(Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    /// The unit in 3D. Units in 2D are per meter of depth.
    pub(crate) unit: &'static str,
    pub(crate) default: WhenAbsent,
    /// One sentence about the key, for the documentation.
    pub(crate) about: &'static str,
    pub(crate) only_3d: bool,
}

/// The default of a key.
#[derive(Clone, Copy, Debug)]
pub(crate) enum WhenAbsent {
    /// None: its absence is an error.
    Required,
    /// A value in TOML.
    Value(&'static str),
    /// A value in TOML for 2D, and one for 3D.
    ByDimension(&'static str, &'static str),
    /// A default that these words describe and the reader computes.
    Words(&'static str),
}

/// The kind of a key's value.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    Text,
    /// A color, "#rrggbb".
    Color,
    Number(Bound),
    /// `true` or `false`.
    Flag,
    /// A whole number between two bounds, both included.
    Integer(i64, i64),
    /// A list of D numbers.
    Vector,
    /// D numbers or expressions.
    Formulas(Variables),
    /// A number in 2D, three in 3D.
    Rotation,
    /// D rows of D numbers.
    Matrix,
    /// A list of points of D numbers.
    Points,
    /// Two numbers, the lower first.
    Interval,
    /// Two whole numbers above 0.
    Size,
    Word(&'static [&'static str]),
    Words(&'static [&'static str]),
    /// Names of particle fields.
    Fields,
    /// One of several kinds. The first one with the TOML type of the value decides.
    OneOf(&'static [Kind]),
    Table(&'static Section),
    /// A list of tables, `[[name]]`.
    Tables(&'static Section),
    /// The tables `[materials.NAME]`, each with the keys of its model.
    Materials,
    /// A key reserved for a later version.
    Later,
}

/// The bounds of a number. NaN and infinite numbers are never allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bound {
    Any,
    Positive,
    NotNegative,
    /// From 0 to 1, both included.
    Part,
    /// Between −1 and ½, both excluded.
    Poisson,
}

impl Bound {
    pub(crate) fn allows(self, number: f64) -> bool {
        number.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => number > 0.0,
                Self::NotNegative => number >= 0.0,
                Self::Part => (0.0..=1.0).contains(&number),
                Self::Poisson => number > -1.0 && number < 0.5,
            }
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Any => "a number",
            Self::Positive => "a number above 0",
            Self::NotNegative => "a number, 0 or above",
            Self::Part => "a number from 0 to 1",
            Self::Poisson => "a number between -1 and 0.5",
        }
    }
}

impl Kind {
    /// Describes the kind, as in "must be ..".
    pub(crate) fn words(self, dimension: usize) -> String {
        match self {
            Self::Text => "text in quotes".to_owned(),
            Self::Color => "a color like \"#3d9be9\"".to_owned(),
            Self::Number(bound) => bound.words().to_owned(),
            Self::Flag => "true or false".to_owned(),
            Self::Integer(0, i64::MAX) => "a whole number, 0 or above".to_owned(),
            Self::Integer(low, i64::MAX) => format!("a whole number, {low} or above"),
            Self::Integer(low, high) => format!("a whole number from {low} to {high}"),
            Self::Vector => format!("{dimension} numbers, like {}", vector_example(dimension)),
            Self::Formulas(_) => format!(
                "{dimension} numbers or expressions, like {}",
                vector_example(dimension)
            ),
            Self::Rotation if dimension == 2 => "a number".to_owned(),
            Self::Rotation => "3 numbers, like [0.0, 0.0, 1.0]".to_owned(),
            Self::Matrix => format!("{dimension} rows of {dimension} numbers"),
            Self::Points => format!("a list of points of {dimension} numbers"),
            Self::Interval => "two numbers, the lower first".to_owned(),
            Self::Size => "two whole numbers, like [1280, 720]".to_owned(),
            Self::Word(words) => alternatives(words),
            Self::Words(words) => format!("a list of {}", alternatives(words)),
            Self::Fields => {
                "a list of particle fields, like [\"position\", \"velocity\"]".to_owned()
            }
            Self::OneOf(kinds) => kinds
                .iter()
                .map(|kind| kind.words(dimension))
                .collect::<Vec<_>>()
                .join(", or "),
            Self::Table(_) | Self::Materials => "a table".to_owned(),
            Self::Tables(_) => "a list of tables".to_owned(),
            Self::Later => "absent".to_owned(),
        }
    }
}

fn vector_example(dimension: usize) -> &'static str {
    if dimension == 2 {
        "[0.0, 1.0]"
    } else {
        "[0.0, 1.0, 0.0]"
    }
}

fn alternatives(words: &[&str]) -> String {
    words
        .iter()
        .map(|word| format!("\"{word}\""))
        .collect::<Vec<_>>()
        .join(" | ")
}

pub(crate) const fn key(
    name: &'static str,
    kind: Kind,
    unit: &'static str,
    default: WhenAbsent,
    about: &'static str,
) -> Key {
    Key {
        name,
        kind,
        unit,
        default,
        about,
        only_3d: false,
    }
}

/// Returns the words of a table of words and meanings, which the reader of the key uses too.
pub(crate) const fn words<T, const N: usize>(
    choices: &[(&'static str, T); N],
) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = choices[i].0;
        i += 1;
    }
    words
}

pub(crate) const fn later(name: &'static str) -> Key {
    key(name, Kind::Later, "", WhenAbsent::Words(""), "")
}

pub(crate) const fn only_3d(mut key: Key) -> Key {
    key.only_3d = true;
    key
}

/// Reads a color "#rrggbb".
pub(crate) fn color(text: &str) -> Option<[u8; 3]> {
    let hex = text
        .strip_prefix('#')
        .filter(|hex| hex.len() == 6 && hex.is_ascii())?;
    let part = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).ok();
    Some([part(0)?, part(2)?, part(4)?])
}
