//! `lahar bench`: measures the speed of scenes, prints it as a table or as ratios to a baseline, and plots growth.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lahar::Isa;
use lahar_io::files::{output_folder, write_file};
use lahar_lab::bench::{self, BenchError, BenchReport, Case, Machine, Options};
use serde_json::json;

use crate::error::CliError;
use crate::{args, terminal, threads};
use lahar_lab::numbers::with_prefix;

/// Measures the cases of `args`.
pub(crate) fn bench(args: &args::Bench) -> Result<ExitCode, CliError> {
    let cases = wanted(args)?;
    let baseline = args.compare.as_deref().map(read).transpose()?;
    let threads: Vec<usize> = match &args.threads[..] {
        [] => vec![threads::count(None)],
        given => given.iter().copied().map(usize::from).collect(),
    };
    let particles: Vec<Option<f64>> = match &args.growth {
        Some(counts) => counts.iter().copied().map(Some).collect(),
        None => vec![args.particles],
    };
    let mut report = BenchReport {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        machine: Machine::here(),
        results: Vec::new(),
    };
    for case in cases {
        for &particles in &particles {
            for &threads in &threads {
                let options = Options {
                    particles,
                    isa: args.isa.unwrap_or_else(Isa::detect),
                    runs: args.runs.into(),
                };
                report.results.push(measure(case, &options, threads)?);
            }
        }
    }
    let plots = if args.growth.is_some() {
        let folder = args.output.clone();
        draw(
            &report,
            &folder.unwrap_or_else(|| PathBuf::from("out/bench")),
        )?
    } else {
        Vec::new()
    };
    if args.json {
        terminal::print_json(&json!(report));
    } else {
        terminal::print(&report.text(baseline.as_ref()));
        for path in plots {
            terminal::print(&format!("  {}\n", path.display()));
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn measure(case: &Case, options: &Options, threads: usize) -> Result<bench::Measurement, CliError> {
    let measured = threads::pool(threads)?
        .install(|| bench::measure(case, options))
        .map_err(|error| match error {
            BenchError::Scene(error) => CliError::Scene(error),
            BenchError::Failure(what) => {
                CliError::Machine(format!("{}: the simulation failed: {what}", case.name))
            }
        })?;
    terminal::note(&format!(
        "{}, {} on {threads} thread(s), {} particles: {} particle-steps/s",
        case.name,
        measured.isa,
        measured.particles,
        with_prefix(measured.median),
    ));
    Ok(measured)
}

/// The cases that the options name, or their default.
fn wanted(args: &args::Bench) -> Result<Vec<&'static Case>, CliError> {
    if args.cases.is_empty() {
        let many = if args.growth.is_some() {
            1
        } else {
            bench::CASES.len()
        };
        return Ok(bench::CASES.iter().take(many).collect());
    }
    let find = |name: &String| {
        bench::find(name).ok_or_else(|| {
            let names: Vec<&str> = bench::CASES.iter().map(|case| case.name).collect();
            CliError::Usage(format!(
                "there is no case \"{name}\"; there are {}",
                names.join(", ")
            ))
        })
    };
    args.cases.iter().map(find).collect()
}

/// Reads a baseline from a file.
fn read(path: &Path) -> Result<BenchReport, CliError> {
    let wrong = |what: String| CliError::Usage(format!("{}: {what}", path.display()));
    let text = fs::read_to_string(path).map_err(|error| wrong(format!("cannot read: {error}")))?;
    serde_json::from_str(&text)
        .map_err(|error| wrong(format!("not a result of `lahar bench --json`: {error}")))
}

/// Draws the plots into `folder`; returns their paths.
fn draw(report: &BenchReport, folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    output_folder(Some(folder), PathBuf::new())?;
    let plots = bench::growth(&report.results).into_iter();
    plots
        .map(|(name, plot)| {
            let path = folder.join(format!("{name}.svg"));
            let svg = plot
                .svg_from_zero()
                .map_err(|error| CliError::Machine(error.to_string()))?;
            write_file(&path, svg)?;
            Ok(path)
        })
        .collect()
}
