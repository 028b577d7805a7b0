//! Colliders as plain data: shape, contact and prescribed motion.

use super::Contact;
use crate::error::SetupError;
use crate::geometry::Primitive;

/// A body with a prescribed motion that stops the material.
#[derive(Clone, Debug, PartialEq)]
pub struct Collider<const D: usize> {
    /// Its name, for messages and for the forces that are measured on it.
    pub name: String,
    /// Its shape at rest: the union of these primitives, which [`Shape::primitives`](crate::geometry::Shape::primitives)
    /// makes of a shape.
    pub primitives: Vec<Primitive<D>>,
    /// Its contact with the material.
    pub contact: Contact,
    /// The point that it turns about, in the coordinates of `primitives` \[m\].
    pub center: [f64; D],
    /// Its motion over time.
    pub motion: Motion<D>,
}

/// The motion of a collider. Times are those of the simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion<const D: usize> {
    /// It does not move.
    Still,
    /// It moves at constant velocity and spin from its place at time 0.
    Steady {
        /// Velocity of its center \[m/s\].
        velocity: [f64; D],
        /// Angular velocity about its center, counter-clockwise about this direction \[rad/s\]; (0, 0, ω) in 2D.
        spin: [f64; 3],
    },
    /// It moves from each keyframe to the next at constant speed. Before the first and after the last it rests there. At
    /// least one, at ascending times.
    Keyframes(Vec<Keyframe<D>>),
}

/// The place of a collider at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe<const D: usize> {
    /// The time \[s\].
    pub time: f64,
    /// The place of its center \[m\].
    pub position: [f64; D],
    /// The angle by which it has turned, counter-clockwise about this direction \[rad\]; (0, 0, φ) in 2D.
    pub turn: [f64; 3],
}

impl<const D: usize> Collider<D> {
    /// Makes a collider that stands still. Its center is the middle of its first primitive.
    pub fn still(name: impl Into<String>, primitives: Vec<Primitive<D>>, contact: Contact) -> Self {
        Self {
            name: name.into(),
            center: primitives.first().map_or([0.0; D], Primitive::center),
            primitives,
            contact,
            motion: Motion::Still,
        }
    }

    /// Checks that it can be simulated.
    ///
    /// # Errors
    /// Names the key that is wrong.
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
