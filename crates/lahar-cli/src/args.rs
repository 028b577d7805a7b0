//! What may be written on the command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Parser, Subcommand};
use lahar::Isa;
use lahar_io::scene::Comparison;

use crate::recorded_frames::Frames;

/// Fluids, and the solids they meet, simulated by the Moving Least Squares Material Point Method.
///
/// Without a command a window opens on the default scene; without a display the same scene runs and leaves a film.
#[derive(Debug, Parser)]
#[command(name = "lahar", version, max_term_width = 100)]
pub(crate) struct Args {
    /// What to do; nothing: open the window on the default scene.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

impl Args {
    /// Whether standard output is to hold one JSON document.
    pub(crate) fn wants_json(&self) -> bool {
        match &self.command {
            Some(Command::Run(run)) => run.json,
            Some(Command::Resume(resume)) => resume.json,
            Some(Command::List(list)) => list.json,
            Some(Command::Show(show)) => show.json,
            Some(Command::Validate(validate)) => validate.json,
            Some(Command::Bench(bench)) => bench.json,
            _ => false,
        }
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Open the window on a scene
    View(View),
    /// Run a scene without a window and write what it comes to
    Run(Run),
    /// Go on with a run that was interrupted, killed or failed, as if it had not been
    Resume(Resume),
    /// List the built-in scenes
    List(List),
    /// Show what a scene comes to: particles, nodes, memory, sound speed, time step and what limits it
    Show(Show),
    /// Write a commented scene to start from
    New(New),
    /// Make surface meshes of a 3D run's particles, by material
    #[cfg(feature = "mesh")]
    Mesh(Mesh),
    /// Draw a run's frames: pictures, and a film
    Render(Render),
    /// Write a page of HTML that tells how a run went, with pictures and plots in it
    Report(Report),
    /// Plot what runs have measured over time: energies, momenta, volume, speed, time step, probes
    Plot(Plot),
    /// Run physics cases and compare with exact solutions, experiments and other programs
    Validate(Validate),
    /// Measure how fast scenes are computed
    Bench(Bench),
    /// Print the JSON schema of scene files, for editors
    Schema,
    /// Print completions for a shell
    Completions(Completions),
}

/// Options of `view`.
#[derive(Debug, clap::Args)]
pub(crate) struct View {
    /// A built-in scene's name, a scene file, or a run's folder, which is replayed
    #[arg(value_name = "SCENE|RUN")]
    pub(crate) what: String,

    /// Set a key of the scene, as in `--set gravity=[0,-1.62]` or `--set bodies.column.velocity=[1,0]`
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Run the scene with several values of a key, side by side, as in `--compare transfer=pic,apic`
    #[arg(long, value_name = "KEY=A,B")]
    pub(crate) compare: Option<Comparison>,

    /// The instruction set to compute with; the widest of this machine if not given
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Threads to compute with; all of this machine if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Print a line a second on standard error: how fast it computes and draws
    #[arg(long)]
    pub(crate) trace: bool,
}

/// The scene and what is laid over it.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SceneArgs {
    /// A built-in scene's name (see `lahar list`) or a scene file
    pub(crate) scene: String,

    /// Set a key of the scene, as in `--set gravity=[0,-1.62]` or `--set bodies.column.velocity=[1,0]`
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// The instruction set to compute with; the widest of this machine if not given
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,
}

/// Options of `run`.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Run {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// The folder to write; out/SCENE, numbered if taken, if not given
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// Replace the run that is in the folder
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,

    /// Write frame 0 and so many more
    #[arg(long, value_name = "N", conflicts_with = "until")]
    pub(crate) frames: Option<u64>,

    /// Run to this simulated time in seconds, to the end of the frame it is in
    #[arg(long, value_name = "T", value_parser = positive)]
    pub(crate) until: Option<f64>,

    /// Threads to compute with; all of this machine if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// What to write of a frame: particles as npz, vtk, ply or bgeo, png, gif (a film of all), or none; the scene's choice if not given
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    pub(crate) format: Option<Vec<String>>,

    /// Make a film of the run (video.gif), whatever the formats
    #[arg(long)]
    pub(crate) video: bool,

    /// Keep a picture of every frame (images/000000.png), whatever the formats
    #[arg(long)]
    pub(crate) images: bool,

    /// Run the scene once for each of several values of a key, and put pictures and plots side by side, as in
    /// `--compare transfer=pic,flip,apic`
    #[arg(long, value_name = "KEY=A,B", conflicts_with_all = ["dry_run", "json"])]
    pub(crate) compare: Option<Comparison>,

    /// Check everything and say what would be done, without doing it
    #[arg(long)]
    pub(crate) dry_run: bool,

    /// Print the report as one JSON document on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `resume`.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Resume {
    /// The folder of the run
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,

    /// Go on to frame N, beyond the run's own end
    #[arg(long, value_name = "N", conflicts_with = "until")]
    pub(crate) frames: Option<u64>,

    /// Go on to this simulated time in seconds, beyond the run's own end
    #[arg(long, value_name = "T", value_parser = positive)]
    pub(crate) until: Option<f64>,

    /// Threads to compute with; all of this machine if not given. The bits are the same
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Go on with another instruction set than the run began with; the bits are others then
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Print the report as one JSON document on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `list`.
#[derive(Debug, clap::Args)]
pub(crate) struct List {
    /// Print one JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `show`.
#[derive(Debug, clap::Args)]
pub(crate) struct Show {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Print one JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `new`.
#[derive(Debug, clap::Args)]
pub(crate) struct New {
    /// The file to write, like my.toml; one that is there is left alone
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
}

/// Frames of a run, and where what is made of them goes: what `mesh` and `render` have in common.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct Recorded {
    /// A folder that `lahar run` has written with npz frames; it need not have come to its end
    #[arg(value_name = "DIR")]
    pub(crate) run: PathBuf,

    /// The folder to write; meshes/ or render/ in the run's folder if not given
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// The frames, by number: 12, 0..60, 0..60:5 (every fifth) or 10..; all if not given
    #[arg(
        long,
        value_name = "FRAMES",
        default_value = "0..",
        hide_default_value = true
    )]
    pub(crate) frames: Frames,
}

/// Options of `mesh`.
#[cfg(feature = "mesh")]
#[derive(Debug, clap::Args)]
pub(crate) struct Mesh {
    #[command(flatten)]
    pub(crate) recorded: Recorded,

    /// The materials; all if not given
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) materials: Vec<String>,

    /// What to write of each: ply, obj, vtk
    #[arg(
        long,
        value_name = "FORMATS",
        value_delimiter = ',',
        default_value = "ply"
    )]
    pub(crate) format: Vec<String>,

    /// Passes of smoothing; 0: as it is cut, with steps
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) smoothing: u32,

    /// Edge of the cubes that the surface is cut from, in spacings of particles: smaller is finer
    #[arg(long, value_name = "SIZE", default_value = "0.5", value_parser = positive)]
    pub(crate) cube: f64,
}

/// Options of `render`.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct Render {
    #[command(flatten)]
    pub(crate) recorded: Recorded,

    /// Make a film, too: video.gif, and video.mp4 where ffmpeg is installed or the program was built with the feature mp4
    #[arg(long)]
    pub(crate) video: bool,

    /// Keep no pictures: the film only
    #[arg(long, requires = "video")]
    pub(crate) no_images: bool,

    /// Width and height in pixels; the scene's choice if not given
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub(crate) size: Option<Size>,

    /// From the scene to the camera, in 3D, as in `--camera 1,0.5,2`; more by `--set camera.KEY=VALUE`
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) camera: Option<String>,

    /// What colours mean: material, body, speed, pressure, density, J
    #[arg(long, value_name = "WHAT")]
    pub(crate) color_by: Option<String>,

    /// What draws: the window's renderer, on a graphics adapter or one in software (no display is needed), or the
    /// processor; auto: the window's where that works
    #[arg(long, value_name = "WHICH", value_enum, default_value_t)]
    pub(crate) renderer: Renderer,

    /// Set a key of the scene, as in `--set camera.height=2`
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

/// What draws pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Renderer {
    /// The window's renderer where that works, else the processor
    #[default]
    Auto,
    /// The window's renderer
    Gpu,
    /// The processor
    Cpu,
}

/// Pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size(pub(crate) [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| {
            text.trim()
                .parse()
                .ok()
                .filter(|n| (16..=16384).contains(n))
        };
        text.split_once(['x', 'X', '×'])
            .and_then(|(width, height)| Some(Self([side(width)?, side(height)?])))
            .ok_or_else(|| "write it as 1280x720, each from 16 to 16384".to_owned())
    }
}

/// Options of `report`.
#[derive(Debug, clap::Args)]
pub(crate) struct Report {
    /// A folder that `lahar run` has written
    #[arg(value_name = "DIR")]
    pub(crate) run: PathBuf,

    /// The file to write; report.html in the run's folder if not given
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `plot`.
#[derive(Debug, clap::Args)]
pub(crate) struct Plot {
    /// Folders that `lahar run` has written; several are drawn into the same plots
    #[arg(required = true, value_name = "DIR")]
    pub(crate) runs: Vec<PathBuf>,

    /// The folder to write; plots/ in the run's folder if not given, and there is one run
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `validate`.
#[derive(Debug, clap::Args)]
pub(crate) struct Validate {
    /// Cases by name (K1, F5, D1, ..) or by their scene; a file is run in place of the built-in scene of its name.
    /// All but the long ones if none is given
    #[arg(value_name = "CASE|SCENE")]
    pub(crate) cases: Vec<String>,

    /// The coarser resolutions only: all in under two minutes
    #[arg(long)]
    pub(crate) quick: bool,

    /// The cases that take long, too
    #[arg(long)]
    pub(crate) long: bool,

    /// Set a key of the cases' scenes, as in `--set transfer=flip`; the cases' own settings come first
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// The folder for validation.md and its plots; out/validate if not given
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// The instruction set to compute with; the widest of this machine if not given
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Threads to compute with; all of this machine if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Print the findings as one JSON document on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `bench`.
#[derive(Debug, clap::Args)]
pub(crate) struct Bench {
    /// What to measure: dam-3d, dam-2d, jelly-3d, snow-3d, dam-3d-f64, dam-3d-portable; all if not given, dam-3d with
    /// --growth
    #[arg(long = "case", value_name = "CASES", value_delimiter = ',')]
    pub(crate) cases: Vec<String>,

    /// About so many particles in place of the scenes' million
    #[arg(long, value_name = "N", value_parser = positive, conflicts_with = "growth")]
    pub(crate) particles: Option<f64>,

    /// Threads to compute with, one after the other, as in `--threads 1,2`; all of this machine if not given
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Vec<u16>,

    /// The instruction set to compute with; the widest of this machine if not given
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Timed runs of each
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(crate) runs: u16,

    /// Show the ratios to what an earlier `bench --json` has printed
    #[arg(long, value_name = "FILE")]
    pub(crate) compare: Option<PathBuf>,

    /// How speed and memory grow: measure with each of these numbers of particles, and draw plots
    #[arg(long, value_name = "N,M", value_delimiter = ',', value_parser = positive, num_args = 0..=1,
          default_missing_value = "1e5,3e5,1e6,3e6,1e7", require_equals = true)]
    pub(crate) growth: Option<Vec<f64>>,

    /// The folder for the plots of --growth; out/bench if not given
    #[arg(short, long, value_name = "DIR", requires = "growth")]
    pub(crate) output: Option<PathBuf>,

    /// Print the measurements as one JSON document on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `completions`.
#[derive(Debug, clap::Args)]
pub(crate) struct Completions {
    /// The shell
    pub(crate) shell: clap_complete::Shell,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write it as KEY=VALUE".to_owned()),
    }
}

fn isa(text: &str) -> Result<Isa, String> {
    let names = || Isa::ALL.map(Isa::name).join(", ");
    let isa = Isa::ALL
        .into_iter()
        .find(|isa| isa.name() == text)
        .ok_or_else(|| format!("it is one of {}", names()))?;
    if isa.is_available() {
        Ok(isa)
    } else {
        let have: Vec<_> = Isa::ALL
            .into_iter()
            .filter(|isa| isa.is_available())
            .map(Isa::name)
            .collect();
        Err(format!(
            "this machine does not have it; it has {}",
            have.join(", ")
        ))
    }
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|time: &f64| time.is_finite() && *time > 0.0)
        .ok_or_else(|| "it is a number above 0".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definitions_agree() {
        Args::command().debug_assert();
    }

    #[test]
    fn sizes() {
        assert_eq!("1280x720".parse(), Ok(Size([1280, 720])));
        for wrong in ["1280", "8x8", "x", "-1x20", "20000x20"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn assignments() {
        assert_eq!(assignment("dx = 0.1"), Ok(("dx".into(), "0.1".into())));
        assert_eq!(assignment("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert!(assignment("dx").is_err() && assignment("=3").is_err());
    }
}
