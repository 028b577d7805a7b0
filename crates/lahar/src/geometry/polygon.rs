//! Polygons in the first two coordinates: area, inside test, clipping, signed distance.

use super::Bounds;
use crate::math::Vector;

/// Returns the area of a polygon \[m²\], positive if its corners run counter-clockwise.
///
/// ```
/// use lahar::geometry::polygon_area;
///
/// assert_eq!(polygon_area(&[[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]), 1.0);
/// ```
pub fn polygon_area<const D: usize>(points: &[[f64; D]]) -> f64 {
    let Some(origin) = points.first() else {
        return 0.0;
    };
    (0..points.len())
        .map(|i| {
            let (a, b) = (points[i], points[(i + 1) % points.len()]);
            0.5 * ((a[0] - origin[0]) * (b[1] - origin[1])
                - (b[0] - origin[0]) * (a[1] - origin[1]))
        })
        .sum()
}

/// Returns the first two sides of a polygon that cross each other, by the numbers of their first
/// corners; `None` if no sides cross. Takes n² / 2 tests for n corners.
pub fn crossing_sides<const D: usize>(points: &[[f64; D]]) -> Option<(usize, usize)> {
    let n = points.len();
    let turn = |a: [f64; D], b: [f64; D], c: [f64; D]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    for i in 0..n {
        for j in i + 2..n {
            if i == 0 && j == n - 1 {
                continue;
            }
            let (a, b, c, d) = (points[i], points[i + 1], points[j], points[(j + 1) % n]);
            if turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0 {
                return Some((i, j));
            }
        }
    }
    None
}

/// Returns true if `p` is inside the polygon: a ray along +x crosses its sides an odd number of times.
pub(super) fn contains<const D: usize>(points: &[[f64; D]], p: &[f64; D]) -> bool {
    let mut inside = false;
    let mut before = points.len().wrapping_sub(1);
    for i in 0..points.len() {
        let (a, b) = (points[i], points[before]);
        if (a[1] > p[1]) != (b[1] > p[1])
            && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]
        {
            inside = !inside;
        }
        before = i;
    }
    inside
}

/// Cuts a polygon off at a box (Sutherland and Hodgman). The parts that a concave polygon falls into
/// stay joined by edges along the box, which have no area.
pub(super) fn clip<const D: usize>(points: &[[f64; D]], clip: &Bounds<D>) -> Vec<[f64; D]> {
    let mut points = points.to_vec();
    for (axis, sign, at) in [
        (0, 1.0, clip.min[0]),
        (0, -1.0, clip.max[0]),
        (1, 1.0, clip.min[1]),
        (1, -1.0, clip.max[1]),
    ] {
        if !at.is_finite() {
            continue;
        }
        let depth = |p: &[f64; D]| sign * (p[axis] - at);
        let mut kept = Vec::new();
        for i in 0..points.len() {
            let (a, b) = (points[i], points[(i + 1) % points.len()]);
            let (da, db) = (depth(&a), depth(&b));
            if da >= 0.0 {
                kept.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                kept.push(core::array::from_fn(|k| {
                    a[k] + (b[k] - a[k]) * da / (da - db)
                }));
            }
        }
        points = kept;
    }
    points
}

/// Returns the distance from the outline, negative inside, and the unit vector out of the polygon, at
/// the point `y` from the first corner.
pub(super) fn signed_distance<const D: usize>(
    points: &[[f64; D]],
    y: Vector<f64, D>,
) -> (f64, Vector<f64, D>) {
    let corner = |i: usize| {
        let (point, first) = (points[i % points.len()], points[0]);
        [point[0] - first[0], point[1] - first[1]]
    };
    let (mut nearest, mut squared) = ([0.0; 2], f64::INFINITY);
    let (mut inside, mut area, mut side) = (false, 0.0, [0.0; 2]);
    for i in 0..points.len() {
        let (a, b) = (corner(i), corner(i + 1));
        let (along, from) = ([b[0] - a[0], b[1] - a[1]], [y[0] - a[0], y[1] - a[1]]);
        let length = along[0] * along[0] + along[1] * along[1];
        let part = (from[0] * along[0] + from[1] * along[1]) / length.max(f64::MIN_POSITIVE);
        let part = part.clamp(0.0, 1.0);
        let away = [from[0] - part * along[0], from[1] - part * along[1]];
        let found = away[0] * away[0] + away[1] * away[1];
        if found < squared {
            (nearest, squared, side) = (away, found, along);
        }
        // Crossings of the ray along +x.
        if (a[1] > y[1]) != (b[1] > y[1]) {
            inside ^= y[0] < a[0] + (y[1] - a[1]) * along[0] / along[1];
        }
        area += a[0] * b[1] - a[1] * b[0];
    }
    let distance = squared.sqrt();
    let sign = if inside { -1.0 } else { 1.0 };
    let mut out = Vector([0.0; D]);
    if distance > 0.0 {
        (out[0], out[1]) = (sign * nearest[0] / distance, sign * nearest[1] / distance);
    } else {
        // On a side, the normal is across it; the sense of the corners tells which way is out.
        let length = (side[0] * side[0] + side[1] * side[1]).sqrt() * area.signum();
        (out[0], out[1]) = (side[1] / length, -side[0] / length);
    }
    (sign * distance, out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_sides_are_found() {
        assert_eq!(
            crossing_sides(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
            None
        );
        assert!(crossing_sides(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]).is_some());
    }
}
