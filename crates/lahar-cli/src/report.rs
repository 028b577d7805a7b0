//! `lahar report`: writes one page of HTML about a run, with its pictures and plots inside.

use std::path::Path;
use std::process::ExitCode;

use lahar_io::files::write_file;
use lahar_io::image::{Picture, Scenery};
use lahar_io::output::{Recording, read_record};
use lahar_lab::run_page;

use crate::error::CliError;
use crate::{appearance, args, recorded_frames, terminal};

/// Number of pictures of a run's particles.
const PICTURE_COUNT: usize = 4;

/// Width and height of a picture \[pixels\].
const PICTURE_SIZE: [u32; 2] = [640, 360];

/// Writes the page of `args.run`.
pub(crate) fn report(args: &args::Report) -> Result<ExitCode, CliError> {
    let folder = match args.run.ends_with("run.json") {
        true => args.run.parent().unwrap_or(Path::new("")),
        false => &args.run,
    };
    let (_, record) = read_record(folder).map_err(recorded_frames::unreadable)?;
    // Without particles, or if a file of the scene is gone, the page has no pictures.
    let pictures = match Recording::open(folder) {
        Ok(recording) => pictures(&recording).unwrap_or_default(),
        Err(_) => Vec::new(),
    };
    let page = run_page::html(folder, &record, &pictures)?;
    let path = match &args.output {
        Some(path) => path.clone(),
        None => folder.join("report.html"),
    };
    write_file(&path, page)?;
    terminal::print(&format!("  {}\n", path.display()));
    Ok(ExitCode::SUCCESS)
}

/// Draws pictures from the run's start to its end, each with a caption.
fn pictures(recording: &Recording) -> Result<Vec<(String, Picture)>, CliError> {
    let scene = recorded_frames::scene(recording, &[])?;
    let first = recording.frame(0).map_err(recorded_frames::unreadable)?;
    let renderer = appearance::renderer(&scene, &Scenery::recorded(&scene, &first), PICTURE_SIZE);
    let last = recording.len() - 1;
    let mut indices: Vec<usize> = (0..PICTURE_COUNT)
        .map(|i| i * last / (PICTURE_COUNT - 1))
        .collect();
    indices.dedup();
    let mut pictures = Vec::new();
    for index in indices {
        let snapshot = recording
            .frame(index)
            .map_err(recorded_frames::unreadable)?;
        let caption = format!("t = {:.3} s", snapshot.time);
        pictures.push((caption, renderer.render(&snapshot)));
    }
    Ok(pictures)
}
