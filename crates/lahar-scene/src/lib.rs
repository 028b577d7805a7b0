//! Scenes of the lahar simulator: a TOML text, and the particles and meshes that it names, become a simulation.
//!
//! ```text
//!   scene text ──▶ Scene ──build()──▶ Built ──▶ a simulation with its particles
//!                    ├─ view()        materials, bodies, colliders, camera: what windows and pictures show
//!                    └─ resolved()    the scene with every default filled in, as JSON
//! ```
//!
//! # Quick start
//!
//! ```
//! use lahar::Isa;
//! use lahar_scene::scene::Scene;
//!
//! let text = r#"
//!     dx = 0.05                       # m
//!     [domain]
//!     min = [0.0, 0.0]
//!     max = [2.0, 1.0]
//!     [materials.water]
//!     preset = "water"
//!     [[bodies]]
//!     material = "water"
//!     shape = { box = { min = [0.0, 0.0], max = [0.5, 0.5] } }
//! "#;
//! let scene = Scene::parse(text, "column.toml", &[])?;
//! let mut built = scene.build(Isa::Portable)?;
//! assert_eq!(built.simulation.particle_count(), 400);
//! built.simulation.advance_to(0.01)?; // s
//! assert!(built.simulation.time() >= 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Tour
//!
//! - [`scene::Scene`] reads, checks and builds scenes. Every error ([`error::SceneError`]) carries its file, line and
//!   column, and most carry advice.
//! - [`scene::SceneFiles`] finds the files that scenes name: on disk, or in memory where there is no file system.
//! - [`builtin`] has the scenes that ship with the program.
//! - [`particle_list`] and [`ply`] read particles; [`npz`] reads and writes NumPy's archives.
//! - [`driver`] advances the simulation of a scene frame by frame.
//! - [`scene::docs`] and [`scene::schema`] document every key, as Markdown and as a JSON schema.
//!
//! # Features
//!
//! - `npz` (default): NumPy's archives.
//! - `threads` (default): particles are sampled on all threads. The bits do not depend on it.
//!
//! Without default features the crate needs no threads, archives or images.

#[cfg(feature = "npz")]
mod after_error;
pub mod builtin;
pub mod driver;
pub mod error;
mod even;
mod expression;
#[doc(hidden)]
pub mod fuzzing;
mod mesh_file;
#[cfg(feature = "npz")]
pub mod npz;
mod parallel;
pub mod particle_list;
pub mod ply;
pub mod scene;
mod text;

/// The Rust block of this crate's README, compiled and run by the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
