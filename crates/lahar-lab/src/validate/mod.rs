//! Physics cases: scenes compared with exact solutions, experiments, and the tests of other programs.
//!
//! ```text
//! case ─► its scene, at one or more resolutions ─► measure ─┬► findings (reference, ours, error, target)
//!                                                           └► plots of the measurement and the reference
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

/// A physics case: a scene and a comparison with a reference.
///
/// ```
/// use lahar_lab::validate::{cases, find};
///
/// assert_eq!(find("d1")[0].title, "Dam break of Martin and Moyce, n² = 2");
/// assert!(cases().count() > 20);
/// ```
pub struct Case {
    /// Short name, such as "D1".
    pub id: &'static str,
    /// Title in reports.
    pub title: &'static str,
    /// Source of the reference.
    pub reference: &'static str,
    /// Name of the scene that it runs.
    pub scene: &'static str,
    /// True if it takes many minutes and is run only on demand.
    pub long: bool,
    run: fn(&mut Session<'_>) -> Result<(), CaseError>,
}

/// Returns all cases, in the order of the report.
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

/// Returns the case with this short name (capitals do not matter), or the cases that run this scene.
pub fn find(name: &str) -> Vec<&'static Case> {
    let stem = std::path::Path::new(name).file_stem().unwrap_or_default();
    cases()
        .filter(|case| case.id.eq_ignore_ascii_case(name) || stem.eq_ignore_ascii_case(case.scene))
        .collect()
}

/// Options of a validation run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Runs the coarser resolution only.
    pub quick: bool,
    /// Instruction set that computes.
    pub isa: Isa,
    /// Keys and values laid over the scenes of all cases.
    pub set: Vec<(String, String)>,
    /// A scene file that replaces the built-in scene of the case.
    pub scene_file: Option<String>,
}

/// One measured number of a case, with its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Short name of the case.
    pub case: &'static str,
    /// Quantity that was measured, with the resolution.
    pub quantity: String,
    /// Value of the reference.
    pub reference: f64,
    /// Value that was measured.
    pub ours: f64,
    /// Error, relative to the reference unless the quantity says otherwise.
    pub error: f64,
    /// Largest error that passes; `None` if the number is reported only.
    pub target: Option<f64>,
}

impl Finding {
    /// Returns true if the error is within the target.
    pub fn pass(&self) -> bool {
        self.target.is_none_or(|target| self.error.abs() <= target)
    }
}

/// The results of a case.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// All measured numbers.
    pub findings: Vec<Finding>,
    /// Plots, each with the name of its file without ending.
    pub plots: Vec<(String, Plot)>,
    /// The scenes that were run, one line each, and the retries of frames.
    pub runs: Vec<String>,
    /// The error, if a simulation failed.
    pub failure: Option<String>,
}

impl Outcome {
    /// Returns true if no simulation failed and all numbers meet their targets.
    pub fn pass(&self) -> bool {
        self.failure.is_none() && self.findings.iter().all(Finding::pass)
    }
}

/// Runs a case. `progress` gets a line before each scene.
///
/// # Errors
/// If the scene, or a value laid over it, is wrong.
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
