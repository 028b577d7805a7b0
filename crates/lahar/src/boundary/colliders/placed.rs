//! Where colliders are during a substep.

use crate::geometry::{Primitive, rotation};
use crate::math::{Matrix, Vector};
use crate::setup::{Collider, Contact, Keyframe, Motion};

impl<const D: usize> Motion<D> {
    /// Returns how far the center has moved from `center`, its place at rest, and how far the collider has turned.
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

    /// Returns the largest speed of the center, and the largest rate of turning \[rad/s\], from `time` on for `span`.
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
    /// Places the collider where it is at `time` \[s\].
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
        placed.move_to(self, time);
        placed
    }

    /// Returns a bound on the speed of its points in the box `min` .. `max`, for `span` \[s\] from `time` \[s\] on.
    pub fn largest_speed(&self, time: f64, span: f64, (min, max): ([f64; D], [f64; D])) -> f64 {
        let (speed, rate) = self.motion.speeds(time, span);
        if rate == 0.0 {
            return speed;
        }
        // Of a half-space only the part in the box counts.
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

    /// Returns the collider with all lengths counted from `origin` in units of `unit`.
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
}

/// A collider at one moment. Displacements are stored apart from places, since their sum would be rounded far from the
/// origin.
#[derive(Clone, Debug)]
pub struct Placed<const D: usize> {
    /// The place of its center at rest.
    rest: [f64; D],
    /// The displacement of its center.
    moved: Vector<f64, D>,
    rotation: Matrix<f64, D>,
    turns: bool,
    /// Its primitives at rest, each with the displacement of its middle.
    primitives: Vec<(Primitive<D>, Vector<f64, D>)>,
    /// Lengths of the axes that are periodic.
    pub(crate) period: [Option<f64>; D],
}

impl<const D: usize> Placed<D> {
    /// Moves it to where it is at `time`; `collider` is the one that it was made from.
    fn move_to(&mut self, collider: &Collider<D>, time: f64) {
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

    /// Returns the distance of `x` from the surface, negative inside, and the unit vector out of the collider. Lengths
    /// are in the unit of the collider.
    pub fn distance(&self, x: [f64; D]) -> (f64, [f64; D]) {
        let (distance, normal) = self.distance_from(x, Vector([0.0; D]));
        (distance, normal.0)
    }

    /// Returns [`Self::distance`] of the point that is at `x` from `base`.
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

    /// Returns the place of its center.
    pub(crate) fn center(&self) -> Vector<f64, D> {
        Vector(self.rest) + self.moved
    }

    /// Returns its primitives where they are.
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

    /// Returns the shortest of the periodic images of `y`.
    fn wrapped(&self, mut y: Vector<f64, D>) -> Vector<f64, D> {
        for i in 0..D {
            if let Some(period) = self.period[i] {
                y[i] -= period * (y[i] / period).round();
            }
        }
        y
    }
}

/// A collider during a substep: its places at the start and at the end, and the motion between them.
#[derive(Clone, Debug)]
pub(crate) struct Moving<const D: usize> {
    pub(crate) start: Placed<D>,
    pub(crate) end: Placed<D>,
    pub(crate) contact: Contact,
    moves: bool,
    /// The velocity of its center.
    velocity: Vector<f64, D>,
    /// (R′ Rᵀ − I) / Δt, with R and R′ its rotation at start and end.
    turning: Matrix<f64, D>,
}

impl<const D: usize> Moving<D> {
    /// Makes `collider` at time 0, standing still; `period` are the lengths of periodic axes.
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

    /// Moves it to the substep of length `dt` that begins at `time`; `collider` is the one that it was made from.
    pub(crate) fn move_to(&mut self, collider: &Collider<D>, time: f64, dt: f64) {
        let Self { start, end, .. } = self;
        start.move_to(collider, time);
        end.move_to(collider, time + dt);
        let per_time = if dt > 0.0 { 1.0 / dt } else { 0.0 };
        self.velocity = (end.moved - start.moved) * per_time;
        self.turning = if start.turns || end.turns {
            (end.rotation * start.rotation.transpose() - Matrix::identity(1.0)) * per_time
        } else {
            Matrix::scaled_identity(0.0)
        };
    }

    /// Returns the velocity of the collider at the point that is at `x` from `base`, in units of length per second. It
    /// carries each point of the collider to its place at the end of the substep.
    pub(crate) fn velocity(&self, base: [f64; D], x: Vector<f64, D>) -> Vector<f64, D> {
        if !self.moves {
            return Vector([0.0; D]);
        }
        let arm = (Vector(base) - Vector(self.start.rest)) + (x - self.start.moved);
        self.velocity + self.turning * self.start.wrapped(arm)
    }
}
