//! File names made from names that users choose.

use std::fmt::Write as _;

/// Longest file name made here, in bytes. Most file systems allow 255; an ending and ".partial" must still fit.
const LONGEST: usize = 200;

/// Names that Windows reserves for devices, with any ending.
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "com", "lpt"];

/// Turns any name (of a material, a body, a probe, a scene) into a file name that stays in its folder.
///
/// Letters, digits, spaces, `-`, `_`, `+` and points inside the name are kept. Everything else becomes `%` and two
/// hexadecimal digits per byte, so that different names give different files.
///
/// ```
/// use lahar_io::files::file_name;
///
/// assert_eq!(file_name("sea water"), "sea water");
/// assert_eq!(file_name("../../escaped"), "%2E.%2F..%2Fescaped");
/// assert_eq!(file_name("/etc/passwd"), "%2Fetc%2Fpasswd");
/// ```
pub fn file_name(name: &str) -> String {
    let last = name.chars().count().saturating_sub(1);
    let mut safe = String::new();
    for (index, letter) in name.chars().enumerate() {
        let at_an_end = index == 0 || index == last;
        let is_safe = match letter {
            '-' | '_' | '+' => true,
            // A leading point hides a file; Windows drops points and spaces at the end.
            '.' | ' ' => !at_an_end,
            _ => letter.is_alphanumeric(),
        };
        if is_safe {
            safe.push(letter);
        } else {
            escape(letter, &mut safe);
        }
    }
    if is_device(&safe) {
        // "con" becomes "%63on".
        let rest = safe.split_off(1);
        let first = core::mem::take(&mut safe);
        first.chars().for_each(|letter| escape(letter, &mut safe));
        safe += &rest;
    }
    if safe.is_empty() {
        // No other name gives a single "%".
        safe.push('%');
    }
    if safe.len() > LONGEST {
        let mut end = LONGEST;
        while !safe.is_char_boundary(end) {
            end -= 1;
        }
        safe.truncate(end);
        write!(safe, "%{:08X}", crc32fast::hash(name.as_bytes())).expect("writing to a String");
    }
    safe
}

fn escape(letter: char, into: &mut String) {
    for byte in letter.encode_utf8(&mut [0; 4]).bytes() {
        write!(into, "%{byte:02X}").expect("writing to a String");
    }
}

/// Returns true for `con`, `COM1`, `nul.txt` and the like.
fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default();
    let word = stem
        .trim_end_matches(|letter: char| letter.is_ascii_digit())
        .to_ascii_lowercase();
    stem.is_ascii() && stem.len() <= word.len() + 1 && DEVICES.contains(&word.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::{Component, Path};

    #[test]
    fn every_name_is_one_plain_component() {
        let long = "x".repeat(1000);
        let names = [
            "",
            ".",
            "..",
            "/",
            "../../escaped",
            "/abs",
            "a/b",
            "a\\b",
            "c:",
            "a\0b",
            "\u{1b}[2J",
            "-o",
            "con",
            "COM1",
            "nul.txt",
            "~",
            "*",
            "ends.",
            "ends ",
            " starts",
            "Ä ö",
            &long,
        ];
        for name in names {
            let safe = file_name(name);
            let parts: Vec<_> = Path::new(&safe).components().collect();
            assert!(
                matches!(parts[..], [Component::Normal(_)]),
                "{name:?}: {safe:?}"
            );
            assert!(
                safe.len() < 220 && !safe.contains(['/', '\\', ':', '\0', '*']),
                "{safe:?}"
            );
            assert!(
                !safe.ends_with(['.', ' ']) && !safe.starts_with('.'),
                "{safe:?}"
            );
            assert!(!is_device(&safe), "{safe:?}");
        }
    }

    #[test]
    fn plain_names_stay_and_different_names_stay_different() {
        for name in [
            "water",
            "P1",
            "P.1",
            "sea water",
            "Öl",
            "a-b_c+d",
            "comb",
            "com10",
        ] {
            assert_eq!(file_name(name), name);
        }
        let long = |end: &str| "y".repeat(300) + end;
        for (one, other) in [
            ("a/b", "a\\b"),
            ("a/b", "a%2Fb"),
            ("", "%"),
            ("con", "%63on"),
            (&long("1"), &long("2")),
        ] {
            assert_ne!(file_name(one), file_name(other), "{one} and {other}");
        }
    }
}
