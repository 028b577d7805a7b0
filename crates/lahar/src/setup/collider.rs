//! Primitive bodies that stand or move as they are told: shape, contact and motion, as plain data.

use super::Contact;
use crate::error::SetupError;
use crate::geometry::Primitive;

/// A body that stops the material and is not moved by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Collider<const D: usize> {
    /// Its name, for messages and for what is measured on it.
    pub name: String,
    /// What it is made of, at rest: all that is in any of them.
    pub primitives: Vec<Primitive<D>>,
    /// What it does to the material.
    pub contact: Contact,
    /// The point that it turns about, in the coordinates of `primitives` \[m\].
    pub center: [f64; D],
    /// How it moves.
    pub motion: Motion<D>,
}

/// How a collider moves; time is the simulation's.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion<const D: usize> {
    /// Not at all.
    Still,
    /// From where its primitives are at time 0, always on.
    Steady {
        /// Of its centre \[m/s\].
        velocity: [f64; D],
        /// About its centre, counter-clockwise about this direction \[rad/s\]; (0, 0, ω) in 2D.
        spin: [f64; 3],
    },
    /// From one to the next at constant speeds; before the first it is where the first says, after
    /// the last where the last says. At least one, at ascending times.
    Keyframes(Vec<Keyframe<D>>),
}

/// Where a collider is at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe<const D: usize> {
    /// \[s\]
    pub time: f64,
    /// Where its centre is \[m\].
    pub position: [f64; D],
    /// How far it has turned about this direction, counter-clockwise \[rad\]; (0, 0, φ) in 2D.
    pub turn: [f64; 3],
}

impl<const D: usize> Collider<D> {
    /// A collider that stands still, and turns about its first primitive's middle if it is moved.
    pub fn still(name: impl Into<String>, primitives: Vec<Primitive<D>>, contact: Contact) -> Self {
        Self {
            name: name.into(),
            center: primitives.first().map_or([0.0; D], Primitive::center),
            primitives,
            contact,
            motion: Motion::Still,
        }
    }

    /// What cannot be simulated of it.
    ///
    /// # Errors
    /// Names the key.
    pub(crate) fn check(&self) -> Result<(), SetupError> {
        let error = |key: &str, message: String| {
            Err(SetupError {
                key: format!("colliders.{}.{key}", self.name),
                message,
            })
        };
        let finite = |x: &[f64]| x.iter().all(|x| x.is_finite());
        if self.primitives.is_empty() {
            return error("shape", "has no part".into());
        }
        for primitive in &self.primitives {
            if let Primitive::Polygon { points } = primitive
                && (points.len() < 3 || !points.iter().all(|x| finite(x)))
            {
                return error("shape", "must have three corners or more".into());
            }
            let thin = primitive
                .thickness()
                .is_some_and(|t| !(t > 0.0 && t.is_finite()));
            if thin || !finite(&primitive.center()) {
                return error("shape", "must have a place and extent".into());
            }
        }
        if self.contact == Contact::Open {
            return error("contact", "\"open\" is for sides of the domain".into());
        }
        match &self.motion {
            Motion::Still => {}
            Motion::Steady { velocity, spin } => {
                if !finite(velocity) || !finite(spin) {
                    return error("velocity", "must be finite".into());
                }
            }
            Motion::Keyframes(frames) => {
                let ascending = frames.windows(2).all(|pair| pair[0].time < pair[1].time);
                let good =
                    |f: &Keyframe<D>| f.time.is_finite() && finite(&f.position) && finite(&f.turn);
                if frames.is_empty() || !ascending || !frames.iter().all(good) {
                    return error(
                        "keyframes",
                        "must be at least one, finite, at ascending times".into(),
                    );
                }
            }
        }
        Ok(())
    }
}
