//! The comparison that the panel is putting together: a setting of the scene, and values for it.

use lahar_scene::scene::Comparison;

use crate::scenes::{Setting, SettingValue};

/// A setting and the values to compare.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComparisonDraft {
    /// The key of the setting; empty before there is a scene.
    pub key: String,
    /// The values, at first the scene's own and another one.
    pub values: Vec<SettingValue>,
}

impl ComparisonDraft {
    /// Takes over the settings of a scene that was opened: keeps the comparison that runs, or else suggests one.
    pub(crate) fn offer(&mut self, settings: &[Setting], running: Option<&Comparison>) {
        if running.is_some_and(|running| running.key == self.key) {
            return;
        }
        let wanted = running.map_or("transfer", |running| &running.key);
        let found = settings.iter().find(|setting| setting.key == wanted);
        match (found.or(settings.first()), running) {
            (Some(setting), None) => self.choose(setting),
            (Some(setting), Some(running)) if setting.key == running.key => {
                self.key.clone_from(&setting.key);
                self.values = (running.values.iter())
                    .map(|value| setting.value.like(value))
                    .collect();
            }
            // The panel does not offer the key of the comparison that runs, or there are no settings.
            (_, Some(_)) | (None, None) => *self = Self::default(),
        }
    }

    /// Chooses a setting, with its value and another one.
    pub fn choose(&mut self, setting: &Setting) {
        self.key.clone_from(&setting.key);
        self.values = vec![setting.value.clone(), setting.value.another()];
    }

    /// Adds one more value.
    pub fn add(&mut self) {
        if let Some(last) = self
            .values
            .last()
            .filter(|_| self.values.len() < Comparison::MOST)
        {
            self.values.push(last.another());
        }
    }

    /// The comparison; `None` if it has fewer than two different values.
    pub fn comparison(&self) -> Option<Comparison> {
        let mut values: Vec<String> = vec![];
        for value in self.values.iter().map(SettingValue::to_toml) {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        (values.len() > 1).then(|| Comparison {
            key: self.key.clone(),
            values,
        })
    }
}

impl SettingValue {
    /// A value to compare this one with: the next word, or twice the number.
    fn another(&self) -> Self {
        match self {
            Self::Number(number) if *number == 0.0 => Self::Number(1.0),
            Self::Number(number) => Self::Number(2.0 * number),
            Self::Word(word, words) => {
                let at = words.iter().position(|other| other == word);
                let next = words[at.map_or(0, |at| (at + 1) % words.len())];
                Self::Word(next.to_owned(), words)
            }
        }
    }

    /// Reads a value of the same kind from `text`.
    fn like(&self, text: &str) -> Self {
        match self {
            Self::Number(number) => Self::Number(text.parse().unwrap_or(*number)),
            Self::Word(_, words) => Self::Word(text.trim_matches(['"', '\'']).to_owned(), words),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transfer() -> Setting {
        Setting {
            key: "transfer".into(),
            group: "scene".into(),
            name: "transfer".into(),
            value: SettingValue::Word("apic".into(), &["apic", "pic", "flip"]),
        }
    }

    #[test]
    fn a_setting_is_never_compared_with_itself() {
        let mut draft = ComparisonDraft::default();
        assert_eq!(draft.comparison(), None);
        draft.offer(&[transfer()], None);
        let comparison = draft.comparison().unwrap();
        assert_eq!(comparison.to_string(), "transfer=\"apic\",\"pic\"");
        draft.add();
        draft.add();
        draft.add();
        assert_eq!(draft.values.len(), Comparison::MOST);
        // The fourth word is the first one again.
        assert_eq!(draft.comparison().unwrap().values.len(), 3);
    }

    #[test]
    fn the_panel_shows_the_comparison_of_the_command_line() {
        let mut draft = ComparisonDraft::default();
        let running: Comparison = "transfer=pic,flip".parse().unwrap();
        draft.offer(&[transfer()], Some(&running));
        assert_eq!(
            draft.comparison().unwrap().to_string(),
            "transfer=\"pic\",\"flip\""
        );
        let other: Comparison = "seed=1,2".parse().unwrap();
        draft.offer(&[transfer()], Some(&other));
        assert_eq!(draft.comparison(), None);
    }
}
