//! Physics cases: scenes against exact solutions, experiments and other programs' own tests.
//!
//! ```text
//! case ─► its scene, at one or more resolutions ─► measure ─► findings (reference, ours, error, target)
//!                                                       └──► plots of ours over the reference
//! ```
//! A case is an ordinary scene file (scenes/validation/) and a function that runs it and measures. Reference
//! numbers that are not formulas are tables in data/, each with its source in its first lines.

mod dam_breaks;
mod document;
mod flows;
mod laws;
mod measure;
mod method;
mod running;
mod solids;
mod tanks;
mod waves;

use lahar::Isa;

use crate::plot::Plot;
pub use document::{document, json, text};
use lahar_scene::error::SceneError;
use running::{CaseError, Session};

/// A case.
pub struct Case {
    /// Its short name: "D1".
    pub id: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Where its reference is from.
    pub reference: &'static str,
    /// The scene it runs.
    pub scene: &'static str,
    /// Whether it takes many minutes, and is run only when asked for.
    pub long: bool,
    run: fn(&mut Session<'_>) -> Result<(), CaseError>,
}

/// All cases, in the order of the report.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    [
        method::CASES,
        laws::CASES,
        solids::CASES,
        waves::CASES,
        tanks::CASES,
        flows::CASES,
        dam_breaks::CASES,
    ]
    .into_iter()
    .flatten()
}

/// The case with this short name, whatever its capitals, or those that run this scene.
pub fn find(name: &str) -> Vec<&'static Case> {
    let stem = std::path::Path::new(name).file_stem().unwrap_or_default();
    cases()
        .filter(|case| case.id.eq_ignore_ascii_case(name) || stem.eq_ignore_ascii_case(case.scene))
        .collect()
}

/// How cases are run.
#[derive(Clone, Debug)]
pub struct Options {
    /// The coarser resolution only, and no case that takes longer than seconds.
    pub quick: bool,
    /// Instruction set.
    pub isa: Isa,
    /// Laid over the scenes of all cases.
    pub set: Vec<(String, String)>,
    /// A file to take the case's scene from, in place of the built-in one.
    pub scene_file: Option<String>,
}

/// One number of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The case's short name.
    pub case: &'static str,
    /// What was measured, with the resolution.
    pub quantity: String,
    /// What it should be.
    pub reference: f64,
    /// What it is.
    pub ours: f64,
    /// How far off: of the reference's size unless the quantity says otherwise.
    pub error: f64,
    /// The most that passes; `None`: reported only.
    pub target: Option<f64>,
}

impl Finding {
    /// Whether the error is within the target.
    pub fn pass(&self) -> bool {
        self.target.is_none_or(|target| self.error.abs() <= target)
    }
}

/// What a case came to.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The numbers.
    pub findings: Vec<Finding>,
    /// Plots by their file's name, without its ending.
    pub plots: Vec<(String, Plot)>,
    /// What was run, a line each: resolution, particles, substeps.
    pub runs: Vec<String>,
    /// What stopped it, if a simulation failed.
    pub failure: Option<String>,
}

impl Outcome {
    /// Whether all is within its targets.
    pub fn pass(&self) -> bool {
        self.failure.is_none() && self.findings.iter().all(Finding::pass)
    }
}

/// Runs a case; `progress` is told what is run.
///
/// # Errors
/// If its scene, or what is laid over it, is wrong.
pub fn run(
    case: &'static Case,
    options: &Options,
    progress: &dyn Fn(&str),
) -> Result<Outcome, SceneError> {
    let mut session = Session::new(case, options, progress);
    let ended = (case.run)(&mut session);
    let outcome = session.finish();
    match ended {
        Ok(()) => Ok(outcome),
        Err(CaseError::Scene(error)) => Err(*error),
        Err(CaseError::Failure(failure)) => Ok(Outcome {
            failure: Some(failure),
            ..outcome
        }),
    }
}
