//! The quantities that particles can be colored by, with their words in scene files.

/// A quantity that particles are colored by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// The particle's material.
    #[default]
    Material,
    /// The particle's body.
    Body,
    /// The speed |v| \[m/s\].
    Speed,
    /// The pressure −tr σ/d \[Pa\].
    Pressure,
    /// The Jacobian J = V/V⁰.
    Jacobian,
    /// The density m/(J V⁰) \[kg/m³; kg/m² in 2D\].
    Density,
}

impl ColorBy {
    /// All quantities, in the order of [`Self::WORDS`].
    pub const ALL: [Self; 6] = [
        Self::Material,
        Self::Body,
        Self::Speed,
        Self::Pressure,
        Self::Jacobian,
        Self::Density,
    ];

    /// Their words in scene files.
    pub const WORDS: [&'static str; 6] = ["material", "body", "speed", "pressure", "J", "density"];

    /// The quantity of a word in scene files.
    pub fn from_word(word: &str) -> Option<Self> {
        let place = Self::WORDS.iter().position(|known| *known == word)?;
        Some(Self::ALL[place])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_to_color_by_are_one_each() {
        for (by, word) in ColorBy::ALL.into_iter().zip(ColorBy::WORDS) {
            assert_eq!(ColorBy::from_word(word), Some(by));
        }
        assert_eq!(ColorBy::from_word("taste"), None);
    }
}
