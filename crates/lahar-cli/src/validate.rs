//! `lahar validate`: physics cases against their references, as a table, a report and plots.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lahar::Isa;
use lahar_io::files::{make_folder, write_file};
use lahar_lab::validate::{self, Case, Options, Outcome};

use crate::error::{CliError, FAILED};
use crate::{args, clock, terminal};

/// The folder of plots in the report's.
const IMAGES: &str = "images/validation";

/// Runs the cases that are asked for.
pub(crate) fn validate(args: &args::Validate) -> Result<ExitCode, CliError> {
    let wanted = wanted(args)?;
    let threads = args.threads.map_or_else(
        || std::thread::available_parallelism().map_or(1, usize::from),
        usize::from,
    );
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool
        .map_err(|error| CliError::Machine(format!("cannot start {threads} threads: {error}")))?;
    let isa = args.isa.unwrap_or_else(Isa::detect);
    let started = clock::seconds();
    let mut outcomes: Vec<(&Case, Outcome)> = Vec::new();
    for (case, scene_file) in wanted {
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
    let how = how(args, threads, isa, clock::seconds() - started);
    let folder = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from("out/validate"));
    let files = write(&outcomes, &folder, &how)?;
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
            files,
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

/// The cases of the words on the command line, each with the file that its scene is taken from, if one is named; all
/// that are not long without words.
fn wanted(args: &args::Validate) -> Result<Vec<(&'static Case, Option<String>)>, CliError> {
    if args.cases.is_empty() {
        let cases = validate::cases().filter(|case| args.long || !case.long);
        return Ok(cases.map(|case| (case, None)).collect());
    }
    let mut wanted = Vec::new();
    for name in &args.cases {
        let cases = validate::find(name);
        if cases.is_empty() {
            let names: Vec<&str> = validate::cases().map(|case| case.id).collect();
            return Err(CliError::Usage(format!(
                "there is no case \"{name}\"; there are {}; a scene file is run for the cases of the scene with its name",
                names.join(", ")
            )));
        }
        let file = Path::new(name).extension().is_some().then(|| name.clone());
        wanted.extend(cases.into_iter().map(|case| (case, file.clone())));
    }
    Ok(wanted)
}

/// What was run, on what.
fn how(args: &args::Validate, threads: usize, isa: Isa, seconds: f64) -> String {
    let mut command = "lahar validate".to_owned();
    for (given, word) in [(args.quick, " --quick"), (args.long, " --long")] {
        if given {
            command += word;
        }
    }
    for word in &args.cases {
        command += &format!(" {word}");
    }
    for (key, value) in &args.set {
        command += &format!(" --set {key}={value}");
    }
    if let Some(folder) = &args.output {
        command += &format!(" -o {}", folder.display());
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
