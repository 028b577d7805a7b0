//! The frames of a run: each is simulated, handed to the writing thread and shown as progress.

use lahar::{DtLimit, Failure, Field, Retry};
use lahar_io::checkpoint::{self, Header, Start};
use lahar_io::output::{OutputError, PhaseSeconds, Writer};
use lahar_scene::driver::{Driver, Event, Frame};

use crate::progress::{Milestone, Progress};
use crate::run_plan::RunPlan;

use crate::{clock, interrupt};

/// Why the frames of a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// All frames are written.
    Done,
    /// Ctrl-C or SIGTERM came.
    Interrupted,
    /// The run's deadline has passed.
    Deadline,
}

/// The error that ends the frames of a run.
pub(crate) enum RunError {
    /// The simulation failed.
    Simulation {
        failure: Box<Failure>,
        /// The number of the frame that failed; so many frames are written.
        frame: u64,
    },
    /// A file could not be written.
    Output(OutputError),
}

/// Advice that follows a retry where the scene fixes dt.
const FIXED_DT_ADVICE: &str = "; the scene fixes dt, and a shorter one would avoid this";

/// The loop over the frames of a run.
pub(crate) struct FrameLoop<'a> {
    plan: &'a RunPlan,
    start: &'a Start,
    driver: &'a mut Driver,
    writer: Writer,
    /// The fields of particles that output needs.
    fields: Vec<Field>,
    /// The progress of the run when this process took it up; `None` for a new run.
    resumed: Option<checkpoint::Progress>,
    /// Seconds from the start of this process to its first substep, without output.
    startup_seconds: f64,
    /// Seconds that this process has spent on output.
    output_seconds: f64,
}

impl<'a> FrameLoop<'a> {
    /// Continues after the frame that `resumed` names, or begins with frame 0.
    pub(crate) fn new(
        plan: &'a RunPlan,
        start: &'a Start,
        driver: &'a mut Driver,
        writer: Writer,
        resumed: Option<checkpoint::Progress>,
    ) -> Self {
        Self {
            plan,
            start,
            driver,
            writer,
            fields: plan.fields(),
            resumed,
            startup_seconds: 0.0,
            output_seconds: 0.0,
        }
    }

    /// Runs all frames. However they end, the run can be resumed: a frame that failed or was interrupted is given
    /// back, and a checkpoint of the one before it is taken.
    pub(crate) fn run(&mut self) -> Result<End, RunError> {
        let mut progress = Progress::new(self.plan.frames);
        let end = self.run_frames(&mut progress);
        progress.finish();
        let resumable = !matches!(end, Ok(End::Done)) || self.driver.keeps_checkpoints();
        if resumable && !matches!(end, Err(RunError::Output(_))) {
            self.checkpoint().map_err(RunError::Output)?;
        }
        end
    }

    /// Waits for the writing thread, which makes the film last.
    pub(crate) fn into_writer(self) -> Writer {
        self.writer
    }

    fn run_frames(&mut self, progress: &mut Progress) -> Result<End, RunError> {
        if self.resumed.is_none() {
            let start = self.driver.start();
            self.write(start).map_err(RunError::Output)?;
        }
        self.startup_seconds = clock::seconds() - self.output_seconds;
        while self.driver.frame() < self.plan.frames {
            let deadline = self.plan.deadline.unwrap_or(f64::INFINITY);
            if self.driver.is_between_frames() && clock::seconds() > deadline {
                return Ok(End::Deadline);
            }
            match self.driver.pump(&mut || !interrupt::asked_to_stop()) {
                Event::Frame(frame) => self.finish_frame(frame, progress)?,
                Event::Retry(retry) => progress.note(&retry_warning(&retry)),
                Event::Unfinished => {
                    self.driver.cancel();
                    return Ok(End::Interrupted);
                }
                Event::Failed(failure) => {
                    let frame = self.driver.frame() + 1;
                    return Err(RunError::Simulation { failure, frame });
                }
            }
        }
        Ok(End::Done)
    }

    fn finish_frame(&mut self, frame: Frame, progress: &mut Progress) -> Result<(), RunError> {
        let (number, advance, checkpoint_due) = (frame.number, frame.advance, frame.checkpoint_due);
        self.write(frame).map_err(RunError::Output)?;
        if checkpoint_due {
            self.checkpoint().map_err(RunError::Output)?;
        }
        let particle_steps = self.driver.particle_steps() as f64;
        progress.update(&Milestone {
            frame: number,
            time: self.driver.simulation().time(),
            rate: particle_steps / self.solving_seconds().max(1e-9),
            seconds: clock::seconds(),
            advance,
        });
        Ok(())
    }

    /// Hands a frame to the writing thread.
    fn write(&mut self, frame: Frame) -> Result<(), OutputError> {
        let simulation = self.driver.simulation_mut();
        let before = clock::seconds();
        let wanted = frame.output_due && !self.fields.is_empty();
        let snapshot = wanted.then(|| simulation.snapshot(&self.fields));
        let diagnostics = simulation.diagnostics();
        let result = (self.writer).frame(frame.number, snapshot, diagnostics, frame.probes);
        self.output_seconds += clock::seconds() - before;
        result
    }

    /// Hands a checkpoint of the last finished frame to the writing thread, unless it has one.
    fn checkpoint(&mut self) -> Result<(), OutputError> {
        let before = clock::seconds();
        let Some(checkpoint) = self.driver.checkpoint() else {
            return Ok(());
        };
        let simulation = self.driver.simulation();
        let header = Header {
            lahar: self.start.lahar.clone(),
            dimension: simulation.dimension(),
            precision: simulation.precision().to_owned(),
            isa: simulation.backend().instruction_set,
            start: self.start.sum(),
            progress: checkpoint::Progress {
                retries: self.retries(self.driver.settled_retries()),
                ..self.progress()
            },
        };
        let result = self.writer.checkpoint(header, checkpoint);
        self.output_seconds += clock::seconds() - before;
        result
    }

    /// Seconds of this process since its first substep, without output.
    fn solving_seconds(&self) -> f64 {
        clock::seconds() - self.startup_seconds - self.output_seconds
    }

    /// The retries of earlier processes of this run, and those of this one.
    fn retries(&self, own: &[Retry]) -> Vec<String> {
        let mut retries =
            (self.resumed.as_ref()).map_or_else(Vec::new, |before| before.retries.clone());
        retries.extend(own.iter().map(Retry::to_string));
        retries
    }

    /// How far the run has come from its beginning.
    pub(crate) fn progress(&self) -> checkpoint::Progress {
        let phases = self.driver.simulation().phase_times();
        let before = self.resumed.clone().unwrap_or_default();
        checkpoint::Progress {
            frame: self.driver.frame(),
            particle_steps: before.particle_steps + self.driver.particle_steps(),
            sorts: before.sorts + phases.sorts,
            retries: self.retries(self.driver.retries()),
            startup_seconds: before.startup_seconds + self.startup_seconds,
            seconds: before.seconds + clock::seconds(),
            phase_seconds: before.phase_seconds
                + PhaseSeconds::new(phases, self.solving_seconds(), self.output_seconds),
            output: Default::default(), // the writing thread fills it in
        }
    }
}

fn retry_warning(retry: &Retry) -> String {
    let advice = match retry.failure.dt_limit {
        DtLimit::Fixed => FIXED_DT_ADVICE,
        _ => "",
    };
    format!("warning: {retry}{advice}")
}
