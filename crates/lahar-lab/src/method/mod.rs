//! Checks of the method, K1 to K8, which must hold in any scene.
//!
//! ```text
//! scenes ──► engine (oracle, f64, f32, a scene's) ──► check ──► numbers
//! ```
//! A check takes an [`Engine`](engine::Engine) and returns errors. `lahar validate` runs the checks on its scenes; the tests
//! of this crate run them on every engine, with every kernel, transfer scheme and form of the force, against limits.

pub mod conservation;
pub mod energy;
pub mod engine;
pub mod kernels;
pub mod laws;
pub mod mpm88;
pub mod random;
pub mod scenes;
pub mod table;
