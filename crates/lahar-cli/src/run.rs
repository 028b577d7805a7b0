//! `lahar run`: frames until the end, an error, Ctrl-C or the deadline; whatever ends it, the folder is whole.

use std::process::ExitCode;

use lahar::{Advance, Checkpoint, DtLimit, Failure, Field, Retry, Simulate};
use lahar_io::checkpoint::{Header, Progress as Done, Start, Store};
use lahar_io::image::Scenery;
use lahar_io::output::{
    self, OutputError, PhaseSeconds, Record, RunFolder, Status, Writer, Written,
};

use crate::error::{CliError, INTERRUPTED};
use crate::plan::Plan;
use crate::progress::{Progress, Standing};
use crate::summary::{self, End};
use crate::{clock, interrupt, terminal};

/// What a run that goes on goes on from.
pub(crate) struct Origin {
    /// The run's folder.
    pub(crate) folder: RunFolder,
    /// What it began with.
    pub(crate) start: Start,
    /// A checkpoint; `None`: the beginning.
    pub(crate) checkpoint: Option<(Header, Checkpoint)>,
}

/// Runs `plan`; the report is one JSON document if `as_json`.
pub(crate) fn run(plan: Plan, as_json: bool) -> Result<ExitCode, CliError> {
    if plan.dry_run {
        return summary::dry_run(&plan, as_json);
    }
    begin(plan, None, as_json)
}

/// Runs `plan` from its beginning, or goes on with a run of it.
pub(crate) fn begin(
    plan: Plan,
    origin: Option<Origin>,
    as_json: bool,
) -> Result<ExitCode, CliError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(plan.threads)
        .thread_name(|index| format!("lahar-{index}"))
        .build()
        .map_err(|error| {
            CliError::Machine(format!("cannot start {} threads: {error}", plan.threads))
        })?;
    interrupt::watch()?;
    let built = pool.install(|| plan.scene.build(plan.isa))?;
    let mut simulation = built.simulation;
    let models: Vec<&str> = plan
        .scene
        .materials
        .iter()
        .map(|material| material.model.as_str())
        .collect();
    let scenery = Scenery::of(&*simulation, &models).with_colliders(&plan.scene.colliders);
    let (folder, start, checkpoint) = match origin {
        Some(origin) => (origin.folder, origin.start, origin.checkpoint),
        None => {
            for warning in &built.warnings {
                terminal::note(&format!("warning: {warning}"));
            }
            let folder = plan.make_folder()?;
            let mut start = plan.start(&built.warnings);
            start.write(&plan.scene, &folder.checkpoints())?;
            (folder, start, None)
        }
    };
    let progress = match checkpoint {
        Some((header, checkpoint)) => {
            simulation.resume(checkpoint).map_err(|error| {
                let folder = folder.path().display();
                CliError::Machine(format!("{folder}: the checkpoint cannot be used: {error}"))
            })?;
            Some(header.progress)
        }
        None => None,
    };
    simulation.set_clock(clock::seconds);
    let mut record = first_record(&plan, &*simulation, start.warnings.clone());
    record.write(&folder.record())?;
    terminal::note(&summary::announcement(
        &plan,
        &record,
        &folder,
        progress.as_ref(),
    ));

    let writer = Writer::start(
        output::Plan {
            folder: folder.clone(),
            dimension: simulation.dimension(),
            formats: plan.outputs.formats.particles.clone(),
            pictures: plan.pictures(&scenery),
            film: plan.film(&scenery),
        },
        progress.as_ref().map(|progress| &progress.output),
    );
    let outcome = writer.map_err(Stop::Output).and_then(|writer| {
        pool.install(|| {
            let mut going = Going::new(&plan, &start, &mut *simulation, writer, progress);
            let end = going.frames();
            let so_far = going.so_far();
            record.retries = so_far.retries;
            record.particle_steps = so_far.particle_steps;
            record.sorts = so_far.sorts;
            record.startup_seconds = so_far.startup_seconds;
            record.phase_seconds = so_far.phase_seconds;
            record.seconds = so_far.seconds;
            // The film is made even if the run failed: it shows how.
            let waited = clock::seconds();
            let written = going.writer.finish();
            let waited = clock::seconds() - waited;
            record.phase_seconds.output += waited;
            record.seconds += waited;
            match (end, written) {
                (Err(stop), _) => Err(stop),
                (Ok(_), Err(error)) => Err(Stop::Output(error)),
                (Ok(end), Ok(written)) => Ok((end, written)),
            }
        })
    });

    finish_record(&mut record, &*simulation, &outcome);
    let recorded = record.write(&folder.record());
    let newest = || {
        let all = Store::new(&folder.checkpoints()).all();
        all.into_iter().next().map(|(_, path)| path)
    };
    match outcome {
        Err(Stop::Failure { failure, frame }) => Err(CliError::Simulation {
            what: Retry::in_vain(&failure),
            folder: folder.path().to_owned(),
            frames: frame,
            checkpoint: newest(),
        }),
        Err(Stop::Output(error)) => Err(CliError::Broken {
            error,
            folder: folder.path().to_owned(),
            checkpoint: newest(),
        }),
        Ok((end, written)) => {
            recorded?;
            if end == End::Done {
                folder.forget_film_pictures()?;
            }
            summary::print(&plan, &record, &folder, end, written, as_json);
            Ok(match end {
                End::Interrupted => ExitCode::from(INTERRUPTED),
                End::Done | End::Deadline => ExitCode::SUCCESS,
            })
        }
    }
}

/// What to do about a step that was too long.
const FIXED_STEP: &str = "; the scene fixes dt, a shorter one would spare this";

/// So many substeps; fewer if `go_on`, asked before each, says no.
fn take(
    simulation: &mut dyn Simulate,
    substeps: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Advance, Failure> {
    let mut whole = Advance {
        dt_min: f64::INFINITY,
        ..Advance::default()
    };
    for _ in 0..substeps {
        if !go_on() {
            break;
        }
        let one = simulation.substep()?;
        whole.substeps += one.substeps;
        if one.dt_min < whole.dt_min {
            (whole.dt_min, whole.limit) = (one.dt_min, one.limit);
        }
    }
    Ok(whole)
}

/// What stopped the frames before their end.
enum Stop {
    Failure {
        failure: Box<Failure>,
        /// Frames before it.
        frame: u64,
    },
    Output(OutputError),
}

/// A run while it goes.
struct Going<'a> {
    plan: &'a Plan,
    start: &'a Start,
    simulation: &'a mut dyn Simulate,
    writer: Writer,
    fields: Vec<Field>,
    /// What was done before this program began with it.
    before: Done,
    /// Seconds before the first substep, without output; of this program.
    startup_seconds: f64,
    /// Seconds of output; of this program.
    output_seconds: f64,
    particle_steps: u64,
    retries: Vec<String>,
    /// How many of them there were when the last frame was written.
    settled_retries: usize,
    /// The last frame that was written; none yet at the very start.
    frame: Option<u64>,
    /// The frame of the last checkpoint, and when it was taken.
    kept: (Option<u64>, f64),
}

impl<'a> Going<'a> {
    fn new(
        plan: &'a Plan,
        start: &'a Start,
        simulation: &'a mut dyn Simulate,
        writer: Writer,
        progress: Option<Done>,
    ) -> Self {
        let frame = progress.as_ref().map(|progress| progress.frame);
        let before = progress.unwrap_or_default();
        Self {
            plan,
            start,
            simulation,
            writer,
            fields: plan.fields(),
            startup_seconds: 0.0,
            output_seconds: 0.0,
            particle_steps: before.particle_steps,
            retries: before.retries.clone(),
            settled_retries: before.retries.len(),
            frame,
            kept: (frame, clock::seconds()),
            before,
        }
    }

    fn frames(&mut self) -> Result<End, Stop> {
        let mut progress = Progress::new(self.plan.frames);
        let end = self.frames_with(&mut progress);
        progress.finish();
        // Whatever it was that ended the frames before their time, the run can go on from here: a frame that
        // failed or was given up is as if it had not begun.
        let more = !matches!(end, Ok(End::Done)) || self.is_kept();
        if more && !matches!(end, Err(Stop::Output(_))) {
            self.keep().map_err(Stop::Output)?;
        }
        end
    }

    fn frames_with(&mut self, progress: &mut Progress) -> Result<End, Stop> {
        let first = match self.frame {
            Some(frame) => frame + 1,
            None => {
                self.write(0).map_err(Stop::Output)?;
                1
            }
        };
        self.startup_seconds = clock::seconds() - self.output_seconds;
        for frame in first..=self.plan.frames {
            if self
                .plan
                .deadline
                .is_some_and(|deadline| clock::seconds() > deadline)
            {
                return Ok(End::Deadline);
            }
            let particles = self.simulation.particle_count() as u64;
            let advance = self
                .advance(frame, progress)
                .map_err(|failure| Stop::Failure {
                    failure: Box::new(failure),
                    frame,
                })?;
            if interrupt::asked_to_stop() {
                self.simulation.give_up_frame();
                self.retries.truncate(self.settled_retries);
                return Ok(End::Interrupted);
            }
            self.particle_steps += particles * advance.substeps;
            self.write(frame).map_err(Stop::Output)?;
            if self.is_due(frame) {
                self.keep().map_err(Stop::Output)?;
            }
            let steps = self.particle_steps - self.before.particle_steps;
            progress.update(&Standing {
                frame,
                time: self.simulation.time(),
                rate: steps as f64 / self.solving_seconds().max(1e-9),
                seconds: clock::seconds(),
                advance,
            });
        }
        Ok(End::Done)
    }

    /// Seconds of this program since the first substep, without output.
    fn solving_seconds(&self) -> f64 {
        clock::seconds() - self.startup_seconds - self.output_seconds
    }

    /// A frame, with shorter time steps if it fails.
    fn advance(&mut self, number: u64, progress: &Progress) -> Result<Advance, Failure> {
        let scene = &self.plan.scene;
        let retries = &mut self.retries;
        let mut go_on = || !interrupt::asked_to_stop();
        lahar::frame(
            &mut *self.simulation,
            |simulation| match scene.substeps_per_frame {
                Some(substeps) => take(simulation, substeps, &mut go_on),
                None => simulation.advance_while(number as f64 / scene.frame_rate, &mut go_on),
            },
            |retry| {
                let fixed = retry.failure.dt_limit == DtLimit::Fixed;
                let advice = if fixed { FIXED_STEP } else { "" };
                progress.note(&format!("warning: {retry}{advice}"));
                retries.push(retry.to_string());
            },
        )
    }

    /// Hands a frame to the writing thread.
    fn write(&mut self, frame: u64) -> Result<(), OutputError> {
        let (before, sorted) = (clock::seconds(), self.simulation.phase_times().sort);
        let due = frame.is_multiple_of(self.plan.scene.output.every.max(1));
        let snapshot =
            (due && !self.fields.is_empty()).then(|| self.simulation.snapshot(&self.fields));
        let diagnostics = self.simulation.diagnostics();
        let probes = self.simulation.take_probe_samples();
        let result = self.writer.frame(frame, snapshot, diagnostics, probes);
        // Diagnostics sort if the next substep would have: that is no output.
        let sorting = self.simulation.phase_times().sort - sorted;
        self.output_seconds += clock::seconds() - before - sorting;
        self.frame = Some(frame);
        self.settled_retries = self.retries.len();
        result
    }

    /// Whether this run keeps checkpoints by frames, or has kept one.
    fn is_kept(&self) -> bool {
        self.plan.scene.output.checkpoint_every > 0 || self.kept.0.is_some()
    }

    /// Whether it is time for a checkpoint.
    fn is_due(&self, frame: u64) -> bool {
        let output = &self.plan.scene.output;
        let by_frames =
            output.checkpoint_every > 0 && frame.is_multiple_of(output.checkpoint_every);
        let minutes = (clock::seconds() - self.kept.1) / 60.0;
        by_frames || output.checkpoint_minutes > 0.0 && minutes >= output.checkpoint_minutes
    }

    /// Hands a checkpoint after the last frame to the writing thread.
    fn keep(&mut self) -> Result<(), OutputError> {
        if self.frame.is_none() || self.kept.0 == self.frame {
            return Ok(());
        }
        let before = clock::seconds();
        let header = Header {
            lahar: self.start.lahar.clone(),
            dimension: self.simulation.dimension(),
            precision: self.simulation.precision().to_owned(),
            isa: self.simulation.isa().name().to_owned(),
            start: self.start.sum(),
            progress: Done {
                retries: self.retries[..self.settled_retries].to_vec(),
                ..self.so_far()
            },
        };
        let result = self.writer.checkpoint(header, self.simulation.checkpoint());
        self.output_seconds += clock::seconds() - before;
        self.kept = (self.frame, clock::seconds());
        result
    }

    /// How far the run is, from its beginning.
    fn so_far(&self) -> Done {
        let phases = self.simulation.phase_times();
        let before = &self.before;
        Done {
            frame: self.frame.unwrap_or_default(),
            particle_steps: self.particle_steps,
            sorts: before.sorts + phases.sorts,
            retries: self.retries.clone(),
            startup_seconds: before.startup_seconds + self.startup_seconds,
            seconds: before.seconds + clock::seconds(),
            phase_seconds: before.phase_seconds
                + PhaseSeconds::new(phases, self.solving_seconds(), self.output_seconds),
            output: Default::default(), // the writing thread knows
        }
    }
}

fn first_record(plan: &Plan, simulation: &dyn Simulate, warnings: Vec<String>) -> Record {
    Record {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        status: Status::Running,
        failure: None,
        scene_name: plan.scene.name.clone(),
        scene: plan.scene.resolved(),
        seed: plan.scene.seed,
        dimension: simulation.dimension(),
        precision: simulation.precision().to_owned(),
        isa: simulation.isa().name().to_owned(),
        threads: plan.threads,
        frames: 0,
        time: 0.0,
        substeps: 0,
        particles: simulation.particle_count() as u64,
        particle_steps: 0,
        particle_steps_per_second: 0.0,
        startup_seconds: 0.0,
        seconds: 0.0,
        phase_seconds: PhaseSeconds::default(),
        sorts: 0,
        warnings,
        retries: Vec::new(),
    }
}

fn finish_record(
    record: &mut Record,
    simulation: &dyn Simulate,
    outcome: &Result<(End, Written), Stop>,
) {
    record.status = match outcome {
        Ok((End::Interrupted | End::Deadline, _)) => Status::Interrupted,
        Ok(_) => Status::Done,
        Err(_) => Status::Failed,
    };
    match outcome {
        Ok((_, written)) => record.frames = written.frames,
        Err(Stop::Failure { failure, frame }) => {
            record.frames = *frame;
            record.failure = Some(Retry::in_vain(failure));
        }
        Err(Stop::Output(error)) => record.failure = Some(error.to_string()),
    }
    record.time = simulation.time();
    record.substeps = simulation.substeps();
    record.particles = simulation.particle_count() as u64;
    record.particle_steps_per_second =
        record.particle_steps as f64 / record.phase_seconds.solving().max(1e-9);
}
