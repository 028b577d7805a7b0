//! Words of commands that a message suggests, quoted so that a shell reads them as they are.

use std::borrow::Cow;
use std::path::Path;

/// Quotes `word` if a shell would change it, as zsh does with brackets.
///
/// ```
/// use lahar_lab::shell::quoted;
///
/// assert_eq!(quoted("dx=0.01"), "dx=0.01");
/// assert_eq!(quoted("gravity=[0,-1.62]"), "'gravity=[0,-1.62]'");
/// ```
pub fn quoted(word: &str) -> Cow<'_, str> {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:=,+%@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        Cow::Borrowed(word)
    } else {
        Cow::Owned(format!("'{}'", word.replace('\'', r"'\''")))
    }
}

/// Quotes `path` if a shell would change it.
pub fn quoted_path(path: &Path) -> String {
    quoted(&path.to_string_lossy()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_special_characters_are_quoted() {
        assert_eq!(quoted("out/dam-break"), "out/dam-break");
        assert_eq!(quoted("dx=0.01"), "dx=0.01");
        assert_eq!(quoted("gravity=[0,-1.62]"), "'gravity=[0,-1.62]'");
        assert_eq!(quoted("my runs/it's"), r"'my runs/it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
