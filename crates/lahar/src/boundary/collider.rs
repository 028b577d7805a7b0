//! Primitive bodies that stand or move as they are told: shape, contact and motion, as plain data.

use super::Contact;
use crate::error::SetupError;
use crate::geometry::{Primitive, rotation};
use crate::math::{Matrix, Vector};

/// A body that stops the material and is not moved by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Collider<const D: usize> {
    /// Its name, for messages and for what is measured on it.
    pub name: String,
    /// Its shape at rest: the union of these primitives, which [`Shape::primitives`](crate::geometry::Shape::primitives)
    /// makes of a shape.
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

impl<const D: usize> Motion<D> {
    /// How far the centre has moved from `center`, where it is at rest, and how far it has turned.
    fn at(&self, center: [f64; D], time: f64) -> (Vector<f64, D>, [f64; 3]) {
        let zero = Vector([0.0; D]);
        match self {
            Self::Still => (zero, [0.0; 3]),
            Self::Steady { velocity, spin } => (Vector(*velocity) * time, spin.map(|w| w * time)),
            Self::Keyframes(frames) => {
                let next = frames.partition_point(|frame| frame.time <= time);
                let (low, high) = (
                    &frames[next.saturating_sub(1)],
                    &frames[next.min(frames.len() - 1)],
                );
                let span = high.time - low.time;
                let part = if span > 0.0 {
                    ((time - low.time) / span).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let moved = |frame: &Keyframe<D>| Vector(frame.position) - Vector(center);
                (
                    moved(low) + (moved(high) - moved(low)) * part,
                    core::array::from_fn(|i| low.turn[i] + part * (high.turn[i] - low.turn[i])),
                )
            }
        }
    }

    /// The largest speed of its centre, and of its turning \[rad/s\], from `time` on for `span`.
    fn speeds(&self, time: f64, span: f64) -> (f64, f64) {
        match self {
            Self::Still => (0.0, 0.0),
            Self::Steady { velocity, spin } => (Vector(*velocity).norm(), Vector(*spin).norm()),
            Self::Keyframes(frames) => frames
                .windows(2)
                .filter(|pair| pair[0].time <= time + span && pair[1].time >= time)
                .fold((0.0, 0.0), |(speed, rate): (f64, f64), pair| {
                    let span = pair[1].time - pair[0].time;
                    let moved = Vector(pair[1].position) - Vector(pair[0].position);
                    let turned = Vector(pair[1].turn) - Vector(pair[0].turn);
                    (
                        speed.max(moved.norm() / span),
                        rate.max(turned.norm() / span),
                    )
                }),
        }
    }
}

impl<const D: usize> Collider<D> {
    /// A collider that stands still, and turns about the middle of its first primitive if it is moved.
    pub fn still(name: impl Into<String>, primitives: Vec<Primitive<D>>, contact: Contact) -> Self {
        Self {
            name: name.into(),
            center: primitives.first().map_or([0.0; D], Primitive::center),
            primitives,
            contact,
            motion: Motion::Still,
        }
    }

    /// Where it is at `time` \[s\].
    pub fn at(&self, time: f64) -> Placed<D> {
        let still = |primitive: &Primitive<D>| (primitive.clone(), Vector([0.0; D]));
        let mut placed = Placed {
            rest: self.center,
            moved: Vector([0.0; D]),
            rotation: Matrix::identity(1.0),
            turns: false,
            primitives: self.primitives.iter().map(still).collect(),
            period: [None; D],
        };
        placed.put(self, time);
        placed
    }

    /// A bound on the speed of its points within `span` \[s\] from `time` \[s\] on, as far as they are
    /// among the points of the box `min` .. `max`.
    pub fn largest_speed(&self, time: f64, span: f64, (min, max): ([f64; D], [f64; D])) -> f64 {
        let (speed, rate) = self.motion.speeds(time, span);
        if rate == 0.0 {
            return speed;
        }
        // A half-space moves only what is in the box.
        let moved = self.motion.at(self.center, time).0;
        let arm = |x: &[f64; D], i: usize| (x[i] - self.center[i] - moved[i]).abs();
        let in_box = (0..D)
            .map(|i| arm(&min, i).max(arm(&max, i)))
            .map(|reach| reach * reach)
            .sum::<f64>()
            .sqrt();
        let own = self.primitives.iter().map(|primitive| {
            let arm = (Vector(primitive.center()) - Vector(self.center)).norm();
            primitive.reach().map_or(f64::INFINITY, |reach| arm + reach)
        });
        speed + rate * own.fold(0.0, f64::max).min(in_box)
    }

    /// All lengths divided by `unit` and counted from `origin`.
    pub(crate) fn in_units(&self, unit: f64, origin: [f64; D]) -> Self {
        let place = |x: [f64; D]| core::array::from_fn(|i| (x[i] - origin[i]) / unit);
        Self {
            name: self.name.clone(),
            primitives: self
                .primitives
                .iter()
                .map(|primitive| primitive.in_units(unit, origin))
                .collect(),
            contact: self.contact,
            center: place(self.center),
            motion: match &self.motion {
                Motion::Still => Motion::Still,
                Motion::Steady { velocity, spin } => Motion::Steady {
                    velocity: velocity.map(|v| v / unit),
                    spin: *spin,
                },
                Motion::Keyframes(frames) => Motion::Keyframes(
                    frames
                        .iter()
                        .map(|frame| Keyframe {
                            position: place(frame.position),
                            ..*frame
                        })
                        .collect(),
                ),
            },
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

/// A collider at a moment. Moves are kept apart from places: far from the origin their sum would be
/// rounded.
#[derive(Clone, Debug)]
pub struct Placed<const D: usize> {
    /// Where its centre is at rest.
    rest: [f64; D],
    /// How far the centre has moved.
    moved: Vector<f64, D>,
    rotation: Matrix<f64, D>,
    turns: bool,
    /// Each at rest, with how far its middle has moved.
    primitives: Vec<(Primitive<D>, Vector<f64, D>)>,
    /// Lengths of the axes that are periodic.
    pub(crate) period: [Option<f64>; D],
}

impl<const D: usize> Placed<D> {
    /// Makes this where `collider`, which it was made of, is at `time`.
    fn put(&mut self, collider: &Collider<D>, time: f64) {
        let (moved, turn) = collider.motion.at(collider.center, time);
        self.moved = moved;
        self.turns = turn != [0.0; 3];
        self.rotation = if self.turns {
            rotation(turn)
        } else {
            Matrix::identity(1.0)
        };
        for (primitive, its_move) in &mut self.primitives {
            let arm = Vector(primitive.center()) - Vector(self.rest);
            *its_move = moved + (self.rotation * arm - arm);
        }
    }

    /// Distance of `x` from the surface, negative inside, and the unit vector out of the collider, in
    /// the unit of length that the collider is in.
    pub fn distance(&self, x: [f64; D]) -> (f64, [f64; D]) {
        let (distance, normal) = self.distance_from(x, Vector([0.0; D]));
        (distance, normal.0)
    }

    /// [`Self::distance`] of the point at `x` from `base`.
    pub(crate) fn distance_from(&self, base: [f64; D], x: Vector<f64, D>) -> (f64, Vector<f64, D>) {
        let mut nearest = (f64::INFINITY, Vector([0.0; D]));
        for (primitive, moved) in &self.primitives {
            let mut y = (Vector(base) - Vector(primitive.center())) + (x - *moved);
            if primitive.reach().is_some() {
                y = self.wrapped(y);
            }
            let found = if self.turns {
                let (distance, out) = primitive.distance_from_center(self.rotation.transpose() * y);
                (distance, self.rotation * out)
            } else {
                primitive.distance_from_center(y)
            };
            if found.0 < nearest.0 {
                nearest = found;
            }
        }
        nearest
    }

    /// Where its centre is.
    pub(crate) fn center(&self) -> Vector<f64, D> {
        Vector(self.rest) + self.moved
    }

    /// Its primitives as they are now.
    pub fn primitives(&self) -> Vec<Primitive<D>> {
        let turned = |v: [f64; D]| (self.rotation * Vector(v)).0;
        self.primitives
            .iter()
            .map(|(primitive, moved)| {
                let now = Vector(primitive.center()) + *moved;
                let shift = |x: [f64; D]| {
                    let arm = Vector(x) - Vector(primitive.center());
                    (now + self.rotation * arm).0
                };
                primitive.mapped(shift, turned, 1.0)
            })
            .collect()
    }

    /// The shortest of the images of `y` on periodic axes.
    fn wrapped(&self, mut y: Vector<f64, D>) -> Vector<f64, D> {
        for i in 0..D {
            if let Some(period) = self.period[i] {
                y[i] -= period * (y[i] / period).round();
            }
        }
        y
    }
}

/// A collider during a substep: where it is at its start and at its end, and what carries the one to
/// the other.
#[derive(Clone, Debug)]
pub(crate) struct Moving<const D: usize> {
    pub(crate) start: Placed<D>,
    pub(crate) end: Placed<D>,
    pub(crate) contact: Contact,
    moves: bool,
    /// Of its centre.
    velocity: Vector<f64, D>,
    /// (R′ Rᵀ − I) / Δt, R and R′ its rotation at start and end.
    turning: Matrix<f64, D>,
}

impl<const D: usize> Moving<D> {
    /// `collider` at time 0, standing still, on axes of these lengths if periodic.
    pub(crate) fn of(collider: &Collider<D>, period: [Option<f64>; D]) -> Self {
        let mut start = collider.at(0.0);
        start.period = period;
        Self {
            contact: collider.contact,
            moves: collider.motion != Motion::Still,
            velocity: Vector([0.0; D]),
            turning: Matrix::scaled_identity(0.0),
            end: start.clone(),
            start,
        }
    }

    /// Makes this `collider`, which it was made of, from `time` for `dt`.
    pub(crate) fn put(&mut self, collider: &Collider<D>, time: f64, dt: f64) {
        let Self { start, end, .. } = self;
        start.put(collider, time);
        end.put(collider, time + dt);
        let per_time = if dt > 0.0 { 1.0 / dt } else { 0.0 };
        self.velocity = (end.moved - start.moved) * per_time;
        self.turning = if start.turns || end.turns {
            (end.rotation * start.rotation.transpose() - Matrix::identity(1.0)) * per_time
        } else {
            Matrix::scaled_identity(0.0)
        };
    }

    /// The velocity of the collider at `x` from `base`, in units of length a second: it carries each of
    /// its points to where it is at the end of the substep.
    pub(crate) fn velocity(&self, base: [f64; D], x: Vector<f64, D>) -> Vector<f64, D> {
        if !self.moves {
            return Vector([0.0; D]);
        }
        let arm = (Vector(base) - Vector(self.start.rest)) + (x - self.start.moved);
        self.velocity + self.turning * self.start.wrapped(arm)
    }
}
