//! `lahar validate`: runs physics cases and compares them with their references, in a table, a report and plots.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lahar::Isa;
use lahar_io::files::{make_folder, write_file};
use lahar_lab::shell;
use lahar_lab::validate::{self, Case, Options, Outcome};

use crate::error::{CliError, FAILED};
use crate::{args, clock, terminal, threads};

/// The folder of the plots, inside the folder of the report.
const IMAGES: &str = "images/validation";

/// Runs the cases of `args`.
pub(crate) fn validate(args: &args::Validate) -> Result<ExitCode, CliError> {
    let chosen = chosen_cases(args)?;
    let threads = threads::count(args.threads);
    let pool = threads::pool(threads)?;
    let isa = args.isa.unwrap_or_else(Isa::detect);
    let started = clock::seconds();
    let mut outcomes: Vec<(&Case, Outcome)> = Vec::new();
    for (case, scene_file) in chosen {
        let options = Options {
            quick: args.quick,
            isa,
            set: args.set.clone(),
            scene_file,
        };
        let began = clock::seconds();
        let outcome =
            pool.install(|| validate::run(case, &options, &|what| terminal::note(what)))?;
        terminal::note(&format!("{}: {:.0} s", case.id, clock::seconds() - began));
        if let Some(failure) = &outcome.failure {
            terminal::note(&format!("{}: the simulation failed: {failure}", case.id));
        }
        outcomes.push((case, outcome));
    }
    let origin = origin(args, threads, isa, clock::seconds() - started);
    let folder = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from("out/validate"));
    let plots = write(&outcomes, &folder, &origin)?;
    let findings = || outcomes.iter().flat_map(|(_, outcome)| &outcome.findings);
    if args.json {
        terminal::print_json(&validate::json(findings()));
    } else {
        terminal::print(&validate::text(findings()));
        let targets = || findings().filter(|finding| finding.target.is_some());
        let met = targets().filter(|finding| finding.pass()).count();
        terminal::print(&format!(
            "\n{met} of {} targets are met; {} and {} plots in {}\n",
            targets().count(),
            "validation.md",
            plots,
            folder.display()
        ));
    }
    let passed = outcomes.iter().all(|(_, outcome)| outcome.pass());
    Ok(if passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(FAILED)
    })
}

/// The cases that `args` names, each with the scene file that replaces its scene, if one is given. Without names: all
/// cases that are not long.
fn chosen_cases(args: &args::Validate) -> Result<Vec<(&'static Case, Option<String>)>, CliError> {
    if args.cases.is_empty() {
        let cases = validate::cases().filter(|case| args.long || !case.long);
        return Ok(cases.map(|case| (case, None)).collect());
    }
    let mut chosen = Vec::new();
    for name in &args.cases {
        let cases = validate::find(name);
        if cases.is_empty() {
            let names: Vec<&str> = validate::cases().map(|case| case.id).collect();
            return Err(CliError::Usage(format!(
                "there is no case \"{name}\"; there are {}; a scene file replaces the scene of its name",
                names.join(", ")
            )));
        }
        let file = Path::new(name).extension().is_some().then(|| name.clone());
        chosen.extend(cases.into_iter().map(|case| (case, file.clone())));
    }
    Ok(chosen)
}

/// A sentence for the report: the command, and what ran it.
fn origin(args: &args::Validate, threads: usize, isa: Isa, seconds: f64) -> String {
    let mut command = "lahar validate".to_owned();
    for (given, word) in [(args.quick, " --quick"), (args.long, " --long")] {
        if given {
            command += word;
        }
    }
    for word in &args.cases {
        command += &format!(" {}", shell::quoted(word));
    }
    for (key, value) in &args.set {
        command += &format!(" --set {}", shell::quoted(&format!("{key}={value}")));
    }
    if let Some(folder) = &args.output {
        command += &format!(" -o {}", shell::quoted_path(folder));
    }
    format!(
        "Made by `{command}`, version {}, {} on {threads} thread(s), in {seconds:.0} s.",
        env!("CARGO_PKG_VERSION"),
        isa.name()
    )
}

/// Writes the report and the plots into `folder`; returns how many plots.
fn write(outcomes: &[(&Case, Outcome)], folder: &Path, how: &str) -> Result<usize, CliError> {
    let images = folder.join(IMAGES);
    make_folder(&images)?;
    let mut count = 0;
    for (name, plot) in outcomes.iter().flat_map(|(_, outcome)| &outcome.plots) {
        // A run that failed early may have nothing to draw.
        let Ok(svg) = plot.svg() else { continue };
        write_file(&images.join(format!("{name}.svg")), svg)?;
        count += 1;
    }
    let document = validate::document(outcomes, IMAGES, how);
    write_file(&folder.join("validation.md"), document)?;
    Ok(count)
}
