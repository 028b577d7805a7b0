//! `lahar run`: makes the run's folder, simulates its frames into it, and reports how it went.
//!
//! However a run ends (finished, failed, interrupted, or out of time), its folder is left whole.

use std::path::PathBuf;
use std::process::ExitCode;

use lahar::{Checkpoint, Retry, Simulate};
use lahar_io::checkpoint::{self, Header, Start, Store};
use lahar_io::image::Scenery;
use lahar_io::output::{self, OutputCounts, PhaseSeconds, Record, RunFolder, Status, Writer};
use lahar_scene::driver::Driver;

use crate::error::{CliError, INTERRUPTED};
use crate::frame_loop::{End, FrameLoop, RunError};
use crate::run_plan::RunPlan;
use crate::{clock, interrupt, summary, terminal, threads};

/// The run that `lahar resume` continues.
pub(crate) struct Origin {
    /// The run's folder.
    pub(crate) folder: RunFolder,
    /// The run's `start.json`.
    pub(crate) start: Start,
    /// The checkpoint to continue from; `None`: from the beginning.
    pub(crate) checkpoint: Option<(Header, Checkpoint)>,
}

/// Runs `plan`, or describes it if it is a dry run. The report is one JSON document if `as_json`.
pub(crate) fn run(plan: RunPlan, as_json: bool) -> Result<ExitCode, CliError> {
    if plan.dry_run {
        return summary::dry_run(&plan, as_json);
    }
    begin(plan, None, as_json)
}

/// Runs `plan` from its beginning, or continues the run in `origin`.
pub(crate) fn begin(
    plan: RunPlan,
    origin: Option<Origin>,
    as_json: bool,
) -> Result<ExitCode, CliError> {
    let pool = threads::pool(plan.threads)?;
    interrupt::watch()?;
    let built = pool.install(|| plan.scene.build(plan.isa))?;
    let scenery = scenery(&plan, &*built.simulation);
    let Origin {
        folder,
        start,
        checkpoint,
    } = match origin {
        Some(origin) => origin,
        None => new_run(&plan, &built.warnings)?,
    };
    let mut driver = Driver::of_scene(&plan.scene, built.simulation).with_clock(clock::seconds);
    let mut resumed = None;
    if let Some((header, checkpoint)) = checkpoint {
        (driver.simulation_mut().resume(checkpoint)).map_err(|error| {
            let folder = folder.path().display();
            CliError::Machine(format!("{folder}: the checkpoint cannot be used: {error}"))
        })?;
        driver = driver.resumed_after(header.progress.frame);
        resumed = Some(header.progress);
    }
    let mut record = first_record(&plan, driver.simulation(), start.warnings.clone());
    record.write(&folder.record())?;
    let announcement = summary::announcement(&plan, &record, &folder, resumed.as_ref());
    terminal::note(&announcement);

    let outcome = pool.install(|| {
        let writer = writer(&plan, &folder, &scenery, &driver, resumed.as_ref())?;
        let mut frames = FrameLoop::new(&plan, &start, &mut driver, writer, resumed);
        let end = frames.run();
        record_progress(&mut record, frames.progress());
        // The film is made even if the simulation failed: it shows how.
        let waiting_since = clock::seconds();
        let written = frames.into_writer().finish();
        let waited = clock::seconds() - waiting_since;
        record.phase_seconds.output += waited;
        record.seconds += waited;
        Ok((end?, written.map_err(RunError::Output)?))
    });
    record_outcome(&mut record, driver.simulation(), &outcome);
    let recorded = record.write(&folder.record());
    let (end, written) = outcome.map_err(|error| into_cli_error(error, &folder))?;
    recorded?;
    summary::print(&plan, &record, &folder, end, written, as_json);
    Ok(match end {
        End::Interrupted => ExitCode::from(INTERRUPTED),
        End::Done | End::Deadline => ExitCode::SUCCESS,
    })
}

/// The parts of the scene that pictures show beside its particles.
fn scenery(plan: &RunPlan, simulation: &dyn Simulate) -> Scenery {
    let materials = plan.scene.materials.iter();
    let models: Vec<&str> = materials.map(|material| material.model.as_str()).collect();
    Scenery::of(simulation, &models).with_colliders(&plan.scene.colliders)
}

/// Makes the folder of a new run, with its `start.json`, and prints the scene's warnings.
fn new_run(plan: &RunPlan, warnings: &[String]) -> Result<Origin, CliError> {
    for warning in warnings {
        terminal::note(&format!("warning: {warning}"));
    }
    let folder = plan.make_folder()?;
    let mut start = plan.start(warnings);
    start.write(&plan.scene, &folder.checkpoints())?;
    Ok(Origin {
        folder,
        start,
        checkpoint: None,
    })
}

/// Starts the thread that writes the run's files.
fn writer(
    plan: &RunPlan,
    folder: &RunFolder,
    scenery: &Scenery,
    driver: &Driver,
    resumed: Option<&checkpoint::Progress>,
) -> Result<Writer, RunError> {
    let written = output::OutputPlan {
        folder: folder.clone(),
        dimension: driver.simulation().dimension(),
        formats: plan.outputs.formats.particles.clone(),
        pictures: plan.pictures(scenery),
        film: plan.film(scenery),
    };
    Writer::start(written, resumed.map(|progress| &progress.output)).map_err(RunError::Output)
}

/// The record of a run whose first frame is not written yet.
fn first_record(plan: &RunPlan, simulation: &dyn Simulate, warnings: Vec<String>) -> Record {
    Record {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        status: Status::Running,
        failure: None,
        scene_name: plan.scene.name.clone(),
        scene: plan.scene.resolved(),
        seed: plan.scene.seed,
        dimension: simulation.dimension(),
        precision: simulation.precision().to_owned(),
        isa: simulation.backend().instruction_set,
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

fn record_progress(record: &mut Record, progress: checkpoint::Progress) {
    record.retries = progress.retries;
    record.particle_steps = progress.particle_steps;
    record.sorts = progress.sorts;
    record.startup_seconds = progress.startup_seconds;
    record.phase_seconds = progress.phase_seconds;
    record.seconds = progress.seconds;
}

fn record_outcome(
    record: &mut Record,
    simulation: &dyn Simulate,
    outcome: &Result<(End, OutputCounts), RunError>,
) {
    record.status = match outcome {
        Ok((End::Interrupted | End::Deadline, _)) => Status::Interrupted,
        Ok((End::Done, _)) => Status::Done,
        Err(_) => Status::Failed,
    };
    match outcome {
        Ok((_, written)) => record.frames = written.frames,
        Err(RunError::Simulation { failure, frame }) => {
            record.frames = *frame;
            record.failure = Some(Retry::in_vain(failure));
        }
        Err(RunError::Output(error)) => record.failure = Some(error.to_string()),
    }
    record.time = simulation.time();
    record.substeps = simulation.substeps();
    record.particles = simulation.particle_count() as u64;
    record.particle_steps_per_second =
        record.particle_steps as f64 / record.phase_seconds.solving().max(1e-9);
}

/// The error with the run's folder and its newest checkpoint.
fn into_cli_error(error: RunError, folder: &RunFolder) -> CliError {
    let checkpoints: Vec<(u64, PathBuf)> = Store::new(&folder.checkpoints()).all();
    let checkpoint = checkpoints.into_iter().next().map(|(_, path)| path);
    let folder = folder.path().to_owned();
    match error {
        RunError::Simulation { failure, frame } => CliError::Simulation {
            message: Retry::in_vain(&failure),
            folder,
            frames: frame,
            checkpoint,
        },
        RunError::Output(error) => CliError::RunOutput {
            error,
            folder,
            checkpoint,
        },
    }
}
