//! The materials, bodies and output of a scene, as windows, pictures and runs need them.

use super::read::Reader;
use crate::error::SceneError;

/// The precision that a simulation computes in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Numbers of 32 bits.
    #[default]
    F32,
    /// Numbers of 64 bits.
    F64,
}

/// A material of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialInfo {
    /// The name in the scene.
    pub name: String,
    /// The word for the constitutive model.
    pub model: String,
    /// Density at rest \[kg/m³; kg/m² in 2D\].
    pub density: f64,
    /// Speed of pressure waves at rest \[m/s\]: the speed of sound of a fluid, √((λ+2μ)/ρ) of a solid.
    pub wave_speed: f64,
    /// The color, if the scene or the preset gives one.
    pub color: Option<[u8; 3]>,
}

/// A body of a scene. Particles know it by its index in [`Scene::bodies`](super::Scene::bodies).
#[derive(Clone, Debug, PartialEq)]
pub struct BodyInfo {
    /// The name in the scene.
    pub name: String,
    /// Index of the material.
    pub material: usize,
    /// The color, if the scene gives one. Otherwise the body has the color of its material.
    pub color: Option<[u8; 3]>,
    /// Number of particles: an estimate for shapes that are sampled on lattices.
    pub expected_particles: f64,
}

/// The output that a scene asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPlan {
    /// Words of the formats.
    pub formats: Vec<String>,
    /// Names of the particle fields; `None` for all that carry information.
    pub fields: Option<Vec<String>>,
    /// Every how many frames one is written.
    pub every: u64,
    /// Every how many frames a checkpoint is kept; 0 for none by frames.
    pub checkpoint_every: u64,
    /// Minutes of wall-clock time between checkpoints; 0 for none by time.
    pub checkpoint_minutes: f64,
    /// Width and height of pictures \[pixels\].
    pub picture_size: [u32; 2],
}

/// Reads the table `[output]`.
pub(super) fn read_output(scene: &Reader<'_>) -> Result<OutputPlan, SceneError> {
    let Some(table) = scene.opt_table("output") else {
        return Err(scene.error("there is no output"));
    };
    let size = table.vector::<2>("picture_size")?;
    Ok(OutputPlan {
        formats: table.opt_words("formats").unwrap_or_default(),
        fields: table.opt_words("fields"),
        every: table.integer("every")?,
        checkpoint_every: table.integer("checkpoint_every")?,
        checkpoint_minutes: table.number("checkpoint_minutes")?,
        picture_size: size.map(|side| side as u32),
    })
}
