//! Files of the [lahar](https://docs.rs/lahar) simulator: run folders, checkpoints, exports, pictures, films, surfaces.
//!
//! ```text
//! simulation ─┬─ Snapshot, Diagnostics ─► output::Writer ────┬─► DIR/ ─► output::Recording ─► image, surface, export
//!             └─ Checkpoint ────────────► checkpoint::Store ─┘
//! ```
//!
//! - [`output`]: a run's folder, the thread that writes it, and recordings read back.
//! - [`checkpoint`]: states on disk from which a run is resumed with the same bits.
//! - [`export`]: files of particles and meshes for NumPy, ParaView, Blender and Houdini.
//! - [`image`]: pictures and films, drawn by the processor.
//! - `surface`: triangle meshes around particles (feature `surface`).
//! - [`files`]: safe writing, which the others share. No link in a run's folder is followed.
//!
//! # Tour
//!
//! A built-in scene runs for a tenth of a second; its particles become a file for NumPy and a picture.
//!
//! ```
//! use lahar::Isa;
//! use lahar_io::export::Format;
//! use lahar_io::image::{self, Renderer, Scenery, Style};
//! use lahar_io::output::{frame_name, write_frame};
//! use lahar_scene::scene::Scene;
//!
//! let scene = Scene::load("dam-break", &[("dx".into(), "0.1".into())])?;
//! let mut simulation = scene.build(Isa::detect())?.simulation;
//! simulation.advance_to(0.1)?;
//!
//! let folder = tempfile::tempdir()?;
//! let snapshot = simulation.snapshot(image::FIELDS);
//! write_frame(&folder.path().join(frame_name(0, "npz")), &snapshot, Format::Npz)?;
//!
//! let scenery = Scenery::of(&*simulation, &["fluid"]);
//! let picture = Renderer::new(scenery, Style::default()).render(&snapshot);
//! picture.save_png(folder.path().join(frame_name(0, "png")))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod checkpoint;
pub mod export;
pub mod files;
#[doc(hidden)]
pub mod fuzzing;
pub mod image;
pub mod output;
#[cfg(feature = "surface")]
pub mod surface;
