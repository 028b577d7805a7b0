//! Checks of the method, K1 to K8, which must hold in any scene.
//!
//! ```text
//! scenes ──► engine (oracle, f64, f32, a scene's) ──► check ──► numbers
//! ```
//! A check takes an [`Engine`](engine::Engine) and returns errors. `lahar validate` runs the checks on its scenes; the tests
//! of this crate run them on every engine, with every kernel, transfer scheme and form of the force, against limits.
//!
//! ```
//! use lahar_lab::method::conservation::momentum_change;
//! use lahar_lab::method::engine::{Build, Oracle};
//! use lahar_lab::method::scenes::{corotated, setup, stirred_ball};
//!
//! let setup = setup(0.1, 1e-4, corotated());
//! let mut engine = Oracle::<2>::build(&setup, &[stirred_ball(0.1)])?;
//! let change = momentum_change(&mut engine, 10)?;
//! assert!(change.linear < 1e-12 && change.angular < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod conservation;
pub mod energy;
pub mod engine;
pub mod kernels;
pub mod laws;
pub mod mpm88;
pub mod random;
pub mod scenes;
pub mod table;
