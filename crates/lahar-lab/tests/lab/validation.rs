//! The physics cases that take seconds: each finding meets its target, or misses it and is listed in
//! docs/known-misses.md.

use std::collections::BTreeSet;

use lahar::Isa;
use lahar_lab::validate::{self, Options};

/// Cases that take seconds at their coarser resolution. The others run by `lahar validate` only.
const FAST: [&str; 18] = [
    "K1", "K2", "K3", "K4", "K5", "K6", "K7", "K8", "E1", "E4", "F1", "F2", "F3", "F4", "F6", "F7",
    "F8", "D1",
];

/// Returns the listed misses of `lahar validate`: (case, quantity).
fn known_misses() -> BTreeSet<(String, String)> {
    let text = include_str!("../../docs/known-misses.md");
    let (_, list) = text
        .split_once("## By `lahar validate`")
        .expect("the list has its heading");
    let rows = list.lines().filter_map(|line| line.strip_prefix("| "));
    rows.skip(1)
        .map(|row| {
            let mut cells = row.split(" | ");
            let mut cell = || cells.next().unwrap_or_default().trim().to_owned();
            (cell(), cell())
        })
        .collect()
}

#[test]
fn fast_cases_meet_their_targets_or_are_known_to_miss() {
    let options = Options {
        quick: true,
        isa: Isa::Portable,
        set: Vec::new(),
        scene_file: None,
    };
    let known = known_misses();
    let mut wrong = Vec::new();
    for id in FAST {
        let [case] = validate::find(id)[..] else {
            panic!("{id} is one case");
        };
        let outcome =
            validate::run(case, &options, &|_| {}).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(outcome.failure, None, "{id}");
        assert!(
            outcome
                .findings
                .iter()
                .any(|finding| finding.target.is_some())
                || id == "D1",
            "{id}"
        );
        for finding in &outcome.findings {
            let listed = known.contains(&(id.to_owned(), finding.quantity.clone()));
            if finding.pass() == listed {
                wrong.push(format!("{finding:?} is listed as a miss: {listed}"));
            }
        }
    }
    assert_eq!(wrong, [] as [String; 0]);
}

/// Frames that fail because the time step is too long are retried with a shorter one, as by `lahar run`, and reported.
#[test]
fn frames_that_fail_are_retried() {
    let [case] = validate::find("E1")[..] else {
        panic!("E1 is one case");
    };
    let options = Options {
        quick: true,
        isa: Isa::Portable,
        set: [("dt", "0.2"), ("frame_rate", "0.5")]
            .map(|(key, to)| (key.into(), to.into()))
            .into(),
        scene_file: None,
    };
    let outcome = validate::run(case, &options, &|_| {}).unwrap();
    assert_eq!(outcome.failure, None);
    assert!(!outcome.findings.is_empty());
    let again = |run: &&String| run.contains("frame_rate=0.5: the frame from t = ");
    let retries = outcome.runs.iter().filter(again).count();
    assert!(retries > 0, "{:?}", outcome.runs);
}

/// Every case on the list of misses exists.
#[test]
fn listed_misses_name_cases() {
    let known = known_misses();
    for (case, _) in &known {
        assert_eq!(validate::find(case).len(), 1, "{case}");
    }
}

/// A case is found by its name in upper or lower case; a scene or a file of its name finds all cases that run it.
#[test]
fn cases_are_found() {
    let found =
        |name: &str| -> Vec<&str> { validate::find(name).iter().map(|case| case.id).collect() };
    for (name, ids) in [
        ("d1", &["D1"][..]),
        ("f5-standing-wave", &["F5"]),
        ("my/d3-wall-impact.toml", &["D3", "D4", "D5"]),
        ("D9", &[]),
        ("", &[]),
    ] {
        assert_eq!(found(name), ids, "{name}");
    }
}
