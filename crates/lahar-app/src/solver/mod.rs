//! The simulation on a thread of its own, paced by the clock, never by the display.
//!
//! ```text
//!   window ── Order ──▶ channel ──▶ solver ── Shown ──▶ triple buffer ──▶ window
//!             (sending never waits)          (writing and reading never wait)
//! ```
//!
//! Frames end at multiples of 1/frame_rate of simulated time, whatever the display does, so that a
//! scene left alone has the same bits here as in a headless run. Between substeps the solver looks
//! for orders: a key is answered within a substep, also where a frame takes seconds.

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

/// A scene, and how it is to run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneRequest {
    /// By name or path; the folder of a run is replayed.
    pub scene: String,
    /// Laid over it.
    pub changes: Changes,
    /// Several values of a key, side by side.
    pub comparison: Option<Comparison>,
}

/// What the window may ask of the solver.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Opens a scene.
    Open(SceneRequest),
    /// The same scene, from its start.
    Restart,
    /// Stops the clock, or lets it run.
    Pause(bool),
    /// One substep, while paused; one frame of a recording.
    Substep,
    /// To a frame of a recording, counted from 0.
    Seek(usize),
    /// Simulated seconds per second, at most.
    Speed(f64),
    /// Fields that snapshots should have, beyond [`ALWAYS`].
    Fields(Vec<Field>),
    /// Passed on to the simulation.
    Command(Command),
}

/// Fields that every snapshot has.
pub const ALWAYS: [Field; 3] = [Field::Position, Field::Body, Field::Volume0];

/// Numbers for the panel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Readouts {
    /// Simulated time \[s\].
    pub time: f64,
    /// Simulated seconds per second of the clock, over the last moment.
    pub real_time: f64,
    /// Substeps of the last whole frame.
    pub substeps_per_frame: u64,
    /// Substeps since the start.
    pub substeps: u64,
    /// The last substep \[s\].
    pub dt: f64,
    /// What limited it.
    pub limit: DtLimit,
    /// Particles × substeps per second spent computing \[1/s\].
    pub particle_steps_per_second: f64,
    /// Particles now.
    pub particles: usize,
    /// Frames that had to be tried again with a shorter time step.
    pub retries: u64,
    /// The frame of a recording, counted from 0.
    pub frame: usize,
}

/// One of the simulations that run side by side; the only one as a rule.
#[derive(Clone, Debug)]
pub struct Side {
    /// What tells it from the others; empty when it is alone.
    pub title: String,
    /// The particles.
    pub snapshot: Arc<Snapshot>,
    /// Numbers for the panel.
    pub readouts: Readouts,
    /// Why a frame was last tried again.
    pub retry: Option<String>,
}

/// What the solver is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Condition {
    /// Building a scene.
    #[default]
    Opening,
    /// The clock runs.
    Running,
    /// The clock stands.
    Paused,
    /// The last frame of a recording.
    Ended,
    /// It cannot go on, and why. [`Order::Restart`] and [`Order::Open`] help.
    Failed(String),
}

/// All that the window shows, at one moment.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// Grows with every publication.
    pub number: u64,
    /// Grows whenever a scene is opened or restarted.
    pub opened: u64,
    /// `None` before the first scene is built.
    pub info: Option<Arc<SceneInfo>>,
    /// What there is to see; none before the first scene is built.
    pub sides: Vec<Side>,
    /// What the solver is doing.
    pub condition: Condition,
}

/// What is called after each publication, from the solver's thread.
type News = Arc<OnceLock<Box<dyn Fn() + Send + Sync>>>;

/// The window's end of the solver. Dropping it ends the thread after the substep at hand.
pub struct Solver {
    orders: Sender<Order>,
    shown: Output<Shown>,
    news: News,
}

impl Solver {
    /// Starts so many threads, 0 for as many as the machine has; nothing runs until [`Order::Open`].
    ///
    /// # Errors
    /// The system refuses threads.
    pub fn start(source: Arc<dyn SceneSource>, threads: usize) -> Result<Self, String> {
        let (orders, inbox) = channel();
        let (input, shown) = TripleBuffer::new(&Shown::default()).split();
        let news = News::default();
        let worker = Worker::new(source, input, Arc::clone(&news));
        // The worker is one of the pool's threads: what it divides among them needs no waking.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("lahar-solver-{index}"))
            .build()
            .map_err(|error| error.to_string())?;
        pool.spawn(move || worker.run(&inbox));
        Ok(Self {
            orders,
            shown,
            news,
        })
    }

    /// Calls `tell` whenever there is something newer to show; a second `tell` is not taken.
    pub fn on_news(&self, tell: impl Fn() + Send + Sync + 'static) {
        self.news.get_or_init(|| Box::new(tell));
    }

    /// Sends an order; never waits.
    pub fn order(&self, order: Order) {
        // The receiver is gone only if its thread died, which `Condition::Failed` has told.
        let _ = self.orders.send(order);
    }

    /// The newest state if it is newer than the last one taken; never waits.
    pub fn newest(&mut self) -> Option<Shown> {
        self.shown
            .update()
            .then(|| self.shown.output_buffer().clone())
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
