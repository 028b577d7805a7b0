//! The comparison that the panel is putting together: a setting of the scene, and values for it.

use lahar_scene::scene::{Comparison, Setting, SettingValue};

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
                    .map(|value| like(&setting.value, value))
                    .collect();
            }
            // The panel does not offer the key of the comparison that runs, or there are no settings.
            (_, Some(_)) | (None, None) => *self = Self::default(),
        }
    }

    /// Chooses a setting, with its value and another one.
    pub fn choose(&mut self, setting: &Setting) {
        self.key.clone_from(&setting.key);
        self.values = vec![setting.value.clone(), another(&setting.value)];
    }

    /// Adds one more value.
    pub fn add(&mut self) {
        if let Some(last) = self
            .values
            .last()
            .filter(|_| self.values.len() < Comparison::MOST)
        {
            self.values.push(another(last));
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

/// A value to compare `value` with: the next word, or twice the number.
fn another(value: &SettingValue) -> SettingValue {
    match value {
        SettingValue::Number(number) if *number == 0.0 => SettingValue::Number(1.0),
        SettingValue::Number(number) => SettingValue::Number(2.0 * number),
        SettingValue::Word(word, words) => {
            let at = words.iter().position(|other| other == word);
            let next = words[at.map_or(0, |at| (at + 1) % words.len())];
            SettingValue::Word(next.to_owned(), words)
        }
    }
}

/// Reads a value of the same kind as `value` from `text`.
fn like(value: &SettingValue, text: &str) -> SettingValue {
    match value {
        SettingValue::Number(number) => SettingValue::Number(text.parse().unwrap_or(*number)),
        SettingValue::Word(_, words) => {
            SettingValue::Word(text.trim_matches(['"', '\'']).to_owned(), words)
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
