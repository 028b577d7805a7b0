//! Where scenes come from: the window knows them by name and gets a simulation that is ready to run.

use lahar::Simulate;

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
pub enum Look {
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

/// A material as legends show it.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialCard {
    /// Its name in the scene.
    pub name: String,
    /// What it is drawn as.
    pub look: Look,
}

/// A scene, built.
pub struct Stage {
    /// How lists show it.
    pub card: SceneCard,
    /// At its start.
    pub simulation: Box<dyn Simulate>,
    /// Frames per simulated second \[1/s\].
    pub frame_rate: f64,
    /// By the index that particles name them by; may be short, the rest is drawn as [`Look::Other`].
    pub materials: Vec<MaterialCard>,
    /// What the scene's author should know though it runs.
    pub warnings: Vec<String>,
}

/// A shelf of scenes. Called from the window's and from the solver's thread.
pub trait SceneSource: Send + Sync {
    /// The scenes to choose from; keys 1 to 9 open the first nine.
    fn list(&self) -> Vec<SceneCard>;

    /// Builds a scene at its start.
    ///
    /// # Errors
    /// What is wrong with the scene and where, for people to read.
    fn open(&self, name_or_path: &str) -> Result<Stage, String>;
}
