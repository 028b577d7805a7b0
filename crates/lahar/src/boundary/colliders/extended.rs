//! Colliders that stand on a side of the domain are extended beyond it.
//!
//! ```text
//!   │   ●──▶ out     A node at the foot of a box: the face that the box stands on is the nearest one, and out of it
//!   │   ▼            is down, into the floor.
//!  ─┴─────────────   floor
//! ```
//! A flat face on a wall, or beyond it, meets no material. So it is moved out until no point inside the domain is nearer
//! to it than to the other faces.

use crate::boundary::walls::{Side, Walls};
use crate::geometry::Primitive;
use crate::math::Vector;
use crate::setup::{Collider, Motion};

/// The largest distance of a face from the side that it stands on \[cells\].
const TOUCHES: f64 = 1e-6;

/// A face is parallel to a side if the cosine of the angle between them is at least this.
const PARALLEL: f64 = 1.0 - 1e-12;

impl Side {
    /// Returns how far `x` is beyond the side; negative inside the domain.
    fn depth<const D: usize>(&self, x: [f64; D]) -> f64 {
        (x[self.axis] - self.at) * self.out
    }

    /// Returns true if `direction` points straight out of the domain.
    fn is_faced<const D: usize>(&self, direction: Vector<f64, D>) -> bool {
        direction[self.axis] * self.out >= PARALLEL
    }
}

impl<const D: usize> Collider<D> {
    /// Extends the primitives that stand on a side of the domain beyond that side; lengths are in cells. A face that leaves
    /// its side, since the collider moves, stays where it is.
    pub(crate) fn extended(mut self, walls: &Walls<D>) -> Self {
        for side in walls
            .ends()
            .filter(|side| self.motion.stays_on(side.axis, &self.center))
        {
            for primitive in &mut self.primitives {
                primitive.extend(side);
            }
        }
        self
    }
}

impl<const D: usize> Motion<D> {
    /// Returns true if points on a plane across `axis` never leave it.
    fn stays_on(&self, axis: usize, center: &[f64; D]) -> bool {
        let turns_in_it = |turn: &[f64; 3]| (0..3).all(|i| i == axis || turn[i] == 0.0);
        match self {
            Self::Still => true,
            Self::Steady { velocity, spin } => velocity[axis] == 0.0 && turns_in_it(spin),
            Self::Keyframes(frames) => frames
                .iter()
                .all(|frame| frame.position[axis] == center[axis] && turns_in_it(&frame.turn)),
        }
    }
}

impl<const D: usize> Primitive<D> {
    /// Moves each flat face that stands on `side`, or beyond it, and faces out of it. It is moved so far that it is not
    /// the nearest face for any point inside the domain.
    fn extend(&mut self, side: Side) {
        match self {
            Self::Box { center, half, axes } => {
                for face in 0..D {
                    let axis = Vector(axes[face]);
                    for sign in [-1.0, 1.0] {
                        let out = axis * sign;
                        let depth = side.depth((Vector(*center) + out * half[face]).0);
                        // The largest distance of a point inside from all other faces.
                        let needed = (0..D)
                            .filter(|&i| i != face)
                            .map(|i| half[i])
                            .fold(f64::INFINITY, f64::min);
                        if side.is_faced(out) && -TOUCHES <= depth && depth < needed {
                            *center = (Vector(*center) + out * (0.5 * needed)).0;
                            half[face] += 0.5 * needed;
                        }
                    }
                }
            }
            Self::Rod {
                from,
                to,
                radius,
                round: false,
            } => {
                let along = Vector(*to) - Vector(*from);
                let axis = along * (1.0 / along.norm());
                for (end, out) in [(from, -axis), (to, axis)] {
                    let depth = side.depth(*end);
                    if side.is_faced(out) && -TOUCHES <= depth && depth < *radius {
                        *end = (Vector(*end) + out * *radius).0;
                    }
                }
            }
            Self::Polygon { points } => *points = extended_polygon(points, side),
            // These have no flat face that ends.
            Self::Ball { .. } | Self::HalfSpace { .. } | Self::Rod { round: true, .. } => {}
        }
    }
}

/// Returns the polygon with a foot below each stretch of its outline that is on `side` or beyond it.
fn extended_polygon<const D: usize>(points: &[[f64; D]], side: Side) -> Vec<[f64; D]> {
    if side.axis >= 2 {
        return points.to_vec();
    }
    let extent = |axis: usize| {
        let on_axis = || points.iter().map(|point| point[axis]);
        on_axis().fold(f64::NEG_INFINITY, f64::max) - on_axis().fold(f64::INFINITY, f64::min)
    };
    // The largest distance of a point inside from the edges that are not on the side.
    let needed = extent(1 - side.axis);
    let n = points.len();
    let is_beyond = |i: usize| side.depth(points[i % n]) >= -TOUCHES;
    let mut extended = Vec::with_capacity(n + 2);
    for (i, &point) in points.iter().enumerate() {
        let (before, after) = (is_beyond(i + n - 1), is_beyond(i + 1));
        if !is_beyond(i) || !(before || after) {
            extended.push(point);
            continue;
        }
        let mut foot = point;
        foot[side.axis] = side.at + side.out * side.depth(point).max(0.0) + side.out * needed;
        match (before, after) {
            (false, _) => extended.extend([point, foot]),
            (_, false) => extended.extend([foot, point]),
            _ => extended.push(foot),
        }
    }
    extended
}
