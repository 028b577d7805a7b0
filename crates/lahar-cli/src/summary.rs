//! The text of a run: before it begins, after it has ended, and for a dry run.

use std::process::ExitCode;

use lahar_io::checkpoint::Progress;
use lahar_io::output::{OutputCounts, Record, RunFolder};
use lahar_lab::numbers::{duration, with_prefix};
use lahar_lab::shell;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::frame_loop::End;
use crate::run_plan::RunPlan;
use crate::{show, terminal};

/// Returns the line that announces a run. `from` is the progress of a run that is resumed.
pub(crate) fn announcement(
    plan: &RunPlan,
    record: &Record,
    folder: &RunFolder,
    from: Option<&Progress>,
) -> String {
    let frames = match from {
        None => format!("{} frames of", plan.frames),
        Some(progress) => format!(
            "resumed from frame {} of {}, each of",
            progress.frame, plan.frames
        ),
    };
    format!(
        "{}: {} particles, {frames} {:.4} s, {} on {} thread(s), into {}",
        plan.scene.title,
        record.particles,
        1.0 / plan.scene.frame_rate,
        record.isa,
        plan.threads,
        folder.path().display(),
    )
}

/// Prints the result of a run, as one JSON document if `as_json`.
pub(crate) fn print(
    plan: &RunPlan,
    record: &Record,
    folder: &RunFolder,
    end: End,
    written: OutputCounts,
    as_json: bool,
) {
    if as_json {
        let mut value = serde_json::to_value(record).unwrap_or_else(|_| json!({}));
        if let Value::Object(map) = &mut value {
            // The scene is long, and it is in run.json.
            map.remove("scene");
            map.insert("folder".to_owned(), json!(folder.path()));
            map.insert("formats".to_owned(), json!(plan.outputs.formats.names()));
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
        print_files(folder, written);
    }
    match end {
        End::Done => {}
        End::Deadline => terminal::note(&format!(
            "stopped at t = {:.3} s of {:.3} s to end within a minute; `lahar resume {}` continues to the end",
            record.time,
            plan.scene.duration,
            shell::quoted_path(folder.path()),
        )),
        End::Interrupted => terminal::note(&format!(
            "interrupted after {} of {} frames; `lahar resume {}` continues",
            record.frames,
            plan.frames + 1,
            shell::quoted_path(folder.path()),
        )),
    }
}

/// Lists the files of a run.
fn print_files(folder: &RunFolder, written: OutputCounts) {
    let mut files = Vec::new();
    if written.film {
        files.push(folder.video().display().to_string());
    }
    if written.images > 0 {
        let images = folder.images();
        files.push(format!(
            "{}/ ({} pictures)",
            images.display(),
            written.images
        ));
    }
    if written.particles > 0 {
        let frames = folder.frames();
        files.push(format!(
            "{}/ ({} frames)",
            frames.display(),
            written.particles
        ));
    }
    files.push(folder.diagnostics().display().to_string());
    if folder.probes().is_dir() {
        files.push(format!("{}/", folder.probes().display()));
    }
    files.push(folder.record().display().to_string());
    for file in files {
        terminal::print(&format!("  {file}\n"));
    }
}

/// Prints what a run would do, as one JSON document if `as_json`.
pub(crate) fn dry_run(plan: &RunPlan, as_json: bool) -> Result<ExitCode, CliError> {
    let mut value = show::describe(&plan.scene, plan.isa)?;
    let folder = match &plan.folder {
        Some(path) => path.display().to_string(),
        None => format!("out/{}", plan.name()),
    };
    if let Value::Object(map) = &mut value {
        map.insert("status".to_owned(), json!("dry-run"));
        map.insert("frames".to_owned(), json!(plan.frames));
        map.insert("threads".to_owned(), json!(plan.threads));
        map.insert("formats".to_owned(), json!(plan.outputs.formats.names()));
        map.insert("folder".to_owned(), json!(folder));
    }
    if as_json {
        terminal::print_json(&value);
    } else {
        terminal::print(&show::text(&value));
        terminal::print(&format!(
            "would write frame 0 and {} more ({}) into {folder} on {} thread(s)\n",
            plan.frames,
            plan.outputs.formats.names().join(", "),
            plan.threads,
        ));
    }
    Ok(ExitCode::SUCCESS)
}
