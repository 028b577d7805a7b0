//! `lahar validate` and `lahar bench`: reports, tables, and errors.

use serde_json::Value;

use crate::support::{code, errors, here, json, lahar, names};

#[test]
fn validate_prints_a_table_or_json_and_leaves_a_report() {
    let here = here();
    let output = lahar(
        here.path(),
        &["validate", "k1", "E1", "--quick", "--json", "-o", "v"],
    );
    code(&output, 0);
    let findings = json(&output);
    let periods: Vec<&Value> = (findings.as_array().expect("a list").iter())
        .filter(|finding| finding["case"] == "E1")
        .collect();
    assert_eq!(periods.len(), 1, "{findings}");
    assert_eq!(periods[0]["reference"], 10.0);
    assert_eq!(periods[0]["pass"], true);
    let report = std::fs::read_to_string(here.path().join("v/validation.md")).expect("a report");
    assert!(report.contains("## E1: ") && report.contains("images/validation/e1-speed.svg"));
    assert!(
        here.path()
            .join("v/images/validation/e1-speed.svg")
            .exists()
    );
    // A bar that is far too soft misses its target: exit code 1.
    let soft = [
        "validate",
        "E1",
        "--quick",
        "--set",
        "materials.bar.youngs_modulus=50.0",
    ];
    let output = lahar(here.path(), &soft);
    code(&output, 1);
    assert!(String::from_utf8_lossy(&output.stdout).contains("MISS"));
    let output = lahar(here.path(), &["validate", "Z1"]);
    code(&output, 2);
    assert!(errors(&output).contains("there is no case \"Z1\""));
}

#[test]
fn bench_measures_compares_and_draws() {
    let here = here();
    let small = [
        "bench",
        "--case=dam-2d,jelly-3d",
        "--particles=3000",
        "--threads=1,2",
        "--runs=2",
    ];
    let words: Vec<&str> = small.iter().chain(&["--json"]).copied().collect();
    let output = lahar(here.path(), &words);
    code(&output, 0);
    let report = json(&output);
    let results = report["results"].as_array().unwrap();
    let cases: Vec<&str> = results
        .iter()
        .map(|m| m["case"].as_str().unwrap())
        .collect();
    assert_eq!(cases, ["dam-2d", "dam-2d", "jelly-3d", "jelly-3d"]);
    for measured in results {
        let number = |key: &str| measured[key].as_f64().unwrap();
        assert!(
            0.0 < number("min") && number("min") <= number("median"),
            "{measured}"
        );
        assert!(
            number("median") <= number("max") && number("sorts") >= 2.0,
            "{measured}"
        );
        assert!(
            (number("particles") / 3000.0 - 1.0).abs() < 0.1,
            "{measured}"
        );
    }
    std::fs::write(here.path().join("before.json"), &output.stdout).unwrap();
    let words: Vec<&str> = small
        .iter()
        .chain(&["--compare=before.json"])
        .copied()
        .collect();
    let output = lahar(here.path(), &words);
    code(&output, 0);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("to baseline"), "{text}");
    assert_eq!(
        text.lines().filter(|line| line.contains("dam-2d")).count(),
        2,
        "{text}"
    );

    let words = [
        "bench",
        "--case=dam-2d",
        "--growth=1000,4000",
        "--threads=1,2",
        "--runs=1",
        "-o",
        "plots",
    ];
    code(&lahar(here.path(), &words), 0);
    assert!(
        names(&here.path().join("plots"))
            .iter()
            .any(|name| name == "threads.svg")
    );
}

#[test]
fn bench_names_wrong_arguments() {
    let here = here();
    let output = lahar(here.path(), &["bench", "--case=dam"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("no case \"dam\"; there are dam-3d,"),
        "{}",
        errors(&output)
    );
    std::fs::write(here.path().join("no.json"), "{}").unwrap();
    let output = lahar(here.path(), &["bench", "--compare=no.json"]);
    code(&output, 2);
    assert!(
        errors(&output).contains("no.json: not a result of"),
        "{}",
        errors(&output)
    );
}
