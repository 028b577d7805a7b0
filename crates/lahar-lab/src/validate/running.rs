//! A case while it runs: it starts scenes and collects findings and plots.

use std::cell::RefCell;
use std::rc::Rc;

use lahar::{Data, Diagnostics, Failure, Field, ProbeSamples, Retry, Simulate};
use lahar_scene::driver::{Driver, Event};

use super::{Case, Finding, Options, Outcome};
use crate::plot::{Line, Plot};
use crate::shell::quoted;
use lahar_scene::error::SceneError;
use lahar_scene::scene::Scene;

/// An error that ends a case early.
pub(super) enum CaseError {
    /// The scene, or a value laid over it, is wrong.
    Scene(Box<SceneError>),
    /// The simulation failed.
    Failure(String),
}

impl From<SceneError> for CaseError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<Failure> for CaseError {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure.to_string())
    }
}

/// A running case: its options and its results so far.
pub(super) struct Session<'a> {
    case: &'static Case,
    options: &'a Options,
    progress: &'a dyn Fn(&str),
    outcome: Outcome,
    /// Sentences about frames that were retried.
    retries: Rc<RefCell<Vec<String>>>,
}

/// A scene of a case while it runs.
pub(super) struct RunningScene {
    pub(super) scene: Scene,
    driver: Driver,
    /// Readings of probes so far.
    probes: Vec<ProbeSamples>,
    /// Scene and options, as on the command line.
    command: String,
    /// The list of retries of the whole case.
    retries: Rc<RefCell<Vec<String>>>,
}

/// A quantity over time: pairs of time \[s\] and value.
pub(super) type Series = Vec<(f64, f64)>;

impl<'a> Session<'a> {
    pub(super) fn new(
        case: &'static Case,
        options: &'a Options,
        progress: &'a dyn Fn(&str),
    ) -> Self {
        Self {
            case,
            options,
            progress,
            outcome: Outcome::default(),
            retries: Rc::default(),
        }
    }

    /// Returns the results. The lines about retries follow those about scenes.
    pub(super) fn finish(mut self) -> Outcome {
        self.outcome.runs.append(&mut self.retries.borrow_mut());
        self.outcome
    }

    /// Returns true if only the coarser resolution is wanted.
    pub(super) fn quick(&self) -> bool {
        self.options.quick
    }

    /// Returns the resolutions that are wanted.
    pub(super) fn resolutions<T: Copy>(&self, coarse: T, fine: T) -> Vec<T> {
        if self.quick() {
            vec![coarse]
        } else {
            vec![coarse, fine]
        }
    }

    /// Starts the case's scene with `set` laid over it, and the user's values over both.
    pub(super) fn start(&mut self, set: &[(&str, String)]) -> Result<RunningScene, CaseError> {
        let scene = self
            .options
            .scene_file
            .as_deref()
            .unwrap_or(self.case.scene);
        self.start_scene(scene, set)
    }

    /// Starts a scene other than the case's own.
    pub(super) fn start_scene(
        &mut self,
        scene: &str,
        set: &[(&str, String)],
    ) -> Result<RunningScene, CaseError> {
        let own = set
            .iter()
            .map(|(key, value)| ((*key).to_owned(), value.clone()));
        let set: Vec<(String, String)> = own.chain(self.options.set.iter().cloned()).collect();
        let words = set
            .iter()
            .map(|(key, value)| format!(" --set {}", quoted(&format!("{key}={value}"))));
        let command = format!("{scene}{}", words.collect::<String>());
        (self.progress)(&format!("{}: {command}", self.case.id));
        let scene = Scene::load(scene, &set)?;
        let driver = Driver::of_scene(&scene, scene.build(self.options.isa)?.simulation);
        let count = driver.simulation().particle_count();
        self.outcome
            .runs
            .push(format!("{command} ({count} particles)"));
        Ok(RunningScene {
            scene,
            driver,
            probes: Vec::new(),
            command,
            retries: Rc::clone(&self.retries),
        })
    }

    /// Compares `ours` with `reference`; the error is relative.
    pub(super) fn relative(&mut self, quantity: &str, reference: f64, ours: f64, target: f64) {
        self.push(
            quantity,
            reference,
            ours,
            (ours - reference) / reference,
            Some(target),
        );
    }

    /// Compares `ours` with `reference`; the error is absolute.
    pub(super) fn absolute(&mut self, quantity: &str, reference: f64, ours: f64, target: f64) {
        self.push(quantity, reference, ours, ours - reference, Some(target));
    }

    /// Adds a deviation from 0.
    pub(super) fn at_most(&mut self, quantity: &str, ours: f64, target: f64) {
        self.push(quantity, 0.0, ours, ours, Some(target));
    }

    /// Compares a number with a lower bound; the error is the amount by which it is below.
    pub(super) fn at_least(&mut self, quantity: &str, bound: f64, ours: f64) {
        let deficit = if ours.is_nan() {
            ours
        } else {
            (bound - ours).max(0.0)
        };
        self.push(quantity, bound, ours, deficit, Some(0.0));
    }

    /// Adds a number without a target.
    pub(super) fn report(&mut self, quantity: &str, reference: f64, ours: f64) {
        self.push(quantity, reference, ours, ours - reference, None);
    }

    fn push(&mut self, quantity: &str, reference: f64, ours: f64, error: f64, target: Option<f64>) {
        self.outcome.findings.push(Finding {
            case: self.case.id,
            quantity: quantity.to_owned(),
            reference,
            ours,
            error,
            target,
        });
    }

    /// Adds a plot; its file is called by the case and `name`.
    pub(super) fn plot(
        &mut self,
        name: &str,
        title: &str,
        axes: [&str; 2],
        lines: Vec<(String, Series)>,
    ) {
        let lines = lines
            .into_iter()
            .map(|(name, points)| Line { name, points });
        self.outcome.plots.push((
            format!("{}-{name}", self.case.id.to_lowercase()),
            Plot {
                title: title.to_owned(),
                x_label: axes[0].to_owned(),
                y_label: axes[1].to_owned(),
                lines: lines.collect(),
            },
        ));
    }
}

impl RunningScene {
    /// Returns the simulation.
    pub(super) fn simulation(&self) -> &dyn Simulate {
        self.driver.simulation()
    }

    /// Returns the simulation for single substeps and for diagnostics.
    pub(super) fn simulation_mut(&mut self) -> &mut dyn Simulate {
        self.driver.simulation_mut()
    }

    /// Runs to `time` \[s\]. If a substep fails, all are retried with a shorter dt.
    pub(super) fn advance_to(&mut self, time: f64) -> Result<(), CaseError> {
        let (retries, command) = (&self.retries, &self.command);
        let note = |retry: &Retry| retries.borrow_mut().push(format!("{command}: {retry}"));
        let frame = (self.driver.advance_to(time, note))
            .map_err(|failure| CaseError::Failure(Retry::in_vain(&failure)))?;
        self.keep_probes(frame.probes);
        Ok(())
    }

    /// Runs to the end of the scene's next frame.
    pub(super) fn frame(&mut self) -> Result<(), CaseError> {
        loop {
            match self.driver.pump(&mut || true) {
                Event::Frame(frame) => {
                    self.keep_probes(frame.probes);
                    return Ok(());
                }
                Event::Retry(retry) => {
                    let sentence = format!("{}: {retry}", self.command);
                    self.retries.borrow_mut().push(sentence);
                }
                Event::Failed(failure) => return Err(CaseError::Failure(Retry::in_vain(&failure))),
                Event::Unfinished => {}
            }
        }
    }

    /// Runs frame by frame to the scene's end. `look` is called at the start and after each frame.
    pub(super) fn frames(
        &mut self,
        mut look: impl FnMut(&mut dyn Simulate),
    ) -> Result<(), CaseError> {
        look(self.simulation_mut());
        for _ in 0..self.scene.frames() {
            self.frame()?;
            look(self.simulation_mut());
        }
        Ok(())
    }

    /// Runs to the scene's end. Returns the diagnostics of the start and of each frame.
    pub(super) fn rows(&mut self) -> Result<Vec<Diagnostics>, CaseError> {
        let mut rows = Vec::new();
        self.frames(|simulation| rows.push(simulation.diagnostics()))?;
        Ok(rows)
    }

    fn keep_probes(&mut self, samples: Vec<ProbeSamples>) {
        if self.probes.is_empty() {
            self.probes = samples;
            return;
        }
        for (all, new) in self.probes.iter_mut().zip(samples) {
            all.samples.extend(new.samples);
        }
    }

    /// Returns one column of a probe's readings; empty if there is no such probe.
    pub(super) fn probe(&mut self, name: &str, column: usize) -> Series {
        let latest = self.simulation_mut().take_probe_samples();
        self.keep_probes(latest);
        let probe = self.probes.iter().find(|probe| probe.name == name);
        let samples = probe.map_or(&[][..], |probe| &probe.samples);
        let point = |sample: &lahar::ProbeSample| Some((sample.time, *sample.values.get(column)?));
        samples.iter().filter_map(point).collect()
    }
}

/// Returns the numbers of a field, one particle after the other by ascending id.
pub(super) fn field(simulation: &dyn Simulate, field: Field) -> Vec<f64> {
    let snapshot = simulation.snapshot(&[field]);
    snapshot.get(field).map(Data::to_f64).unwrap_or_default()
}

/// Returns the amplitude of the mode f in the velocities: Σ m v_axis f(x) / Σ m f(x)².
pub(super) fn mode(simulation: &dyn Simulate, axis: usize, f: impl Fn(&[f64]) -> f64) -> f64 {
    let d = simulation.dimension();
    let fields = [Field::Position, Field::Velocity, Field::Mass];
    let [x, v, m] = fields.map(|name| field(simulation, name));
    let (mut above, mut below) = (0.0, 0.0);
    for ((x, v), m) in x.chunks(d).zip(v.chunks(d)).zip(m) {
        let f = f(x);
        above += m * v[axis] * f;
        below += m * f * f;
    }
    above / below
}
