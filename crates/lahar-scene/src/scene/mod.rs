//! Scene files: TOML text → [`Scene`], a plan that is known to be sound → [`Built`], a simulation.
//!
//! ```
//! let text = r#"
//!     dx = 0.05
//!     [domain]
//!     min = [0.0, 0.0]
//!     max = [2.0, 1.0]
//!     [materials.water]
//!     preset = "water"
//!     [[bodies]]
//!     material = "water"
//!     shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }
//! "#;
//! let scene = lahar_scene::scene::Scene::parse(text, "column.toml", &[])?;
//! let built = scene.build(lahar::Isa::Portable)?;
//! assert_eq!(built.simulation.particle_count(), 400);
//! # Ok::<(), lahar_scene::error::SceneError>(())
//! ```

mod bodies;
mod build;
mod check;
mod colliders;
mod comparison;
mod contact;
mod controls;
mod document;
mod domain;
mod files;
mod forces;
mod formula;
mod key;
mod keys;
mod limits;
mod material;
mod motion;
mod plan;
mod probes;
mod read;
mod read_plan;
mod reference;
mod shapes;
mod stiffness;
#[cfg(test)]
mod tests;
mod view;
mod warnings;

pub use colliders::{ColliderInfo, colliders_of};
pub use comparison::Comparison;
pub use controls::Controls;
pub use material::Look;
pub use reference::{docs, docs_of, schema};
pub use stiffness::SoundSpeeds;
pub use view::{BodyView, Camera, ColorBy, MaterialView, SceneView, Setting, SettingValue};

use crate::builtin;
use crate::error::SceneError;
use document::{Document, Span, json_table};
use files::{EmbeddedFiles, Files, KeptFiles, read_text};
pub use files::{FileSource, FolderFiles, KeptFile, SceneFile, SceneFiles};
use lahar::particles::{FIELDS, FieldInfo};
use lahar::{Field, Isa, Simulate, Simulation, TimeStep};
pub use limits::Limits;
use motion::InMotion;
use plan::Plan;
use read::Reader;
use std::fmt;
use std::path::Path;

/// Kind of numbers that a simulation computes with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits.
    #[default]
    F32,
    /// 64 bits.
    F64,
}

/// A material, for outlets.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialInfo {
    /// Its name in the scene.
    pub name: String,
    /// The name of its model.
    pub model: String,
    /// Density at rest \[kg/m³; kg/m² in 2D\].
    pub density: f64,
    /// Speed of pressure waves at rest \[m/s\]: of sound for fluids, √((λ+2μ)/ρ) for solids.
    pub wave_speed: f64,
    /// Its colour, if the scene or its preset gives one.
    pub color: Option<[u8; 3]>,
}

/// A body, for outlets. Its number, as particles know it, is its index.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyInfo {
    /// Its name.
    pub name: String,
    /// Index of its material.
    pub material: usize,
    /// Its colour, if the scene gives it one; else it has its material's.
    pub color: Option<[u8; 3]>,
    /// Number of particles; about, for shapes that are sampled on lattices.
    pub expected_particles: f64,
}

/// What a run writes.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPlan {
    /// Names of formats.
    pub formats: Vec<String>,
    /// Names of particle fields; `None`: all.
    pub fields: Option<Vec<String>>,
    /// Frames between frames that are written.
    pub every: u64,
    /// Frames between checkpoints; 0: none by frames.
    pub checkpoint_every: u64,
    /// Minutes of the clock between checkpoints; 0: none by time.
    pub checkpoint_minutes: f64,
    /// Width and height of pictures \[pixels\].
    pub picture_size: [u32; 2],
}

/// A scene that has been read and checked.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the file or built-in scene.
    pub name: String,
    /// The TOML text that it was read from.
    pub text: String,
    /// What was laid over it.
    pub overrides: Vec<(String, String)>,
    /// The files that it names.
    pub files: Vec<SceneFile>,
    /// What it is, for people.
    pub title: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Simulated time of a run \[s\].
    pub duration: f64,
    /// Frames a simulated second.
    pub frame_rate: f64,
    /// Substeps of a frame, if the scene fixes them.
    pub substeps_per_frame: Option<u64>,
    /// Numbers to compute with.
    pub precision: Precision,
    /// Of everything random.
    pub seed: u64,
    /// The materials, by index.
    pub materials: Vec<MaterialInfo>,
    /// The bodies, by number.
    pub bodies: Vec<BodyInfo>,
    /// The colliders, in the order of the scene.
    pub colliders: Vec<ColliderInfo>,
    /// How to look at it.
    pub camera: Camera,
    /// What keys and mouse do in the window.
    pub controls: Controls,
    /// What to write.
    pub output: OutputPlan,
    /// What is suspicious about it.
    pub warnings: Vec<String>,
    document: Document,
    plan: AnyPlan,
}

#[derive(Clone, Debug)]
enum AnyPlan {
    D2(Plan<2>),
    D3(Plan<3>),
}

/// A simulation that is ready to run.
pub struct Built {
    /// The simulation, at time 0.
    pub simulation: Box<dyn Simulate>,
    /// Particles of each body, by number.
    pub body_particles: Vec<usize>,
    /// Particles that each body would have where colliders are, by number; they were not made.
    pub left_out: Vec<usize>,
    /// What is suspicious, the scene's own warnings included.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Reads a scene from its text. `name` is the file's, for messages; particle lists are looked
    /// for in its folder. Overrides are keys, dotted as on the command line, and values in TOML.
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

    /// Reads a built-in scene by its name, or a file.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn load(what: &str, overrides: &[(String, String)]) -> Result<Self, SceneError> {
        Self::load_within(what, overrides, &Limits::default())
    }

    /// [`Scene::load`] with other limits.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line and column.
    pub fn load_within(
        what: &str,
        overrides: &[(String, String)],
        limits: &Limits,
    ) -> Result<Self, SceneError> {
        if let Some(scene) = builtin::find(what) {
            let files = EmbeddedFiles(scene.files);
            return read_scene(scene.text, scene.name, overrides, limits, &files);
        }
        Self::parse_within(&read_text(what)?, what, overrides, limits)
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

    /// The scene of a run, from [`Scene::resolved`] as its record keeps it, and its name; with overrides.
    ///
    /// # Errors
    /// What is wrong with it: a file that it names may be gone.
    pub fn recorded(
        resolved: &serde_json::Value,
        name: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, SceneError> {
        let wrong = |error: &dyn fmt::Display| {
            SceneError::of_file(name, format!("the scene in run.json: {error}"))
        };
        let mut scene = toml::Value::try_from(resolved).map_err(|error| wrong(&error))?;
        if let Some(root) = scene.as_table_mut() {
            root.remove("computed");
        }
        restore_infinities(&mut scene);
        let text = toml::to_string(&scene).map_err(|error| wrong(&error))?;
        let limits = Limits::default();
        match builtin::find(name) {
            Some(scene) => {
                let files = EmbeddedFiles(scene.files);
                read_scene(&text, name, overrides, &limits, &files)
            }
            None => Self::parse_within(&text, name, overrides, &limits),
        }
    }

    /// Samples the particles and makes the simulation.
    ///
    /// # Errors
    /// What the simulator refuses, pointed at in the scene; an instruction set that this machine
    /// does not have.
    pub fn build(&self, isa: Isa) -> Result<Built, SceneError> {
        if !isa.is_available() {
            let have: Vec<&str> = Isa::ALL
                .into_iter()
                .filter(|isa| isa.is_available())
                .map(Isa::name)
                .collect();
            return Err(SceneError::of_file(
                &*self.name,
                format!("this machine has no {}", isa.name()),
            )
            .hint(format!("it has: {}", have.join(", "))));
        }
        match (&self.plan, self.precision) {
            (AnyPlan::D2(plan), Precision::F32) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f32, 2>::new(setup, batches)?))
            }),
            (AnyPlan::D2(plan), Precision::F64) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f64, 2>::new(setup, batches)?))
            }),
            (AnyPlan::D3(plan), Precision::F32) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f32, 3>::new(setup, batches)?))
            }),
            (AnyPlan::D3(plan), Precision::F64) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f64, 3>::new(setup, batches)?))
            }),
        }
    }

    fn build_from<const D: usize>(
        &self,
        plan: &Plan<D>,
        isa: Isa,
        make: impl Fn(lahar::Setup<D>, InMotion<'_, D>) -> Result<Box<dyn Simulate>, lahar::SetupError>,
    ) -> Result<Built, SceneError> {
        let mut warnings = self.warnings.clone();
        let (batches, left_out) = plan.batches(self.seed, &mut warnings);
        for (batch, body) in batches.iter().zip(&plan.bodies) {
            if batch.position.is_empty() {
                let error = self.error_at(
                    &format!("bodies.{}.shape", body.name),
                    format!("body \"{}\" comes to no particle", body.name),
                );
                return Err(error.hint(if plan.colliders.is_empty() {
                    "make the body larger, or dx or spacing smaller"
                } else {
                    "what is inside colliders is left out; make the body larger, or dx or spacing smaller"
                }));
            }
        }
        for (first, second, inside) in plan.overlaps(&batches) {
            warnings.push(format!("bodies \"{}\" and \"{}\" overlap: {inside} particles of the second start inside the first", plan.bodies[first].name, plan.bodies[second].name));
        }
        let body_particles = batches.iter().map(|batch| batch.position.len()).collect();
        let batches = InMotion::new(plan, batches, self.seed);
        let simulation = make(plan.setup(isa), batches).map_err(|error| {
            self.error_at(&error.key, format!("{}: {}", error.key, error.message))
        })?;
        Ok(Built {
            simulation,
            body_particles,
            left_out,
            warnings,
        })
    }

    /// An error that points at a key of the scene ("output.formats"), or at the longest part of it
    /// that is there.
    pub fn error_at(&self, key: &str, message: impl Into<String>) -> SceneError {
        match self.document.locate(key) {
            Some(span) => self.document.sources.error(span, message),
            None => SceneError::of_file(&*self.name, message),
        }
    }

    /// The scene as windows and pictures show it.
    pub fn view(&self) -> SceneView {
        let Document { sources, root } = &self.document;
        let reader = Reader::new(sources, root, Span::default());
        SceneView::read(&reader, self.frame_rate, self.colliders.clone())
    }

    /// The center and the height that a picture is to show \[m\], if the scene's camera gives one of them.
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

    /// The scene with every default filled in, and what was computed from it under "computed".
    pub fn resolved(&self) -> serde_json::Value {
        let mut value = json_table(&self.document.root);
        let materials: serde_json::Map<String, serde_json::Value> = self
            .materials
            .iter()
            .map(|material| {
                let computed = serde_json::json!({
                    "wave_speed": material.wave_speed,
                    "modulus": material.density * material.wave_speed * material.wave_speed,
                });
                (material.name.clone(), computed)
            })
            .collect();
        let bodies: serde_json::Map<String, serde_json::Value> = self
            .bodies
            .iter()
            .map(|body| {
                (
                    body.name.clone(),
                    serde_json::json!({ "expected_particles": body.expected_particles.round() }),
                )
            })
            .collect();
        if let Some(root) = value.as_object_mut() {
            let computed = serde_json::json!({
                "name": self.name,
                "frame_rate": self.frame_rate,
                "frames": self.frames(),
                "materials": materials,
                "bodies": bodies,
            });
            root.insert("computed".to_owned(), computed);
        }
        value
    }

    /// The materials as the simulator has them.
    fn simulated_materials(&self) -> &[lahar::Material] {
        match &self.plan {
            AnyPlan::D2(plan) => &plan.materials,
            AnyPlan::D3(plan) => &plan.materials,
        }
    }

    /// The fields in files of particles, in the order of [`FIELDS`]: those asked for, or else all that say
    /// something of any of the materials.
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

    /// How fast sound should be when gravity is changed while it runs.
    pub fn sound_speeds(&self) -> SoundSpeeds {
        match &self.plan {
            AnyPlan::D2(plan) => plan.sound_speeds(),
            AnyPlan::D3(plan) => plan.sound_speeds(),
        }
    }

    /// Frames of a run, the first one at time 0 not counted.
    pub fn frames(&self) -> u64 {
        (self.duration * self.frame_rate).round().max(1.0) as u64
    }

    /// Number of particles; about, where shapes are sampled on lattices.
    pub fn expected_particles(&self) -> f64 {
        self.bodies.iter().map(|body| body.expected_particles).sum()
    }

    /// Distance between nodes \[m\].
    pub fn dx(&self) -> f64 {
        match &self.plan {
            AnyPlan::D2(plan) => plan.dx,
            AnyPlan::D3(plan) => plan.dx,
        }
    }

    /// Lower and upper corner of the domain, or of the bodies where there is none \[m\].
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        match &self.plan {
            AnyPlan::D2(plan) => bounds(plan),
            AnyPlan::D3(plan) => bounds(plan),
        }
    }

    /// What the scene comes to, in a few lines.
    pub fn summary(&self) -> String {
        let (setup, dx) = match &self.plan {
            AnyPlan::D2(plan) => (time_step_words(plan.time_step), plan.dx),
            AnyPlan::D3(plan) => (time_step_words(plan.time_step), plan.dx),
        };
        let (min, max) = self.bounds();
        let sides: Vec<String> = (0..self.dimension)
            .map(|i| format!("{:.4}", max[i] - min[i]))
            .collect();
        let cells: Vec<String> = (0..self.dimension)
            .map(|i| format!("{:.0}", (max[i] - min[i]) / dx))
            .collect();
        let mut lines = vec![
            if self.title.is_empty() {
                self.name.clone()
            } else {
                format!("{}: {}", self.name, self.title)
            },
            format!(
                "{}D, {} m, {} cells of {dx} m",
                self.dimension,
                sides.join(" x "),
                cells.join(" x ")
            ),
            format!(
                "{} s in {} frames, time step {setup}",
                self.duration,
                self.frames()
            ),
        ];
        for body in &self.bodies {
            let material = &self.materials[body.material];
            lines.push(format!(
                "{}: about {:.0} particles of {} ({}, {} kg/m3, wave speed {:.2} m/s)",
                body.name,
                body.expected_particles,
                material.name,
                material.model,
                material.density,
                material.wave_speed
            ));
        }
        lines.join("\n") + "\n"
    }
}

/// JSON has no infinite numbers, so [`Scene::resolved`] has words in their place.
fn restore_infinities(value: &mut toml::Value) {
    match value {
        toml::Value::String(word) if word == "inf" => *value = toml::Value::Float(f64::INFINITY),
        toml::Value::String(word) if word == "-inf" => {
            *value = toml::Value::Float(f64::NEG_INFINITY);
        }
        toml::Value::Array(values) => values.iter_mut().for_each(restore_infinities),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, v)| restore_infinities(v)),
        _ => {}
    }
}

fn time_step_words(time_step: TimeStep) -> String {
    match time_step {
        TimeStep::Fixed(dt) => format!("fixed at {dt} s"),
        TimeStep::Automatic { cfl, longest } if longest.is_finite() => {
            format!("automatic, cfl {cfl}, at most {longest} s")
        }
        TimeStep::Automatic { cfl, .. } => format!("automatic, cfl {cfl}"),
    }
}

fn bounds<const D: usize>(plan: &Plan<D>) -> ([f64; 3], [f64; 3]) {
    let (min, max) = match &plan.domain {
        Some(domain) => (domain.min, domain.max),
        None => plan.bodies.iter().map(plan::Body::bounds).fold(
            ([f64::INFINITY; D], [f64::NEG_INFINITY; D]),
            |(min, max), b| {
                (
                    core::array::from_fn(|i| min[i].min(b.min[i])),
                    core::array::from_fn(|i| max[i].max(b.max[i])),
                )
            },
        ),
    };
    (three(min), three(max))
}

fn three<const D: usize>(v: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|i| if i < D { v[i] } else { 0.0 })
}

fn read_scene(
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
        probes: probes::read_probes(&reader, plan.dx, frame_rate)?,
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
    let colliders = colliders::infos(&reader, &plan.colliders);
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
        precision: if reader.text("precision")? == "f64" {
            Precision::F64
        } else {
            Precision::F32
        },
        seed: reader.integer("seed")?,
        materials,
        bodies,
        colliders,
        camera: view.camera,
        controls: controls::read_controls(&reader)?,
        output: read_output(&reader)?,
        warnings: plan.warnings.clone(),
        document: document.clone(),
        plan: wrap(plan),
    })
}

/// Frames a second, and substeps a frame where they are fixed.
fn read_frames(scene: &Reader<'_>, time_step: TimeStep) -> Result<(f64, Option<u64>), SceneError> {
    let rate = scene.opt_number("frame_rate");
    let Some(substeps) = scene.opt_integer("substeps_per_frame") else {
        return Ok((rate.unwrap_or(60.0), None));
    };
    let TimeStep::Fixed(dt) = time_step else {
        return Err(scene
            .error_at_key(
                "substeps_per_frame",
                "\"substeps_per_frame\" needs a fixed dt",
            )
            .hint("add dt = .., in seconds"));
    };
    let comes_to = 1.0 / (dt * substeps as f64);
    match rate {
        Some(rate) if (rate / comes_to - 1.0).abs() > 1e-9 => {
            let error = scene.error_at(
                "frame_rate",
                format!(
                    "{substeps} substeps of {dt} s come to {comes_to} frames a second, not {rate}"
                ),
            );
            Err(error.hint("remove frame_rate or substeps_per_frame"))
        }
        _ => Ok((comes_to, Some(substeps))),
    }
}

fn read_output(scene: &Reader<'_>) -> Result<OutputPlan, SceneError> {
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
