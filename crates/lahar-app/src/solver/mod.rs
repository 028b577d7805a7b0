//! The solver: simulations on a thread of their own, paced by real time and never by the display.
//!
//! ```text
//!   window ── Order ──▶ channel ──▶ solver ── SolverState ──▶ triple buffer ──▶ window
//!             (sending never waits)               (writing and reading never wait)
//! ```
//!
//! Frames end at multiples of 1/frame_rate of simulated time, whatever the display does. So a scene left alone has the
//! same bits here as in a headless run. Between substeps the solver looks for orders: it answers a key within a substep,
//! even where a frame takes seconds.

mod clock;
mod live;
mod replay;
mod worker;

use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, OnceLock};

use lahar::{Command, DtLimit, Field, Snapshot};
use lahar_scene::scene::Comparison;
use triple_buffer::{Output, TripleBuffer};

use crate::scenes::{Changes, SceneInfo, SceneSource};
use worker::Worker;

/// A scene to open, and its settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneRequest {
    /// The scene's name or path, or the folder of a run to replay.
    pub scene: String,
    /// Keys and values that override the scene's.
    pub changes: Changes,
    /// Values of a key to run side by side.
    pub comparison: Option<Comparison>,
}

/// An order of the window to the solver.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Opens a scene.
    Open(SceneRequest),
    /// Restarts the scene.
    Restart,
    /// Pauses if true, continues if false.
    Pause(bool),
    /// Takes one substep while paused; in a recording, shows the next frame.
    Substep,
    /// Shows a frame of a recording, counted from 0.
    Seek(usize),
    /// Sets the largest speed, in simulated seconds per second.
    Speed(f64),
    /// Sets the fields that snapshots have in addition to [`ALWAYS`].
    Fields(Vec<Field>),
    /// Passes a command on to the simulations.
    Command(Command),
}

/// The fields that every snapshot has.
pub const ALWAYS: [Field; 3] = [Field::Position, Field::Body, Field::Volume0];

/// The numbers that the panel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Readouts {
    /// Simulated time \[s\].
    pub time: f64,
    /// Simulated seconds per second, over the last moments.
    pub real_time: f64,
    /// Number of substeps of the last finished frame.
    pub substeps_per_frame: u64,
    /// Number of substeps since the start.
    pub substeps: u64,
    /// Length of the last substep \[s\].
    pub dt: f64,
    /// The reason why it was not longer.
    pub limit: DtLimit,
    /// Particles × substeps per second of computing \[1/s\].
    pub particle_steps_per_second: f64,
    /// Number of particles.
    pub particles: usize,
    /// Number of retries with a shorter dt.
    pub retries: u64,
    /// The frame of a recording that is shown, counted from 0.
    pub frame: usize,
}

/// One of the simulations that run side by side. As a rule it is the only one.
#[derive(Clone, Debug)]
pub struct Side {
    /// Its value of the compared setting, as a title; empty if it is the only one.
    pub title: String,
    /// A copy of the particles.
    pub snapshot: Arc<Snapshot>,
    /// The numbers that the panel shows.
    pub readouts: Readouts,
    /// The last retry, in words.
    pub retry: Option<String>,
}

/// The state of playing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Condition {
    /// A scene is being built.
    #[default]
    Opening,
    /// The simulation or the recording runs.
    Running,
    /// The simulation or the recording is paused.
    Paused,
    /// The last frame of a recording is shown.
    Ended,
    /// The scene cannot go on, for this reason, until [`Order::Restart`] or [`Order::Open`].
    Failed(String),
}

/// The solver at one moment: everything that the window shows.
#[derive(Clone, Debug, Default)]
pub struct SolverState {
    /// Grows with every state that is published.
    pub number: u64,
    /// Grows with every scene that is opened or restarted.
    pub opened: u64,
    /// The open scene; `None` before the first one is built.
    pub info: Option<Arc<SceneInfo>>,
    /// The simulations side by side, or the recording; none before the first scene is built.
    pub sides: Vec<Side>,
    /// The state of playing.
    pub condition: Condition,
}

/// A function that the solver's thread calls after each publication.
type Listener = Arc<OnceLock<Box<dyn Fn() + Send + Sync>>>;

/// The window's handle on the solver. Dropping it ends the solver's thread after the present substep.
pub struct Solver {
    orders: Sender<Order>,
    states: Output<SolverState>,
    listener: Listener,
}

impl Solver {
    /// Starts the solver on this number of threads, 0 for as many as the machine has. Nothing runs until [`Order::Open`].
    ///
    /// # Errors
    /// The system refuses to start threads.
    pub fn start(source: Arc<dyn SceneSource>, threads: usize) -> Result<Self, String> {
        let (orders, inbox) = channel();
        let (input, states) = TripleBuffer::new(&SolverState::default()).split();
        let listener = Listener::default();
        let worker = Worker::new(source, input, Arc::clone(&listener));
        // The worker is one of the pool's threads, so that it need not wake the pool to divide work.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("lahar-solver-{index}"))
            .build()
            .map_err(|error| error.to_string())?;
        pool.spawn(move || worker.run(&inbox));
        Ok(Self {
            orders,
            states,
            listener,
        })
    }

    /// Calls `listener` whenever there is a newer state. Only the first listener is kept.
    pub fn on_new_state(&self, listener: impl Fn() + Send + Sync + 'static) {
        self.listener.get_or_init(|| Box::new(listener));
    }

    /// Sends an order. Never waits.
    pub fn order(&self, order: Order) {
        // The receiver is gone only if its thread died, which is no reason to end the window.
        let _ = self.orders.send(order);
    }

    /// The newest state, if there is a newer one than the last one taken. Never waits.
    pub fn newest(&mut self) -> Option<SolverState> {
        self.states
            .update()
            .then(|| self.states.output_buffer().clone())
    }
}

/// A panic as the window tells it.
fn panic_report(panic: &(dyn std::any::Any + Send)) -> String {
    let message = panic_message(panic);
    format!("a mistake in lahar itself, please report it: {message}")
}

/// The message of a panic.
pub(crate) fn panic_message(panic: &(dyn std::any::Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}
