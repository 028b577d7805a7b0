//! Retries: a frame that fails is tried again from its start, with half the time step.

use crate::error::Failure;
use crate::math::Lanes;
use crate::state::State;
use core::fmt;

/// Number of times that the time step of a frame is halved before the frame is given up: to 1/64.
const MOST_HALVINGS: u32 = 6;

/// A frame that failed and is tried again.
#[derive(Clone, Debug, PartialEq)]
pub struct Retry {
    /// The start of the frame, from which it goes on \[s\].
    pub time: f64,
    /// The part of the usual time step that it takes from now on.
    pub part: f64,
    /// The failure that ended the attempt.
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
    /// Returns a message for a failure that remained with the shortest time step.
    pub fn in_vain(failure: &Failure) -> String {
        let least = 2_u32.pow(MOST_HALVINGS);
        format!(
            "{failure}; the frame was tried with down to 1/{least} of the time step, from its start"
        )
    }
}

/// The start of a frame, to go back to.
pub(crate) struct RetryPoint<T: Lanes, const D: usize> {
    state: State<T, D>,
    /// How often the frame has been tried again.
    attempts: u32,
}

impl<T: Lanes, const D: usize> RetryPoint<T, D> {
    /// Copies `state` into the memory of `old`, if there is one.
    pub(crate) fn save(state: &State<T, D>, old: Option<Self>) -> Self {
        let state = match old {
            None => state.clone(),
            Some(mut old) => {
                old.state.clone_from(state);
                old.state
            }
        };
        Self { state, attempts: 0 }
    }

    /// Memory of the copy \[bytes\].
    pub(crate) fn bytes(&self) -> usize {
        self.state.bytes()
    }

    /// Sets `state` back to the start of the frame, as if it had not begun.
    pub(crate) fn restore(&self, state: &mut State<T, D>) {
        state.clone_from(&self.state);
    }

    /// Sets `state` back to the start of the frame, with half the time step of the last attempt. Commands given
    /// during the failed frame stay in force. Returns `None` if that has been tried often enough.
    pub(crate) fn retry(&mut self, state: &mut State<T, D>, failure: &Failure) -> Option<Retry> {
        let (gravity, pointer) = (state.gravity, state.pointer);
        let stiffness: Vec<Option<f64>> = (state.groups.iter())
            .map(|group| group.law.bulk_modulus())
            .collect();
        self.restore(state);
        state.set_gravity(gravity);
        state.pointer = pointer;
        for (material, bulk_modulus) in stiffness.into_iter().enumerate() {
            state.stiffen(material, bulk_modulus);
        }
        self.attempts += 1;
        if self.attempts > MOST_HALVINGS {
            return None;
        }
        state.control.begin_frame();
        Some(Retry {
            time: state.control.time(),
            part: state.control.shorten(self.attempts),
            failure: failure.clone(),
        })
    }
}
