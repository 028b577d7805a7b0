//! A page of HTML about one run, with its pictures and plots inside, so that one file can be sent.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use lahar_io::files::{OutputError, confined};
use lahar_io::image::Picture;
use lahar_io::output::{Record, Status, Table};

use crate::numbers::{duration, with_prefix};
use crate::run_plots::{svg_plots, table_path};

/// Largest film that is put into the page \[bytes\].
const LARGEST_FILM: u64 = 12 << 20;

/// Writes the page of the run in `folder`. `pictures` are pictures of its particles with their captions; the run's film
/// stands before them if it has one.
///
/// # Errors
/// If the run has no `diagnostics.csv`, or a table of its is damaged.
pub fn html(
    folder: &Path,
    record: &Record,
    pictures: &[(String, Picture)],
) -> Result<String, OutputError> {
    let view = record.view();
    let title = match view.title.as_str() {
        "" => &record.scene_name,
        title => title,
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
    page += &figures(folder, pictures);
    page += "<h2>How it went</h2>\n";
    page += &summary(record);
    let runs = [(String::new(), folder.to_owned())];
    page += "<h2>Over time</h2>\n<div class=\"plots\">\n";
    for (_, svg) in svg_plots(&runs)? {
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

fn write_to(page: &mut String, text: std::fmt::Arguments<'_>) {
    page.write_fmt(text).expect("writing to a String");
}

/// Escapes `text` for HTML.
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

/// A sentence about the end of the run.
fn outcome(record: &Record) -> String {
    let so_far = format!(
        "{} frames to t = {:.4} s, {} particles",
        record.frames, record.time, record.particles
    );
    match record.status {
        Status::Done => format!("Done: {so_far}."),
        Status::Interrupted => format!("Interrupted: {so_far}."),
        Status::Running => "Still running, or killed.".to_owned(),
        Status::Failed => format!(
            "Failed: {so_far}. {}",
            record.failure.as_deref().unwrap_or_default()
        ),
    }
}

/// The run's film, if there is one, and the pictures.
fn figures(folder: &Path, pictures: &[(String, Picture)]) -> String {
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
    for (caption, picture) in pictures {
        let mut png = Vec::new();
        if picture.write_png(&mut png).is_ok() {
            figures.push(figure("image/png", &png, caption));
        }
    }
    match figures.is_empty() {
        true => String::new(),
        false => format!("<div class=\"pictures\">\n{}</div>\n", figures.concat()),
    }
}

/// An image of the given media type inside the page, with a caption.
fn figure(media_type: &str, bytes: &[u8], caption: &str) -> String {
    let caption = escaped(caption);
    format!(
        "<figure><img alt=\"{caption}\" src=\"data:{media_type};base64,{}\"><figcaption>{caption}</figcaption></figure>\n",
        BASE64.encode(bytes)
    )
}

/// A table of counts, rates and times.
fn summary(record: &Record) -> String {
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

/// A table of the limits of the time step, with the number of frames of each.
fn limits(folder: &Path) -> Result<String, OutputError> {
    let words = Table::words(&table_path(folder)?, "dt_limit")?;
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
        "<h2>Limits of the time step</h2>\n<table>\n{}</table>\n",
        rows.concat()
    ))
}
