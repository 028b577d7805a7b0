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

use lahar::{Advance, Command, Failure, Field, Simulate};

use super::clock::Throughput;
use super::{Readouts, Side, mistake};

/// More substeps than this before the end of a frame, and one is taken singly, with the same dt as
/// `advance_to` would choose; only the last few may be fitted to the frame's end.
const SINGLE_SUBSTEPS_LEFT: f64 = 4.0;

/// One of them.
struct Runner {
    title: String,
    simulation: Box<dyn Simulate>,
    readouts: Readouts,
    throughput: Throughput,
    frame_substeps: u64,
    /// Whether it has reached the end of the frame at hand.
    arrived: bool,
}

impl Runner {
    fn step(
        &mut self,
        step: impl FnOnce(&mut dyn Simulate) -> Result<Advance, Failure>,
    ) -> Result<(), String> {
        let start = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| step(self.simulation.as_mut())));
        let advance = match done {
            Ok(Ok(advance)) => advance,
            Ok(Err(failure)) => return Err(self.failed(failure.to_string())),
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
        Ok(())
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
    /// Simulations at their start, each with its title.
    pub(super) fn new(simulations: Vec<(String, Box<dyn Simulate>)>, frame_rate: f64) -> Self {
        let runner = |(title, simulation): (String, Box<dyn Simulate>)| {
            let (dt, limit) = simulation.next_dt();
            Runner {
                title,
                readouts: Readouts {
                    dt,
                    limit,
                    ..Readouts::default()
                },
                simulation,
                throughput: Throughput::default(),
                frame_substeps: 0,
                arrived: false,
            }
        };
        Self {
            runners: simulations.into_iter().map(runner).collect(),
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
            if end - runner.simulation.time() > SINGLE_SUBSTEPS_LEFT * runner.readouts.dt {
                runner.step(|simulation| simulation.substep())?;
            } else {
                runner.step(|simulation| simulation.advance_to(end))?;
                runner.arrived = true;
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
        for runner in &mut self.runners {
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
            runner.simulation.command(command);
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
