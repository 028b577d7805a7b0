//! The solver's thread: it obeys orders, computes the next frame when that is due, and publishes its state.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::{Duration, Instant};

use lahar::Field;
use triple_buffer::Input;

use super::clock::{Clock, Rate};
use super::live::{Live, Runner};
use super::replay::Replay;
use super::{ALWAYS, Condition, Listener, Order, SceneRequest, SolverState, panic_report};
use crate::scenes::{OpenedScene, SceneContent, SceneSource};

/// The shortest time between two snapshots, unless the window waits for one.
const SNAPSHOT_INTERVAL: Duration = Duration::from_millis(8);
/// The time between two snapshots within a frame that takes long.
const SNAPSHOT_WITHIN_FRAME: Duration = Duration::from_millis(50);

/// The simulations or the recording that is played.
enum Play {
    Nothing,
    Live(Live),
    Replay(Box<Replay>),
}

/// The solver's side of the channels.
pub(super) struct Worker {
    source: Arc<dyn SceneSource>,
    output: Input<SolverState>,
    listener: Listener,
    /// The state as it was last published, or is to be published next.
    state: SolverState,
    wanted: Option<SceneRequest>,
    play: Play,
    paused: bool,
    speed: f64,
    fields: Vec<Field>,
    /// The frame to show once no order is left, because dragging a slider asks for many.
    seek: Option<usize>,
    clock: Clock,
    real_time: Rate,
    published: Instant,
    /// True if the state is newer than the one last published.
    changed: bool,
}

/// The window has dropped its end of the channel.
struct Disconnected;

impl Worker {
    pub(super) fn new(
        source: Arc<dyn SceneSource>,
        output: Input<SolverState>,
        listener: Listener,
    ) -> Self {
        Self {
            source,
            output,
            listener,
            state: SolverState::default(),
            wanted: None,
            play: Play::Nothing,
            paused: false,
            speed: 1.0,
            fields: ALWAYS.to_vec(),
            seek: None,
            clock: Clock::at(0.0),
            real_time: Rate::from(0.0),
            published: Instant::now(),
            changed: false,
        }
    }

    pub(super) fn run(mut self, inbox: &Receiver<Order>) {
        loop {
            match self.next_order(inbox) {
                Ok(Some(order)) => {
                    self.obey(order);
                    continue; // all orders are obeyed before the next substep
                }
                Ok(None) => {}
                Err(Disconnected) => return,
            }
            if self.is_running() && self.wait().is_none() {
                self.work();
            }
        }
    }

    /// Returns the next order. Waits for one as long as there is nothing else to do.
    fn next_order(&mut self, inbox: &Receiver<Order>) -> Result<Option<Order>, Disconnected> {
        let order = match inbox.try_recv() {
            Ok(order) => return Ok(Some(order)),
            Err(TryRecvError::Disconnected) => return Err(Disconnected),
            Err(TryRecvError::Empty) => {
                if let Some(frame) = self.seek.take() {
                    self.go_to(frame);
                }
                let wait = self.wait().filter(|_| self.is_running());
                if self.is_running() && wait.is_none() {
                    return Ok(None); // `work` publishes when it is time
                }
                if self.changed {
                    self.publish();
                }
                match wait {
                    None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
                    Some(wait) => inbox.recv_timeout(wait),
                }
            }
        };
        match order {
            Ok(order) => Ok(Some(order)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(Disconnected),
        }
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Open(wanted) => {
                self.wanted = Some(wanted);
                self.open();
            }
            Order::Restart => match self.play {
                Play::Replay(_) => self.seek = Some(0),
                _ => self.open(),
            },
            Order::Pause(paused) => {
                self.paused = paused;
                self.set_clock();
                self.update_condition();
            }
            Order::Substep => self.substep(),
            Order::Seek(frame) => self.seek = Some(frame),
            Order::Speed(speed) => {
                self.speed = speed;
                self.set_clock();
            }
            Order::Fields(extra) => {
                self.fields = ALWAYS.to_vec();
                self.fields.extend(extra);
                self.publish();
            }
            Order::Command(command) => {
                if let Play::Live(live) = &mut self.play {
                    live.command(command);
                }
            }
        }
    }

    fn open(&mut self) {
        let Some(wanted) = self.wanted.clone() else {
            return;
        };
        self.state.condition = Condition::Opening;
        self.publish(); // the old particles are shown until the new ones are seeded
        let opened = catch_unwind(AssertUnwindSafe(|| open_scenes(&*self.source, &wanted)))
            .unwrap_or_else(|panic| Err(panic_report(&*panic)))
            .and_then(|scenes| self.begin(scenes));
        if let Err(why) = opened {
            self.fail(why);
        }
        self.state.opened += 1;
        self.publish();
    }

    fn begin(&mut self, scenes: Vec<(String, OpenedScene)>) -> Result<(), String> {
        let mut simulations = vec![];
        let mut info = None;
        let mut replay = None;
        for (title, scene) in scenes {
            info.get_or_insert(scene.info);
            match scene.content {
                SceneContent::Simulation(driver) => simulations.push(Runner::new(title, *driver)),
                SceneContent::Recording(recording) => replay = Some(Replay::new(*recording)?),
            }
        }
        let Some(info) = info else {
            return Ok(());
        };
        self.play = match replay {
            Some(replay) => Play::Replay(Box::new(replay)),
            None => Play::Live(Live::new(simulations, info.frame_rate)),
        };
        self.state.info = Some(Arc::new(info));
        self.state.condition = Condition::Running;
        self.seek = None;
        self.real_time = Rate::from(0.0);
        self.set_clock();
        self.update_condition();
        Ok(())
    }

    fn fail(&mut self, why: String) {
        self.play = Play::Nothing; // its state may be invalid
        self.state.condition = Condition::Failed(why);
        self.changed = true;
    }

    /// Sets the condition by pause and end, unless the scene has failed.
    fn update_condition(&mut self) {
        if !matches!(self.state.condition, Condition::Failed(_)) {
            let at_end = matches!(&self.play, Play::Replay(replay) if replay.next_time().is_none());
            self.state.condition = if at_end {
                Condition::Ended
            } else if self.paused {
                Condition::Paused
            } else {
                Condition::Running
            };
        }
        self.changed = true;
    }

    fn time(&self) -> f64 {
        match &self.play {
            Play::Nothing => 0.0,
            Play::Live(live) => live.time(),
            Play::Replay(replay) => replay.time(),
        }
    }

    fn is_running(&self) -> bool {
        self.state.condition == Condition::Running && !matches!(self.play, Play::Nothing)
    }

    /// The wait until the next frame is due. `None` if it is due, or if one has begun.
    fn wait(&self) -> Option<Duration> {
        match &self.play {
            Play::Nothing => None,
            Play::Live(live) if !live.is_between_frames() => None,
            Play::Live(live) => self.clock.until(live.time(), self.speed),
            Play::Replay(replay) => {
                let time = replay.next_time().unwrap_or(replay.time());
                self.clock.until(time, self.speed)
            }
        }
    }

    fn set_clock(&mut self) {
        self.clock = Clock::at(self.time());
        self.real_time.restart(self.time());
    }

    /// Takes a substep, or shows the next frame of a recording.
    fn work(&mut self) {
        let done = match &mut self.play {
            Play::Nothing => return,
            Play::Live(live) => live.advance(),
            Play::Replay(replay) => replay.advance().map(|()| true),
        };
        self.changed = true;
        match done {
            Err(why) => self.publish_and_fail(why),
            Ok(false) => {
                if self.published.elapsed() > SNAPSHOT_WITHIN_FRAME && self.output.consumed() {
                    self.publish();
                }
            }
            Ok(true) => {
                self.update_condition();
                self.clock.forgive(self.time(), self.speed);
                if self.output.consumed() || self.published.elapsed() > SNAPSHOT_INTERVAL {
                    self.publish();
                }
            }
        }
    }

    /// Fails, but publishes the particles as they were at the failure before.
    fn publish_and_fail(&mut self, why: String) {
        if catch_unwind(AssertUnwindSafe(|| self.publish())).is_err() {
            self.changed = true; // taking a snapshot panicked too
        }
        self.fail(why);
    }

    fn substep(&mut self) {
        if !self.paused || matches!(self.state.condition, Condition::Failed(_)) {
            return;
        }
        let done = match &mut self.play {
            Play::Nothing => return,
            Play::Live(live) => live.substep(),
            Play::Replay(replay) => replay.advance(),
        };
        match done {
            Ok(()) => self.update_condition(),
            Err(why) => self.publish_and_fail(why),
        }
        self.publish();
    }

    fn go_to(&mut self, frame: usize) {
        if let Play::Replay(replay) = &mut self.play {
            match replay.seek(frame) {
                Ok(()) => {
                    self.set_clock();
                    self.update_condition();
                }
                Err(why) => self.fail(why),
            }
        }
    }

    fn publish(&mut self) {
        let real_time = self.real_time.update(self.time());
        match &self.play {
            Play::Nothing => {}
            Play::Live(live) => self.state.sides = live.sides(&self.fields, real_time),
            Play::Replay(replay) => self.state.sides = vec![replay.side(real_time)],
        }
        self.state.number += 1;
        self.output.write(self.state.clone());
        if let Some(listener) = self.listener.get() {
            listener();
        }
        self.published = Instant::now();
        self.changed = false;
    }
}

/// Builds the scene of a request, once or for each value of its comparison.
fn open_scenes(
    source: &dyn SceneSource,
    wanted: &SceneRequest,
) -> Result<Vec<(String, OpenedScene)>, String> {
    let Some(comparison) = &wanted.comparison else {
        let scene = source.open(&wanted.scene, &wanted.changes)?;
        return Ok(vec![(String::new(), scene)]);
    };
    (comparison.titles().zip(comparison.overrides(&wanted.changes)))
        .map(|(title, changes)| {
            let scene = source.open(&wanted.scene, &changes)?;
            match scene.content {
                SceneContent::Simulation(_) => Ok((title, scene)),
                SceneContent::Recording(_) => Err(format!(
                    "{} is a finished run: it cannot be compared with other settings of itself; open its scene",
                    wanted.scene
                )),
            }
        })
        .collect()
}
