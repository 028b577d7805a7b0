//! `lahar resume`: takes a run from its newest usable checkpoint, or from the beginning, to its end or a later one.

use std::fs;
use std::process::ExitCode;

use lahar::Checkpoint;
use lahar_io::checkpoint::{Header, Newest, Start, StartError, Store};
use lahar_io::output::{Record, RunFolder, Status};
use lahar_lab::shell;
use lahar_scene::scene::Scene;
use serde_json::json;

use crate::args;
use crate::error::CliError;
use crate::run::{self, Origin};
use crate::run_plan::RunPlan;
use crate::terminal;

/// Resumes the run in `args.folder`.
pub(crate) fn resume(args: &args::Resume) -> Result<ExitCode, CliError> {
    let folder = RunFolder::of_run(&args.folder)?;
    let checkpoints = folder.checkpoints();
    let mut start = Start::read(&checkpoints)?;
    if start.lahar != env!("CARGO_PKG_VERSION") {
        return Err(CliError::Usage(format!(
            "{} was started by lahar {}, and this is {}, which would give other bits; use that version",
            folder.path().display(),
            start.lahar,
            env!("CARGO_PKG_VERSION")
        )));
    }
    let scene = start.scene(&checkpoints).map_err(|error| match error {
        StartError::File(error) => CliError::Output(error),
        StartError::Scene(error) => CliError::Scene(error),
    })?;
    let finished = finished_record(&folder, start.frames);
    let last_frame = last_frame(args, &scene).unwrap_or(start.frames);
    if last_frame < start.frames {
        return Err(CliError::Usage(format!(
            "{} already goes to frame {}; it can only continue to a later one",
            folder.path().display(),
            start.frames
        )));
    }
    let is_extended = last_frame > start.frames;
    if let Some(record) = finished.as_ref().filter(|_| !is_extended) {
        report_finished(&folder, record, args.json);
        return Ok(ExitCode::SUCCESS);
    }
    start.frames = last_frame;
    let plan = RunPlan::of_start(&start, scene, args.threads, args.isa)?;
    let checkpoint = checkpoint(args, &folder, &start, &plan, finished.is_some())?;
    if is_extended {
        start.rewrite(&checkpoints)?;
    }
    let origin = Origin {
        folder,
        start,
        checkpoint,
    };
    run::begin(plan, Some(origin), args.json)
}

/// The last frame that the options ask for.
fn last_frame(args: &args::Resume, scene: &Scene) -> Option<u64> {
    match (args.frames, args.until) {
        (Some(frames), _) => Some(frames),
        // A little less, so that 0.1 s at 60 frames per second is 6 frames.
        (None, Some(time)) => Some((time * scene.frame_rate - 1e-9).ceil().max(1.0) as u64),
        (None, None) => None,
    }
}

/// The record of the run, if it is finished.
fn finished_record(folder: &RunFolder, frames: u64) -> Option<Record> {
    let record: Record = serde_json::from_slice(&fs::read(folder.record()).ok()?).ok()?;
    (record.status == Status::Done && record.frames > frames).then_some(record)
}

fn report_finished(folder: &RunFolder, record: &Record, as_json: bool) {
    if as_json {
        terminal::print_json(&json!({
            "status": "done",
            "folder": folder.path(),
            "frames": record.frames,
            "time": record.time,
        }));
    } else {
        let path = folder.path().display();
        terminal::print(&format!(
            "{path} is done: {} frames to t = {:.4} s; `lahar resume {} --until T` continues beyond its end\n",
            record.frames,
            record.time,
            shell::quoted_path(folder.path()),
        ));
    }
}

/// The newest checkpoint that can be used, with warnings about newer ones. `None`: the run starts over.
///
/// # Errors
/// If the run is finished and all its checkpoints are unusable: starting over would replace a whole run.
fn checkpoint(
    args: &args::Resume,
    folder: &RunFolder,
    start: &Start,
    plan: &RunPlan,
    is_finished: bool,
) -> Result<Option<(Header, Checkpoint)>, CliError> {
    let sum = start.sum();
    let usable = |header: &Header| {
        if header.start != sum || header.lahar != start.lahar {
            return Err("it is of another run".to_owned());
        }
        if header.isa != plan.isa.name() && args.isa.is_none() {
            return Err(format!(
                "it was made with the instruction set {}",
                header.isa
            ));
        }
        header.progress.output.check(folder.path())
    };
    let Newest { found, refused } = Store::new(&folder.checkpoints()).newest(usable);
    for error in &refused {
        terminal::note(&format!("warning: {error}"));
    }
    let Some((_, mut header, checkpoint)) = found else {
        if is_finished && !refused.is_empty() {
            return Err(CliError::Usage(format!(
                "{} is finished and none of its checkpoints can be used, so it cannot continue beyond its end; `lahar run` into another folder makes a longer run",
                folder.path().display()
            )));
        }
        terminal::note(match refused.is_empty() {
            true => "there is no checkpoint yet: the run starts over",
            false => "warning: no checkpoint can be used: the run starts over",
        });
        return Ok(None);
    };
    let output = &mut header.progress.output;
    if let Some(reason) = output.forget_lost_film(folder.path()) {
        let last_frame = output.written.frames.saturating_sub(1);
        let kept = match folder.keep_old_video(last_frame)? {
            Some(path) => format!("; the film so far is {}", path.display()),
            None => String::new(),
        };
        terminal::note(&format!(
            "warning: {reason}: the film begins after frame {last_frame}{kept}"
        ));
    }
    let missing = output.missing(folder.path());
    if let Some(first) = missing.first() {
        terminal::note(&format!(
            "warning: {} file(s) written before the checkpoint are gone or cut, {first} the first; they are not made again: `lahar run` into another folder makes all",
            missing.len()
        ));
    }
    Ok(Some((header, checkpoint)))
}
