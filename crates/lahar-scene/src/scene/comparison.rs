//! Comparisons of one scene with several values of one key: `transfer=pic,apic`.

use std::fmt;
use std::str::FromStr;

/// A key of a scene and the values to set it to, one simulation per value.
///
/// ```
/// use lahar_scene::scene::Comparison;
///
/// let comparison: Comparison = "transfer=pic,apic".parse()?;
/// assert_eq!(comparison.values, ["pic", "apic"]);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comparison {
    /// The key, dotted as in `materials.water.viscosity`.
    pub key: String,
    /// The values in TOML, at least two and all different. Single words need no quotes.
    pub values: Vec<String>,
}

impl Comparison {
    /// Largest number of values. More pictures side by side would be too small.
    pub const MOST: usize = 4;

    /// Returns the overrides for each of the values: `base`, and then the key.
    pub fn overrides<'a>(
        &'a self,
        base: &'a [(String, String)],
    ) -> impl Iterator<Item = Vec<(String, String)>> + 'a {
        self.values.iter().map(move |value| {
            let mut all = base.to_vec();
            all.push((self.key.clone(), value.clone()));
            all
        })
    }

    /// Returns the title of each simulation: the key, and the value without quotes.
    pub fn titles(&self) -> impl Iterator<Item = String> + '_ {
        (self.values.iter()).map(|value| format!("{} = {}", self.key, value.trim_matches('"')))
    }
}

/// Writes the comparison as on the command line.
impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.values.join(","))
    }
}

impl FromStr for Comparison {
    type Err = String;

    /// Reads `KEY=A,B`. Commas inside brackets, braces and quotes belong to a value.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |why: &str| format!("{why}; write it as KEY=A,B, as in transfer=pic,apic");
        let (key, rest) = text
            .split_once('=')
            .ok_or_else(|| wrong("there is no \"=\""))?;
        let key = key.trim().to_owned();
        if key.is_empty() {
            return Err(wrong("there is no key"));
        }
        let values: Vec<String> = split(rest)
            .into_iter()
            .map(|value| value.trim().to_owned())
            .collect();
        if values.iter().any(String::is_empty) {
            return Err(wrong("a value is missing"));
        }
        if values.len() < 2 {
            return Err(wrong("one value is nothing to compare"));
        }
        for (i, value) in values.iter().enumerate() {
            if values[..i].contains(value) {
                return Err(wrong(&format!("{value} is there twice")));
            }
        }
        Ok(Self { key, values })
    }
}

/// Splits a text at commas outside of brackets, braces and quotes.
fn split(text: &str) -> Vec<&str> {
    let mut parts = vec![];
    let (mut depth, mut quote, mut start) = (0_i32, None, 0);
    for (i, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, ',') if depth == 0 => {
                parts.push(&text[start..i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_split_at_their_own_commas() {
        let parsed = |text: &str| text.parse::<Comparison>().unwrap().values;
        assert_eq!(parsed("transfer=pic, flip,apic"), ["pic", "flip", "apic"]);
        assert_eq!(
            parsed("gravity=[0,-1.62],[0,-9.81]"),
            ["[0,-1.62]", "[0,-9.81]"]
        );
        assert_eq!(parsed(r#"title="a,b",'c,d'"#), [r#""a,b""#, "'c,d'"]);
    }

    #[test]
    fn the_key_comes_last_so_that_it_wins() {
        let comparison: Comparison = "dx=0.1,0.05".parse().unwrap();
        let base = [("dx".to_owned(), "1".to_owned())];
        let all: Vec<_> = comparison.overrides(&base).collect();
        assert_eq!(all[1][1], ("dx".to_owned(), "0.05".to_owned()));
        assert_eq!(
            comparison.titles().collect::<Vec<_>>(),
            ["dx = 0.1", "dx = 0.05"]
        );
        assert_eq!(comparison.to_string(), "dx=0.1,0.05");
    }

    #[test]
    fn what_is_no_comparison_is_said() {
        for (text, why) in [
            ("transfer", "no \"=\""),
            ("=a,b", "no key"),
            ("dx=1", "nothing to compare"),
            ("dx=1,", "missing"),
            ("dx=1,2,1", "1 is there twice"),
        ] {
            let error = text.parse::<Comparison>().unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
    }
}
