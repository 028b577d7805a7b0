//! `lahar resume`: from the newest checkpoint that can be used, or from the beginning, to the end.

use std::fs;
use std::process::ExitCode;

use lahar_io::checkpoint::{Header, Newest, Start, Store, Unusable};
use lahar_io::output::{Record, RunFolder, Status};
use serde_json::json;

use crate::args;
use crate::error::CliError;
use crate::plan::Plan;
use crate::run::{self, Origin};
use crate::terminal;

/// Goes on with the run in `args.folder`.
pub(crate) fn resume(args: &args::Resume) -> Result<ExitCode, CliError> {
    let folder = RunFolder::of_run(&args.folder)?;
    let checkpoints = folder.checkpoints();
    let mut start = Start::read(&checkpoints)?;
    if start.lahar != env!("CARGO_PKG_VERSION") {
        return Err(CliError::Usage(format!(
            "{} was begun by lahar {}, this is {}: it would go on with other bits; use that version",
            folder.path().display(),
            start.lahar,
            env!("CARGO_PKG_VERSION")
        )));
    }
    let scene = start.scene(&checkpoints).map_err(|error| match error {
        Unusable::File(error) => CliError::Output(error),
        Unusable::Scene(error) => CliError::Scene(error),
    })?;
    let end = match (args.frames, args.until) {
        (Some(frames), _) => Some(frames),
        // A little less, so that 0.1 s at 60 frames a second is 6 frames.
        (None, Some(time)) => Some((time * scene.frame_rate - 1e-9).ceil().max(1.0) as u64),
        (None, None) => None,
    };
    if let Some(end) = end.filter(|end| *end != start.frames) {
        if end < start.frames {
            return Err(CliError::Usage(format!(
                "{} goes to frame {} already; it can go on to a later one",
                folder.path().display(),
                start.frames
            )));
        }
        start.frames = end;
        start.rewrite(&checkpoints)?;
    } else if let Some(record) = done(&folder, start.frames) {
        let what = format!(
            "{} is done: {} frames to t = {:.4} s",
            folder.path().display(),
            record.frames,
            record.time
        );
        if args.json {
            terminal::print_json(&json!({
                "status": "done",
                "folder": folder.path(),
                "frames": record.frames,
                "time": record.time,
            }));
        } else {
            terminal::print(&format!(
                "{what}; `lahar resume {} --until T` goes on beyond its end\n",
                folder.path().display()
            ));
        }
        return Ok(ExitCode::SUCCESS);
    }
    let plan = Plan::of_start(&start, scene, args.threads, args.isa)?;
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
    let Newest { found, refused } = Store::new(&checkpoints).newest(usable);
    for error in &refused {
        terminal::note(&format!("warning: {error}"));
    }
    if found.is_none() {
        terminal::note(match refused.is_empty() {
            true => "there is no checkpoint yet: the run starts over",
            false => "warning: no checkpoint can be used: the run starts over",
        });
    }
    let checkpoint = found.map(|(_, header, checkpoint)| {
        let missing = header.progress.output.missing(folder.path());
        if let Some(first) = missing.first() {
            terminal::note(&format!(
                "warning: {} file(s) written before the checkpoint are gone or cut, {first} the first; they are not made again: `lahar run` into another folder makes all",
                missing.len()
            ));
        }
        (header, checkpoint)
    });
    let origin = Origin {
        folder,
        start,
        checkpoint,
    };
    run::begin(plan, Some(origin), args.json)
}

/// The record of a run that is done.
fn done(folder: &RunFolder, frames: u64) -> Option<Record> {
    let record: Record = serde_json::from_slice(&fs::read(folder.record()).ok()?).ok()?;
    (record.status == Status::Done && record.frames > frames).then_some(record)
}
