//! A case while it runs: scenes in, findings and plots out.

use std::cell::RefCell;
use std::rc::Rc;

use lahar::{Data, Diagnostics, Failure, Field, ProbeSamples, Retry, Simulate};
use lahar_scene::driver::{Driver, Event};

use super::{Case, Finding, Options, Outcome};
use crate::plot::{Line, Plot};
use lahar_scene::error::SceneError;
use lahar_scene::scene::Scene;

/// What ends a case early.
pub(super) enum CaseError {
    /// The scene, or what is laid over it, is wrong.
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

/// A case while it runs.
pub(super) struct Session<'a> {
    case: &'static Case,
    options: &'a Options,
    progress: &'a dyn Fn(&str),
    outcome: Outcome,
    /// Frames that were tried again.
    retries: Rc<RefCell<Vec<String>>>,
}

/// A scene that runs.
pub(super) struct RunningScene {
    pub(super) scene: Scene,
    driver: Driver,
    /// What probes have read so far.
    probes: Vec<ProbeSamples>,
    /// What it was started by.
    command: String,
    /// The session's.
    retries: Rc<RefCell<Vec<String>>>,
}

/// A number over time: (time \[s\], value).
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

    /// What it came to; frames that were tried again are told below what was run.
    pub(super) fn finish(mut self) -> Outcome {
        self.outcome.runs.append(&mut self.retries.borrow_mut());
        self.outcome
    }

    /// Whether only what takes seconds is to be run.
    pub(super) fn quick(&self) -> bool {
        self.options.quick
    }

    /// Of a coarse and a fine resolution those that are wanted.
    pub(super) fn resolutions<T: Copy>(&self, coarse: T, fine: T) -> Vec<T> {
        if self.quick() {
            vec![coarse]
        } else {
            vec![coarse, fine]
        }
    }

    /// The case's scene with `set` laid over it, and what the user laid over that.
    pub(super) fn start(&mut self, set: &[(&str, String)]) -> Result<RunningScene, CaseError> {
        let scene = self
            .options
            .scene_file
            .as_deref()
            .unwrap_or(self.case.scene);
        self.start_scene(scene, set)
    }

    /// Another scene than the case's own.
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
            .map(|(key, value)| format!(" --set {key}={value}"));
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

    /// `ours` against `reference`, the difference relative to the reference.
    pub(super) fn relative(&mut self, quantity: &str, reference: f64, ours: f64, target: f64) {
        self.push(
            quantity,
            reference,
            ours,
            (ours - reference) / reference,
            Some(target),
        );
    }

    /// `ours` against `reference`, the difference as it is.
    pub(super) fn absolute(&mut self, quantity: &str, reference: f64, ours: f64, target: f64) {
        self.push(quantity, reference, ours, ours - reference, Some(target));
    }

    /// A deviation from 0 that is given already.
    pub(super) fn at_most(&mut self, quantity: &str, ours: f64, target: f64) {
        self.push(quantity, 0.0, ours, ours, Some(target));
    }

    /// A number that must not be below a bound; what it lacks is the error.
    pub(super) fn at_least(&mut self, quantity: &str, bound: f64, ours: f64) {
        let lacks = if ours.is_nan() {
            ours
        } else {
            (bound - ours).max(0.0)
        };
        self.push(quantity, bound, ours, lacks, Some(0.0));
    }

    /// A number without a target.
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

    /// Adds a plot; `name` is joined to the case's.
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
    /// The simulation.
    pub(super) fn simulation(&self) -> &dyn Simulate {
        self.driver.simulation()
    }

    /// The simulation, for substeps of its own and for diagnostics.
    pub(super) fn simulation_mut(&mut self) -> &mut dyn Simulate {
        self.driver.simulation_mut()
    }

    /// Runs to `time` \[s\]. Substeps that fail are taken again from here with a shorter dt.
    pub(super) fn advance_to(&mut self, time: f64) -> Result<(), CaseError> {
        let (retries, command) = (&self.retries, &self.command);
        let told = |retry: &Retry| retries.borrow_mut().push(format!("{command}: {retry}"));
        let frame = (self.driver.advance_to(time, told))
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
                    let told = format!("{}: {retry}", self.command);
                    self.retries.borrow_mut().push(told);
                }
                Event::Failed(failure) => return Err(CaseError::Failure(Retry::in_vain(&failure))),
                Event::Unfinished => {}
            }
        }
    }

    /// Runs frame by frame to the scene's end; `look` sees the simulation at the start and after each.
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

    /// Runs to the scene's end; a row of totals a frame, the start's first.
    pub(super) fn rows(&mut self) -> Result<Vec<Diagnostics>, CaseError> {
        let mut rows = Vec::new();
        self.frames(|simulation| rows.push(simulation.diagnostics()))?;
        Ok(rows)
    }

    fn keep_probes(&mut self, taken: Vec<ProbeSamples>) {
        if self.probes.is_empty() {
            self.probes = taken;
            return;
        }
        for (all, new) in self.probes.iter_mut().zip(taken) {
            all.samples.extend(new.samples);
        }
    }

    /// One number of what a probe has read; nothing if there is no such probe.
    pub(super) fn probe(&mut self, name: &str, column: usize) -> Series {
        let latest = self.simulation_mut().take_probe_samples();
        self.keep_probes(latest);
        let probe = self.probes.iter().find(|probe| probe.name == name);
        let samples = probe.map_or(&[][..], |probe| &probe.samples);
        let point = |sample: &lahar::ProbeSample| Some((sample.time, *sample.values.get(column)?));
        samples.iter().filter_map(point).collect()
    }
}

/// The numbers of a field, particle after particle by ascending id.
pub(super) fn field(simulation: &dyn Simulate, field: Field) -> Vec<f64> {
    let snapshot = simulation.snapshot(&[field]);
    snapshot.get(field).map(Data::to_f64).unwrap_or_default()
}

/// Σ m v_axis f(x) / Σ m f(x)²: how much of a mode the velocities hold.
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
