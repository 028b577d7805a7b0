//! Simulations that run side by side: one as a rule, several when they are compared.
//!
//! ```text
//!   time ─────────────▶            frame k          frame k+1
//!   first   ──s──s──s──s──s──s──s──s│──s──s──s
//!   second  ────s────s────s────s────│────s            the one that is behind goes next
//! ```
//!
//! Each takes the substeps that it would take alone, so its bits are those of a headless run.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use lahar::{Advance, Command, Failure, Field, Retry, Simulate};

use lahar_io::scene::SoundSpeeds;

use super::clock::Throughput;
use super::{Readouts, Side, mistake};

/// More substeps than this before the end of a frame, and one is taken singly, with the same dt as
/// `advance_to` would choose; only the last few may be fitted to the frame's end.
const SINGLE_SUBSTEPS_LEFT: f64 = 4.0;

/// One of them.
pub(super) struct Runner {
    title: String,
    simulation: Box<dyn Simulate>,
    /// What follows when gravity is changed.
    sound_speeds: Option<SoundSpeeds>,
    readouts: Readouts,
    throughput: Throughput,
    frame_substeps: u64,
    /// Whether it has reached the end of the frame at hand.
    arrived: bool,
    /// The frame that it would begin again.
    begun: Option<u64>,
    /// Why it last did.
    retry: Option<String>,
}

impl Runner {
    /// A simulation at its start.
    pub(super) fn new(
        title: String,
        simulation: Box<dyn Simulate>,
        sound_speeds: Option<SoundSpeeds>,
    ) -> Self {
        let (dt, limit) = simulation.next_dt();
        Self {
            title,
            readouts: Readouts {
                dt,
                limit,
                ..Readouts::default()
            },
            simulation,
            sound_speeds,
            throughput: Throughput::default(),
            frame_substeps: 0,
            arrived: false,
            begun: None,
            retry: None,
        }
    }

    fn command(&mut self, command: Command) {
        self.simulation.command(command);
        if let (Command::Gravity(gravity), Some(speeds)) = (command, &self.sound_speeds) {
            for follows in speeds.under(gravity) {
                self.simulation.command(follows);
            }
        }
    }

    /// At the start of a frame, a copy to begin it again from.
    fn begin(&mut self, frame: u64) {
        if self.begun != Some(frame) {
            self.begun = Some(frame);
            self.simulation.begin_frame();
        }
    }

    /// Whether the step went well; if not, the frame begins again with a shorter one.
    fn step(
        &mut self,
        step: impl FnOnce(&mut dyn Simulate) -> Result<Advance, Failure>,
    ) -> Result<bool, String> {
        let start = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| step(self.simulation.as_mut())));
        let advance = match done {
            Ok(Ok(advance)) => advance,
            Ok(Err(failure)) => {
                let Some(retry) = self.simulation.retry_frame(&failure) else {
                    return Err(self.failed(Retry::in_vain(&failure)));
                };
                self.retry = Some(self.failed(retry.to_string()));
                self.readouts.retries += 1;
                self.frame_substeps = 0;
                return Ok(false);
            }
            Err(panic) => return Err(self.failed(mistake(&*panic))),
        };
        if advance.substeps > 0 {
            self.readouts.dt = advance.dt_min;
            self.readouts.limit = advance.limit;
        }
        self.frame_substeps += advance.substeps;
        let particles = self.simulation.particle_count() as u64;
        self.throughput
            .add(start.elapsed(), advance.substeps * particles);
        Ok(true)
    }

    fn failed(&self, why: String) -> String {
        if self.title.is_empty() {
            why
        } else {
            format!("{}: {why}", self.title)
        }
    }
}

/// All of them.
pub(super) struct Live {
    runners: Vec<Runner>,
    frame_rate: f64,
    frame: u64,
}

impl Live {
    pub(super) fn new(runners: Vec<Runner>, frame_rate: f64) -> Self {
        Self {
            runners,
            frame_rate,
            frame: 0,
        }
    }

    /// The time that all of them have reached \[s\].
    pub(super) fn time(&self) -> f64 {
        (self.runners.iter())
            .map(|runner| runner.simulation.time())
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether none has begun with the next frame.
    pub(super) fn is_between_frames(&self) -> bool {
        (self.runners.iter()).all(|runner| runner.frame_substeps == 0 && !runner.arrived)
    }

    fn frame_end(&self) -> f64 {
        (self.frame + 1) as f64 / self.frame_rate
    }

    /// A substep of the one that is behind, or its last few of a frame; whether the frame is done.
    pub(super) fn work(&mut self) -> Result<bool, String> {
        while self.frame_end() <= self.time() {
            self.frame += 1; // single substeps went past it
        }
        let end = self.frame_end();
        let behind = (self.runners.iter_mut())
            .filter(|runner| !runner.arrived && runner.simulation.time() < end)
            .min_by(|a, b| a.simulation.time().total_cmp(&b.simulation.time()));
        if let Some(runner) = behind {
            runner.begin(self.frame);
            if end - runner.simulation.time() > SINGLE_SUBSTEPS_LEFT * runner.readouts.dt {
                runner.step(|simulation| simulation.substep())?;
            } else {
                runner.arrived = runner.step(|simulation| simulation.advance_to(end))?;
            }
        }
        let done =
            (self.runners.iter()).all(|runner| runner.arrived || runner.simulation.time() >= end);
        if done {
            self.frame += 1;
            for runner in &mut self.runners {
                runner.readouts.substeps_per_frame = core::mem::take(&mut runner.frame_substeps);
                runner.arrived = false;
                // The window does not show readings of probes; kept, they would pile up.
                drop(runner.simulation.take_probe_samples());
            }
        }
        Ok(done)
    }

    /// A substep of the first, and of the others until they have caught up.
    pub(super) fn substep(&mut self) -> Result<(), String> {
        let mut until = f64::NEG_INFINITY;
        while self.frame_end() <= self.time() {
            self.frame += 1;
        }
        for runner in &mut self.runners {
            runner.begin(self.frame);
            loop {
                runner.step(|simulation| simulation.substep())?;
                if runner.simulation.time() >= until - 0.5 * runner.readouts.dt {
                    break;
                }
            }
            until = until.max(runner.simulation.time());
        }
        Ok(())
    }

    pub(super) fn command(&mut self, command: Command) {
        for runner in &mut self.runners {
            runner.command(command);
        }
    }

    /// What there is to see of them now.
    pub(super) fn sides(&self, fields: &[Field], real_time: f64) -> Vec<Side> {
        (self.runners.iter())
            .map(|runner| {
                let simulation = runner.simulation.as_ref();
                Side {
                    title: runner.title.clone(),
                    snapshot: Arc::new(simulation.snapshot(fields)),
                    retry: runner.retry.clone(),
                    readouts: Readouts {
                        time: simulation.time(),
                        real_time,
                        substeps: simulation.substeps(),
                        particles: simulation.particle_count(),
                        particle_steps_per_second: runner.throughput.per_second(),
                        ..runner.readouts
                    },
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lahar::material::{Corotated, lame};
    use lahar::{Material, Model, ParticleBatch, Setup, Simulation, TimeStep};

    /// A square of jelly that falls on nothing, stretched by its spin, with a step that is too long.
    fn stiff() -> Simulation<f32, 2> {
        let (lambda, mu) = lame(2e4, 0.3);
        let jelly = Material {
            name: "jelly".into(),
            density: 500.0,
            model: Model::Corotated(Corotated { lambda, mu }),
        };
        let mut setup = Setup::<2>::new(0.1, vec![jelly]);
        setup.time_step = TimeStep::Fixed(0.025);
        let places = (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20)].map(|x| 0.05 * x));
        let position: Vec<[f64; 2]> = places.collect();
        let velocity = position.iter().map(|x| [0.5 - x[1], x[0] - 0.5]).collect();
        let batch = ParticleBatch {
            position,
            velocity,
            volume: vec![0.0025],
            ..ParticleBatch::default()
        };
        Simulation::new(setup, &[batch]).expect("sound")
    }

    /// In the window a frame that fails is tried again as in a run without one, to the same bits; and
    /// those beside it wait.
    #[test]
    fn a_frame_is_tried_again_as_without_a_window() {
        let (frame_rate, frames) = (1.0, 3);
        let sides = ["a", "b"].map(|title| Runner::new(title.to_owned(), Box::new(stiff()), None));
        let mut live = Live::new(sides.into(), frame_rate);
        let mut done = 0;
        while done < frames {
            done += u32::from(live.work().expect("a shorter step helps"));
        }
        let mut simulation = stiff();
        let mut retries = Vec::new();
        for number in 1..=frames {
            let end = f64::from(number) / frame_rate;
            let told = |retry: &Retry| retries.push(retry.to_string());
            lahar::frame(&mut simulation, |s| s.advance_to(end), told).expect("here too");
        }
        assert!(!retries.is_empty());
        let fields = [Field::Position, Field::Velocity];
        for side in live.sides(&fields, 1.0) {
            assert_eq!(side.readouts.retries, retries.len() as u64);
            let last = retries.last().map(|why| format!("{}: {why}", side.title));
            assert_eq!(side.retry, last);
            let alone = simulation.snapshot(&fields);
            for (shown, alone) in side.snapshot.columns.iter().zip(&alone.columns) {
                assert_eq!(shown.1.to_f32(), alone.1.to_f32());
            }
        }
    }

    /// What cannot be helped is said, and the side that failed is named.
    #[test]
    fn a_failure_that_stays_ends_the_scene() {
        let mut live = Live::new(
            vec![Runner::new("a".to_owned(), Box::new(stiff()), None)],
            1.0,
        );
        live.command(Command::Gravity([f64::NAN; 3]));
        let mut end = live.work();
        while end.is_ok() {
            end = live.work();
        }
        let why = end.expect_err("the loop ends so");
        assert!(
            why.starts_with("a: a particle's motion") && why.contains("1/64"),
            "{why}"
        );
    }
}
