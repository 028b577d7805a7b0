//! What the panel would compare: a setting of the scene, and the values to run it with.

use lahar_scene::scene::Comparison;

use crate::scenes::{Setting, SettingValue};

/// A comparison being put together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComparisonDraft {
    /// The setting, by its key; empty before there is a scene.
    pub key: String,
    /// The values, the scene's own first at first.
    pub values: Vec<SettingValue>,
}

impl ComparisonDraft {
    /// Another scene, or the same with other settings: keeps to what is compared, or suggests something.
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
            // A comparison by a key that the panel does not offer.
            (_, Some(_)) | (None, None) => *self = Self::default(),
        }
    }

    /// A setting, with its value and another one.
    pub fn choose(&mut self, setting: &Setting) {
        self.key.clone_from(&setting.key);
        self.values = vec![setting.value.clone(), setting.value.another()];
    }

    /// One value more.
    pub fn add(&mut self) {
        if let Some(last) = self
            .values
            .last()
            .filter(|_| self.values.len() < Comparison::MOST)
        {
            self.values.push(last.another());
        }
    }

    /// What it comes to; `None` if there is nothing to compare.
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
    /// Something to compare it with: the next word, twice the number.
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

    /// The value that `text` writes, of this one's kind.
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
    fn a_setting_is_compared_with_something_else_and_never_with_itself() {
        let mut draft = ComparisonDraft::default();
        assert_eq!(draft.comparison(), None);
        draft.offer(&[transfer()], None);
        let comparison = draft.comparison().unwrap();
        assert_eq!(comparison.to_string(), "transfer=\"apic\",\"pic\"");
        draft.add();
        draft.add();
        draft.add();
        assert_eq!(draft.values.len(), Comparison::MOST);
        // The fourth word is the first again.
        assert_eq!(draft.comparison().unwrap().values.len(), 3);
    }

    #[test]
    fn what_was_asked_for_on_the_command_line_is_in_the_panel() {
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
