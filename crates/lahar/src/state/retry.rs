//! Frames that fail are tried again from their start, with half the time step.

use crate::error::Failure;
use crate::instance::Instance;
use crate::setup::Command;
use crate::simulate::Simulate;
use crate::simulation::Simulation;
use crate::state::State;
use core::fmt;

/// How often a frame's time step is halved before the simulation is given up: to 1/64.
const MOST_HALVINGS: u32 = 6;

/// A frame that failed and is tried again.
#[derive(Clone, Debug, PartialEq)]
pub struct Retry {
    /// Where it goes on from: the start of the frame \[s\].
    pub time: f64,
    /// What part of the usual time step it takes now.
    pub part: f64,
    /// What happened.
    pub failure: Failure,
}

impl fmt::Display for Retry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the frame from t = {:.6} s is tried again with 1/{:.0} of the time step, since {}",
            self.time,
            1.0 / self.part,
            self.failure
        )
    }
}

impl Retry {
    /// What to say of a failure that no shorter time step has helped.
    pub fn in_vain(failure: &Failure) -> String {
        let least = 2_u32.pow(MOST_HALVINGS);
        format!(
            "{failure}; the frame was tried with down to 1/{least} of the time step, from its start"
        )
    }
}

/// The state at the start of a frame.
pub(crate) struct Mark<T, const D: usize> {
    pub(crate) state: State<T, D>,
    /// How often the frame has been tried again.
    attempts: u32,
}

impl<T: Instance<D>, const D: usize> Simulation<T, D> {
    pub(crate) fn begin(&mut self) {
        let old = self.mark.take().map(|mark| mark.state);
        self.mark = Some(Mark {
            state: self.save(old),
            attempts: 0,
        });
        self.control.frame_begins();
    }

    pub(crate) fn give_up_frame(&mut self) -> bool {
        let Some(mark) = self.mark.take() else {
            return false;
        };
        self.restore(&mark.state);
        self.mark = Some(mark);
        true
    }

    pub(crate) fn begin_again(&mut self, failure: &Failure) -> Option<Retry> {
        let mut mark = self.mark.take()?;
        // What was ordered meanwhile stands.
        let (gravity, pointer) = (self.gravity(), self.pointer);
        let stiffness: Vec<Option<f64>> =
            (self.groups.iter().map(|group| group.law.bulk_modulus())).collect();
        self.restore(&mark.state);
        self.command(Command::Gravity(gravity));
        self.command(Command::Pointer(pointer));
        for (material, bulk_modulus) in stiffness.into_iter().enumerate() {
            self.stiffen(material, bulk_modulus);
        }
        mark.attempts += 1;
        let attempts = mark.attempts;
        self.mark = Some(mark);
        if attempts > MOST_HALVINGS {
            return None;
        }
        self.control.frame_begins();
        Some(Retry {
            time: self.control.time(),
            part: self.control.shorten(attempts),
            failure: failure.clone(),
        })
    }
}

/// One frame by `advance`, tried again with half the time step whenever a substep fails; `told` is
/// called before each time. Whatever `advance` returns is that of the attempt that went well.
///
/// ```
/// # use lahar::{Isa, Material, Model, ParticleBatch, Setup, Simulate, Simulation, material::Dust};
/// # let dust = Material { name: "dust".into(), density: 1.0, model: Model::Dust(Dust) };
/// # let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.1, vec![dust]), &[])?;
/// for frame in 1..=10 {
///     let end = f64::from(frame) / 60.0;
///     lahar::frame(&mut simulation, |s| s.advance_to(end), |retry| eprintln!("{retry}"))?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// What failed last, when the shortest step has not helped either; the simulation is at the frame's
/// start then.
pub fn frame<S: Simulate + ?Sized, R>(
    simulation: &mut S,
    mut advance: impl FnMut(&mut S) -> Result<R, Failure>,
    mut told: impl FnMut(&Retry),
) -> Result<R, Failure> {
    simulation.begin_frame();
    loop {
        match advance(simulation) {
            Ok(done) => return Ok(done),
            Err(failure) => match simulation.retry_frame(&failure) {
                Some(retry) => told(&retry),
                None => return Err(failure),
            },
        }
    }
}
