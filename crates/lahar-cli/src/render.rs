//! `lahar render`: draws pictures and films from the frames of a run.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lahar_io::files::output_folder;
use lahar_io::image::{self, Mp4, Mp4Maker, Picture};
use lahar_io::output::{Recording, film_pace, frame_name};
use lahar_scene::scene::Scene;

use crate::error::CliError;
use crate::painter::{Painter, Subject};
use crate::recorded_frames::{self, Completion};
use crate::{args, terminal};

/// Draws the frames of `args.recorded.run`.
pub(crate) fn render(args: &args::Render) -> Result<ExitCode, CliError> {
    let recording = recorded_frames::open(&args.recorded.run)?;
    let scene = recorded_frames::scene(&recording, &changes(args))?;
    let chosen = recorded_frames::chosen(&recording, args.recorded.frames)?;
    let first = recording.frame(0).map_err(recorded_frames::unreadable)?;
    let subject = Subject {
        recording: &recording,
        scene: &scene,
        first: &first,
        size: args.size.map_or(scene.output.picture_size, |size| size.0),
    };
    let mut painter = Painter::choose(args.renderer, &subject)?;
    let default = recording.folder().join("render");
    let folder = output_folder(args.output.as_deref(), default)?;
    let rate = film_rate(&recording, &scene, &chosen);
    let completion = match draw(args, &recording, &folder, rate, &mut painter)? {
        Drawn::All(completion) => completion,
        Drawn::Failed(why) if args.renderer == args::Renderer::Gpu => {
            return Err(CliError::Machine(format!("--renderer gpu: {why}")));
        }
        // All frames are drawn again, so that the film has one look.
        Drawn::Failed(why) => {
            painter = Painter::cpu(&subject, Some(&why));
            match draw(args, &recording, &folder, rate, &mut painter)? {
                Drawn::All(completion) => completion,
                Drawn::Failed(why) => return Err(CliError::Machine(why)),
            }
        }
    };
    Ok(completion.exit_code())
}

/// The result of drawing all frames.
enum Drawn {
    All(Completion),
    /// The painter cannot draw any more, for this reason.
    Failed(String),
}

/// Draws all chosen frames into `folder`.
fn draw(
    args: &args::Render,
    recording: &Recording,
    folder: &Path,
    rate: f64,
    painter: &mut Painter,
) -> Result<Drawn, CliError> {
    let mut films = args.video.then(|| Films::new(folder, rate));
    let mut failed = None;
    let completion = recorded_frames::each(recording, args.recorded.frames, |number, snapshot| {
        let picture = painter.render(snapshot).map_err(|why| {
            failed = Some(format!("frame {number}: {why}"));
            CliError::Machine(why)
        })?;
        if !args.no_images {
            let path = folder.join(frame_name(number, "png"));
            picture
                .save_png(&path)
                .map_err(|error| cannot(&path, &error))?;
        }
        if let Some(films) = &mut films {
            films.push(&picture)?;
        }
        Ok(format!("t = {:.3} s", snapshot.time))
    });
    if let Some(why) = failed {
        return Ok(Drawn::Failed(why));
    }
    let completion = completion?;
    if !args.no_images {
        terminal::print(&format!("  {}/\n", folder.display()));
    }
    if let Some(films) = films {
        films.finish()?;
    }
    Ok(Drawn::All(completion))
}

/// The changes to the scene that the options ask for.
fn changes(args: &args::Render) -> Vec<(String, String)> {
    let mut changes = args.set.clone();
    if let Some(direction) = &args.camera {
        changes.push(("camera.direction".to_owned(), format!("[{direction}]")));
    }
    if let Some(word) = &args.color_by {
        changes.push(("camera.color_by".to_owned(), format!("\"{word}\"")));
    }
    changes
}

/// The rate of a film of all chosen frames \[1/s\]: in real time, unless the film would be too short.
fn film_rate(recording: &Recording, scene: &Scene, chosen: &[usize]) -> f64 {
    let (Some(first), Some(last)) = (chosen.first(), chosen.last()) else {
        return scene.frame_rate;
    };
    let span = (recording.number(*last) - recording.number(*first)).max(1) as f64;
    let shown = chosen.len().max(2) as f64 - 1.0;
    let rate = scene.frame_rate * shown / span;
    let pace = film_pace(rate, chosen.len() as u64);
    // The film contains all frames, so none may be skipped.
    (pace.rate * pace.every as f64).min(HIGHEST_RATE)
}

/// The highest rate of a film \[1/s\]: GIF gives delays in hundredths of a second, and browsers slow down one.
const HIGHEST_RATE: f64 = 50.0;

fn cannot(path: &Path, error: &std::io::Error) -> CliError {
    CliError::Machine(format!("{}: cannot write: {error}", path.display()))
}

/// The films being made: always a GIF, and an MP4 if ffmpeg or the feature `mp4` is there.
struct Films {
    gif: (PathBuf, image::Film),
    mp4: Option<(PathBuf, Mp4Maker, Option<Mp4>)>,
    rate: f64,
}

impl Films {
    fn new(folder: &Path, rate: f64) -> Self {
        let maker = Mp4Maker::find();
        terminal::note(&match &maker {
            Some(maker) => format!("video: GIF by lahar, MP4 by {maker}"),
            None => {
                "video: GIF by lahar; for MP4 too, install ffmpeg or build with the feature mp4"
                    .to_owned()
            }
        });
        Self {
            gif: (folder.join("video.gif"), image::Film::new(rate)),
            mp4: maker.map(|maker| (folder.join("video.mp4"), maker, None)),
            rate,
        }
    }

    fn push(&mut self, picture: &Picture) -> Result<(), CliError> {
        let (path, film) = &mut self.gif;
        film.push(picture).map_err(|error| cannot(path, &error))?;
        let Some((path, maker, film)) = &mut self.mp4 else {
            return Ok(());
        };
        let running = match film {
            Some(running) => running,
            None => film.insert(
                (maker.start(path, self.rate, picture)).map_err(|error| cannot(path, &error))?,
            ),
        };
        if running.push(picture).is_err()
            && let Some(ended) = film.take()
        {
            // Its own message says more than the broken pipe.
            ended.finish().map_err(|error| cannot(path, &error))?;
        }
        Ok(())
    }

    fn finish(self) -> Result<(), CliError> {
        let (path, film) = self.gif;
        film.save(&path).map_err(|error| cannot(&path, &error))?;
        terminal::print(&format!("  {}\n", path.display()));
        if let Some((path, _, Some(film))) = self.mp4 {
            film.finish().map_err(|error| cannot(&path, &error))?;
            terminal::print(&format!("  {}\n", path.display()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_comes_from_options() {
        let args = args::Render {
            camera: Some("1,2,3".to_owned()),
            color_by: Some("speed".to_owned()),
            set: vec![("camera.height".to_owned(), "2".to_owned())],
            ..args::Render::default()
        };
        let pairs = [
            ("camera.height", "2"),
            ("camera.direction", "[1,2,3]"),
            ("camera.color_by", "\"speed\""),
        ];
        assert_eq!(
            changes(&args),
            pairs.map(|(key, value)| (key.to_owned(), value.to_owned()))
        );
    }
}
