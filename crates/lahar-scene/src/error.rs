//! The one error type of this crate: the fault of a scene, its line, and what to write instead.
//!
//! ```text
//! error: unknown key "gravty"
//!  --> scenes/dam.toml:4:1
//!   |
//! 4 | gravty = [0.0, -9.81]
//!   | ^^^^^^
//!   = help: did you mean "gravity"?
//! ```

use core::fmt;

/// Longest part of a line that is shown \[characters\]. Lines of particle files may have any length.
const SHOWN: usize = 120;

/// A fault of a scene, an override, or a file that the scene names.
///
/// ```
/// use lahar_scene::scene::Scene;
///
/// let error = Scene::parse("gravty = [0.0, -9.81]", "dam.toml", &[]).unwrap_err();
/// assert_eq!((error.line, error.column), (1, 1));
/// assert_eq!(error.hint.as_deref(), Some("did you mean \"gravity\"?"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The file, the built-in scene or the override ("--set dx").
    pub file: String,
    /// Line, counted from 1; 0 for an error of the whole file.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// Number of characters that the error points at.
    pub length: usize,
    /// The text of the line.
    pub text: String,
    /// The fault, in words.
    pub message: String,
    /// Advice on what to do.
    pub hint: Option<String>,
}

impl SceneError {
    /// Makes an error of a whole file.
    pub fn of_file(file: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            line: 0,
            column: 0,
            length: 0,
            text: String::new(),
            message: message.into(),
            hint: None,
        }
    }

    /// Makes an error that points at the bytes `start..end` of `text`, the content of `file`.
    pub fn at(
        file: impl Into<String>,
        text: &str,
        start: usize,
        end: usize,
        message: impl Into<String>,
    ) -> Self {
        let start = floor_boundary(text, start.min(text.len()));
        let end = floor_boundary(text, end.clamp(start, text.len()));
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let line = &text[line_start..line_end];
        Self {
            file: file.into(),
            line: text[..line_start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            length: text[start..end.min(line_end).max(start)].chars().count(),
            text: line.strip_suffix('\r').unwrap_or(line).to_owned(),
            message: message.into(),
            hint: None,
        }
    }

    /// Returns the error with advice added.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Returns the error as text of several lines, with terminal colors if `color` is true.
    pub fn render(&self, color: bool) -> String {
        let paint = |code: &str, text: &str| {
            if color {
                format!("\u{1b}[{code}m{text}\u{1b}[0m")
            } else {
                text.to_owned()
            }
        };
        let mut out = format!("{}: {}\n", paint("1;31", "error"), self.message);
        let number = self.line.to_string();
        let margin = " ".repeat(if self.line == 0 { 1 } else { number.len() });
        let arrow = paint("34", "-->");
        let bar = paint("34", "|");
        if self.line == 0 {
            out += &format!("{margin}{arrow} {}\n", self.file);
        } else {
            let (shown, column, length) = self.excerpt();
            let caret = format!("{}{}", " ".repeat(column), "^".repeat(length));
            out += &format!(
                "{margin}{arrow} {}:{}:{}\n{margin} {bar}\n{} {bar} {shown}\n{margin} {bar} {}\n",
                self.file,
                self.line,
                self.column,
                paint("34", &number),
                paint("1;31", &caret),
            );
        }
        if let Some(hint) = &self.hint {
            out += &format!("{margin} {} {hint}\n", paint("34", "= help:"));
        }
        out
    }

    /// Returns the part of the line around the column, in characters that take one place each, and the offset
    /// and length of the caret in it.
    fn excerpt(&self) -> (String, usize, usize) {
        let column = self.column.saturating_sub(1);
        let first = if column < SHOWN {
            0
        } else {
            column - SHOWN / 2
        };
        let clean = |c: char| if c.is_control() { '\u{b7}' } else { c };
        let mut shown: String = self
            .text
            .chars()
            .skip(first)
            .take(SHOWN)
            .map(|c| if c == '\t' { ' ' } else { clean(c) })
            .collect();
        let mut at = column - first;
        if first > 0 {
            shown.insert_str(0, "...");
            at += 3;
        }
        let room = shown.chars().count().saturating_sub(at);
        if self.text.chars().count() > first + SHOWN {
            shown += "...";
        }
        (
            shown.trim_end().to_owned(),
            at,
            self.length.min(room).max(1),
        )
    }
}

/// Returns the start of the character that byte `at` belongs to.
fn floor_boundary(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.render(false).trim_end())
    }
}

impl core::error::Error for SceneError {}

/// Returns the candidate nearest to `word`, if it is near enough to be meant.
pub(crate) fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let word = plain(word);
    candidates
        .into_iter()
        .map(|candidate| (distance(&word, &plain(candidate)), candidate))
        .filter(|(distance, candidate)| {
            *distance <= 1 + candidate.chars().count().max(word.chars().count()) / 3
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// Returns the number of insertions, deletions, replacements and swaps of neighbors between two words.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().take(64).collect();
    let b: Vec<char> = b.chars().take(64).collect();
    let mut before = vec![0; b.len() + 1];
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut next = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replace = row[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            next[j] = replace.min(row[j] + 1).min(next[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                next[j] = next[j].min(before[j - 2] + 1);
            }
        }
        before = core::mem::replace(&mut row, next);
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(distance("gravity", "gravity"), 0);
        assert_eq!(distance("gravty", "gravity"), 1);
        assert_eq!(distance("grvaity", "gravity"), 1);
        assert_eq!(distance("", "dx"), 2);
    }

    #[test]
    fn nearest_needs_likeness() {
        assert_eq!(nearest("Gravty", ["dx", "gravity"]), Some("gravity"));
        assert_eq!(
            nearest("poison_ratio", ["density", "poisson_ratio"]),
            Some("poisson_ratio")
        );
        assert_eq!(nearest("zebra", ["density", "gravity"]), None);
    }

    #[test]
    fn place_in_the_text() {
        let error = SceneError::at("a.toml", "one\ntwö = 3\r\n", 11, 12, "no");
        assert_eq!((error.line, error.column, error.length), (2, 7, 1));
        assert_eq!(error.text, "twö = 3");
        let end = SceneError::at("a.toml", "one", 99, 120, "no");
        assert_eq!((end.line, end.column, end.length), (1, 4, 0));
    }

    #[test]
    fn long_lines_are_cut_around_the_caret() {
        let text = "x".repeat(5000);
        let rendered = SceneError::at("a", &text, 4000, 4001, "no").render(false);
        assert!(rendered.lines().all(|line| line.len() < 150), "{rendered}");
        assert!(rendered.contains('^'));
    }
}
