//! Measurements of the lahar simulator: physics cases against references, the speed of a machine, and plots of both.
//!
//! - [`method`] checks the method itself on any engine.
//! - [`validate`] runs scenes and compares numbers with exact solutions, experiments and other programs.
//! - [`bench`] measures particle-steps per second.
//! - [`plot`] draws curves as SVG.

pub mod bench;
pub mod method;
pub mod numbers;
pub mod plot;
pub mod run_page;
pub mod run_plots;
pub mod validate;
