//! Measurements of the [lahar](https://docs.rs/lahar) simulator: physics cases against references, the speed of a machine,
//! and plots and reports of runs.
//!
//! - [`method`] checks the method itself on any engine.
//! - [`validate`] runs scenes and compares numbers with exact solutions, experiments and other programs.
//! - [`mod@bench`] measures particle-steps per second.
//! - [`run_plots`] and [`run_page`] draw the measurements of runs, and join them to a page of HTML.
//! - [`plot`] draws curves as SVG; [`numbers`] writes numbers for people; [`shell`] quotes words of commands.
//!
//! # Tour
//!
//! A physics case is run and its findings are printed as a table:
//!
//! ```
//! use lahar::Isa;
//! use lahar_lab::validate::{self, Options};
//!
//! let options = Options {
//!     quick: true,
//!     isa: Isa::Portable,
//!     set: Vec::new(),
//!     scene_file: None,
//! };
//! let outcome = validate::run(validate::find("K1")[0], &options, &|_| {})?;
//! assert!(outcome.pass());
//! println!("{}", validate::text(&outcome.findings));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bench;
pub mod method;
pub mod numbers;
pub mod plot;
pub mod run_page;
pub mod run_plots;
pub mod shell;
pub mod validate;
