//! Scene files: TOML text → [`Scene`], which is checked → [`Built`], a simulation.
//!
//! ```text
//!   text ─ document ─▶ tree of values ─ check ─▶ with defaults ─ read_plan ─▶ Plan<D> ─ build ─▶ Simulation
//!                                         ▲
//!                                        keys: one table of all keys, from which documentation and schema follow
//! ```
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
mod built;
mod check;
mod checked;
mod choices;
mod colliders;
mod color_by;
mod comparison;
mod contact;
mod controls;
mod document;
mod domain;
mod files;
mod forces;
mod formula;
mod info;
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
mod resolved;
mod shapes;
mod space;
mod stiffness;
mod summary;
#[cfg(test)]
mod tests;
mod view;
mod warnings;

pub use built::Built;
pub use checked::Scene;
pub use colliders::{ColliderInfo, colliders_of};
pub use color_by::ColorBy;
pub use comparison::Comparison;
pub use controls::Controls;
pub use files::{FileSource, FolderFiles, KeptFile, SceneFile, SceneFiles};
pub use info::{BodyInfo, MaterialInfo, OutputPlan, Precision};
pub use limits::Limits;
pub use material::Look;
pub use reference::{docs, docs_of, schema};
pub use stiffness::SoundSpeeds;
pub use view::{BodyView, Camera, MaterialView, SceneView, Setting, SettingValue};
