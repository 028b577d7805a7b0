//! From what was written on the command line to what is done: everything that can be wrong is found here.

use std::path::PathBuf;

use lahar::{Field, Isa, particles};
use lahar_io::checkpoint::Start;
use lahar_io::export::Format;
use lahar_io::image::{self, Scenery};
use lahar_io::output::{FilmPlan, PicturePlan, RunFolder, film_pace};
use lahar_scene::scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::appearance;
use crate::args;
use crate::error::CliError;

/// A run, checked.
pub(crate) struct RunPlan {
    /// What is run.
    pub(crate) scene: Scene,
    /// With which instructions.
    pub(crate) isa: Isa,
    /// On how many threads.
    pub(crate) threads: usize,
    /// Frames after the one at the start.
    pub(crate) frames: u64,
    /// What is written.
    pub(crate) outputs: Outputs,
    /// The folder asked for; the usual one if none.
    pub(crate) folder: Option<PathBuf>,
    /// Whether a run in it is replaced.
    pub(crate) overwrite: bool,
    /// Say what would be done only.
    pub(crate) dry_run: bool,
    /// Stop after so many seconds, whatever is left.
    pub(crate) deadline: Option<f64>,
}

/// What a run writes; the same when it goes on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Outputs {
    /// Files of a frame.
    pub(crate) formats: Formats,
    /// Frames that the film is paced for.
    pub(crate) film_frames: u64,
}

/// What is written of frames.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Formats {
    /// Particles, in the table's order.
    pub(crate) particles: Vec<Format>,
    /// Pictures, every so many frames; 0: none.
    pub(crate) png: u64,
    /// A film.
    pub(crate) gif: bool,
}

impl Formats {
    /// From their names.
    fn from_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self, String> {
        let mut formats = Self::default();
        for name in names {
            match (name.trim(), Format::named(name.trim())) {
                (_, Some(format)) => formats.particles.push(format),
                ("png", _) => formats.png = 1,
                ("gif", _) => formats.gif = true,
                ("none", _) => {}
                _ => {
                    let particles: Vec<_> = Format::ALL
                        .iter()
                        .map(|format| format.info().name)
                        .collect();
                    return Err(format!(
                        "there is no format \"{name}\"; there are {}, png, gif and none",
                        particles.join(", ")
                    ));
                }
            }
        }
        let order = |format: &Format| Format::ALL.iter().position(|other| other == format);
        formats.particles.sort_by_key(order);
        formats.particles.dedup();
        Ok(formats)
    }

    /// Their names.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        let pictures = [(self.png > 0, "png"), (self.gif, "gif")];
        let names: Vec<_> = (self.particles.iter())
            .map(|format| format.info().name)
            .chain((pictures.into_iter()).filter_map(|(wanted, name)| wanted.then_some(name)))
            .collect();
        if names.is_empty() {
            vec!["none"]
        } else {
            names
        }
    }
}

/// Threads of this machine.
fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

impl RunPlan {
    /// Of `lahar run`.
    pub(crate) fn from_args(args: &args::Run) -> Result<Self, CliError> {
        let scene = Scene::load(&args.scene.scene, &args.scene.set)?;
        let mut formats = match &args.format {
            Some(names) => {
                Formats::from_names(names.iter().map(String::as_str)).map_err(CliError::Usage)?
            }
            None => Formats::from_names(scene.output.formats.iter().map(String::as_str))
                .map_err(|message| scene.error_at("output.formats", message))?,
        };
        formats.gif |= args.video;
        if args.images {
            formats.png = 1;
        }
        let frames = match (args.frames, args.until) {
            (Some(frames), _) => frames,
            // A little less, so that 0.1 s at 60 frames a second is 6 frames.
            (None, Some(time)) => (time * scene.frame_rate - 1e-9).ceil().max(1.0) as u64,
            (None, None) => scene.frames(),
        };
        Ok(Self {
            isa: args.scene.isa.unwrap_or_else(Isa::detect),
            threads: args.threads.map_or_else(all_threads, usize::from),
            frames,
            outputs: Outputs {
                formats,
                film_frames: frames,
            },
            folder: args.output.clone(),
            overwrite: args.overwrite,
            dry_run: args.dry_run,
            deadline: None,
            scene,
        })
    }

    /// Of `lahar` where there is no display: the scene with a film and some pictures, within `deadline` seconds.
    pub(crate) fn demonstration(scene: &str, deadline: f64) -> Result<Self, CliError> {
        let scene = Scene::load(scene, &[])?;
        let frames = scene.frames();
        Ok(Self {
            isa: Isa::detect(),
            threads: all_threads(),
            frames,
            outputs: Outputs {
                formats: Formats {
                    particles: Vec::new(),
                    png: (frames / DEMONSTRATION_PICTURES).max(1),
                    gif: true,
                },
                film_frames: frames,
            },
            folder: None,
            overwrite: false,
            dry_run: false,
            deadline: Some(deadline),
            scene,
        })
    }

    /// What `checkpoints/start.json` keeps of this.
    pub(crate) fn start(&self, warnings: &[String]) -> Start {
        Start {
            lahar: env!("CARGO_PKG_VERSION").to_owned(),
            scene: self.scene.name.clone(),
            text: self.scene.text.clone(),
            set: self.scene.overrides.clone(),
            files: Vec::new(),
            isa: self.isa.name().to_owned(),
            frames: self.frames,
            outputs: json!(self.outputs),
            warnings: warnings.to_vec(),
        }
    }

    /// The plan of which `start` was kept, on `threads` threads or all, with the instruction set `isa` or the one
    /// it began with.
    pub(crate) fn of_start(
        start: &Start,
        scene: Scene,
        threads: Option<u16>,
        isa: Option<Isa>,
    ) -> Result<Self, CliError> {
        let began_with = Isa::ALL.into_iter().find(|isa| isa.name() == start.isa);
        let Some(isa) = isa.or(began_with.filter(|isa| isa.is_available())) else {
            return Err(CliError::Usage(format!(
                "the run was begun with the instruction set {}, which this machine does not have; `--isa portable` goes on with another, and other roundings",
                start.isa
            )));
        };
        let outputs = Outputs::deserialize(&start.outputs).map_err(|error| {
            CliError::Usage(format!("what the run writes cannot be read: {error}"))
        })?;
        Ok(Self {
            scene,
            isa,
            threads: threads.map_or_else(all_threads, usize::from),
            frames: start.frames,
            outputs,
            folder: None,
            overwrite: false,
            dry_run: false,
            deadline: None,
        })
    }

    /// The scene's name in paths.
    pub(crate) fn name(&self) -> String {
        let stem = std::path::Path::new(&self.scene.name)
            .file_stem()
            .map_or_else(|| "run".into(), |stem| stem.to_string_lossy().into_owned());
        if stem.is_empty() {
            "run".to_owned()
        } else {
            stem
        }
    }

    /// Makes the folder.
    pub(crate) fn make_folder(&self) -> Result<RunFolder, CliError> {
        Ok(match &self.folder {
            Some(path) => RunFolder::at(path, self.overwrite)?,
            None => RunFolder::numbered(std::path::Path::new(""), &self.name())?,
        })
    }

    /// The fields that frames are made of.
    pub(crate) fn fields(&self) -> Vec<Field> {
        let particles = &self.outputs.formats.particles;
        let chosen = self.scene.output_fields();
        let pictures = self.outputs.formats.png > 0 || self.outputs.formats.gif;
        let wanted = |field: Field| {
            let in_files = !particles.is_empty() && chosen.contains(&field);
            let placed = field == Field::Position
                && particles.iter().any(|format| format.info().needs_positions);
            let drawn = pictures && image::FIELDS.contains(&field);
            in_files || placed || drawn
        };
        let fields = particles::FIELDS.iter().map(|info| info.field);
        fields.filter(|field| wanted(*field)).collect()
    }

    /// Pictures, if wanted.
    pub(crate) fn pictures(&self, scenery: &Scenery) -> Option<PicturePlan> {
        let [width, height] = self.scene.output.picture_size;
        (self.outputs.formats.png > 0).then(|| PicturePlan {
            renderer: appearance::renderer(&self.scene, scenery, [width, height]),
            every: self.outputs.formats.png,
        })
    }

    /// A film, if wanted.
    pub(crate) fn film(&self, scenery: &Scenery) -> Option<FilmPlan> {
        self.outputs.formats.gif.then(|| FilmPlan {
            renderer: appearance::renderer(
                &self.scene,
                scenery,
                appearance::film_size(self.scene.output.picture_size),
            ),
            pace: film_pace(self.scene.frame_rate, self.outputs.film_frames),
        })
    }
}

/// Pictures of a demonstration, besides the first.
const DEMONSTRATION_PICTURES: u64 = 6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_name() {
        let formats = Formats::from_names(["npz", "gif"]).unwrap();
        assert_eq!(formats.names(), ["npz", "gif"]);
        assert_eq!(Formats::from_names(["none"]).unwrap().names(), ["none"]);
        let formats = Formats::from_names(["bgeo", "ply", "vtk", "npz", "vtp"]).unwrap();
        assert_eq!(formats.names(), ["npz", "vtk", "ply", "bgeo"]);
        assert!(
            Formats::from_names(["bmp"])
                .unwrap_err()
                .contains("no format")
        );
    }
}
