//! The window of lahar: particles drawn as they move, keys, mouse and a panel to stir them.
//!
//! ```text
//!            keys, mouse ─▶ view, panel ─▶ AppState ─▶ Order ─▶ Solver (its thread) ─▶ Simulation
//!   window ◀─ renderer ◀─ Picture ◀─────── AppState ◀─ Shown ◀─┘
//! ```
//!
//! A scene runs alone or, to compare settings, several times side by side; a finished run is replayed.
//!
//! The same renderer draws a run's frames into pictures, without a window: [`Painter`].
//!
//! [`run`] opens it. [`app_state`] holds what the window knows and decides, and needs no window;
//! [`solver`] runs the simulation; [`renderer`] draws. Where there is no display or nothing to draw
//! with, [`run`] says so in its error, before anything is opened, and a caller may go on without.

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
use eframe::egui_wgpu::{WgpuSetup, WgpuSetupCreateNew, wgpu};

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

/// How the window opens.
#[derive(Clone, Debug)]
pub struct Options {
    /// The scene to open, by a built-in's name or a path; a run's folder is replayed. `None`: the
    /// default scene.
    pub scene: Option<String>,
    /// Values of a key that it is to run with, side by side.
    pub comparison: Option<Comparison>,
    /// Keys and values laid over every scene, as `--set` on the command line.
    pub overrides: Vec<(String, String)>,
    /// The instruction set to run on.
    pub isa: Isa,
    /// Size of the window in points.
    pub size: [f32; 2],
    /// Where F12 puts its pictures.
    pub screenshots: PathBuf,
    /// Threads to compute with; 0: as many as the machine has.
    pub threads: usize,
    /// Is told how fast it goes, a line a second.
    pub say: Option<fn(&str)>,
}

impl Default for Options {
    /// The default scene, a window for laptops, pictures in the current folder.
    fn default() -> Self {
        Self {
            scene: None,
            comparison: None,
            overrides: vec![],
            isa: Isa::detect(),
            size: [1180.0, 720.0],
            screenshots: PathBuf::from("."),
            threads: 0,
            say: None,
        }
    }
}

/// The scene that opens first, and with Shift+R.
pub const DEFAULT_SCENE: &str = "dam-break";

/// Why there is no window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AppError {
    /// No screen to open it on, and how that was found out.
    NoDisplay(String),
    /// No graphics adapter, not even one in software, and which were looked for.
    NoAdapter(String),
    /// There is a screen and an adapter, and still it did not open.
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

/// Opens the window on the scenes that ship with lahar and on scene files, and returns when it is
/// closed. Call it on the main thread, once a process.
///
/// # Errors
/// There is no display, no adapter, or the window did not open. A scene that cannot be opened is no
/// error: the window shows what is wrong.
pub fn run(options: Options) -> Result<(), AppError> {
    let library = SceneLibrary {
        isa: options.isa,
        overrides: options.overrides.clone(),
    };
    run_with(options, Arc::new(library))
}

/// [`run`] with scenes from elsewhere.
///
/// # Errors
/// There is no display, no adapter, or the window did not open. A scene that cannot be opened is no
/// error: the window shows what is wrong.
pub fn run_with(options: Options, source: Arc<dyn SceneSource>) -> Result<(), AppError> {
    let start = Instant::now();
    check_display()?;
    let adapter_setup = WgpuSetupCreateNew::without_display_handle();
    check_adapter(&adapter_setup.instance_descriptor)?;

    let wanted = SceneRequest {
        scene: options.scene.unwrap_or_else(|| DEFAULT_SCENE.to_owned()),
        comparison: options.comparison,
        ..SceneRequest::default()
    };
    let state = AppState::new(source.list(), DEFAULT_SCENE, Some(wanted));
    let solver = Solver::start(Arc::clone(&source), options.threads)
        .map_err(|error| AppError::Window(format!("no threads for the solver: {error}")))?;
    let meter = options.say.map(|say| Meter::new(say, start));
    let mut native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("lahar")
            .with_app_id("lahar")
            .with_inner_size(options.size)
            .with_min_inner_size([360.0, 240.0]),
        renderer: eframe::Renderer::Wgpu,
        // Of use for wide gradients, of which there are none; it costs software drivers dearly.
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
    // Window systems whose libraries are missing are met with panics below us, not with errors.
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

/// Whether there is anything to open a window on; opens nothing.
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

/// What is asked for adapters of `backends`, without a display.
fn instance_of(wanted: &wgpu::InstanceDescriptor, backends: wgpu::Backends) -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wanted.flags,
        backend_options: wanted.backend_options.clone(),
        memory_budget_thresholds: wanted.memory_budget_thresholds,
        display: None,
    })
}

/// Whether there is anything to draw with, software included.
fn check_adapter(wanted: &wgpu::InstanceDescriptor) -> Result<(), AppError> {
    let backends = wanted.backends;
    let instance = instance_of(wanted, backends);
    let found = pollster::block_on(instance.enumerate_adapters(backends));
    if found.is_empty() {
        return Err(AppError::NoAdapter(no_adapter(backends)));
    }
    Ok(())
}

/// That there is none of these.
fn no_adapter(backends: wgpu::Backends) -> String {
    format!(
        "looked for {backends:?} (on Linux, a software adapter comes with the package mesa-vulkan-drivers)"
    )
}
