//! The thread: obeys orders, works when the next frame is due, shows what came of it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::{Duration, Instant};

use lahar::Field;
use triple_buffer::Input;

use super::clock::{Clock, Rate};
use super::live::{Live, Runner};
use super::replay::Replay;
use super::{ALWAYS, Condition, News, Order, SceneRequest, Shown, panic_report};
use crate::scenes::{OpenedScene, SceneContent, SceneSource};

/// Snapshots are not taken more often than this, unless the window waits for one.
const SNAPSHOT_INTERVAL: Duration = Duration::from_millis(8);
/// Within a frame that takes long, a snapshot this often.
const SNAPSHOT_WITHIN_FRAME: Duration = Duration::from_millis(50);

/// What is played.
enum Play {
    Nothing,
    Live(Live),
    Replay(Box<Replay>),
}

/// The solver's end.
pub(super) struct Worker {
    source: Arc<dyn SceneSource>,
    output: Input<Shown>,
    news: News,
    shown: Shown,
    wanted: Option<SceneRequest>,
    play: Play,
    paused: bool,
    speed: f64,
    fields: Vec<Field>,
    /// The frame to go to once no order is left: dragging a slider asks for many.
    seek: Option<usize>,
    clock: Clock,
    real_time: Rate,
    published: Instant,
    changed: bool,
}

/// The window's end is gone.
struct Gone;

impl Worker {
    pub(super) fn new(source: Arc<dyn SceneSource>, output: Input<Shown>, news: News) -> Self {
        Self {
            source,
            output,
            news,
            shown: Shown::default(),
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
                if let Some(frame) = self.seek.take() {
                    self.go_to(frame);
                }
                let wait = self.wait().filter(|_| self.is_running());
                if self.is_running() && wait.is_none() {
                    return Ok(None); // `work` says when there is something to show
                }
                if self.changed {
                    self.publish(); // nothing is newer: what waits to be seen is shown
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
            Err(RecvTimeoutError::Disconnected) => Err(Gone),
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
                self.settle();
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
        self.shown.condition = Condition::Opening;
        self.publish(); // the old particles stay in sight while the new ones are seeded
        let opened = catch_unwind(AssertUnwindSafe(|| stages(&*self.source, &wanted)))
            .unwrap_or_else(|panic| Err(panic_report(&*panic)))
            .and_then(|stages| self.begin(stages));
        if let Err(why) = opened {
            self.fail(why);
        }
        self.shown.opened += 1;
        self.publish();
    }

    fn begin(&mut self, stages: Vec<(String, OpenedScene)>) -> Result<(), String> {
        let mut simulations = vec![];
        let mut info = None;
        let mut replay = None;
        for (title, stage) in stages {
            info.get_or_insert(stage.info);
            match stage.content {
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
        self.shown.info = Some(Arc::new(info));
        self.shown.condition = Condition::Running;
        self.seek = None;
        self.real_time = Rate::from(0.0);
        self.set_clock();
        self.settle();
        Ok(())
    }

    fn fail(&mut self, why: String) {
        self.play = Play::Nothing; // whatever it is now, it is not to be trusted
        self.shown.condition = Condition::Failed(why);
        self.changed = true;
    }

    /// Says whether the clock runs, unless something worse is to be said.
    fn settle(&mut self) {
        if !matches!(self.shown.condition, Condition::Failed(_)) {
            let at_end = matches!(&self.play, Play::Replay(replay) if replay.next_time().is_none());
            self.shown.condition = if at_end {
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
        self.shown.condition == Condition::Running && !matches!(self.play, Play::Nothing)
    }

    /// How long until the next frame is due; `None`: it is, or one is at work.
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

    /// A substep, or the last few of a frame; a frame of a recording.
    fn work(&mut self) {
        let done = match &mut self.play {
            Play::Nothing => return,
            Play::Live(live) => live.advance(),
            Play::Replay(replay) => replay.advance().map(|()| true),
        };
        self.changed = true;
        match done {
            Err(why) => self.fail_in_sight(why),
            Ok(false) => {
                if self.published.elapsed() > SNAPSHOT_WITHIN_FRAME && self.output.consumed() {
                    self.publish();
                }
            }
            Ok(true) => {
                self.settle();
                self.clock.forgive(self.time(), self.speed);
                if self.output.consumed() || self.published.elapsed() > SNAPSHOT_INTERVAL {
                    self.publish();
                }
            }
        }
    }

    /// The particles as they were when it failed stay in sight.
    fn fail_in_sight(&mut self, why: String) {
        if catch_unwind(AssertUnwindSafe(|| self.publish())).is_err() {
            self.changed = true; // not even a picture could be taken of it
        }
        self.fail(why);
    }

    fn substep(&mut self) {
        if !self.paused || matches!(self.shown.condition, Condition::Failed(_)) {
            return;
        }
        let done = match &mut self.play {
            Play::Nothing => return,
            Play::Live(live) => live.substep(),
            Play::Replay(replay) => replay.advance(),
        };
        match done {
            Ok(()) => self.settle(),
            Err(why) => self.fail_in_sight(why),
        }
        self.publish();
    }

    fn go_to(&mut self, frame: usize) {
        if let Play::Replay(replay) = &mut self.play {
            match replay.seek(frame) {
                Ok(()) => {
                    self.set_clock();
                    self.settle();
                }
                Err(why) => self.fail(why),
            }
        }
    }

    fn publish(&mut self) {
        let real_time = self.real_time.at(self.time());
        match &self.play {
            Play::Nothing => {}
            Play::Live(live) => self.shown.sides = live.sides(&self.fields, real_time),
            Play::Replay(replay) => self.shown.sides = vec![replay.side(real_time)],
        }
        self.shown.number += 1;
        self.output.write(self.shown.clone());
        if let Some(tell) = self.news.get() {
            tell();
        }
        self.published = Instant::now();
        self.changed = false;
    }
}

/// What is wanted, built: one stage, or one for each value of a comparison.
fn stages(
    source: &dyn SceneSource,
    wanted: &SceneRequest,
) -> Result<Vec<(String, OpenedScene)>, String> {
    let Some(comparison) = &wanted.comparison else {
        let stage = source.open(&wanted.scene, &wanted.changes)?;
        return Ok(vec![(String::new(), stage)]);
    };
    (comparison.titles().zip(comparison.overrides(&wanted.changes)))
        .map(|(title, changes)| {
            let stage = source.open(&wanted.scene, &changes)?;
            match stage.content {
                SceneContent::Simulation(_) => Ok((title, stage)),
                SceneContent::Recording(_) => Err(format!(
                    "{} is a finished run: it cannot be compared with other settings of itself; open its scene",
                    wanted.scene
                )),
            }
        })
        .collect()
}
