//! Where scenes come from: the window knows them by name and gets a simulation that is ready to run.

use lahar::{Field, Isa, Simulate};
use lahar_io::builtin;
use lahar_io::image::{Picture, Renderer, Scenery, Style};
use lahar_io::scene::Scene;

use crate::colour::{ColourBy, palette};

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

/// What particles look like, as legends show it: a material, or a body that the scene dyes.
#[derive(Clone, Debug, PartialEq)]
pub struct Swatch {
    /// The material's name or the body's.
    pub name: String,
    /// What it is drawn as.
    pub look: Look,
    /// Its colour; `None`: its look's.
    pub colour: Option<[u8; 3]>,
}

/// A scene, built.
pub struct Stage {
    /// How lists show it.
    pub card: SceneCard,
    /// At its start.
    pub simulation: Box<dyn Simulate>,
    /// Frames per simulated second \[1/s\].
    pub frame_rate: f64,
    /// What there is to see.
    pub swatches: Vec<Swatch>,
    /// Index into `swatches`, by the number of a body; a body beyond the end is drawn as the first.
    pub body_swatches: Vec<usize>,
    /// How the scene wants to be looked at.
    pub angle: Angle,
    /// What the panel offers to change.
    pub settings: Vec<Setting>,
    /// What the scene's author should know though it runs.
    pub warnings: Vec<String>,
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

/// How to look at a scene. The window fits itself to the scene's size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Angle {
    /// From the scene to the camera; 3D only.
    pub direction: Option<[f64; 3]>,
    /// Colour behind everything.
    pub background: Option<[u8; 3]>,
    /// What particles are coloured by at first.
    pub colour_by: ColourBy,
}

/// A shelf of scenes. Called from the window's and from the solver's thread.
pub trait SceneSource: Send + Sync {
    /// The scenes to choose from; keys 1 to 9 open the first nine.
    fn list(&self) -> Vec<SceneCard>;

    /// Builds a scene at its start, with changes.
    ///
    /// # Errors
    /// What is wrong with the scene and where, for people to read.
    fn open(&self, name_or_path: &str, changes: &Changes) -> Result<Stage, String>;

    /// A small picture of a scene for lists, no larger than `size` pixels; takes its time.
    fn thumbnail(&self, _name: &str, _size: [u32; 2]) -> Option<Picture> {
        None
    }
}

/// The scenes that ship with lahar, and scene files.
#[derive(Clone, Debug)]
pub struct Shelf {
    /// The instruction set to run on.
    pub isa: Isa,
    /// Laid over every scene.
    pub overrides: Changes,
}

impl Default for Shelf {
    /// The widest instruction set of this machine, scenes as they are.
    fn default() -> Self {
        Self {
            isa: Isa::detect(),
            overrides: vec![],
        }
    }
}

impl SceneSource for Shelf {
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

    fn open(&self, name_or_path: &str, changes: &Changes) -> Result<Stage, String> {
        let changes = [self.overrides.as_slice(), changes].concat();
        let scene = Scene::load(name_or_path, &changes).map_err(|e| e.render(false))?;
        let built = scene.build(self.isa).map_err(|e| e.render(false))?;
        let (swatches, body_swatches) = swatches(&scene);
        Ok(Stage {
            card: SceneCard {
                name: name_or_path.to_owned(),
                title: if scene.title.is_empty() {
                    scene.name.clone()
                } else {
                    scene.title.clone()
                },
                sentence: builtin::find(name_or_path)
                    .map(|scene| scene.summary.to_owned())
                    .unwrap_or_default(),
                dimension: scene.dimension,
            },
            simulation: built.simulation,
            frame_rate: scene.frame_rate,
            swatches,
            body_swatches,
            angle: Angle {
                direction: Some(scene.camera.direction),
                background: Some(scene.camera.background),
                colour_by: match scene.camera.color_by.as_str() {
                    "speed" => ColourBy::Speed,
                    "pressure" => ColourBy::Pressure,
                    "density" => ColourBy::Density,
                    "J" => ColourBy::Jacobian,
                    _ => ColourBy::Material,
                },
            },
            settings: settings(&scene.resolved()),
            warnings: built.warnings,
        })
    }

    fn thumbnail(&self, name: &str, [width, height]: [u32; 2]) -> Option<Picture> {
        let stage = self.open(name, &vec![]).ok()?;
        let simulation = stage.simulation.as_ref();
        let mut scenery = Scenery::of(simulation, &[]);
        scenery.colours = palette(&stage.swatches)
            .iter()
            .map(|colour| [colour.r(), colour.g(), colour.b()])
            .collect();
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

/// What of a scene is worth turning while one watches.
fn settings(scene: &serde_json::Value) -> Vec<Setting> {
    const WORDS: [(&str, &[&str]); 3] = [
        ("transfer", &["apic", "flip", "pic"]),
        ("force", &["mls", "classic"]),
        ("kernel", &["quadratic", "cubic", "linear"]),
    ];
    let mut settings = vec![];
    let mut offer = |group: &str, path: &str, name: &str, value: Option<&serde_json::Value>| {
        let words = WORDS.iter().find(|(key, _)| *key == name);
        let value = match (value, words) {
            (Some(serde_json::Value::Number(number)), None) => {
                number.as_f64().map(SettingValue::Number)
            }
            (Some(serde_json::Value::String(word)), Some((_, words))) => {
                Some(SettingValue::Word(word.clone(), words))
            }
            _ => None,
        };
        settings.extend(value.map(|value| Setting {
            key: format!("{path}{name}"),
            group: group.to_owned(),
            name: name.to_owned(),
            value,
        }));
    };
    for name in ["dx", "transfer", "flip_blend", "force", "kernel", "cfl"] {
        offer("scene", "", name, scene.get(name));
    }
    for (material, table) in scene["materials"].as_object().into_iter().flatten() {
        for (name, value) in table.as_object().into_iter().flatten() {
            offer(
                material,
                &format!("materials.{material}."),
                name,
                Some(value),
            );
        }
    }
    for table in scene["bodies"].as_array().into_iter().flatten() {
        if let Some(body) = table["name"].as_str() {
            let name = "particles_per_cell";
            offer(body, &format!("bodies.{body}."), name, table.get(name));
        }
    }
    settings
}

/// The materials, then the bodies that have colours of their own; and which is whose.
fn swatches(scene: &Scene) -> (Vec<Swatch>, Vec<usize>) {
    let look = |material: usize| match scene.materials[material].model.as_str() {
        "fluid" => Look::Liquid,
        "corotated" | "neo_hookean" => Look::Jelly,
        "snow" => Look::Snow,
        "none" => Look::Dust,
        _ => Look::Other,
    };
    let mut swatches: Vec<Swatch> = (0..scene.materials.len())
        .map(|i| Swatch {
            name: scene.materials[i].name.clone(),
            look: look(i),
            colour: scene.materials[i].color,
        })
        .collect();
    let mut of_body = vec![];
    for body in &scene.bodies {
        of_body.push(match body.color {
            None => body.material,
            Some(colour) => {
                swatches.push(Swatch {
                    name: body.name.clone(),
                    look: look(body.material),
                    colour: Some(colour),
                });
                swatches.len() - 1
            }
        });
    }
    // What no particle has needs no place in the legend.
    let used: Vec<usize> = (0..swatches.len())
        .filter(|i| of_body.contains(i))
        .collect();
    let place = |i: &usize| used.iter().position(|u| u == i).unwrap_or(0);
    let of_body = of_body.iter().map(place).collect();
    (used.iter().map(|&i| swatches[i].clone()).collect(), of_body)
}
