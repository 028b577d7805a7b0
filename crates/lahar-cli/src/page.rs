//! `lahar report`: one page of HTML that tells how a run went, with all its pictures and plots in it.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use lahar_io::files::{confined, write_file};
use lahar_io::image::Scenery;
use lahar_io::output::{Record, Recording, Status, Table, read_record};

use crate::error::CliError;
use crate::progress::{duration, with_prefix};
use crate::{appearance, args, plot, recorded_frames, terminal};

/// Films larger than this are named instead of shown \[bytes\].
const LARGEST_FILM: u64 = 12 << 20;

/// Pictures drawn of a run's particles.
const PICTURES: usize = 4;

/// Their size \[pixels\].
const PICTURE: [u32; 2] = [640, 360];

/// Writes the page of `args.run`.
pub(crate) fn report(args: &args::Report) -> Result<ExitCode, CliError> {
    let folder = match args.run.ends_with("run.json") {
        true => args.run.parent().unwrap_or(Path::new("")),
        false => &args.run,
    };
    let (_, record) = read_record(folder).map_err(recorded_frames::unreadable)?;
    let page = page(folder, &record)?;
    let path = match &args.output {
        Some(path) => path.clone(),
        None => folder.join("report.html"),
    };
    write_file(&path, page)?;
    terminal::print(&format!("  {}\n", path.display()));
    Ok(ExitCode::SUCCESS)
}

fn page(folder: &Path, record: &Record) -> Result<String, CliError> {
    let title = match record.scene["title"].as_str() {
        Some(title) if !title.is_empty() => title,
        _ => &record.scene_name,
    };
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p>{1}</p>\n",
        escaped(title),
        escaped(&outcome(record)),
    );
    let notes = [("Warnings", &record.warnings), ("Retries", &record.retries)];
    for (heading, lines) in notes.iter().filter(|(_, lines)| !lines.is_empty()) {
        write_to(
            &mut page,
            format_args!("<h2>{heading}</h2>\n<ul class=\"notes\">\n"),
        );
        for line in *lines {
            write_to(&mut page, format_args!("<li>{}</li>\n", escaped(line)));
        }
        page += "</ul>\n";
    }
    page += &pictures(folder);
    page += "<h2>How it went</h2>\n";
    page += &numbers(record);
    let runs = [(String::new(), folder.to_owned())];
    page += "<h2>Over time</h2>\n<div class=\"plots\">\n";
    for (_, svg) in plot::figures(&runs)? {
        page += &svg;
        page.push('\n');
    }
    page += "</div>\n";
    page += &limits(folder)?;
    let scene = serde_json::to_string_pretty(&record.scene).unwrap_or_default();
    write_to(
        &mut page,
        format_args!(
            "<h2>The scene</h2>\n<details>\n<summary>{}, with every default</summary>\n<pre>{}</pre>\n</details>\n</body>\n</html>\n",
            escaped(&record.scene_name),
            escaped(&scene),
        ),
    );
    Ok(page)
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:1560px;margin:2rem auto;padding:0 1rem;color:#222}\
h1,h2{line-height:1.2}table{border-collapse:collapse}td,th{padding:.15rem 1rem .15rem 0;text-align:left;vertical-align:top}\
th{font-weight:600}.pictures,.plots{display:flex;flex-wrap:wrap;gap:1rem}figure{margin:0}figcaption{color:#555;font-size:.9rem}\
img,svg{max-width:100%;height:auto}svg{flex:0 1 760px;border:1px solid #ddd}.notes li{color:#8a4b00}\
pre{background:#f5f5f5;padding:1rem;overflow:auto}";

fn write_to(page: &mut String, words: std::fmt::Arguments<'_>) {
    page.write_fmt(words).expect("strings take everything");
}

/// Text for HTML.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            letter => out.push(letter),
        }
    }
    out
}

/// How it ended, in a sentence.
fn outcome(record: &Record) -> String {
    let so_far = format!(
        "{} frames to t = {:.4} s, {} particles",
        record.frames, record.time, record.particles
    );
    match record.status {
        Status::Done => format!("Done: {so_far}."),
        Status::Interrupted => format!("Interrupted: {so_far}."),
        Status::Running => "Still running, or killed without a word.".to_owned(),
        Status::Failed => format!(
            "Failed: {so_far}. {}",
            record.failure.as_deref().unwrap_or_default()
        ),
    }
}

/// The film, if there is one, and pictures from the start to the end, if there are particles.
fn pictures(folder: &Path) -> String {
    let mut figures = Vec::new();
    for film in ["video.gif", "render/video.gif"] {
        let Ok(path) = confined(folder, film) else {
            continue;
        };
        let small = fs::metadata(&path).is_ok_and(|file| file.len() <= LARGEST_FILM);
        if let Some(bytes) = small.then(|| fs::read(&path).ok()).flatten() {
            figures.push(figure("image/gif", &bytes, "the whole run"));
            break;
        }
    }
    // A run without particles, or a scene whose files are gone, has no pictures: the rest is still worth telling.
    if let Ok(recording) = Recording::open(folder)
        && let Ok(drawn) = drawn(&recording)
    {
        figures.extend(drawn);
    }
    match figures.is_empty() {
        true => String::new(),
        false => format!("<div class=\"pictures\">\n{}</div>\n", figures.concat()),
    }
}

fn drawn(recording: &Recording) -> Result<Vec<String>, CliError> {
    let scene = recorded_frames::scene(recording, &[])?;
    let first = recording.frame(0).map_err(recorded_frames::unreadable)?;
    let renderer = appearance::renderer(&scene, &Scenery::recorded(&scene, &first), PICTURE);
    let last = recording.len() - 1;
    let mut indices: Vec<usize> = (0..PICTURES).map(|i| i * last / (PICTURES - 1)).collect();
    indices.dedup();
    let mut figures = Vec::new();
    for index in indices {
        let snapshot = recording
            .frame(index)
            .map_err(recorded_frames::unreadable)?;
        let mut png = Vec::new();
        if renderer.render(&snapshot).write_png(&mut png).is_ok() {
            let words = format!("t = {:.3} s", snapshot.time);
            figures.push(figure("image/png", &png, &words));
        }
    }
    Ok(figures)
}

fn figure(kind: &str, bytes: &[u8], words: &str) -> String {
    let words = escaped(words);
    format!(
        "<figure><img alt=\"{words}\" src=\"data:{kind};base64,{}\"><figcaption>{words}</figcaption></figure>\n",
        BASE64.encode(bytes)
    )
}

/// Rates and times.
fn numbers(record: &Record) -> String {
    let phases = serde_json::to_value(record.phase_seconds).unwrap_or_default();
    let phases: Vec<String> = (phases.as_object().into_iter().flatten())
        .filter_map(|(phase, seconds)| Some((phase, seconds.as_f64()?)))
        .filter(|(_, seconds)| *seconds > 0.0)
        .map(|(phase, seconds)| format!("{phase} {seconds:.2} s"))
        .collect();
    let rows = [
        ("Version", record.version.clone()),
        (
            "Computed",
            format!(
                "{}D, {}, {}, {} thread(s), seed {}",
                record.dimension, record.precision, record.isa, record.threads, record.seed
            ),
        ),
        (
            "Work",
            format!(
                "{} substeps, {} particle-steps, {} sorts",
                record.substeps, record.particle_steps, record.sorts
            ),
        ),
        ("Time", duration(record.seconds)),
        (
            "Rate",
            format!(
                "{} particle-steps/s without output",
                with_prefix(record.particle_steps_per_second)
            ),
        ),
        ("Phases", phases.join(", ")),
        ("Retries", record.retries.len().to_string()),
    ];
    let rows =
        rows.map(|(name, value)| format!("<tr><th>{name}</th><td>{}</td></tr>\n", escaped(&value)));
    format!("<table>\n{}</table>\n", rows.concat())
}

/// What limited the time step, and in how many frames.
fn limits(folder: &Path) -> Result<String, CliError> {
    let words = Table::words(&folder.join("diagnostics.csv"), "dt_limit")?;
    let mut counts: Vec<(String, usize)> = Vec::new();
    for word in words.into_iter().filter(|word| word != "none") {
        match counts.iter_mut().find(|(own, _)| *own == word) {
            Some((_, count)) => *count += 1,
            None => counts.push((word, 1)),
        }
    }
    if counts.is_empty() {
        return Ok(String::new());
    }
    let rows: Vec<String> = (counts.iter())
        .map(|(word, count)| {
            format!(
                "<tr><th>{}</th><td>{count} frame(s)</td></tr>\n",
                escaped(word)
            )
        })
        .collect();
    Ok(format!(
        "<h2>What limited the time step</h2>\n<table>\n{}</table>\n",
        rows.concat()
    ))
}
