//! The usual source of scenes: those that ship with lahar, scene files, and finished runs.

use std::path::Path;

use lahar::{Field, Isa};
use lahar_io::image::{Picture, Renderer, Scenery, Style};
use lahar_io::output::Recording;
use lahar_scene::builtin;
use lahar_scene::driver::Driver;
use lahar_scene::scene::{Controls, Scene, SceneView};

use crate::palette::palette;
use crate::scenes::{
    Changes, OpenedScene, SceneCard, SceneContent, SceneInfo, SceneSource, Swatch,
};

/// The scenes that ship with lahar, scene files, and the folders of finished runs.
#[derive(Clone, Debug)]
pub struct SceneLibrary {
    /// The instruction set to run on.
    pub isa: Isa,
    /// Keys and values that override those of every scene.
    pub overrides: Changes,
}

impl Default for SceneLibrary {
    /// The widest instruction set of this machine, and no overrides.
    fn default() -> Self {
        Self {
            isa: Isa::detect(),
            overrides: vec![],
        }
    }
}

impl SceneSource for SceneLibrary {
    fn list(&self) -> Vec<SceneCard> {
        builtin::list()
            .iter()
            .map(|scene| SceneCard {
                name: scene.name.to_owned(),
                title: scene.title.to_owned(),
                sentence: scene.summary.to_owned(),
                dimension: scene.dimension,
            })
            .collect()
    }

    fn open(&self, name_or_path: &str, changes: &Changes) -> Result<OpenedScene, String> {
        let path = Path::new(name_or_path);
        let shipped = builtin::find(name_or_path);
        if shipped.is_none() && (path.is_dir() || path.ends_with("run.json")) {
            return replay(path);
        }
        let changes = [self.overrides.as_slice(), changes].concat();
        let scene = Scene::load(name_or_path, &changes).map_err(|e| e.render(false))?;
        let built = scene.build(self.isa).map_err(|e| e.render(false))?;
        let simulation = built.simulation;
        let view = scene.view();
        let card = SceneCard {
            name: name_or_path.to_owned(),
            title: title(&view, &scene.name),
            sentence: shipped.map_or_else(String::new, |scene| scene.summary.to_owned()),
            dimension: scene.dimension,
        };
        let info = SceneInfo {
            domain: simulation.domain(),
            gravity: simulation.gravity(),
            numbers: format!(
                "{}, {}",
                simulation.precision(),
                simulation.backend().instruction_set
            ),
            warnings: built.warnings,
            ..scene_info(card, view)
        };
        let driver = Driver::of_scene(&scene, simulation);
        Ok(OpenedScene {
            info,
            content: SceneContent::Simulation(Box::new(driver)),
        })
    }

    fn thumbnail(&self, name: &str, [width, height]: [u32; 2]) -> Option<Picture> {
        let OpenedScene { info, content } = self.open(name, &vec![]).ok()?;
        let SceneContent::Simulation(driver) = content else {
            return None;
        };
        let simulation = driver.simulation();
        let mut scenery = Scenery::of(simulation, &[]).with_colliders(&info.colliders);
        scenery.colors = palette(&info.swatches)
            .iter()
            .map(|color| [color.r(), color.g(), color.b()])
            .collect();
        scenery.background = info.camera.background.unwrap_or(scenery.background);
        let style = Style {
            width,
            height,
            ..Style::default()
        };
        let fields = [
            Field::Position,
            Field::Velocity,
            Field::Material,
            Field::Body,
            Field::Volume0,
        ];
        Some(Renderer::new(scenery, style).render(&simulation.snapshot(&fields)))
    }
}

/// Opens a finished run at its first frame.
fn replay(folder: &Path) -> Result<OpenedScene, String> {
    let recording = Recording::open(folder).map_err(|error| error.to_string())?;
    let view = recording.record().view();
    Ok(OpenedScene {
        info: recorded_info(&recording, view),
        content: SceneContent::Recording(Box::new(recording)),
    })
}

/// Everything about a finished run that stays the same; `view` is the view of its scene.
pub(crate) fn recorded_info(recording: &Recording, view: SceneView) -> SceneInfo {
    let record = recording.record();
    let folder = recording.folder();
    let card = SceneCard {
        name: folder.display().to_string(),
        title: title(&view, &record.scene_name),
        sentence: format!("The run in {}.", folder.display()),
        dimension: record.dimension,
    };
    let controls = Controls {
        speed: view.controls.speed,
        ..Controls::default()
    };
    SceneInfo {
        dimension: record.dimension,
        frames: Some(recording.len()),
        controls,
        settings: vec![],
        numbers: format!("{}, {}", record.precision, record.isa),
        warnings: record.warnings.clone(),
        ..scene_info(card, view)
    }
}

/// Everything that the window takes from the view of a scene.
fn scene_info(card: SceneCard, view: SceneView) -> SceneInfo {
    let (swatches, body_swatches) = swatches(&view);
    SceneInfo {
        card,
        dimension: view.dimension,
        dx: view.dx,
        domain: view.domain,
        colliders: view.colliders,
        gravity: view.gravity,
        frame_rate: view.frame_rate,
        frames: None,
        swatches,
        body_swatches,
        bodies: view.bodies,
        camera: view.camera,
        controls: view.controls,
        settings: view.settings,
        numbers: String::new(),
        warnings: vec![],
    }
}

fn title(view: &SceneView, name: &str) -> String {
    match view.title.as_str() {
        "" => name.to_owned(),
        title => title.to_owned(),
    }
}

/// The entries of the legend: the materials, then the bodies that have colors of their own. With them comes the entry of
/// each body, by number.
fn swatches(view: &SceneView) -> (Vec<Swatch>, Vec<usize>) {
    let material = |name: &str| view.materials.iter().position(|m| m.name == name);
    let look = |index: Option<usize>| index.and_then(|index| view.materials[index].look());
    let mut swatches: Vec<Swatch> = (view.materials.iter())
        .map(|material| Swatch {
            name: material.name.clone(),
            look: material.look(),
            color: material.color,
        })
        .collect();
    let mut of_body = vec![];
    for body in &view.bodies {
        let material = material(&body.material);
        of_body.push(match body.color {
            None => material.unwrap_or(0),
            Some(_) => {
                swatches.push(Swatch {
                    name: body.name.clone(),
                    look: look(material),
                    color: body.color,
                });
                swatches.len() - 1
            }
        });
    }
    // Materials that no body has are left out of the legend.
    let used: Vec<usize> = (0..swatches.len())
        .filter(|i| of_body.contains(i))
        .collect();
    let place = |i: &usize| used.iter().position(|u| u == i).unwrap_or(0);
    let of_body = of_body.iter().map(place).collect();
    (used.iter().map(|&i| swatches[i].clone()).collect(), of_body)
}
