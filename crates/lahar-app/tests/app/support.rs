//! Small scenes for the window's tests, which need no files.

use lahar::material::{Eos, Fluid};
use lahar::{
    Contact, Domain, Isa, Material, Model, ParticleBatch, Setup, Sides, Simulate, Simulation,
    Transfer, WallStyle,
};
use lahar_app::scenes::{
    Changes, OpenedScene, SceneCard, SceneContent, SceneInfo, SceneSource, Swatch,
};
use lahar_scene::driver::{Driver, FrameEnd, Schedule};
use lahar_scene::scene::{BodyView, Camera, Controls, Look, Setting, SettingValue};

/// Blocks of water in 2D and 3D, and a scene that cannot be opened.
pub(crate) struct TestScenes;

impl SceneSource for TestScenes {
    fn list(&self) -> Vec<SceneCard> {
        [
            ("dam-break", "Dam break", 2),
            ("double-dam", "Double dam", 2),
            ("dam-break-3d", "Dam break in 3D", 3),
            ("broken", "Broken", 2),
            ("held", "Gravity while a key is held", 2),
            ("pushed", "The mouse pushes", 2),
        ]
        .map(|(name, title, dimension)| SceneCard {
            name: name.into(),
            title: title.into(),
            sentence: format!("A block of water falls in {dimension}D."),
            dimension,
        })
        .to_vec()
    }

    fn open(&self, name: &str, changes: &Changes) -> Result<OpenedScene, String> {
        let card = self.list().into_iter().find(|card| card.name == name);
        let card = card.ok_or_else(|| format!("no scene \"{name}\""))?;
        let mut water = Water::default();
        for (key, value) in changes {
            water.change(key, value.trim_matches('"'))?;
        }
        let simulation: Box<dyn Simulate> = match name {
            "broken" => return Err("line 3: gravity: expected numbers".into()),
            "double-dam" => Box::new(blocks::<2>(&[[0.1, 0.1], [1.4, 0.1]], 0.5, water)?),
            "dam-break-3d" => Box::new(blocks::<3>(&[[0.2, 0.2, 0.2]], 0.6, water)?),
            _ => Box::new(blocks::<2>(&[[0.1, 0.3]], 0.8, water)?),
        };
        let setting = |key: &str, group: &str, value| Setting {
            key: key.into(),
            group: group.into(),
            name: key.rsplit('.').next().unwrap_or(key).into(),
            value,
        };
        let info = SceneInfo {
            dimension: simulation.dimension(),
            dx: simulation.dx(),
            domain: simulation.domain(),
            colliders: vec![],
            gravity: simulation.gravity(),
            frame_rate: 60.0,
            frames: None,
            swatches: vec![Swatch {
                name: "water".into(),
                look: Some(Look::Liquid),
                color: None,
            }],
            body_swatches: vec![0],
            bodies: vec![BodyView {
                name: "block".into(),
                material: "water".into(),
                color: None,
            }],
            camera: Camera::default(),
            controls: controls(name),
            settings: vec![
                setting(
                    "materials.water.viscosity",
                    "water",
                    SettingValue::Number(water.viscosity),
                ),
                setting(
                    "transfer",
                    "scene",
                    SettingValue::Word(water.transfer_name().into(), &["apic", "pic"]),
                ),
            ],
            numbers: "f32".into(),
            warnings: vec![],
            card,
        };
        Ok(OpenedScene {
            info,
            content: SceneContent::Simulation(Box::new(Driver::new(
                simulation,
                Schedule::new(FrameEnd::Rate(60.0)),
            ))),
        })
    }
}

/// The controls of the scene of this name.
fn controls(name: &str) -> Controls {
    match name {
        "pushed" => Controls {
            pull: Some(5.0),
            reach: Some(0.25),
            push: Some(4.0),
            ..Controls::default()
        },
        "held" => Controls {
            speed: 0.5,
            gravity: Some(30.0),
            hold: true,
            pull: Some(100.0),
            reach: Some(f64::INFINITY),
            softening: Some(0.01),
            push: None,
        },
        _ => Controls::default(),
    }
}

/// The settings of the blocks.
#[derive(Clone, Copy)]
struct Water {
    viscosity: f64,
    transfer: Transfer,
}

impl Default for Water {
    fn default() -> Self {
        Self {
            viscosity: 1.0e-3,
            transfer: Transfer::Apic,
        }
    }
}

impl Water {
    fn transfer_name(self) -> &'static str {
        if self.transfer == Transfer::Pic {
            "pic"
        } else {
            "apic"
        }
    }

    fn change(&mut self, key: &str, value: &str) -> Result<(), String> {
        match (key, value) {
            ("materials.water.viscosity", number) => {
                self.viscosity = number.parse().map_err(|_| format!("{key}: {number}"))?;
            }
            ("transfer", "apic") => self.transfer = Transfer::Apic,
            ("transfer", "pic") => self.transfer = Transfer::Pic,
            _ => return Err(format!("{key} cannot be {value}")),
        }
        Ok(())
    }
}

fn blocks<const D: usize>(
    corners: &[[f64; D]],
    edge: f64,
    changed: Water,
) -> Result<Simulation<f32, D>, String>
where
    f32: lahar::Instance<D>,
{
    let dx = if D == 2 { 0.02 } else { 0.05 };
    let water = Material {
        name: "water".into(),
        density: 1000.0,
        model: Model::Fluid(Fluid {
            eos: Eos::Tait { gamma: 7.0 },
            viscosity: changed.viscosity,
            ..Fluid::inviscid(1.0e5)
        }),
    };
    let mut setup = Setup::<D>::new(dx, vec![water]);
    setup.isa = Isa::Portable;
    setup.transfer = changed.transfer;
    setup.gravity[1] = -9.81;
    let wall = Contact::Separate { friction: 0.0 };
    setup.domain = Some(Domain {
        min: [0.0; D],
        max: core::array::from_fn(|axis| if axis == 0 { 2.0 } else { 1.2 }),
        sides: [Sides::Walls {
            low: wall,
            high: wall,
        }; D],
        style: WallStyle::Plane,
    });
    let spacing = 0.5 * dx;
    let along = (edge / spacing).round() as usize;
    let mut batch = ParticleBatch::<D> {
        volume: vec![spacing.powi(D as i32)],
        ..ParticleBatch::default()
    };
    for corner in corners {
        for i in 0..along.pow(D as u32) {
            batch.position.push(core::array::from_fn(|axis| {
                let k = i / along.pow(axis as u32) % along;
                corner[axis] + (k as f64 + 0.5) * spacing
            }));
        }
    }
    Simulation::new(setup, &[batch]).map_err(|error| error.to_string())
}
