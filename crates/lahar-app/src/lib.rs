//! The window of lahar: it draws particles as they move, and keys, mouse and a panel stir them.
//!
//! ```text
//!            keys, mouse ─▶ view, panel ─▶ AppState ─▶ Order ──────▶ Solver (its thread) ─▶ Driver ─▶ Simulate
//!   window ◀─ renderer ◀─ Picture ◀─────── AppState ◀─ SolverState ◀─┘
//! ```
//!
//! A scene runs alone or, to compare settings, several times side by side. The folder of a finished run is replayed.
//!
//! - [`run`] opens the window. Without a display or a graphics adapter it fails before anything opens, so that its caller
//!   can go on without a window.
//! - [`app_state`] is the state of the window and its decisions; it needs no window itself.
//! - [`solver`] runs the simulations.
//! - [`renderer`] draws. [`Painter`] draws pictures of a run's frames with it, without a window.

mod adapter;
pub mod app_state;
pub mod camera;
mod collider_lines;
pub mod color;
pub mod compare;
pub mod controls;
mod meter;
mod overlay;
mod painter;
pub mod palette;
pub mod panel;
pub mod pointer;
pub mod renderer;
pub mod scene_library;
mod scene_list;
mod scenery;
pub mod scenes;
mod screenshot;
pub mod solver;
pub mod view;
mod window;

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use eframe::egui;
use eframe::egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};

use app_state::AppState;
pub use controls::key_help;
use lahar::Isa;
use lahar_scene::scene::Comparison;
use meter::Meter;
pub use painter::{PaintError, Painter};
use scene_library::SceneLibrary;
use scenes::SceneSource;
use solver::{SceneRequest, Solver};
use window::Window;

/// Options of the window.
#[derive(Clone, Debug)]
pub struct Options {
    /// The scene to open: a built-in's name, a path, or the folder of a run to replay. `None`: the default scene.
    pub scene: Option<String>,
    /// Values of a key to run the scene with, side by side.
    pub comparison: Option<Comparison>,
    /// Keys and values that override those of every scene, as `--set` on the command line does.
    pub overrides: Vec<(String, String)>,
    /// The instruction set to run on.
    pub isa: Isa,
    /// Width and height of the window \[points\].
    pub size: [f32; 2],
    /// The folder that F12 saves pictures in.
    pub screenshots: PathBuf,
    /// Number of threads to compute with; 0: as many as the machine has.
    pub threads: usize,
    /// A function that gets a line on the speed of drawing and simulating once per second.
    pub trace: Option<fn(&str)>,
}

impl Default for Options {
    /// The default scene, a window that fits laptops, and pictures in the current folder.
    fn default() -> Self {
        Self {
            scene: None,
            comparison: None,
            overrides: vec![],
            isa: Isa::detect(),
            size: [1180.0, 720.0],
            screenshots: PathBuf::from("."),
            threads: 0,
            trace: None,
        }
    }
}

/// The scene that opens first, and by Shift+R.
pub const DEFAULT_SCENE: &str = "dam-break";

/// The reason why there is no window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AppError {
    /// There is no display, as this says.
    NoDisplay(String),
    /// There is no graphics adapter, not even one in software; this says which were looked for.
    NoAdapter(String),
    /// There are a display and an adapter, but the window did not open.
    Window(String),
}

impl fmt::Display for AppError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisplay(why) => write!(f, "no display: {why}"),
            Self::NoAdapter(why) => write!(f, "no graphics adapter: {why}"),
            Self::Window(why) => write!(f, "the window did not open: {why}"),
        }
    }
}

impl std::error::Error for AppError {}

/// Opens the window on the scenes that ship with lahar and on scene files, and returns when it is closed. Call it on the
/// main thread, once per process.
///
/// # Errors
/// There is no display, no adapter, or the window did not open. A scene that cannot be opened is no error: the window
/// shows the mistake in it.
pub fn run(options: Options) -> Result<(), AppError> {
    let library = SceneLibrary {
        isa: options.isa,
        overrides: options.overrides.clone(),
    };
    run_with(options, Arc::new(library))
}

/// Opens the window on scenes of any source; otherwise as [`run`].
///
/// # Errors
/// There is no display, no adapter, or the window did not open. A scene that cannot be opened is no error: the window
/// shows the mistake in it.
pub fn run_with(options: Options, source: Arc<dyn SceneSource>) -> Result<(), AppError> {
    let start = Instant::now();
    check_display()?;
    let adapter_setup = WgpuSetupCreateNew::without_display_handle();
    adapter::check(&adapter_setup.instance_descriptor).map_err(AppError::NoAdapter)?;

    let wanted = SceneRequest {
        scene: options.scene.unwrap_or_else(|| DEFAULT_SCENE.to_owned()),
        comparison: options.comparison,
        ..SceneRequest::default()
    };
    let state = AppState::new(source.list(), DEFAULT_SCENE, Some(wanted));
    let solver = Solver::start(Arc::clone(&source), options.threads)
        .map_err(|error| AppError::Window(format!("no threads for the solver: {error}")))?;
    let meter = options.trace.map(|print| Meter::new(print, start));
    let mut native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("lahar")
            .with_app_id("lahar")
            .with_inner_size(options.size)
            .with_min_inner_size([360.0, 240.0]),
        renderer: eframe::Renderer::Wgpu,
        // The window has no wide gradients to dither, and software drivers take long for it.
        dithering: false,
        ..eframe::NativeOptions::default()
    };
    native.wgpu_options.wgpu_setup = WgpuSetup::CreateNew(adapter_setup);
    let open = || {
        eframe::run_native(
            "lahar",
            native,
            Box::new(|context| {
                Ok(Box::new(Window::new(
                    context,
                    state,
                    solver,
                    source,
                    options.screenshots,
                    meter,
                )))
            }),
        )
    };
    // If libraries of the window system are missing, the crates below panic instead of returning errors.
    match catch_unwind(AssertUnwindSafe(open)) {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error @ (eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_)))) => {
            Err(AppError::NoDisplay(error.to_string()))
        }
        Ok(Err(eframe::Error::Wgpu(error))) => Err(AppError::NoAdapter(error.to_string())),
        Ok(Err(error)) => Err(AppError::Window(error.to_string())),
        Err(panic) => Err(AppError::Window(solver::panic_message(&*panic).to_owned())),
    }
}

/// Checks that there is a display, without opening anything.
///
/// # Errors
/// [`AppError::NoDisplay`].
pub fn check_display() -> Result<(), AppError> {
    let named = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let unix = cfg!(all(
        unix,
        not(target_vendor = "apple"),
        not(target_os = "android")
    ));
    if unix && !named("DISPLAY") && !named("WAYLAND_DISPLAY") && !named("WAYLAND_SOCKET") {
        return Err(AppError::NoDisplay(
            "neither DISPLAY nor WAYLAND_DISPLAY is set".into(),
        ));
    }
    Ok(())
}
