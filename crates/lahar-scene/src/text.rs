//! Text: names of axes, numbers and names as messages show them, lines of files.

use crate::error::SceneError;

/// Names of the axes.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// Characters of a name or value that a message shows.
const SHOWN: usize = 40;

/// Bytes of a broken file that a message shows after the first bad one.
const SHOWN_AFTER: usize = 100;

/// Returns the first forty characters of a text, on one line.
pub(crate) fn shorten(text: &str) -> String {
    let clean: String = text
        .chars()
        .take(SHOWN)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().count() > SHOWN {
        clean + "..."
    } else {
        clean
    }
}

/// Returns a number without the noise of subtraction in its last digits.
pub(crate) fn tidy(number: f64) -> f64 {
    format!("{number:.12}").parse().unwrap_or(number)
}

/// Returns a point as messages show it: "(1, 0.5)".
pub(crate) fn point(p: &[f64]) -> String {
    let parts: Vec<String> = p.iter().map(|x| tidy(*x).to_string()).collect();
    format!("({})", parts.join(", "))
}

/// Returns a count as messages show it.
pub(crate) fn count_words(count: f64) -> String {
    if count >= 1e7 {
        format!("{count:.1e}")
    } else {
        format!("{count:.0}")
    }
}

/// Returns the error of a file whose byte number `at` is no UTF-8.
pub(crate) fn not_text(path: &str, bytes: &[u8], at: usize) -> SceneError {
    let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(at + SHOWN_AFTER)]);
    let message = format!("this is not a text file: byte {at} is no UTF-8");
    SceneError::at(path, &shown, at, at + 1, message)
}

/// The lines of a text without their ends, each with the byte at which it starts.
pub(crate) struct Lines<'a> {
    pub(crate) text: &'a str,
    /// The byte at which the next line starts.
    pub(crate) at: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.text.get(self.at..).filter(|rest| !rest.is_empty())?;
        let start = self.at;
        let line = rest.split('\n').next().unwrap_or(rest);
        self.at += line.len() + 1;
        Some((start, line.strip_suffix('\r').unwrap_or(line)))
    }
}
