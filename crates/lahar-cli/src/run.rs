//! `lahar run`: frames until the end, an error, Ctrl-C or the deadline; whatever ends it, the folder is whole.

use std::process::ExitCode;

use lahar::{Advance, DtLimit, Failure, Field, Retry, Simulate};
use lahar_io::image::Scenery;
use lahar_io::output::{
    self, OutputError, PhaseSeconds, Record, RunFolder, Status, Writer, Written,
};
use serde_json::{Value, json};

use crate::error::{CliError, INTERRUPTED};
use crate::plan::Plan;
use crate::progress::{Progress, Standing, duration, with_prefix};
use crate::{clock, interrupt, show, terminal};

/// Runs `plan`; the report is one JSON document if `as_json`.
pub(crate) fn run(plan: Plan, as_json: bool) -> Result<ExitCode, CliError> {
    if plan.dry_run {
        return dry_run(&plan, as_json);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(plan.threads)
        .thread_name(|index| format!("lahar-{index}"))
        .build()
        .map_err(|error| {
            CliError::Machine(format!("cannot start {} threads: {error}", plan.threads))
        })?;
    interrupt::watch()?;
    let built = pool.install(|| plan.scene.build(plan.isa))?;
    for warning in &built.warnings {
        terminal::note(&format!("warning: {warning}"));
    }
    let folder = plan.make_folder()?;
    let mut simulation = built.simulation;
    simulation.set_clock(clock::seconds);
    let mut record = first_record(&plan, &*simulation, built.warnings);
    record.write(&folder.record())?;
    if let Some(what) = announcement(&plan, &record, &folder) {
        terminal::note(&what);
    }

    let models: Vec<&str> = plan
        .scene
        .materials
        .iter()
        .map(|material| material.model.as_str())
        .collect();
    let scenery = Scenery::of(&*simulation, &models).with_colliders(&plan.scene.colliders);
    let writer = Writer::start(output::Plan {
        folder: folder.clone(),
        dimension: simulation.dimension(),
        formats: plan.formats.particles.clone(),
        pictures: plan.pictures(&scenery),
        film: plan.film(&scenery),
    });
    let outcome = writer.map_err(Stop::Output).and_then(|writer| {
        pool.install(|| {
            let mut going = Going {
                plan: &plan,
                simulation: &mut *simulation,
                writer,
                fields: plan.fields(),
                startup_seconds: 0.0,
                output_seconds: 0.0,
                particle_steps: 0,
                retries: Vec::new(),
            };
            let end = going.frames();
            record.retries = core::mem::take(&mut going.retries);
            record.particle_steps = going.particle_steps;
            record.startup_seconds = going.startup_seconds;
            record.phase_seconds = going.phase_seconds();
            // The film is made even if the run failed: it shows how.
            let waited = clock::seconds();
            let written = going.writer.finish();
            record.phase_seconds.output += clock::seconds() - waited;
            match (end, written) {
                (Err(stop), _) => Err(stop),
                (Ok(_), Err(error)) => Err(Stop::Output(error)),
                (Ok(end), Ok(written)) => Ok((end, written)),
            }
        })
    });

    finish_record(&mut record, &*simulation, &outcome);
    let recorded = record.write(&folder.record());
    match outcome {
        Err(Stop::Failure { failure, frame }) => Err(CliError::Simulation {
            what: Retry::in_vain(&failure),
            folder: folder.path().to_owned(),
            frames: frame,
        }),
        Err(Stop::Output(error)) => Err(error.into()),
        Ok((end, written)) => {
            recorded?;
            report(&plan, &record, &folder, end, written, as_json);
            Ok(match end {
                End::Interrupted => ExitCode::from(INTERRUPTED),
                End::Done | End::Deadline => ExitCode::SUCCESS,
            })
        }
    }
}

/// Why the frames ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Done,
    Interrupted,
    Deadline,
}

/// What to do about a step that was too long.
const FIXED_STEP: &str = "; the scene fixes dt, a shorter one would spare this";

/// So many substeps.
fn take(simulation: &mut dyn Simulate, substeps: u64) -> Result<Advance, Failure> {
    let mut whole = Advance {
        dt_min: f64::INFINITY,
        ..Advance::default()
    };
    for _ in 0..substeps {
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
    simulation: &'a mut dyn Simulate,
    writer: Writer,
    fields: Vec<Field>,
    /// Seconds before the first substep, without output.
    startup_seconds: f64,
    output_seconds: f64,
    particle_steps: u64,
    retries: Vec<String>,
}

impl Going<'_> {
    fn frames(&mut self) -> Result<End, Stop> {
        let mut progress = Progress::new(self.plan.frames);
        let end = self.frames_with(&mut progress);
        progress.finish();
        end
    }

    fn frames_with(&mut self, progress: &mut Progress) -> Result<End, Stop> {
        self.write(0).map_err(Stop::Output)?;
        self.startup_seconds = clock::seconds() - self.output_seconds;
        for frame in 1..=self.plan.frames {
            if interrupt::asked_to_stop() {
                return Ok(End::Interrupted);
            }
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
            self.particle_steps += particles * advance.substeps;
            self.write(frame).map_err(Stop::Output)?;
            progress.update(&Standing {
                frame,
                time: self.simulation.time(),
                rate: self.particle_steps as f64 / self.solving_seconds().max(1e-9),
                seconds: clock::seconds(),
                advance,
            });
        }
        Ok(End::Done)
    }

    /// Seconds since the first substep, without output.
    fn solving_seconds(&self) -> f64 {
        clock::seconds() - self.startup_seconds - self.output_seconds
    }

    fn phase_seconds(&self) -> PhaseSeconds {
        PhaseSeconds::new(
            self.simulation.phase_times(),
            self.solving_seconds(),
            self.output_seconds,
        )
    }

    /// A frame, with shorter time steps if it fails.
    fn advance(&mut self, number: u64, progress: &Progress) -> Result<Advance, Failure> {
        let scene = &self.plan.scene;
        let retries = &mut self.retries;
        lahar::frame(
            &mut *self.simulation,
            |simulation| match scene.substeps_per_frame {
                Some(substeps) => take(simulation, substeps),
                None => simulation.advance_to(number as f64 / scene.frame_rate),
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
        result
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
        Ok((End::Interrupted, _)) => Status::Interrupted,
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
    record.sorts = simulation.phase_times().sorts;
    record.seconds = clock::seconds();
    record.particle_steps_per_second =
        record.particle_steps as f64 / record.phase_seconds.solving().max(1e-9);
}

fn announcement(plan: &Plan, record: &Record, folder: &RunFolder) -> Option<String> {
    Some(format!(
        "{}: {} particles, {} frames of {:.4} s, {} on {} thread(s), into {}",
        plan.scene.title,
        record.particles,
        plan.frames,
        1.0 / plan.scene.frame_rate,
        record.isa,
        plan.threads,
        folder.path().display(),
    ))
}

/// What a run has come to.
fn report(
    plan: &Plan,
    record: &Record,
    folder: &RunFolder,
    end: End,
    written: Written,
    as_json: bool,
) {
    if as_json {
        let mut value = serde_json::to_value(record).unwrap_or_else(|_| json!({}));
        if let Value::Object(map) = &mut value {
            // The scene is in run.json; here it would bury the rest.
            map.remove("scene");
            map.insert("folder".to_owned(), json!(folder.path()));
            map.insert("formats".to_owned(), json!(plan.formats.names()));
            map.insert("images".to_owned(), json!(written.images));
            map.insert(
                "video".to_owned(),
                json!(written.film.then(|| folder.video())),
            );
        }
        terminal::print_json(&value);
    } else {
        terminal::print(&format!(
            "{} frames to t = {:.4} s, {} substeps in {} ({} particle-steps/s without output)\n",
            record.frames,
            record.time,
            record.substeps,
            duration(record.seconds),
            with_prefix(record.particle_steps_per_second),
        ));
        for (there, what) in [
            (written.film, folder.video().display().to_string()),
            (
                written.images > 0,
                format!(
                    "{}/ ({} pictures)",
                    folder.images().display(),
                    written.images
                ),
            ),
            (
                written.particles > 0,
                format!(
                    "{}/ ({} frames)",
                    folder.frames().display(),
                    written.particles
                ),
            ),
            (true, folder.diagnostics().display().to_string()),
            (
                folder.probes().is_dir(),
                format!("{}/", folder.probes().display()),
            ),
            (true, folder.record().display().to_string()),
        ] {
            if there {
                terminal::print(&format!("  {what}\n"));
            }
        }
    }
    match end {
        End::Done => {}
        End::Deadline => terminal::note(&format!(
            "stopped at t = {:.3} s of {:.3} s to end within a minute; `lahar run {}` goes to the end",
            record.time, plan.scene.duration, plan.scene.name
        )),
        End::Interrupted => terminal::note(&format!(
            "interrupted after {} of {} frames; what is in {} is whole. There is no checkpoint: `lahar run {} -o {} --overwrite` starts anew",
            record.frames,
            plan.frames + 1,
            folder.path().display(),
            plan.scene.name,
            folder.path().display(),
        )),
    }
}

fn dry_run(plan: &Plan, as_json: bool) -> Result<ExitCode, CliError> {
    let mut value = show::describe(&plan.scene, plan.isa)?;
    let folder = match &plan.folder {
        Some(path) => path.display().to_string(),
        None => format!("out/{}", plan.name()),
    };
    if let Value::Object(map) = &mut value {
        map.insert("status".to_owned(), json!("dry-run"));
        map.insert("frames".to_owned(), json!(plan.frames));
        map.insert("threads".to_owned(), json!(plan.threads));
        map.insert("formats".to_owned(), json!(plan.formats.names()));
        map.insert("folder".to_owned(), json!(folder));
    }
    if as_json {
        terminal::print_json(&value);
    } else {
        terminal::print(&show::text(&value));
        terminal::print(&format!(
            "would write {} and {} more frames ({}) into {folder} on {} thread(s)\n",
            "frame 0",
            plan.frames,
            plan.formats.names().join(", "),
            plan.threads,
        ));
    }
    Ok(ExitCode::SUCCESS)
}
