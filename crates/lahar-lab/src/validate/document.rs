//! Findings as a table for a terminal, as JSON, and as docs/validation.md.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::{Case, Finding, Outcome};

/// Writes a number with five significant digits, or in scientific notation if it is very small or large.
fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || !x.is_finite() {
        format!("{x}")
    } else if (1e-3..1e5).contains(&size) {
        let digits = (4 - size.log10().floor() as i32).clamp(0, 7) as usize;
        format!("{x:.digits$}")
    } else {
        format!("{x:.2e}")
    }
}

fn cells(finding: &Finding) -> [String; 7] {
    [
        finding.case.to_owned(),
        finding.quantity.clone(),
        number(finding.reference),
        number(finding.ours),
        number(finding.error),
        finding.target.map_or_else(|| "–".to_owned(), number),
        match (finding.target, finding.pass()) {
            (None, _) => "–",
            (_, true) => "pass",
            (_, false) => "MISS",
        }
        .to_owned(),
    ]
}

const NAMES: [&str; 7] = [
    "case",
    "quantity",
    "reference",
    "ours",
    "error",
    "target",
    "pass",
];

/// Writes the findings as a table for a terminal, one line per finding under a line of names.
pub fn text<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> String {
    let mut rows = vec![NAMES.map(str::to_owned)];
    rows.extend(findings.into_iter().map(cells));
    let width = |k: usize| {
        rows.iter()
            .map(|row| row[k].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: [usize; 7] = core::array::from_fn(width);
    let mut out = String::new();
    for row in &rows {
        let mut line = String::new();
        for (k, (cell, width)) in row.iter().zip(widths).enumerate() {
            let space = " ".repeat(width - cell.chars().count());
            // Words are aligned to the left, numbers to the right.
            let padded = if (2..=5).contains(&k) {
                format!("{space}{cell}")
            } else {
                format!("{cell}{space}")
            };
            line += &padded;
            line += "  ";
        }
        out += line.trim_end();
        out.push('\n');
    }
    out
}

/// Returns the findings as the list that `--json` prints.
pub fn json<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> Value {
    let object = |finding: &Finding| {
        json!({
            "case": finding.case,
            "quantity": finding.quantity,
            "reference": finding.reference,
            "ours": finding.ours,
            "error": finding.error,
            "target": finding.target,
            "pass": finding.pass(),
        })
    };
    findings.into_iter().map(object).collect()
}

/// Writes docs/validation.md: every case with its scene, findings and plots. `how` is a sentence with the command, version
/// and machine; `images` is the folder of the plots.
pub fn document(outcomes: &[(&Case, Outcome)], images: &str, how: &str) -> String {
    let mut out = format!(
        "# Validation\n\n{how}\n\nErrors are relative to the reference unless the quantity says otherwise; a quantity without a target is \
         reported only. What misses its target is explained in [known-misses.md](known-misses.md).\n"
    );
    let findings = || outcomes.iter().flat_map(|(_, outcome)| &outcome.findings);
    let targets = findings().filter(|finding| finding.target.is_some());
    let met = targets.clone().filter(|finding| finding.pass()).count();
    writeln!(out, "\n{met} of {} targets are met.", targets.count()).expect("writing to a String");
    for (case, outcome) in outcomes {
        write!(
            out,
            "\n## {}: {}\n\nReference: {}. Scene: `{}`.\n\n",
            case.id, case.title, case.reference, case.scene
        )
        .expect("writing to a String");
        if let Some(failure) = &outcome.failure {
            write!(out, "**The simulation failed**: {failure}\n\n").expect("writing to a String");
        }
        out += "| quantity | reference | ours | error | target | |\n|---|---|---|---|---|---|\n";
        for finding in &outcome.findings {
            let [_, cells @ ..] = cells(finding);
            writeln!(
                out,
                "| {} |",
                cells.map(|cell| cell.replace('|', "\\|")).join(" | ")
            )
            .expect("writing to a String");
        }
        for (name, plot) in &outcome.plots {
            write!(out, "\n![{}]({images}/{name}.svg)\n", plot.title).expect("writing to a String");
        }
        out += "\nRuns:\n\n";
        for run in &outcome.runs {
            writeln!(out, "- `{run}`").expect("writing to a String");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(ours: f64, target: Option<f64>) -> Finding {
        Finding {
            case: "F5",
            quantity: "period, dx = 1/28 m".into(),
            reference: 1.13392,
            ours,
            error: ours / 1.13392 - 1.0,
            target,
        }
    }

    #[test]
    fn a_table_for_people_and_one_for_programs() {
        let findings = [
            finding(1.14, Some(0.01)),
            finding(1.2, Some(0.01)),
            finding(1.2, None),
        ];
        let text = text(&findings);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("case  quantity"), "{text}");
        assert!(
            lines[1].ends_with("pass") && lines[2].ends_with("MISS") && lines[3].ends_with('–'),
            "{text}"
        );
        let json = json(&findings);
        assert_eq!(json[1]["pass"], false);
        assert_eq!(json[2]["target"], Value::Null);
        assert_eq!(json[0]["case"], "F5");
    }

    #[test]
    fn nan_never_passes() {
        assert!(!finding(f64::NAN, Some(0.01)).pass());
    }
}
