//! The numbers of docs/equations.md: no two equations share one, and each that a comment cites exists.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of this crate.
const CRATE: &str = env!("CARGO_MANIFEST_DIR");

/// The folder whose code is checked: all crates in the repository, and this crate alone in a published package.
fn code() -> PathBuf {
    let crates = Path::new(CRATE).join("..");
    match crates.join("lahar/Cargo.toml").is_file() {
        true => crates,
        false => CRATE.into(),
    }
}

/// All numbers in brackets, such as `7` and `7g` in "(7), (7g)". Years have too many digits to count, and the brackets
/// of a call of a function follow its name.
fn numbers(text: &str) -> Vec<&str> {
    let is_call = |open: usize| {
        let before = text[..open].chars().next_back();
        before.is_some_and(|c| c.is_alphanumeric() || c == '_')
    };
    text.match_indices('(')
        .filter(|(open, _)| !is_call(*open))
        .filter_map(|(open, _)| {
            let rest = &text[open + 1..];
            let number = &rest[..rest.find(')')?];
            let digits = number.trim_end_matches(|c: char| c.is_ascii_lowercase());
            let letters = number.len() - digits.len();
            let short = matches!(digits.len(), 1 | 2) && letters <= 1;
            (short && digits.bytes().all(|c| c.is_ascii_digit())).then_some(number)
        })
        .collect()
}

/// The numbers that the page gives to equations: at the ends of lines of formulas, and in bold in the text.
fn defined(page: &str) -> Vec<&str> {
    let mut in_formula = false;
    let mut found = Vec::new();
    for line in page.lines() {
        if line.starts_with("```") {
            in_formula = line == "```math";
        } else if in_formula {
            let end = line.trim_end_matches('\\').trim_end_matches('}');
            if end.ends_with(')') {
                let last = &end[end.rfind('(').unwrap_or(0)..];
                found.extend(numbers(last));
            }
        } else {
            let bold = line.split("**").skip(1).step_by(2);
            found.extend(bold.filter(|text| text.starts_with('(')).flat_map(numbers));
        }
    }
    found
}

/// All Rust files below a folder.
fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the repository") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn equation_numbers_are_unique_and_those_in_comments_exist() {
    let page = fs::read_to_string(Path::new(CRATE).join("docs/equations.md")).expect("the page");
    let mut known = BTreeSet::new();
    for number in defined(&page) {
        assert!(known.insert(number), "two equations are ({number})");
    }
    let substep = ["1", "2", "3", "4", "5", "6", "7", "8"];
    assert!(substep.iter().all(|number| known.contains(number)));

    let mut files = Vec::new();
    rust_files(&code(), &mut files);
    let mut citations = 0;
    for file in files {
        let code = fs::read_to_string(&file).expect("a source file");
        for (row, line) in (1..).zip(code.lines()) {
            let comment = line.find("//").map_or("", |start| &line[start..]);
            for number in numbers(comment) {
                citations += 1;
                let at = file.display();
                assert!(
                    known.contains(number),
                    "{at}:{row}: there is no equation ({number})"
                );
            }
        }
    }
    assert!(
        citations > 80,
        "only {citations} numbers were found in comments"
    );
}
