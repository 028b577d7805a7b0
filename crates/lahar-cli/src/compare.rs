//! `lahar run --compare KEY=A,B`: runs a scene once per value, and puts the results side by side.
//!
//! ```text
//! DIR/A/, DIR/B/          one run per value
//! DIR/images/000000.png   the pictures of all runs, side by side
//! DIR/video.gif           the same as a film
//! DIR/plots/energy.svg    the diagnostics of all runs in the same plots
//! ```

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lahar_io::files::make_folder;
use lahar_io::image::{Film, Picture, side_by_side};
use lahar_io::output::{RunFolder, film_pace};
use lahar_lab::run_plots::save_plots;
use lahar_scene::scene::{Comparison, Scene};

use crate::error::CliError;
use crate::run_plan::RunPlan;
use crate::{args, run, terminal};

/// The width of each picture, unless an option sets it \[pixels\].
const WIDTH: u32 = 420;

/// Runs the scene of `args` once for each value of `comparison`.
pub(crate) fn compare(args: &args::Run, comparison: &Comparison) -> Result<ExitCode, CliError> {
    let scene = Scene::load(&args.scene.scene, &args.scene.set)?;
    let [width, height] = scene.output.picture_size;
    let size = format!("[{WIDTH}, {}]", (height * WIDTH / width.max(1)).max(16));
    let mut base = vec![("output.picture_size".to_owned(), size)];
    base.extend(args.scene.set.iter().cloned());

    // All values are checked before the first run begins.
    let mut plans = Vec::new();
    for set in comparison.overrides(&base) {
        let mut args = args.clone();
        args.scene.set = set;
        plans.push(RunPlan::from_args(&args)?);
    }
    let folder = match &args.output {
        Some(path) => RunFolder::for_comparison(path, args.overwrite)?,
        None => RunFolder::numbered(Path::new(""), &format!("{}-compared", plans[0].name()))?
            .into_plain()?,
    };
    let pace = film_pace(scene.frame_rate, plans[0].frames);
    let mut runs = Vec::new();
    for ((mut plan, title), value) in plans
        .into_iter()
        .zip(comparison.titles())
        .zip(&comparison.values)
    {
        let path = folder.join(file_name(value));
        plan.folder = Some(path.clone());
        plan.overwrite = args.overwrite;
        plan.outputs.formats.png = pace.every;
        terminal::note(&format!("{title}:"));
        let code = run::run(plan, false)?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
        runs.push((title, path));
    }
    let pictures = pictures_beside(&runs, &folder, pace.rate)?;
    terminal::print(&format!(
        "side by side:\n  {}\n  {}/ ({pictures} pictures)\n",
        folder.join("video.gif").display(),
        folder.join("images").display(),
    ));
    for file in save_plots(&runs, &folder.join("plots"))? {
        terminal::print(&format!("  {}\n", file.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// Puts the pictures that all `runs` have side by side, as PNG files and as a film of `rate` \[1/s\]. Returns their number.
fn pictures_beside(
    runs: &[(String, PathBuf)],
    folder: &Path,
    rate: f64,
) -> Result<usize, CliError> {
    let cannot = |path: &Path, error: std::io::Error| {
        CliError::Machine(format!("{}: {error}", path.display()))
    };
    let mut common: Option<BTreeSet<_>> = None;
    for (_, run) in runs {
        let images = run.join("images");
        let entries = fs::read_dir(&images).map_err(|error| cannot(&images, error))?;
        let names: BTreeSet<_> = entries.flatten().map(|entry| entry.file_name()).collect();
        common = Some(match common {
            Some(common) => common.intersection(&names).cloned().collect(),
            None => names,
        });
    }
    let images = folder.join("images");
    make_folder(&images)?;
    let (mut film, names) = (Film::new(rate), common.unwrap_or_default());
    for name in &names {
        let mut pictures = Vec::new();
        for (title, run) in runs {
            let path = run.join("images").join(name);
            let picture = Picture::load_png(&path).map_err(|error| cannot(&path, error))?;
            pictures.push((title.as_str(), picture));
        }
        let titled: Vec<_> = pictures.iter().map(|(title, p)| (*title, p)).collect();
        let path = images.join(name);
        let Some(whole) = side_by_side(&titled) else {
            return Err(CliError::Usage(
                "values of output.picture_size cannot be compared: the pictures have different sizes".into(),
            ));
        };
        whole
            .save_png(&path)
            .map_err(|error| cannot(&path, error))?;
        film.push(&whole).map_err(|error| cannot(&path, error))?;
    }
    let video = folder.join("video.gif");
    film.save(&video).map_err(|error| cannot(&video, error))?;
    Ok(names.len())
}

/// Turns a value into the name of a folder: letters, digits, points and dashes stay, and other characters become
/// underscores.
fn file_name(value: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || ".-+".contains(c) {
            c
        } else {
            '_'
        }
    };
    let name: String = value.trim_matches('"').chars().map(plain).collect();
    match name.trim_start_matches('.') {
        "" => "_".to_owned(),
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_have_plain_names() {
        assert_eq!(file_name("\"apic\""), "apic");
        assert_eq!(file_name("[0, -1.62]"), "_0__-1.62_");
        assert_eq!(file_name("../x"), "_x");
        assert_eq!(file_name(".."), "_");
    }
}
