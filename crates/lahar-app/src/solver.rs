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

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread;
use std::time::{Duration, Instant};

use lahar::{Advance, Command, DtLimit, Failure, Field, Simulate, Snapshot};
use triple_buffer::{Input, Output, TripleBuffer};

use crate::scenes::{Angle, Changes, SceneCard, SceneSource, Setting, Stage, Swatch};

/// What the window may ask of the solver.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Opens a scene by name or path, with changes.
    Open(String, Changes),
    /// The same scene, from its start.
    Restart,
    /// Stops the clock, or lets it run.
    Pause(bool),
    /// One substep, while paused.
    Substep,
    /// Simulated seconds per second, at most.
    Speed(f64),
    /// Fields that snapshots should have, beyond [`ALWAYS`].
    Fields(Vec<Field>),
    /// Passed on to the simulation.
    Tell(Command),
}

/// Fields that every snapshot has.
pub const ALWAYS: [Field; 3] = [Field::Position, Field::Body, Field::Volume0];

/// What stays the same while a scene runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// How lists show it.
    pub card: SceneCard,
    /// 2 or 3.
    pub dimension: usize,
    /// Distance between nodes \[m\].
    pub dx: f64,
    /// Corners of the domain \[m\]; `None`: unbounded.
    pub domain: Option<([f64; 3], [f64; 3])>,
    /// Gravity at the start \[m/s²\].
    pub gravity: [f64; 3],
    /// Frames per simulated second \[1/s\].
    pub frame_rate: f64,
    /// What there is to see.
    pub swatches: Vec<Swatch>,
    /// Index into `swatches`, by the number of a body.
    pub body_swatches: Vec<usize>,
    /// How the scene wants to be looked at.
    pub angle: Angle,
    /// What the panel offers to change.
    pub settings: Vec<Setting>,
    /// "f32" or "f64", and the instruction set.
    pub numbers: String,
    /// What the scene's author should know though it runs.
    pub warnings: Vec<String>,
}

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
    pub facts: Option<Arc<Facts>>,
    /// The particles; `None` before the first scene is built.
    pub snapshot: Option<Arc<Snapshot>>,
    /// Numbers for the panel.
    pub readouts: Readouts,
    /// What the solver is doing.
    pub condition: Condition,
}

/// The window's end of the solver. Dropping it ends the thread after the substep at hand.
pub struct Solver {
    orders: Sender<Order>,
    shown: Output<Shown>,
}

impl Solver {
    /// Starts the thread; nothing runs until [`Order::Open`].
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn start(source: Arc<dyn SceneSource>) -> std::io::Result<Self> {
        let (orders, inbox) = channel();
        let (input, shown) = TripleBuffer::new(&Shown::default()).split();
        thread::Builder::new()
            .name("lahar solver".into())
            .spawn(move || Worker::new(source, input).run(&inbox))?;
        Ok(Self { orders, shown })
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

/// More substeps than this before the end of a frame, and one is taken singly, with the same dt as
/// `advance_to` would choose; only the last few may be fitted to the frame's end.
const SINGLE_SUBSTEPS_LEFT: f64 = 4.0;
/// How late a frame may be and still be made up for \[s\]; later ones set the clock anew.
const GRACE: f64 = 0.05;
/// Snapshots are not taken more often than this, unless the window waits for one.
const SNAPSHOT_INTERVAL: Duration = Duration::from_millis(8);
/// Within a frame that takes long, a snapshot this often.
const SNAPSHOT_WITHIN_FRAME: Duration = Duration::from_millis(50);
/// Rates are taken over this long.
const RATE_INTERVAL: Duration = Duration::from_millis(500);

/// The solver's end.
struct Worker {
    source: Arc<dyn SceneSource>,
    output: Input<Shown>,
    shown: Shown,
    wanted: Option<(String, Changes)>,
    simulation: Option<Box<dyn Simulate>>,
    frame_rate: f64,
    frame: u64,
    frame_substeps: u64,
    paused: bool,
    speed: f64,
    fields: Vec<Field>,
    clock: Clock,
    rates: Rates,
    published: Instant,
    changed: bool,
}

impl Worker {
    fn new(source: Arc<dyn SceneSource>, output: Input<Shown>) -> Self {
        Self {
            source,
            output,
            shown: Shown::default(),
            wanted: None,
            simulation: None,
            frame_rate: 60.0,
            frame: 0,
            frame_substeps: 0,
            paused: false,
            speed: 1.0,
            fields: ALWAYS.to_vec(),
            clock: Clock::at(0.0),
            rates: Rates::from(0.0),
            published: Instant::now(),
            changed: false,
        }
    }

    fn run(mut self, inbox: &Receiver<Order>) {
        loop {
            match self.next_order(inbox) {
                Ok(Some(order)) => {
                    self.obey(order);
                    continue; // all orders before the next substep
                }
                Ok(None) => {}
                Err(Gone) => return,
            }
            if self.is_running() && self.wait().is_none() {
                self.work();
            }
        }
    }

    /// Waits for an order as long as there is nothing else to do.
    fn next_order(&mut self, inbox: &Receiver<Order>) -> Result<Option<Order>, Gone> {
        let order = match inbox.try_recv() {
            Ok(order) => return Ok(Some(order)),
            Err(TryRecvError::Disconnected) => return Err(Gone),
            Err(TryRecvError::Empty) => {
                if self.changed {
                    self.publish(); // nothing is newer: what waits to be seen is shown
                }
                if !self.is_running() {
                    inbox.recv().map_err(|_| RecvTimeoutError::Disconnected)
                } else {
                    match self.wait() {
                        None => return Ok(None),
                        Some(wait) => inbox.recv_timeout(wait),
                    }
                }
            }
        };
        match order {
            Ok(order) => Ok(Some(order)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(Gone),
        }
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Open(name, changes) => {
                self.wanted = Some((name, changes));
                self.open();
            }
            Order::Restart => self.open(),
            Order::Pause(paused) => {
                self.paused = paused;
                self.set_clock();
                self.settle();
            }
            Order::Substep => {
                if self.paused && self.simulation.is_some() && !self.has_failed() {
                    self.step(|simulation| simulation.substep());
                    self.publish();
                }
            }
            Order::Speed(speed) => {
                self.speed = speed;
                self.set_clock();
            }
            Order::Fields(extra) => {
                self.fields = ALWAYS.to_vec();
                self.fields.extend(extra);
                self.publish();
            }
            Order::Tell(command) => {
                if let Some(simulation) = &mut self.simulation {
                    simulation.command(command);
                }
            }
        }
    }

    fn open(&mut self) {
        let Some((name, changes)) = self.wanted.clone() else {
            return;
        };
        self.shown.condition = Condition::Opening;
        self.publish(); // the old particles stay in sight while the new ones are seeded
        let source = Arc::clone(&self.source);
        let stage = catch_unwind(AssertUnwindSafe(|| source.open(&name, &changes)))
            .unwrap_or_else(|panic| Err(mistake(&*panic)));
        match stage {
            Ok(stage) => self.begin(stage),
            Err(why) => {
                self.simulation = None;
                self.shown.condition = Condition::Failed(why);
            }
        }
        self.shown.opened += 1;
        self.publish();
    }

    fn begin(&mut self, stage: Stage) {
        let simulation = stage.simulation;
        self.shown.facts = Some(Arc::new(Facts {
            dimension: simulation.dimension(),
            dx: simulation.dx(),
            domain: simulation.domain(),
            gravity: simulation.gravity(),
            frame_rate: stage.frame_rate,
            swatches: stage.swatches,
            body_swatches: stage.body_swatches,
            angle: stage.angle,
            settings: stage.settings,
            numbers: format!("{}, {}", simulation.precision(), simulation.isa().name()),
            warnings: stage.warnings,
            card: stage.card,
        }));
        let (dt, limit) = simulation.next_dt();
        self.shown.readouts = Readouts {
            dt,
            limit,
            ..Readouts::default()
        };
        self.simulation = Some(simulation);
        self.frame_rate = stage.frame_rate;
        self.frame = 0;
        self.frame_substeps = 0;
        self.shown.condition = Condition::Running;
        self.set_clock();
        self.settle();
    }

    /// Says whether the clock runs, unless something worse is to be said.
    fn settle(&mut self) {
        if matches!(self.shown.condition, Condition::Running | Condition::Paused) {
            self.shown.condition = if self.paused {
                Condition::Paused
            } else {
                Condition::Running
            };
        }
        self.changed = true;
    }

    fn time(&self) -> f64 {
        self.simulation.as_ref().map_or(0.0, |s| s.time())
    }

    fn is_running(&self) -> bool {
        self.simulation.is_some() && !self.paused && !self.has_failed()
    }

    fn has_failed(&self) -> bool {
        matches!(self.shown.condition, Condition::Failed(_))
    }

    /// How long until the next frame is due; `None`: it is, or one is at work.
    fn wait(&self) -> Option<Duration> {
        if self.frame_substeps > 0 {
            return None;
        }
        self.clock.until(self.time(), self.speed)
    }

    fn set_clock(&mut self) {
        self.clock = Clock::at(self.time());
        self.rates = Rates::from(self.time());
    }

    /// A substep, or the last few of a frame.
    fn work(&mut self) {
        let time = self.time();
        while self.frame_end() <= time {
            self.frame += 1; // single substeps went past it
        }
        let end = self.frame_end();
        if end - time > SINGLE_SUBSTEPS_LEFT * self.shown.readouts.dt {
            self.step(|simulation| simulation.substep());
            if self.published.elapsed() > SNAPSHOT_WITHIN_FRAME && self.output.consumed() {
                self.publish();
            }
            return;
        }
        self.step(|simulation| simulation.advance_to(end));
        self.frame += 1;
        self.shown.readouts.substeps_per_frame = self.frame_substeps;
        self.frame_substeps = 0;
        self.clock.forgive(self.time(), self.speed);
        if self.output.consumed() || self.published.elapsed() > SNAPSHOT_INTERVAL {
            self.publish();
        }
    }

    fn frame_end(&self) -> f64 {
        (self.frame + 1) as f64 / self.frame_rate
    }

    fn step(&mut self, step: impl FnOnce(&mut dyn Simulate) -> Result<Advance, Failure>) {
        let Some(simulation) = &mut self.simulation else {
            return;
        };
        let start = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| step(simulation.as_mut())));
        let particles = simulation.particle_count();
        let failed = match done {
            Ok(Ok(advance)) => {
                if advance.substeps > 0 {
                    self.shown.readouts.dt = advance.dt_min;
                    self.shown.readouts.limit = advance.limit;
                }
                self.frame_substeps += advance.substeps;
                self.rates
                    .add(start.elapsed(), advance.substeps * particles as u64);
                None
            }
            Ok(Err(failure)) => Some(failure.to_string()),
            Err(panic) => {
                let why = mistake(&*panic);
                self.simulation = None; // whatever it is now, it is not to be trusted
                Some(why)
            }
        };
        if let Some(why) = failed {
            self.shown.condition = Condition::Failed(why);
        }
        self.changed = true;
    }

    fn publish(&mut self) {
        if let Some(simulation) = &self.simulation {
            self.rates
                .update(simulation.time(), &mut self.shown.readouts);
            let readouts = &mut self.shown.readouts;
            readouts.time = simulation.time();
            readouts.substeps = simulation.substeps();
            readouts.particles = simulation.particle_count();
            self.shown.snapshot = Some(Arc::new(simulation.snapshot(&self.fields)));
        }
        self.shown.number += 1;
        self.output.write(self.shown.clone());
        self.published = Instant::now();
        self.changed = false;
    }
}

/// The window's end is gone.
struct Gone;

/// Simulated time against the clock's.
struct Clock {
    start: Instant,
    time: f64,
}

impl Clock {
    fn at(time: f64) -> Self {
        Self {
            start: Instant::now(),
            time,
        }
    }

    /// How long until simulated `time` is due; `None`: it is.
    fn until(&self, time: f64, speed: f64) -> Option<Duration> {
        let wait = (time - self.time) / speed - self.start.elapsed().as_secs_f64();
        // A day at most: speeds near zero are asked again later.
        (wait > 0.0).then(|| Duration::from_secs_f64(wait.min(86_400.0)))
    }

    /// Lateness beyond [`GRACE`] is not made up for: never faster than asked.
    fn forgive(&mut self, time: f64, speed: f64) {
        let due = self.time + speed * self.start.elapsed().as_secs_f64();
        if due - time > GRACE * speed {
            *self = Self::at(time);
        }
    }
}

/// Rates over [`RATE_INTERVAL`].
struct Rates {
    start: Instant,
    time: f64,
    busy: Duration,
    particle_steps: u64,
}

impl Rates {
    fn from(time: f64) -> Self {
        Self {
            start: Instant::now(),
            time,
            busy: Duration::ZERO,
            particle_steps: 0,
        }
    }

    fn add(&mut self, busy: Duration, particle_steps: u64) {
        self.busy += busy;
        self.particle_steps += particle_steps;
    }

    fn update(&mut self, time: f64, readouts: &mut Readouts) {
        let elapsed = self.start.elapsed();
        if elapsed < RATE_INTERVAL || self.busy.is_zero() {
            return;
        }
        readouts.real_time = (time - self.time) / elapsed.as_secs_f64();
        readouts.particle_steps_per_second = self.particle_steps as f64 / self.busy.as_secs_f64();
        *self = Self::from(time);
    }
}

fn mistake(panic: &(dyn std::any::Any + Send)) -> String {
    let what = panic_message(panic);
    format!("a mistake in lahar itself, please report it: {what}")
}

/// What a panic said.
pub(crate) fn panic_message(panic: &(dyn std::any::Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}
