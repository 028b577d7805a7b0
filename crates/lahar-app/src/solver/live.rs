//! Simulations that run side by side: one as a rule, several when settings are compared.
//!
//! ```text
//!   time ─────────────▶            frame k          frame k+1
//!   first   ──s──s──s──s──s──s──s──s│──s──s──s
//!   second  ────s────s────s────s────│────s            the side that is behind goes next
//! ```
//!
//! Each side has a [`Driver`] of its own, so it has the bits of a headless run.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use lahar::{Command, Field, Retry};
use lahar_scene::driver::{Driver, Event, FrameEnd};

use super::clock::Throughput;
use super::{Readouts, Side, panic_report};

/// One simulation and what the window shows of it.
pub(super) struct Runner {
    title: String,
    driver: Driver,
    readouts: Readouts,
    throughput: Throughput,
    /// True if this side has finished the frame at hand and waits for the others.
    arrived: bool,
    /// The last retry, in words.
    retry: Option<String>,
}

impl Runner {
    /// Shows a simulation that is at its start.
    pub(super) fn new(title: String, driver: Driver) -> Self {
        let (dt, limit) = driver.simulation().next_dt();
        Self {
            title,
            driver,
            readouts: Readouts {
                dt,
                limit,
                ..Readouts::default()
            },
            throughput: Throughput::default(),
            arrived: false,
            retry: None,
        }
    }

    fn time(&self) -> f64 {
        self.driver.simulation().time()
    }

    /// Takes one substep. After a failure the frame begins again with a shorter dt.
    fn substep(&mut self) -> Result<(), String> {
        let start = Instant::now();
        let event = catch_unwind(AssertUnwindSafe(|| self.driver.pump_substeps(1)))
            .map_err(|panic| self.titled(panic_report(&*panic)))?;
        let advance = self.driver.last_advance();
        if advance.substeps > 0 {
            (self.readouts.dt, self.readouts.limit) = (advance.dt_min, advance.limit);
            let particles = self.driver.simulation().particle_count() as u64;
            (self.throughput).add(start.elapsed(), advance.substeps * particles);
        }
        match event {
            Event::Unfinished => {}
            Event::Frame(frame) => {
                self.arrived = true;
                self.readouts.substeps_per_frame = frame.advance.substeps;
            }
            Event::Retry(retry) => {
                self.retry = Some(self.titled(retry.to_string()));
                self.readouts.retries += 1;
            }
            Event::Failed(failure) => return Err(self.titled(Retry::in_vain(&failure))),
        }
        Ok(())
    }

    fn titled(&self, message: String) -> String {
        if self.title.is_empty() {
            message
        } else {
            format!("{}: {message}", self.title)
        }
    }

    fn side(&self, fields: &[Field], real_time: f64) -> Side {
        let simulation = self.driver.simulation();
        Side {
            title: self.title.clone(),
            snapshot: Arc::new(simulation.snapshot(fields)),
            retry: self.retry.clone(),
            readouts: Readouts {
                time: simulation.time(),
                real_time,
                substeps: simulation.substeps(),
                particles: simulation.particle_count(),
                particle_steps_per_second: self.throughput.per_second(),
                ..self.readouts
            },
        }
    }
}

/// All sides, in step frame by frame.
pub(super) struct Live {
    runners: Vec<Runner>,
}

impl Live {
    /// One side runs by its own scene's frames. Several share the frames of `frame_rate` \[1/s\].
    pub(super) fn new(mut runners: Vec<Runner>, frame_rate: f64) -> Self {
        if runners.len() > 1 {
            for runner in &mut runners {
                runner.driver.set_frame_end(FrameEnd::Rate(frame_rate));
            }
        }
        Self { runners }
    }

    /// The simulated time that all sides have reached \[s\].
    pub(super) fn time(&self) -> f64 {
        (self.runners.iter())
            .map(Runner::time)
            .fold(f64::INFINITY, f64::min)
    }

    /// True if no side has begun the next frame.
    pub(super) fn is_between_frames(&self) -> bool {
        (self.runners.iter()).all(|runner| runner.driver.is_between_frames() && !runner.arrived)
    }

    /// Takes a substep of the side that is behind. Returns true when all sides have finished the frame.
    pub(super) fn advance(&mut self) -> Result<bool, String> {
        let behind = (self.runners.iter_mut())
            .filter(|runner| !runner.arrived)
            .min_by(|a, b| a.time().total_cmp(&b.time()));
        if let Some(runner) = behind {
            runner.substep()?;
        }
        Ok(self.end_frame())
    }

    /// Takes a substep of the first side, and lets the others catch up with it.
    pub(super) fn substep(&mut self) -> Result<(), String> {
        let mut reached = f64::NEG_INFINITY;
        for runner in &mut self.runners {
            while !runner.arrived {
                runner.substep()?;
                if runner.time() >= reached - 0.5 * runner.readouts.dt {
                    break;
                }
            }
            reached = reached.max(runner.time());
        }
        self.end_frame();
        Ok(())
    }

    /// Lets the next frame begin if all sides have finished this one; returns true if they have.
    fn end_frame(&mut self) -> bool {
        let finished = self.runners.iter().all(|runner| runner.arrived);
        if finished {
            for runner in &mut self.runners {
                runner.arrived = false;
            }
        }
        finished
    }

    pub(super) fn command(&mut self, command: Command) {
        for runner in &mut self.runners {
            runner.driver.command(command);
        }
    }

    /// A snapshot of each side with `fields`, and its numbers for the panel.
    pub(super) fn sides(&self, fields: &[Field], real_time: f64) -> Vec<Side> {
        let side = |runner: &Runner| runner.side(fields, real_time);
        self.runners.iter().map(side).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lahar::Isa;
    use lahar_scene::scene::Scene;

    /// A spinning square of jelly in free space, with a dt that is too long for some of its frames.
    const STIFF_JELLY: &str = r#"
        dx = 0.1
        dt = 0.025
        frame_rate = 1.0
        gravity = [0.0, 0.0]
        [materials.jelly]
        model = "corotated"
        density = 500.0
        youngs_modulus = 2e4
        poisson_ratio = 0.3
        [[bodies]]
        material = "jelly"
        shape = { box = { min = [0.0, 0.0], max = [1.0, 1.0] } }
        sampling = "lattice"
        spin = 1.0
    "#;

    fn driver() -> Driver {
        let scene = Scene::parse(STIFF_JELLY, "jelly.toml", &[]).expect("the scene is valid");
        let built = scene.build(Isa::Portable).expect("the scene is valid");
        Driver::of_scene(&scene, built.simulation)
    }

    #[test]
    fn a_frame_is_retried_to_the_bits_of_a_headless_run() {
        let frames = 3;
        let sides = ["a", "b"].map(|title| Runner::new(title.to_owned(), driver()));
        let mut live = Live::new(sides.into(), 1.0);
        let mut done = 0;
        while done < frames {
            done += u64::from(live.advance().expect("a shorter dt helps"));
        }
        let mut headless = driver();
        while headless.frame() < frames {
            headless.pump(&mut || true);
        }
        assert!(!headless.retries().is_empty());
        let fields = [Field::Position, Field::Velocity];
        for side in live.sides(&fields, 1.0) {
            assert_eq!(side.readouts.retries, headless.retries().len() as u64);
            let last = headless.retries().last();
            let last = last.map(|retry| format!("{}: {retry}", side.title));
            assert_eq!(side.retry, last);
            let alone = headless.simulation().snapshot(&fields);
            assert_eq!(side.snapshot.columns, alone.columns);
        }
    }

    #[test]
    fn a_failure_that_no_shorter_dt_helps_names_its_side() {
        let mut live = Live::new(vec![Runner::new("a".to_owned(), driver())], 1.0);
        live.command(Command::Gravity([f64::NAN; 3]));
        let mut end = live.advance();
        while end.is_ok() {
            end = live.advance();
        }
        let why = end.expect_err("the loop ends with an error");
        assert!(
            why.starts_with("a: a particle's motion") && why.contains("1/64"),
            "{why}"
        );
    }

    #[test]
    fn single_substeps_give_the_bits_of_whole_frames() {
        let mut live = Live::new(vec![Runner::new(String::new(), driver())], 1.0);
        let mut headless = driver();
        while headless.frame() < 1 {
            headless.pump(&mut || true);
        }
        while live.runners[0].driver.frame() < 1 {
            live.substep().expect("the first frame succeeds");
        }
        let fields = [Field::Position, Field::Velocity];
        let alone = headless.simulation().snapshot(&fields);
        assert_eq!(live.sides(&fields, 1.0)[0].snapshot.columns, alone.columns);
    }
}
