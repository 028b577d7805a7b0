//! Where scenes come from: the window knows them by name and gets a simulation that is ready to run.

use lahar_io::image::Picture;
use lahar_io::output::Recording;
use lahar_scene::driver::Driver;
use lahar_scene::scene::{ColliderInfo, Controls};

use crate::color::ColorBy;

/// A scene as lists show it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCard {
    /// What opens it: a built-in's name or a path.
    pub name: String,
    /// A few words.
    pub title: String,
    /// What there is to see, in a sentence; may be empty.
    pub sentence: String,
    /// 2 or 3.
    pub dimension: usize,
}

/// What a material is drawn as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MaterialKind {
    /// Water and what flows like it.
    Liquid,
    /// Elastic bodies.
    Jelly,
    /// Snow.
    Snow,
    /// Loose particles without stress.
    Dust,
    /// Anything else.
    #[default]
    Other,
}

/// What particles look like, as legends show it: a material, or a body that the scene dyes.
#[derive(Clone, Debug, PartialEq)]
pub struct Swatch {
    /// The material's name or the body's.
    pub name: String,
    /// What it is drawn as.
    pub look: MaterialKind,
    /// Its color; `None`: its look's.
    pub color: Option<[u8; 3]>,
}

/// What stays the same while a scene runs.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneInfo {
    /// How lists show it.
    pub card: SceneCard,
    /// 2 or 3.
    pub dimension: usize,
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// Corners of the domain \[m\]; `None`: unbounded.
    pub domain: Option<([f64; 3], [f64; 3])>,
    /// What material cannot enter.
    pub colliders: Vec<ColliderInfo>,
    /// Gravity at the start \[m/s²\].
    pub gravity: [f64; 3],
    /// Frames per simulated second \[1/s\].
    pub frame_rate: f64,
    /// Frames of a recording; `None`: it is simulated.
    pub frames: Option<usize>,
    /// What there is to see.
    pub swatches: Vec<Swatch>,
    /// Index into `swatches`, by the number of a body; a body beyond the end is drawn as the first.
    pub body_swatches: Vec<usize>,
    /// Bodies by number: their names, and what they are drawn in where colors tell bodies apart.
    pub bodies: Vec<(String, [u8; 3])>,
    /// How the scene wants to be looked at.
    pub angle: Angle,
    /// What keys and mouse do.
    pub controls: Controls,
    /// What the panel offers to change.
    pub settings: Vec<Setting>,
    /// "f32" or "f64", and the instruction set.
    pub numbers: String,
    /// What the scene's author should know though it runs.
    pub warnings: Vec<String>,
}

/// A scene, ready to be shown.
pub struct OpenedScene {
    /// What stays the same.
    pub info: SceneInfo,
    /// What moves.
    pub content: SceneContent,
}

/// What moves.
pub enum SceneContent {
    /// A simulation at its start.
    Simulation(Box<Driver>),
    /// A finished run.
    Recording(Box<Recording>),
}

/// A key of the scene that the panel offers to change.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Dotted, as `--set` on the command line takes it.
    pub key: String,
    /// Heading that it stands under: "scene", a material, a body.
    pub group: String,
    /// Its name under the heading.
    pub name: String,
    /// What it is now.
    pub value: SettingValue,
}

/// What a setting can be.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingValue {
    /// A number.
    Number(f64),
    /// One of these words.
    Word(String, &'static [&'static str]),
}

impl SettingValue {
    /// As a scene file has it.
    pub fn to_toml(&self) -> String {
        match self {
            Self::Number(number) => format!("{number:?}"),
            Self::Word(word, _) => format!("\"{word}\""),
        }
    }
}

/// Keys and values in TOML, laid over a scene, as `--set` on the command line.
pub type Changes = Vec<(String, String)>;

/// How to look at a scene. What it leaves open, the window fits to the scene's size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Angle {
    /// What the middle of the window shows \[m\].
    pub center: Option<[f64; 3]>,
    /// Height that the window shows there \[m\].
    pub height: Option<f64>,
    /// From the scene to the camera; 3D only.
    pub direction: Option<[f64; 3]>,
    /// Between the lower and the upper edge of the window \[degrees\]; 3D only.
    pub field_of_view: Option<f64>,
    /// Radius of a particle as drawn \[m\]; `None`: from the particles' spacing.
    pub particle_radius: Option<f64>,
    /// Color behind everything.
    pub background: Option<[u8; 3]>,
    /// What particles are colored by at first.
    pub color_by: ColorBy,
}

/// A library of scenes. Called from the window's and from the solver's thread.
pub trait SceneSource: Send + Sync {
    /// The scenes to choose from; keys 1 to 9 open the first nine.
    fn list(&self) -> Vec<SceneCard>;

    /// Builds a scene at its start, with changes.
    ///
    /// # Errors
    /// What is wrong with the scene and where, for people to read.
    fn open(&self, name_or_path: &str, changes: &Changes) -> Result<OpenedScene, String>;

    /// A small picture of a scene for lists, no larger than `size` pixels; takes its time.
    fn thumbnail(&self, _name: &str, _size: [u32; 2]) -> Option<Picture> {
        None
    }
}
