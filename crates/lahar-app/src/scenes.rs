//! Scenes as the window knows them, and the source that they come from.

use lahar_io::image::Picture;
use lahar_io::output::Recording;
use lahar_scene::driver::Driver;
use lahar_scene::scene::{BodyView, Camera, ColliderInfo, Controls, Look, Setting};

/// A scene as lists show it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCard {
    /// The name that opens it: a built-in's name or a path.
    pub name: String,
    /// A title of a few words.
    pub title: String,
    /// A sentence on what there is to see; may be empty.
    pub sentence: String,
    /// Number of dimensions, 2 or 3.
    pub dimension: usize,
}

/// An entry of the legend: a material, or a body that has a color of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Swatch {
    /// The material's name or the body's.
    pub name: String,
    /// The look of the material; `None` if its model is unknown.
    pub look: Option<Look>,
    /// The color that the scene gives; `None`: the usual color of the look.
    pub color: Option<[u8; 3]>,
}

/// Everything about a scene that stays the same while it runs.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneInfo {
    /// The scene as lists show it.
    pub card: SceneCard,
    /// Number of dimensions, 2 or 3.
    pub dimension: usize,
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// Corners of the domain \[m\]; `None` if it is unbounded.
    pub domain: Option<([f64; 3], [f64; 3])>,
    /// The colliders, which material cannot enter.
    pub colliders: Vec<ColliderInfo>,
    /// Gravity at the start \[m/s²\].
    pub gravity: [f64; 3],
    /// Frames per simulated second \[1/s\].
    pub frame_rate: f64,
    /// Number of frames of a recording; `None` for a simulation.
    pub frames: Option<usize>,
    /// The entries of the legend.
    pub swatches: Vec<Swatch>,
    /// Index into `swatches`, by the number of a body. Bodies beyond the end are drawn as the first one.
    pub body_swatches: Vec<usize>,
    /// The bodies, by number.
    pub bodies: Vec<BodyView>,
    /// The camera that the scene asks for.
    pub camera: Camera,
    /// The controls of keys and mouse.
    pub controls: Controls,
    /// The settings that the panel offers to change.
    pub settings: Vec<Setting>,
    /// The precision and the instruction set, as in "f32, avx2".
    pub numbers: String,
    /// Suspicious things about the scene, in words.
    pub warnings: Vec<String>,
}

/// A scene, ready to be shown.
pub struct OpenedScene {
    /// Everything that stays the same while it runs.
    pub info: SceneInfo,
    /// The particles that move.
    pub content: SceneContent,
}

/// The source of the particles that a scene shows.
pub enum SceneContent {
    /// A simulation at its start.
    Simulation(Box<Driver>),
    /// A finished run to replay.
    Recording(Box<Recording>),
}

/// Keys and values in TOML that override a scene's, as `--set` on the command line does.
pub type Changes = Vec<(String, String)>;

/// A source of scenes. The window's thread and the solver's thread both call it.
pub trait SceneSource: Send + Sync {
    /// Lists the scenes to choose from. The keys 1 to 9 open the first nine.
    fn list(&self) -> Vec<SceneCard>;

    /// Builds a scene at its start, with changes.
    ///
    /// # Errors
    /// The mistake in the scene and its place, for people to read.
    fn open(&self, name_or_path: &str, changes: &Changes) -> Result<OpenedScene, String>;

    /// Draws a small picture of a scene for lists, no larger than `size` pixels. This takes its time.
    fn thumbnail(&self, _name: &str, _size: [u32; 2]) -> Option<Picture> {
        None
    }
}
