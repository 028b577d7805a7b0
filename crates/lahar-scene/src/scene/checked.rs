//! The type [`Scene`]: reading, and what is known of a scene before it is built.

use super::check;
use super::choices::PRECISIONS;
use super::colliders::{ColliderInfo, infos};
use super::controls::{Controls, read_controls};
use super::document::{Document, Span};
use super::files::{
    EmbeddedFiles, Files, FolderFiles, KeptFile, KeptFiles, SceneFile, SceneFiles, read_text,
};
use super::info::{BodyInfo, MaterialInfo, OutputPlan, Precision, read_output};
use super::limits::Limits;
use super::plan::{Body, Plan};
use super::probes::read_probes;
use super::read::Reader;
use super::read_plan::read_frames;
use super::space::vector_in_3d;
use super::stiffness::SoundSpeeds;
use super::view::{Camera, SceneView};
use crate::builtin;
use crate::error::SceneError;
use lahar::geometry::Bounds;
use lahar::particles::{FIELDS, FieldInfo};
use lahar::{Field, TimeStep};
use std::path::Path;

/// A scene that has been read and checked.
///
/// ```
/// use lahar_scene::scene::Scene;
///
/// let scene = Scene::load("dam-break", &[("duration".to_owned(), "2.0".to_owned())])?;
/// assert_eq!((scene.dimension, scene.frames()), (2, 120));
/// # Ok::<(), lahar_scene::error::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the file or built-in scene.
    pub name: String,
    /// The TOML text that it was read from.
    pub text: String,
    /// Keys and values that replaced those of the text, in TOML.
    pub overrides: Vec<(String, String)>,
    /// The files that it names.
    pub files: Vec<SceneFile>,
    /// The title of the scene.
    pub title: String,
    /// Number of dimensions, 2 or 3.
    pub dimension: usize,
    /// Simulated time of a run \[s\].
    pub duration: f64,
    /// Frames per simulated second \[1/s\].
    pub frame_rate: f64,
    /// Substeps per frame, if the scene fixes them.
    pub substeps_per_frame: Option<u64>,
    /// The precision of the simulation.
    pub precision: Precision,
    /// The seed of all random numbers.
    pub seed: u64,
    /// The materials, by index.
    pub materials: Vec<MaterialInfo>,
    /// The bodies, by number.
    pub bodies: Vec<BodyInfo>,
    /// The colliders, in the order of the scene.
    pub colliders: Vec<ColliderInfo>,
    /// The camera of windows and pictures.
    pub camera: Camera,
    /// The controls of keys and mouse in the window.
    pub controls: Controls,
    /// The output of a run.
    pub output: OutputPlan,
    /// Warnings about the scene.
    pub warnings: Vec<String>,
    pub(super) document: Document,
    pub(super) plan: AnyPlan,
}

/// A plan in either dimension.
#[derive(Clone, Debug)]
pub(super) enum AnyPlan {
    D2(Plan<2>),
    D3(Plan<3>),
}

impl Scene {
    /// Reads a scene from its text. `name` is the file's: messages show it, and the files that the scene names
    /// are found from its folder. Overrides are keys, dotted as on the command line, and values in TOML.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn parse(
        text: &str,
        name: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, SceneError> {
        Self::parse_within(text, name, overrides, &Limits::default())
    }

    /// [`Scene::parse`] with other limits.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn parse_within(
        text: &str,
        name: &str,
        overrides: &[(String, String)],
        limits: &Limits,
    ) -> Result<Self, SceneError> {
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        Self::parse_with(text, name, overrides, limits, &FolderFiles(folder.into()))
    }

    /// [`Scene::parse_within`] with other files: from memory, where there is no file system.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn parse_with(
        text: &str,
        name: &str,
        overrides: &[(String, String)],
        limits: &Limits,
        files: &dyn SceneFiles,
    ) -> Result<Self, SceneError> {
        read_scene(text, name, overrides, limits, files)
    }

    /// Reads a built-in scene by its name, or a scene file by its path.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn load(name_or_path: &str, overrides: &[(String, String)]) -> Result<Self, SceneError> {
        Self::load_within(name_or_path, overrides, &Limits::default())
    }

    /// [`Scene::load`] with other limits.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn load_within(
        name_or_path: &str,
        overrides: &[(String, String)],
        limits: &Limits,
    ) -> Result<Self, SceneError> {
        if let Some(scene) = builtin::find(name_or_path) {
            let files = EmbeddedFiles(scene.files);
            return read_scene(scene.text, scene.name, overrides, limits, &files);
        }
        Self::parse_within(&read_text(name_or_path)?, name_or_path, overrides, limits)
    }

    /// Reads a scene that a run has kept: its text, and copies of its `files` in `folder`.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn kept(
        name: &str,
        text: &str,
        overrides: &[(String, String)],
        limits: &Limits,
        (files, folder): (&[KeptFile], &Path),
    ) -> Result<Self, SceneError> {
        read_scene(text, name, overrides, limits, &KeptFiles { files, folder })
    }

    /// Makes an error that points at a key of the scene ("output.formats"), or at the longest part of the key
    /// that the scene has.
    pub fn error_at(&self, key: &str, message: impl Into<String>) -> SceneError {
        match self.document.locate(key) {
            Some(span) => self.document.sources.error(span, message),
            None => SceneError::of_file(&*self.name, message),
        }
    }

    /// Returns the scene as windows and pictures show it.
    pub fn view(&self) -> SceneView {
        let Document { sources, root } = &self.document;
        let reader = Reader::new(sources, root, Span::default());
        SceneView::read(&reader, self.frame_rate, self.colliders.clone())
    }

    /// Returns the center and the height that a picture is to show \[m\], if the scene's camera gives one of them.
    pub fn framing(&self) -> Option<([f64; 3], f64)> {
        let Camera { center, height, .. } = self.camera;
        if center.is_none() && height.is_none() {
            return None;
        }
        let (min, max) = self.bounds();
        let sides: [f64; 3] = core::array::from_fn(|i| max[i] - min[i]);
        let extent = match self.dimension {
            2 => sides[1],
            _ => sides.iter().map(|side| side.powi(2)).sum::<f64>().sqrt(),
        };
        let whole = if extent > 0.0 {
            extent
        } else {
            10.0 * self.dx()
        };
        let middle = core::array::from_fn(|i| 0.5 * (min[i] + max[i]));
        Some((center.unwrap_or(middle), height.unwrap_or(whole)))
    }

    /// Returns the materials as the simulator has them.
    pub(super) fn simulated_materials(&self) -> &[lahar::Material] {
        match &self.plan {
            AnyPlan::D2(plan) => &plan.materials,
            AnyPlan::D3(plan) => &plan.materials,
        }
    }

    /// Returns the fields in files of particles, in the order of [`FIELDS`]: those that the scene asks for, or all
    /// that one of its materials stores.
    pub fn output_fields(&self) -> Vec<Field> {
        let written = |info: &&FieldInfo| match &self.output.fields {
            Some(names) => names.iter().any(|name| name == info.name),
            None => (self.simulated_materials().iter())
                .any(|material| info.field.is_stored_by(&material.model)),
        };
        FIELDS
            .iter()
            .filter(written)
            .map(|info| info.field)
            .collect()
    }

    /// Returns the rule for the speeds of sound when gravity is changed during a run.
    pub fn sound_speeds(&self) -> SoundSpeeds {
        match &self.plan {
            AnyPlan::D2(plan) => plan.sound_speeds(),
            AnyPlan::D3(plan) => plan.sound_speeds(),
        }
    }

    /// Returns the number of frames of a run, without the one at time 0.
    pub fn frames(&self) -> u64 {
        (self.duration * self.frame_rate).round().max(1.0) as u64
    }

    /// Returns the number of particles: an estimate where shapes are sampled on lattices.
    pub fn expected_particles(&self) -> f64 {
        self.bodies.iter().map(|body| body.expected_particles).sum()
    }

    /// Returns the time step that the scene asks for.
    pub(super) fn time_step(&self) -> TimeStep {
        match &self.plan {
            AnyPlan::D2(plan) => plan.time_step,
            AnyPlan::D3(plan) => plan.time_step,
        }
    }

    /// Returns the distance between nodes \[m\].
    pub fn dx(&self) -> f64 {
        match &self.plan {
            AnyPlan::D2(plan) => plan.dx,
            AnyPlan::D3(plan) => plan.dx,
        }
    }

    /// Returns the lower and upper corner of the domain, or of the bodies where there is no domain \[m\].
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        match &self.plan {
            AnyPlan::D2(plan) => corners(plan),
            AnyPlan::D3(plan) => corners(plan),
        }
    }
}

/// Returns the lower and upper corner of the domain, or of the bodies where there is no domain.
fn corners<const D: usize>(plan: &Plan<D>) -> ([f64; 3], [f64; 3]) {
    let bounds = match &plan.domain {
        Some(domain) => Bounds {
            min: domain.min,
            max: domain.max,
        },
        None => Bounds::around(plan.bodies.iter().map(Body::bounds)),
    };
    (vector_in_3d(bounds.min), vector_in_3d(bounds.max))
}

/// Reads a scene from its text, with files from `files`.
pub(super) fn read_scene(
    text: &str,
    name: &str,
    overrides: &[(String, String)],
    limits: &Limits,
    files: &dyn SceneFiles,
) -> Result<Scene, SceneError> {
    let files = Files::new(files, limits);
    let mut document = Document::parse(text, name, overrides)?;
    let Document { sources, root } = &mut document;
    let dimension = check::check(sources, root)?;
    let reader = Reader::new(sources, root, Span::default());
    if dimension == 2 {
        let plan = Plan::<2>::read(&reader, &files)?;
        scene(
            &document,
            plan,
            AnyPlan::D2,
            (text, name, overrides),
            files.used(),
        )
    } else {
        let plan = Plan::<3>::read(&reader, &files)?;
        scene(
            &document,
            plan,
            AnyPlan::D3,
            (text, name, overrides),
            files.used(),
        )
    }
}

/// Puts a scene together from its document and plan.
fn scene<const D: usize>(
    document: &Document,
    plan: Plan<D>,
    wrap: impl Fn(Plan<D>) -> AnyPlan,
    (text, name, overrides): (&str, &str, &[(String, String)]),
    files: Vec<SceneFile>,
) -> Result<Scene, SceneError> {
    let reader = Reader::new(&document.sources, &document.root, Span::default());
    let (frame_rate, substeps_per_frame) = read_frames(&reader, plan.time_step)?;
    let plan = Plan {
        probes: read_probes(&reader, plan.dx, frame_rate)?,
        ..plan
    };
    let material_colors = reader
        .tables("materials")
        .into_iter()
        .map(|(_, table)| (table.opt_text("model"), table.opt_color("color")));
    let materials = plan
        .materials
        .iter()
        .zip(material_colors)
        .map(|(material, (model, color))| MaterialInfo {
            name: material.name.clone(),
            model: model.unwrap_or_default().to_owned(),
            density: material.density,
            wave_speed: material.sound_speed(),
            color,
        })
        .collect();
    let bodies = plan
        .bodies
        .iter()
        .zip(reader.tables("bodies"))
        .zip(plan.expected_particles())
        .map(|((body, (_, table)), expected_particles)| BodyInfo {
            name: body.name.clone(),
            material: body.material,
            color: table.opt_color("color"),
            expected_particles,
        })
        .collect();
    let colliders = infos(&reader, &plan.colliders);
    let view = SceneView::read(&reader, frame_rate, colliders.clone());
    Ok(Scene {
        name: name.to_owned(),
        text: text.to_owned(),
        overrides: overrides.to_vec(),
        files,
        title: reader.text("title")?.to_owned(),
        dimension: D,
        duration: reader.number("duration")?,
        frame_rate,
        substeps_per_frame,
        precision: reader.choice("precision", &PRECISIONS)?,
        seed: reader.integer("seed")?,
        materials,
        bodies,
        colliders,
        camera: view.camera,
        controls: read_controls(&reader)?,
        output: read_output(&reader)?,
        warnings: plan.warnings.clone(),
        document: document.clone(),
        plan: wrap(plan),
    })
}
