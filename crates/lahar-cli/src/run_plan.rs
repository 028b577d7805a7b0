//! The checked plan of a run, made from the options of the command line. All mistakes in options are found here.

use std::path::PathBuf;

use lahar::{Field, Isa, particles};
use lahar_io::checkpoint::Start;
use lahar_io::export::Format;
use lahar_io::image::{self, Scenery};
use lahar_io::output::{FilmPlan, PicturePlan, RunFolder, film_pace};
use lahar_scene::scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::error::CliError;
use crate::{appearance, args, threads};

/// A checked plan of a run: the scene, and the way to run it.
pub(crate) struct RunPlan {
    /// The scene to run.
    pub(crate) scene: Scene,
    /// The instruction set to compute with.
    pub(crate) isa: Isa,
    /// The number of threads to compute with.
    pub(crate) threads: usize,
    /// The number of frames after frame 0.
    pub(crate) frames: u64,
    /// The files to write.
    pub(crate) outputs: Outputs,
    /// The folder to write; `None`: out/NAME, numbered if it exists.
    pub(crate) folder: Option<PathBuf>,
    /// True if a run in that folder is replaced.
    pub(crate) overwrite: bool,
    /// True if the plan is only described.
    pub(crate) dry_run: bool,
    /// The time after which the run stops \[s\].
    pub(crate) deadline: Option<f64>,
}

/// The files that a run writes, before and after it is resumed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Outputs {
    /// The formats of output.
    pub(crate) formats: Formats,
    /// The number of frames that sets the pace of the film.
    pub(crate) film_frames: u64,
}

/// The formats in which frames are written.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Formats {
    /// Formats of particles, in the order of the table of formats.
    pub(crate) particles: Vec<Format>,
    /// The number of frames per picture; 0: no pictures.
    pub(crate) png: u64,
    /// True if a film is made.
    pub(crate) gif: bool,
}

impl Formats {
    /// Returns the formats of these names.
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

    /// The names of the formats.
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

impl RunPlan {
    /// The plan of `lahar run`.
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
            // A little less, so that 0.1 s at 60 frames per second is 6 frames.
            (None, Some(time)) => (time * scene.frame_rate - 1e-9).ceil().max(1.0) as u64,
            (None, None) => scene.frames(),
        };
        Ok(Self {
            isa: args.scene.isa.unwrap_or_else(Isa::detect),
            threads: threads::count(args.threads),
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

    /// The plan of `lahar` without a display: the scene with a film and some pictures, stopped after `deadline` \[s\].
    pub(crate) fn demonstration(scene: &str, deadline: f64) -> Result<Self, CliError> {
        let scene = Scene::load(scene, &[])?;
        let frames = scene.frames();
        Ok(Self {
            isa: Isa::detect(),
            threads: threads::count(None),
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

    /// The contents of `checkpoints/start.json`.
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

    /// The plan of a run that is resumed, with the number of threads and the instruction set that the options ask for.
    /// Without the latter, the run keeps the instruction set that it was started with.
    pub(crate) fn of_start(
        start: &Start,
        scene: Scene,
        threads: Option<u16>,
        isa: Option<Isa>,
    ) -> Result<Self, CliError> {
        let began_with = Isa::ALL.into_iter().find(|isa| isa.name() == start.isa);
        let Some(isa) = isa.or(began_with.filter(|isa| isa.is_available())) else {
            return Err(CliError::Usage(format!(
                "the run was started with the instruction set {}, which this machine does not have; `--isa portable` continues it with other roundings",
                start.isa
            )));
        };
        let outputs = Outputs::deserialize(&start.outputs).map_err(|error| {
            CliError::Usage(format!(
                "checkpoints/start.json: the outputs of the run cannot be read: {error}"
            ))
        })?;
        Ok(Self {
            scene,
            isa,
            threads: threads::count(threads),
            frames: start.frames,
            outputs,
            folder: None,
            overwrite: false,
            dry_run: false,
            deadline: None,
        })
    }

    /// The name of the run's folder.
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

    /// Makes the folder of the run.
    pub(crate) fn make_folder(&self) -> Result<RunFolder, CliError> {
        Ok(match &self.folder {
            Some(path) => RunFolder::at(path, self.overwrite)?,
            None => RunFolder::numbered(std::path::Path::new(""), &self.name())?,
        })
    }

    /// The particle fields that files and pictures need.
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

    /// The plan of the pictures, if there are any.
    pub(crate) fn pictures(&self, scenery: &Scenery) -> Option<PicturePlan> {
        let [width, height] = self.scene.output.picture_size;
        (self.outputs.formats.png > 0).then(|| PicturePlan {
            renderer: appearance::renderer(&self.scene, scenery, [width, height]),
            every: self.outputs.formats.png,
        })
    }

    /// The plan of the film, if there is one.
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

/// The number of pictures of a demonstration after the first one.
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
