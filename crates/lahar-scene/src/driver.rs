//! The driver of frames: it advances a simulation frame by frame, for every outlet of lahar.
//!
//! ```text
//!                      pump(go_on)                                          due at the end of a frame
//!   caller ───────▶ Driver ──substeps──▶ Simulate                            ┌ output
//!      ▲               │                    │ failure                        ├ checkpoint
//!      └──── Event ◀───┘ ◀── shorter dt ◀───┘        Event::Frame(Frame) ────┴ readings of probes
//! ```
//!
//! A frame is one output interval. The command line, the window, validation and benchmarks all drive their
//! simulations here, so they agree on the ends of frames, on the retry of a frame that fails, and on the stiffness that
//! follows gravity. [`Driver::pump`] returns between substeps whenever its caller asks, without changing
//! a bit of the run. It needs no thread, clock or file of its own, so it also serves a page in a browser.
//!
//! ```
//! use lahar_scene::driver::{Driver, Event};
//! use lahar_scene::scene::Scene;
//!
//! let scene = Scene::load("dam-break", &[("dx".into(), "0.1".into())])?;
//! let built = scene.build(lahar::Isa::Portable)?;
//! let mut driver = Driver::of_scene(&scene, built.simulation);
//! while driver.frame() < 2 {
//!     match driver.pump(&mut || true) {
//!         Event::Frame(frame) => println!("frame {}: {} substeps", frame.number, frame.advance.substeps),
//!         Event::Retry(retry) => eprintln!("warning: {retry}"),
//!         Event::Failed(failure) => return Err(failure.into()),
//!         Event::Unfinished => unreachable!("nothing stops this frame"),
//!     }
//! }
//! assert_eq!(driver.simulation().time(), 2.0 / scene.frame_rate);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use lahar::{Advance, Checkpoint, Command, Failure, ProbeSamples, Retry, Simulate};

use crate::scene::{Scene, SoundSpeeds};

/// The rule by which a frame ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameEnd {
    /// Frame k ends at k / rate of simulated time; the rate is in frames per simulated second \[1/s\].
    Rate(f64),
    /// Every frame takes this many substeps of the length that the scene fixes.
    Substeps(u64),
    /// A frame goes on until [`Driver::end_frame`] is called.
    Open,
}

/// The rule by which frames end, and the outputs that are due after them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// The rule by which a frame ends.
    pub frame_end: FrameEnd,
    /// Output is due after every frame whose number is a multiple of this; 0 counts as 1.
    pub output_every: u64,
    /// A checkpoint is due after every frame whose number is a multiple of this; 0: never.
    pub checkpoint_every: u64,
    /// A checkpoint is due after so many minutes of the clock; 0: never.
    pub checkpoint_minutes: f64,
}

impl Schedule {
    /// Frames that end by `frame_end`, with output after each and no checkpoints.
    pub fn new(frame_end: FrameEnd) -> Self {
        Self {
            frame_end,
            output_every: 1,
            checkpoint_every: 0,
            checkpoint_minutes: 0.0,
        }
    }

    /// The schedule that a scene asks for.
    pub fn of_scene(scene: &Scene) -> Self {
        Self {
            frame_end: match scene.substeps_per_frame {
                Some(substeps) => FrameEnd::Substeps(substeps),
                None => FrameEnd::Rate(scene.frame_rate),
            },
            output_every: scene.output.every,
            checkpoint_every: scene.output.checkpoint_every,
            checkpoint_minutes: scene.output.checkpoint_minutes,
        }
    }
}

/// A finished frame, and the outputs that are due after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The frame's number; frame 0 is the start.
    pub number: u64,
    /// The substeps of the attempt that succeeded.
    pub advance: Advance,
    /// True if the schedule asks for an output of this frame.
    pub output_due: bool,
    /// True if the schedule asks for a checkpoint after this frame.
    pub checkpoint_due: bool,
    /// Readings of the probes since the frame before, in the order of the scene's probes.
    pub probes: Vec<ProbeSamples>,
}

/// The result of [`Driver::pump`].
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The caller stopped the driver between two substeps of a frame.
    Unfinished,
    /// A frame is finished.
    Frame(Frame),
    /// A substep failed. The simulation is back at the start of the frame, and the next pump takes shorter substeps.
    Retry(Box<Retry>),
    /// A substep failed, and the shortest dt did not help either. The simulation is back at the start of the frame.
    /// [`Retry::in_vain`] puts the failure into words.
    Failed(Box<Failure>),
}

/// The end of the frame at hand.
#[derive(Clone, Copy)]
enum Target {
    Time(f64),
    Substeps(u64),
    Open,
}

/// A simulation, advanced frame by frame.
pub struct Driver {
    simulation: Box<dyn Simulate>,
    schedule: Schedule,
    /// The fluids whose stiffness follows gravity.
    sound_speeds: Option<SoundSpeeds>,
    clock: Option<fn() -> f64>,
    /// The last finished frame.
    frame: u64,
    /// True while a frame has begun and is not finished.
    in_frame: bool,
    /// The substeps of the frame at hand.
    frame_advance: Advance,
    /// How many substeps of the scene's fixed length the frame at hand has taken, each whole or in parts.
    fixed_substeps: u64,
    /// The substeps of the last pump.
    last_advance: Advance,
    /// Particles × substeps of finished frames.
    particle_steps: u64,
    /// Particles × substeps of the frame at hand.
    frame_particle_steps: u64,
    retries: Vec<Retry>,
    /// The number of retries that belong to finished frames.
    settled_retries: usize,
    /// The frame of the last checkpoint.
    checkpoint_frame: Option<u64>,
    /// The clock's time at the last checkpoint \[s\].
    checkpoint_clock: f64,
}

/// No substeps yet.
const NO_ADVANCE: Advance = Advance {
    substeps: 0,
    dt_min: f64::INFINITY,
    limit: lahar::DtLimit::Frame,
};

impl Driver {
    /// Drives a simulation that is at its start.
    pub fn new(simulation: Box<dyn Simulate>, schedule: Schedule) -> Self {
        Self {
            simulation,
            schedule,
            sound_speeds: None,
            clock: None,
            frame: 0,
            in_frame: false,
            frame_advance: NO_ADVANCE,
            fixed_substeps: 0,
            last_advance: NO_ADVANCE,
            particle_steps: 0,
            frame_particle_steps: 0,
            retries: Vec::new(),
            settled_retries: 0,
            checkpoint_frame: None,
            checkpoint_clock: 0.0,
        }
    }

    /// Drives a simulation built from `scene` by the scene's schedule. Fluids whose speed of sound the scene leaves
    /// open get stiffer when gravity grows.
    pub fn of_scene(scene: &Scene, simulation: Box<dyn Simulate>) -> Self {
        let mut driver = Self::new(simulation, Schedule::of_scene(scene));
        driver.sound_speeds = Some(scene.sound_speeds());
        driver
    }

    /// Gives the driver and its simulation a clock that returns seconds. Phases are timed by it, and checkpoints can
    /// be due by the minute.
    #[must_use]
    pub fn with_clock(mut self, clock: fn() -> f64) -> Self {
        self.simulation.set_clock(clock);
        self.checkpoint_clock = clock();
        self.clock = Some(clock);
        self
    }

    /// Continues after `frame`, whose checkpoint the simulation has resumed from.
    #[must_use]
    pub fn resumed_after(mut self, frame: u64) -> Self {
        self.frame = frame;
        self.checkpoint_frame = Some(frame);
        self
    }

    /// Replaces the rule by which frames end, from the next frame on. Simulations that run side by side share theirs.
    pub fn set_frame_end(&mut self, frame_end: FrameEnd) {
        self.schedule.frame_end = frame_end;
    }

    /// The simulation, for snapshots and the like.
    pub fn simulation(&self) -> &dyn Simulate {
        &*self.simulation
    }

    /// The simulation, for diagnostics and the like. Substeps taken behind the driver's back do not
    /// count towards its frames.
    pub fn simulation_mut(&mut self) -> &mut dyn Simulate {
        &mut *self.simulation
    }

    /// The number of the last finished frame; 0 at the start.
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// True between two frames, when none has begun.
    pub fn is_between_frames(&self) -> bool {
        !self.in_frame
    }

    /// The substeps of the last [`Self::pump`]; none if it failed.
    pub fn last_advance(&self) -> Advance {
        self.last_advance
    }

    /// Particles × substeps of all finished frames.
    pub fn particle_steps(&self) -> u64 {
        self.particle_steps
    }

    /// Every retry so far, those of an unfinished frame included.
    pub fn retries(&self) -> &[Retry] {
        &self.retries
    }

    /// The retries of finished frames.
    pub fn settled_retries(&self) -> &[Retry] {
        &self.retries[..self.settled_retries]
    }

    /// True if the schedule asks for checkpoints by frames, or one was taken or resumed from.
    pub fn keeps_checkpoints(&self) -> bool {
        self.schedule.checkpoint_every > 0 || self.checkpoint_frame.is_some()
    }

    /// Reports the start as frame 0, with the readings that probes have taken there.
    pub fn start(&mut self) -> Frame {
        self.report(0, NO_ADVANCE)
    }

    /// Tells the simulation something. Where it is new gravity, the speeds of sound that depend on gravity follow.
    pub fn command(&mut self, command: Command) {
        self.simulation.command(command);
        if let (Command::Gravity(gravity), Some(speeds)) = (command, &self.sound_speeds) {
            for follows in speeds.under(gravity) {
                self.simulation.command(follows);
            }
        }
    }

    /// Takes substeps until the frame ends, a substep fails, or `go_on`, asked before each substep, returns false.
    ///
    /// The bits of a run do not depend on how often it is stopped this way.
    pub fn pump(&mut self, go_on: &mut dyn FnMut() -> bool) -> Event {
        let target = match self.schedule.frame_end {
            FrameEnd::Rate(rate) => Target::Time((self.frame + 1) as f64 / rate),
            FrameEnd::Substeps(substeps) => Target::Substeps(substeps),
            FrameEnd::Open => Target::Open,
        };
        self.pump_to(target, go_on)
    }

    /// Takes at most this many substeps of the frame; otherwise as [`Self::pump`].
    pub fn pump_substeps(&mut self, most: u64) -> Event {
        let mut left = most;
        self.pump(&mut || {
            let go_on = left > 0;
            left = left.saturating_sub(1);
            go_on
        })
    }

    /// Runs to `time` \[s\] as one frame of its own, whatever the schedule says. `told` is called at each retry.
    ///
    /// # Errors
    /// The last failure, when the shortest dt did not help either. The simulation is back where it was.
    pub fn advance_to(
        &mut self,
        time: f64,
        mut told: impl FnMut(&Retry),
    ) -> Result<Frame, Box<Failure>> {
        loop {
            match self.pump_to(Target::Time(time), &mut || true) {
                Event::Frame(frame) => return Ok(frame),
                Event::Retry(retry) => told(&retry),
                Event::Failed(failure) => return Err(failure),
                Event::Unfinished => {}
            }
        }
    }

    /// Ends the frame at hand, however far it got.
    pub fn end_frame(&mut self) -> Frame {
        self.in_frame = false;
        self.frame += 1;
        self.particle_steps += self.frame_particle_steps;
        self.settled_retries = self.retries.len();
        self.report(self.frame, self.frame_advance)
    }

    /// Gives the frame at hand back: the simulation is as it was at the end of the last finished frame, and the
    /// retries of this frame are forgotten. Returns false if no frame had begun.
    pub fn cancel(&mut self) -> bool {
        self.retries.truncate(self.settled_retries);
        let begun = core::mem::take(&mut self.in_frame);
        begun && self.simulation.give_up_frame()
    }

    /// Takes a checkpoint of the last finished frame. Returns `None` if the last checkpoint was of the same frame.
    ///
    /// Call it between frames: after [`Event::Frame`], [`Event::Failed`] or [`Self::cancel`].
    pub fn checkpoint(&mut self) -> Option<Checkpoint> {
        if self.checkpoint_frame == Some(self.frame) {
            return None;
        }
        self.checkpoint_frame = Some(self.frame);
        self.checkpoint_clock = self.clock.map_or(0.0, |clock| clock());
        Some(self.simulation.checkpoint())
    }

    fn pump_to(&mut self, target: Target, go_on: &mut dyn FnMut() -> bool) -> Event {
        self.last_advance = NO_ADVANCE;
        if !self.in_frame {
            self.simulation.begin_frame();
            self.in_frame = true;
            self.forget_substeps();
        }
        match self.take_substeps(target, go_on) {
            Ok(true) => Event::Frame(self.end_frame()),
            Ok(false) => Event::Unfinished,
            Err(failure) => self.begin_again(failure),
        }
    }

    /// Takes substeps towards the target; returns true when it is reached.
    fn take_substeps(
        &mut self,
        target: Target,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<bool, Failure> {
        let mut stopped = false;
        let mut go_on = || {
            stopped = !go_on();
            !stopped
        };
        let particles = self.simulation.particle_count() as u64;
        let advance = match target {
            Target::Time(time) => self.simulation.advance_while(time, &mut go_on)?,
            Target::Substeps(all) => self.take_fixed_substeps(all, &mut go_on)?,
            Target::Open => self.take_fixed_substeps(u64::MAX, &mut go_on)?,
        };
        self.last_advance = advance;
        self.frame_advance = merged(self.frame_advance, advance);
        self.frame_particle_steps += particles * advance.substeps;
        Ok(!stopped)
    }

    /// Takes substeps until the frame has `all` of them. After a retry each consists of several shorter ones.
    fn take_fixed_substeps(
        &mut self,
        all: u64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Advance, Failure> {
        let mut advance = NO_ADVANCE;
        while self.fixed_substeps < all && go_on() {
            advance = merged(advance, self.simulation.substep()?);
            self.fixed_substeps += 1;
        }
        Ok(advance)
    }

    /// Goes back to the start of the frame after a failure.
    fn begin_again(&mut self, failure: Failure) -> Event {
        self.forget_substeps();
        match self.simulation.retry_frame(&failure) {
            Some(retry) => {
                self.retries.push(retry.clone());
                Event::Retry(Box::new(retry))
            }
            None => {
                self.in_frame = false;
                Event::Failed(Box::new(failure))
            }
        }
    }

    fn forget_substeps(&mut self) {
        self.frame_advance = NO_ADVANCE;
        self.frame_particle_steps = 0;
        self.fixed_substeps = 0;
    }

    fn report(&mut self, number: u64, advance: Advance) -> Frame {
        let every = |frames: u64| frames > 0 && number.is_multiple_of(frames);
        let minutes = (self.clock).map_or(0.0, |clock| (clock() - self.checkpoint_clock) / 60.0);
        let by_clock =
            self.schedule.checkpoint_minutes > 0.0 && minutes >= self.schedule.checkpoint_minutes;
        Frame {
            number,
            advance,
            output_due: every(self.schedule.output_every.max(1)),
            checkpoint_due: every(self.schedule.checkpoint_every) || by_clock,
            probes: self.simulation.take_probe_samples(),
        }
    }
}

/// The substeps of both, with the shorter dt and its limit.
fn merged(first: Advance, second: Advance) -> Advance {
    let shorter = if second.dt_min < first.dt_min {
        second
    } else {
        first
    };
    Advance {
        substeps: first.substeps + second.substeps,
        ..shorter
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lahar::material::{Corotated, lame};
    use lahar::{Data, Field, Isa, Material, Model, ParticleBatch, Setup, Simulation, TimeStep};

    /// A spinning square of jelly in free space, with a dt that is too long for some of its frames.
    fn stiff_jelly() -> Box<dyn Simulate> {
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
        Box::new(Simulation::<f32, 2>::new(setup, &[batch]).expect("the setup is valid"))
    }

    fn small_dam_break() -> Scene {
        let set = [("dx", "0.1"), ("output.every", "2")];
        let set = set.map(|(key, value)| (key.to_owned(), value.to_owned()));
        Scene::load("dam-break", &set).expect("a built-in scene")
    }

    fn water() -> Driver {
        let scene = small_dam_break();
        let built = scene.build(Isa::Portable).expect("a built-in scene");
        Driver::of_scene(&scene, built.simulation)
    }

    /// Every position and velocity, to the bit.
    fn motion(simulation: &dyn Simulate) -> Vec<(Field, Data)> {
        let fields = [Field::Position, Field::Velocity, Field::Affine];
        simulation.snapshot(&fields).columns
    }

    fn snapshot(driver: &Driver) -> Vec<(Field, Data)> {
        motion(driver.simulation())
    }

    /// Runs to the end of `frame` in pumps of at most `slice` substeps, and counts the retries it is told of.
    fn run_to(driver: &mut Driver, frame: u64, slice: u64) -> usize {
        let mut told = 0;
        while driver.frame() < frame {
            match driver.pump_substeps(slice) {
                Event::Retry(_) => told += 1,
                Event::Failed(failure) => panic!("{failure}"),
                Event::Frame(_) | Event::Unfinished => {}
            }
        }
        told
    }

    #[test]
    fn pumping_in_slices_gives_the_same_bits_as_in_one_go() {
        let starts: [fn() -> Driver; 3] = [
            water,
            || Driver::new(stiff_jelly(), Schedule::new(FrameEnd::Rate(1.0))),
            || Driver::new(stiff_jelly(), Schedule::new(FrameEnd::Substeps(40))),
        ];
        for start in starts {
            let mut whole = start();
            let told = run_to(&mut whole, 3, u64::MAX);
            for slice in [1, 7] {
                let mut sliced = start();
                assert_eq!(run_to(&mut sliced, 3, slice), told);
                assert_eq!(snapshot(&sliced), snapshot(&whole));
                assert_eq!(sliced.particle_steps(), whole.particle_steps());
            }
        }
    }

    #[test]
    fn a_driven_run_has_the_bits_of_the_frames_of_the_library() {
        let mut driver = Driver::new(stiff_jelly(), Schedule::new(FrameEnd::Rate(1.0)));
        run_to(&mut driver, 3, u64::MAX);
        let mut simulation = stiff_jelly();
        let mut told = Vec::new();
        for end in [1.0, 2.0, 3.0] {
            let frame = lahar::frame(
                &mut *simulation,
                |s| s.advance_to(end),
                |retry| told.push(retry.clone()),
            );
            frame.expect("a shorter dt helps");
        }
        assert_eq!(snapshot(&driver), motion(&*simulation));
        assert_eq!(driver.retries(), told);
    }

    #[test]
    fn each_retry_is_told_once_and_settles_with_its_frame() {
        let mut driver = Driver::new(stiff_jelly(), Schedule::new(FrameEnd::Rate(1.0)));
        let mut told = 0;
        while driver.frame() < 3 {
            let event = driver.pump_substeps(3);
            told += usize::from(matches!(event, Event::Retry(_)));
            assert_eq!(driver.retries().len(), told);
            if driver.is_between_frames() {
                assert_eq!(driver.settled_retries().len(), told);
            }
        }
        assert!(told > 0, "the jelly is too stiff for its dt");
    }

    #[test]
    fn canceling_gives_the_frame_back() {
        let mut driver = water();
        run_to(&mut driver, 1, u64::MAX);
        let (before, steps) = (snapshot(&driver), driver.particle_steps());
        assert_eq!(driver.pump_substeps(2), Event::Unfinished);
        assert!(!driver.is_between_frames());
        assert_ne!(snapshot(&driver), before);
        assert!(driver.cancel());
        assert!(driver.is_between_frames());
        assert_eq!(
            (snapshot(&driver), driver.particle_steps()),
            (before, steps)
        );
        assert!(!driver.cancel(), "no frame has begun");

        run_to(&mut driver, 2, u64::MAX);
        let mut undisturbed = water();
        run_to(&mut undisturbed, 2, u64::MAX);
        assert_eq!(snapshot(&driver), snapshot(&undisturbed));
    }

    #[test]
    fn the_retries_of_a_canceled_frame_are_forgotten() {
        let mut driver = Driver::new(stiff_jelly(), Schedule::new(FrameEnd::Rate(0.25)));
        while !matches!(driver.pump_substeps(1), Event::Retry(_)) {}
        assert_eq!(driver.retries().len(), 1 + driver.settled_retries().len());
        driver.cancel();
        assert_eq!(driver.retries(), driver.settled_retries());
    }

    #[test]
    fn a_frame_of_fixed_substeps_takes_exactly_these() {
        let mut driver = Driver::new(stiff_jelly(), Schedule::new(FrameEnd::Substeps(5)));
        let Event::Frame(frame) = driver.pump(&mut || true) else {
            panic!("the first frame succeeds");
        };
        assert_eq!((frame.number, frame.advance.substeps), (1, 5));
        let mut simulation = stiff_jelly();
        for _ in 0..5 {
            simulation.substep().expect("the first frame succeeds");
        }
        assert_eq!(driver.simulation().time(), simulation.time());
        assert_eq!(driver.simulation().substeps(), simulation.substeps());
    }

    #[test]
    fn an_open_frame_ends_when_its_caller_says_so() {
        let mut driver = Driver::new(stiff_jelly(), Schedule::new(FrameEnd::Open));
        assert_eq!(driver.pump_substeps(3), Event::Unfinished);
        assert_eq!(driver.last_advance().substeps, 3);
        assert_eq!(driver.pump_substeps(2), Event::Unfinished);
        let frame = driver.end_frame();
        assert_eq!((frame.number, frame.advance.substeps), (1, 5));
    }

    #[test]
    fn a_failure_that_no_shorter_dt_helps_names_itself() {
        let mut driver = water();
        run_to(&mut driver, 1, u64::MAX);
        let before = snapshot(&driver);
        driver.command(Command::Gravity([f64::NAN; 3]));
        let failure = loop {
            match driver.pump(&mut || true) {
                Event::Failed(failure) => break failure,
                Event::Retry(_) => {}
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(failure.material, "water");
        let words = Retry::in_vain(&failure);
        assert!(words.contains("1/64"), "{words}");
        assert!(driver.is_between_frames());
        assert_eq!((driver.frame(), snapshot(&driver)), (1, before));
    }

    #[test]
    fn fluids_get_stiffer_when_gravity_grows_and_recover() {
        let mut driver = water();
        let (usual, _) = driver.simulation().next_dt();
        driver.command(Command::Gravity([0.0, -981.0, 0.0]));
        let (stiff, _) = driver.simulation().next_dt();
        assert!(stiff < 0.2 * usual, "{stiff} s after {usual} s");
        driver.command(Command::Gravity([0.0, -9.81, 0.0]));
        let (again, _) = driver.simulation().next_dt();
        assert!(
            (again / usual - 1.0).abs() < 1e-6,
            "{again} s after {usual} s"
        );
    }

    #[test]
    fn output_and_checkpoints_are_due_by_frames_and_by_minutes() {
        let mut schedule = Schedule::of_scene(&small_dam_break());
        schedule.frame_end = FrameEnd::Open;
        schedule.checkpoint_every = 3;
        let mut driver = Driver::new(stiff_jelly(), schedule);
        assert!(driver.start().output_due);
        let mut due = Vec::new();
        for _ in 0..6 {
            driver.pump_substeps(1);
            let frame = driver.end_frame();
            due.push((frame.output_due, frame.checkpoint_due));
            assert!(driver.checkpoint().is_some());
            assert!(
                driver.checkpoint().is_none(),
                "nothing happened since the last"
            );
        }
        let by_frames = |n: u64| (n.is_multiple_of(2), n.is_multiple_of(3));
        assert_eq!(due, (1..=6).map(by_frames).collect::<Vec<_>>());

        let minutes = |checkpoint_minutes| {
            let frame_end = FrameEnd::Open;
            let schedule = Schedule {
                checkpoint_minutes,
                ..Schedule::new(frame_end)
            };
            let mut driver = Driver::new(stiff_jelly(), schedule).with_clock(|| 0.0);
            driver.checkpoint_clock = -90.0;
            driver.end_frame().checkpoint_due
        };
        assert_eq!([0.0, 1.0, 2.0].map(minutes), [false, true, false]);
    }

    #[test]
    fn probes_are_read_from_the_start_and_come_with_their_frames() {
        let set = [("dx".to_owned(), "0.0146".to_owned())];
        let scene = Scene::load("square-obstacle", &set).expect("a built-in scene");
        let built = scene.build(Isa::Portable).expect("a built-in scene");
        let mut driver = Driver::of_scene(&scene, built.simulation);
        let at_start = driver.start();
        assert!(!at_start.probes.is_empty());
        let Event::Frame(frame) = driver.pump(&mut || true) else {
            panic!("the first frame succeeds");
        };
        for (first, later) in at_start.probes.iter().zip(&frame.probes) {
            assert_eq!(first.name, later.name);
            assert_eq!(first.samples.len(), 1);
            assert!(later.samples.iter().all(|sample| sample.time > 0.0));
        }
    }
}
