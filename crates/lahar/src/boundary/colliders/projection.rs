//! Particles inside of colliders are projected out.

use super::placed::Moving;
use crate::math::Vector;

/// Particles less deep inside than this \[cells\] stay where they are: rounding puts them there.
const SKIN: f64 = 1e-6;

/// How often a particle between several colliders and walls is projected out of each of them, one after the other.
const ROUNDS: usize = 8;

/// Projects a particle inside any of `colliders` onto its surface, and removes the inward part of its velocity. Returns
/// true if it was inside one.
///
/// The particle is at `x` from `base`, in cells, at the end of the substep, and has velocity `v` \[m/s\]. `bounds` are
/// [`Walls::bounds`](crate::boundary::walls::Walls); `dx` is in m. Calls `change(number of the collider, place, change of
/// v)` for each change of velocity.
pub(crate) fn project_out<const D: usize>(
    colliders: &[Moving<D>],
    bounds: &[(Option<f64>, Option<f64>); D],
    base: [f64; D],
    (x, v): (&mut Vector<f64, D>, &mut Vector<f64, D>),
    dx: f64,
    mut change: impl FnMut(usize, Vector<f64, D>, Vector<f64, D>),
) -> bool {
    let mut was_inside = false;
    for _ in 0..ROUNDS {
        let mut is_inside = false;
        for (number, collider) in colliders.iter().enumerate() {
            let (distance, n) = collider.end.distance_from(base, *x);
            if !(distance < -SKIN) {
                continue;
            }
            is_inside = true;
            *x -= n * distance;
            let into = (*v - collider.velocity(base, *x) * dx).dot(n).min(0.0);
            *v -= n * into;
            change(number, Vector(base) + *x, n * -into);
        }
        if !is_inside {
            break;
        }
        was_inside = true;
        for axis in 0..D {
            let (low, high) = bounds[axis];
            x[axis] = x[axis]
                .max(low.map_or(f64::NEG_INFINITY, |low| low - base[axis]))
                .min(high.map_or(f64::INFINITY, |high| high - base[axis]));
        }
    }
    was_inside
}
