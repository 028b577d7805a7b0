//! Colliders that stand on a side of the domain go on beyond it.
//!
//! ```text
//!   │   ●──▶ out     a node at the foot of a box: nearest is the face that it stands on, and out would be down,
//!   │   ▼            into the floor
//!  ─┴─────────────   floor
//! ```
//! A flat face on a wall, or beyond it, meets no material. So it is moved out until no point inside of the domain is
//! nearer to it than to the others.

use super::collider::{Collider, Motion};
use super::walls::Walls;
use crate::geometry::Primitive;
use crate::math::Vector;

/// A face is on a side if it is no farther from it than this \[cells\].
const TOUCHES: f64 = 1e-6;

/// Cosine of the angle from which on a face is parallel to a side.
const PARALLEL: f64 = 1.0 - 1e-12;

/// A side of the domain, in cells from the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    pub(crate) axis: usize,
    /// Its place on `axis`.
    pub(crate) at: f64,
    /// +1 if the domain is below it, else −1.
    pub(crate) out: f64,
}

impl Side {
    /// How far `x` is beyond it; negative inside of the domain.
    fn depth<const D: usize>(&self, x: [f64; D]) -> f64 {
        (x[self.axis] - self.at) * self.out
    }

    /// Whether `direction` points straight out of it.
    fn is_faced<const D: usize>(&self, direction: Vector<f64, D>) -> bool {
        direction[self.axis] * self.out >= PARALLEL
    }
}

impl<const D: usize> Collider<D> {
    /// With what of its primitives stands on a side of the domain going on beyond that; lengths in cells. A face that
    /// leaves its side, since the collider moves, is left where it is.
    pub(crate) fn rooted(mut self, walls: &Walls<D>) -> Self {
        for side in walls
            .ends()
            .filter(|side| self.motion.stays_on(side.axis, &self.center))
        {
            for primitive in &mut self.primitives {
                primitive.root(side);
            }
        }
        self
    }
}

impl<const D: usize> Motion<D> {
    /// Whether points that are on a plane across `axis` never leave it.
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
    /// Moves a flat face that looks out of `side`, from it or from beyond it, out so far that it is not the nearest
    /// one for any point inside of the domain.
    fn root(&mut self, side: Side) {
        match self {
            Self::Box { center, half, axes } => {
                for face in 0..D {
                    let axis = Vector(axes[face]);
                    for sign in [-1.0, 1.0] {
                        let out = axis * sign;
                        let depth = side.depth((Vector(*center) + out * half[face]).0);
                        // No point is farther from all others.
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
            Self::Polygon { points } => *points = rooted_polygon(points, side),
            // They have no flat face that ends.
            Self::Ball { .. } | Self::HalfSpace { .. } | Self::Rod { round: true, .. } => {}
        }
    }
}

/// The polygon with a foot under each stretch of its outline that is on `side` or beyond it.
fn rooted_polygon<const D: usize>(points: &[[f64; D]], side: Side) -> Vec<[f64; D]> {
    if side.axis >= 2 {
        return points.to_vec();
    }
    let extent = |axis: usize| {
        let on_axis = || points.iter().map(|point| point[axis]);
        on_axis().fold(f64::NEG_INFINITY, f64::max) - on_axis().fold(f64::INFINITY, f64::min)
    };
    // No point inside is farther from what is not on the side.
    let needed = extent(1 - side.axis);
    let n = points.len();
    let is_beyond = |i: usize| side.depth(points[i % n]) >= -TOUCHES;
    let mut rooted = Vec::with_capacity(n + 2);
    for (i, &point) in points.iter().enumerate() {
        let (before, after) = (is_beyond(i + n - 1), is_beyond(i + 1));
        if !is_beyond(i) || !(before || after) {
            rooted.push(point);
            continue;
        }
        let mut foot = point;
        foot[side.axis] = side.at + side.out * side.depth(point).max(0.0) + side.out * needed;
        match (before, after) {
            (false, _) => rooted.extend([point, foot]),
            (_, false) => rooted.extend([foot, point]),
            _ => rooted.push(foot),
        }
    }
    rooted
}
