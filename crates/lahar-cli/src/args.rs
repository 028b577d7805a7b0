//! The grammar of the command line: every command with its options, and the help texts.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Parser, Subcommand};
use lahar::Isa;
use lahar_scene::scene::Comparison;

use crate::recorded_frames::Frames;

/// Help of `--set`; not a doc comment, which would take the brackets for a link.
const SET_HELP: &str = "Set a key of the scene, as in --set dx=0.01 or --set 'bodies.column.velocity=[1,0]'; may be repeated";

/// Simulates fluids, and the solids they meet, with the Moving Least Squares Material Point Method
///
/// Without a command, a window opens on the default scene. Without a display, the same scene runs without a window and
/// leaves a film.
#[derive(Debug, Parser)]
#[command(name = "lahar", version, max_term_width = 100)]
pub(crate) struct Args {
    /// The command; without one, the window opens on the default scene.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

impl Args {
    /// Returns true if standard output must be one JSON document.
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

/// A command and its options.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Open the window on a scene, or replay a finished run
    View(View),
    /// Run a scene without a window, and write its frames into a folder
    Run(Run),
    /// Continue a run that was interrupted, killed or failed, with the same result as an unbroken run
    Resume(Resume),
    /// List the built-in scenes
    List(List),
    /// Show a scene's size and cost: particles, nodes, memory, sound speed, time step and what limits it
    Show(Show),
    /// Write a scene file to start from
    New(New),
    /// Make surface meshes of a 3D run, one per material and frame
    #[cfg(feature = "mesh")]
    Mesh(Mesh),
    /// Draw the frames of a run as pictures, and as a film
    Render(Render),
    /// Write one HTML page about a run, with its pictures and plots
    Report(Report),
    /// Plot the measurements of runs over time: energies, momenta, volume, speed, time step, probes
    Plot(Plot),
    /// Run physics cases, and compare with exact solutions, experiments and other programs
    Validate(Validate),
    /// Measure how fast this machine computes scenes
    Bench(Bench),
    /// Print the JSON schema of scene files, for editors
    Schema,
    /// Print a script that completes commands in a shell
    Completions(Completions),
}

/// Options of `view`.
#[derive(Debug, clap::Args)]
pub(crate) struct View {
    /// A built-in scene's name, a scene file, or the folder of a run to replay
    #[arg(value_name = "SCENE|RUN")]
    pub(crate) scene_or_run: String,

    /// Keys of the scene and their values.
    #[arg(help = SET_HELP, long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Run the scene with several values of a key, side by side, as in --compare transfer=pic,apic
    #[arg(long, value_name = "KEY=A,B")]
    pub(crate) compare: Option<Comparison>,

    /// Instruction set [default: the widest of this machine]
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Number of threads [default: all of this machine]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Print the rates of computing and drawing on standard error, once per second
    #[arg(long)]
    pub(crate) trace: bool,
}

/// A scene, the keys that are changed in it, and the instruction set.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SceneArgs {
    /// A built-in scene's name (see `lahar list`) or a scene file
    pub(crate) scene: String,

    /// Keys of the scene and their values.
    #[arg(help = SET_HELP, long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Instruction set [default: the widest of this machine]
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,
}

/// Options of `run`.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Run {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Folder to write [default: out/SCENE, numbered if it exists]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// Replace the run in the folder given by --output
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,

    /// Number of frames to write after frame 0 [default: the scene's duration]
    #[arg(long, value_name = "N", conflicts_with = "until")]
    pub(crate) frames: Option<u64>,

    /// Simulated time to run to, in seconds; the frame that contains it is finished
    #[arg(long, value_name = "T", value_parser = positive)]
    pub(crate) until: Option<f64>,

    /// Number of threads [default: all of this machine]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Output formats: npz, vtk, ply, bgeo (particles of each frame), png (a picture of each frame), gif (a film), or
    /// none [default: the scene's choice]
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    pub(crate) format: Option<Vec<String>>,

    /// Also make a film of the run (video.gif)
    #[arg(long)]
    pub(crate) video: bool,

    /// Also write a picture of every frame (images/000000.png)
    #[arg(long)]
    pub(crate) images: bool,

    /// Run the scene once per value of a key, and put the pictures and plots side by side, as in
    /// --compare transfer=pic,flip,apic
    #[arg(long, value_name = "KEY=A,B", conflicts_with_all = ["dry_run", "json"])]
    pub(crate) compare: Option<Comparison>,

    /// Check everything and print what would be done, but write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,

    /// Print the result as one JSON document on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `resume`.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Resume {
    /// Folder of the run
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,

    /// Continue to frame N, even beyond the end that the run was started with
    #[arg(long, value_name = "N", conflicts_with = "until")]
    pub(crate) frames: Option<u64>,

    /// Continue to this simulated time in seconds, even beyond the end that the run was started with
    #[arg(long, value_name = "T", value_parser = positive)]
    pub(crate) until: Option<f64>,

    /// Number of threads; it does not change the result [default: all of this machine]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Instruction set; another one rounds differently [default: the one that the run was started with]
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Print the result as one JSON document on standard output
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

    /// Print the text of the scene file instead, which can be edited and run
    #[arg(long, conflicts_with_all = ["set", "isa", "json"])]
    pub(crate) toml: bool,

    /// Print one JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `new`.
#[derive(Debug, clap::Args)]
pub(crate) struct New {
    /// File to write, like my.toml; an existing file is never overwritten
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Built-in scene to copy (see `lahar list`), with the files that it names [default: a commented dam break]
    #[arg(long, value_name = "SCENE")]
    pub(crate) from: Option<String>,
}

/// A run, and the frames of it to work on: the options that `mesh` and `render` have in common.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct RecordedArgs {
    /// Folder of a run with npz frames; the run need not be finished
    #[arg(value_name = "DIR")]
    pub(crate) run: PathBuf,

    /// Frames by number: 12, 0..60, 0..60:5 (every fifth) or 10.. [default: all]
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
    pub(crate) recorded: RecordedArgs,

    /// Folder to write [default: meshes/ in the run's folder]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// Materials to mesh, by name [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) materials: Vec<String>,

    /// Mesh formats: ply, obj, vtk
    #[arg(
        long,
        value_name = "FORMATS",
        value_delimiter = ',',
        default_value = "ply"
    )]
    pub(crate) format: Vec<String>,

    /// Number of smoothing passes; 0 leaves the surface as it is cut from the cubes
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) smoothing: u32,

    /// Edge of the cubes that the surface is cut from, in particle spacings; smaller is finer
    #[arg(long, value_name = "SIZE", default_value = "0.5", value_parser = positive)]
    pub(crate) cube: f64,
}

/// Options of `render`.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct Render {
    #[command(flatten)]
    pub(crate) recorded: RecordedArgs,

    /// Folder to write [default: render/ in the run's folder]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// Also make a film: video.gif, and video.mp4 if ffmpeg is installed or lahar was built with the feature mp4
    #[arg(long)]
    pub(crate) video: bool,

    /// Write the film only, without a picture of each frame
    #[arg(long, requires = "video")]
    pub(crate) no_images: bool,

    /// Width and height in pixels [default: the scene's choice]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub(crate) size: Option<Size>,

    /// Direction from the scene to the camera in 3D, as in --camera 1,0.5,2
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) camera: Option<String>,

    /// Quantity that colors show: material, body, speed, pressure, density, J [default: the scene's choice]
    #[arg(long, value_name = "QUANTITY")]
    pub(crate) color_by: Option<String>,

    /// Renderer of the pictures
    #[arg(long, value_name = "RENDERER", value_enum, default_value_t)]
    pub(crate) renderer: Renderer,

    /// Set a key of the scene, as in --set camera.height=2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

/// The program part that draws pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Renderer {
    /// Use gpu if it works, otherwise cpu
    #[default]
    Auto,
    /// Draw as the window does, on a graphics adapter or its software emulation; needs no display
    Gpu,
    /// Draw smooth surfaces on the processor
    Cpu,
}

/// Width and height of a picture \[pixels\].
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
            .ok_or_else(|| "expected WIDTHxHEIGHT like 1280x720, each from 16 to 16384".to_owned())
    }
}

/// Options of `report`.
#[derive(Debug, clap::Args)]
pub(crate) struct Report {
    /// Folder of a run
    #[arg(value_name = "DIR")]
    pub(crate) run: PathBuf,

    /// File to write [default: report.html in the run's folder]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `plot`.
#[derive(Debug, clap::Args)]
pub(crate) struct Plot {
    /// Folders of runs; several runs share the same plots
    #[arg(required = true, value_name = "DIR")]
    pub(crate) runs: Vec<PathBuf>,

    /// Folder to write; required for several runs [default: plots/ in the run's folder]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
}

/// Options of `validate`.
#[derive(Debug, clap::Args)]
pub(crate) struct Validate {
    /// Cases by name (K1, F5, D1, ...) or by scene; a scene file replaces the built-in scene with the same name
    /// [default: all but the long cases]
    #[arg(value_name = "CASE|SCENE")]
    pub(crate) cases: Vec<String>,

    /// Run only the coarser resolutions: all cases in a few minutes
    #[arg(long)]
    pub(crate) quick: bool,

    /// Also run the cases that take long
    #[arg(long)]
    pub(crate) long: bool,

    /// Set a key of the cases' scenes, as in --set transfer=flip, even where a case sets it; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Folder for validation.md and its plots [default: out/validate]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// Instruction set [default: the widest of this machine]
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Number of threads [default: all of this machine]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Print the results as one JSON document on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `bench`.
#[derive(Debug, clap::Args)]
pub(crate) struct Bench {
    /// Cases to measure: dam-3d, dam-2d, jelly-3d, snow-3d, dam-3d-f64, dam-3d-portable [default: all; with --growth:
    /// dam-3d]
    #[arg(long = "case", value_name = "CASES", value_delimiter = ',')]
    pub(crate) cases: Vec<String>,

    /// Approximate number of particles [default: a million]
    #[arg(long, value_name = "N", value_parser = positive, conflicts_with = "growth")]
    pub(crate) particles: Option<f64>,

    /// Numbers of threads to measure in turn, as in --threads 1,2 [default: all of this machine]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Vec<u16>,

    /// Instruction set [default: the widest of this machine]
    #[arg(long, value_name = "SET", value_parser = isa)]
    pub(crate) isa: Option<Isa>,

    /// Number of timed runs per case
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(crate) runs: u16,

    /// Show ratios to an earlier measurement: a file written by bench --json
    #[arg(long, value_name = "FILE")]
    pub(crate) compare: Option<PathBuf>,

    /// Measure with each of these numbers of particles, and plot how speed and memory grow
    #[arg(long, value_name = "N,M", value_delimiter = ',', value_parser = positive, num_args = 0..=1,
          default_missing_value = "1e5,3e5,1e6,3e6,1e7", require_equals = true)]
    pub(crate) growth: Option<Vec<f64>>,

    /// Folder for the plots of --growth [default: out/bench]
    #[arg(short, long, value_name = "DIR", requires = "growth")]
    pub(crate) output: Option<PathBuf>,

    /// Print the measurements as one JSON document on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `completions`.
#[derive(Debug, clap::Args)]
pub(crate) struct Completions {
    /// Shell to complete commands in
    pub(crate) shell: clap_complete::Shell,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected KEY=VALUE".to_owned()),
    }
}

fn isa(text: &str) -> Result<Isa, String> {
    let names = || Isa::ALL.map(Isa::name).join(", ");
    let isa = Isa::ALL
        .into_iter()
        .find(|isa| isa.name() == text)
        .ok_or_else(|| format!("expected one of {}", names()))?;
    if isa.is_available() {
        Ok(isa)
    } else {
        let have: Vec<_> = Isa::ALL
            .into_iter()
            .filter(|isa| isa.is_available())
            .map(Isa::name)
            .collect();
        Err(format!(
            "this machine does not support it; it supports {}",
            have.join(", ")
        ))
    }
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|time: &f64| time.is_finite() && *time > 0.0)
        .ok_or_else(|| "expected a number above 0".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definitions_agree() {
        Args::command().debug_assert();
    }

    /// zsh expands unquoted brackets: an example that it would refuse stands in quotes.
    #[test]
    fn examples_in_help_texts_are_quoted() {
        let mut command = Args::command();
        for command in command.get_subcommands_mut() {
            let help = command.render_long_help().to_string();
            for example in help.split("--set ").skip(1) {
                let word = example.split_whitespace().next().unwrap_or_default();
                assert!(
                    !word.contains(['[', '{']) || word.starts_with('\''),
                    "{help}"
                );
            }
        }
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
