//! What a run says of itself: before it begins, and when it has ended.

use std::process::ExitCode;

use lahar_io::checkpoint::Progress;
use lahar_io::output::{OutputCounts, Record, RunFolder};
use serde_json::{Value, json};

use crate::error::CliError;
use crate::run_plan::RunPlan;
use crate::{show, terminal};
use lahar_lab::numbers::{duration, with_prefix};

/// Why the frames ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// All are there.
    Done,
    /// Ctrl-C.
    Interrupted,
    /// There was no more time.
    Deadline,
}

/// What is about to be run.
pub(crate) fn announcement(
    plan: &RunPlan,
    record: &Record,
    folder: &RunFolder,
    from: Option<&Progress>,
) -> String {
    let which = match from {
        None => format!("{} frames", plan.frames),
        Some(progress) => format!("on from frame {} of {}", progress.frame, plan.frames),
    };
    format!(
        "{}: {} particles, {which} of {:.4} s, {} on {} thread(s), into {}",
        plan.scene.title,
        record.particles,
        1.0 / plan.scene.frame_rate,
        record.isa,
        plan.threads,
        folder.path().display(),
    )
}

/// What a run has come to.
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
            // The scene is in run.json; here it would bury the rest.
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
            "stopped at t = {:.3} s of {:.3} s to end within a minute; `lahar resume {}` goes on to the end",
            record.time,
            plan.scene.duration,
            folder.path().display(),
        )),
        End::Interrupted => terminal::note(&format!(
            "interrupted after {} of {} frames; `lahar resume {}` goes on",
            record.frames,
            plan.frames + 1,
            folder.path().display(),
        )),
    }
}

/// What would be done.
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
            "would write {} and {} more frames ({}) into {folder} on {} thread(s)\n",
            "frame 0",
            plan.frames,
            plan.outputs.formats.names().join(", "),
            plan.threads,
        ));
    }
    Ok(ExitCode::SUCCESS)
}
