//! Volumes of balls and half-spaces cut off at a box.

use super::Bounds;
use core::f64::consts::{FRAC_PI_2, PI};

/// Returns the volume of a ball \[m³; m² in 2D\].
pub(super) fn ball_volume<const D: usize>(radius: f64) -> f64 {
    if D == 2 {
        PI * radius * radius
    } else {
        4.0 / 3.0 * PI * radius.powi(3)
    }
}

/// Intervals of Simpson's rule along an axis. The faces of the box make kinks; with so many intervals
/// the error stays below 1e-6 of the ball.
const INTERVALS: usize = 2048;

/// Returns the volume of the part of a ball in a box, integrated over slices along the last axis.
pub(super) fn clipped_ball<const D: usize>(
    center: &[f64; D],
    radius: f64,
    bounds: &Bounds<D>,
) -> f64 {
    if (0..D).any(|i| bounds.side(i) <= 0.0) {
        return 0.0;
    }
    if D == 2 {
        return clipped_disc(
            [center[0], center[1]],
            radius,
            [bounds.min[0], bounds.min[1]],
            [bounds.max[0], bounds.max[1]],
            INTERVALS,
        );
    }
    let z = D - 1;
    simpson(
        center[z],
        radius,
        bounds.min[z],
        bounds.max[z],
        INTERVALS / 4,
        |slice| {
            clipped_disc(
                [center[0], center[1]],
                slice,
                [bounds.min[0], bounds.min[1]],
                [bounds.max[0], bounds.max[1]],
                INTERVALS / 4,
            )
        },
    )
}

/// Returns the area of the part of a disc in a rectangle.
fn clipped_disc(
    center: [f64; 2],
    radius: f64,
    min: [f64; 2],
    max: [f64; 2],
    intervals: usize,
) -> f64 {
    simpson(center[1], radius, min[1], max[1], intervals, |half| {
        ((center[0] + half).min(max[0]) - (center[0] - half).max(min[0])).max(0.0)
    })
}

/// Returns ∫ f(√(r² − (y−c)²)) dy over `low..high` by Simpson's rule, with y = c + r sin θ: in θ the ends
/// of a ball are smooth.
fn simpson(
    center: f64,
    radius: f64,
    low: f64,
    high: f64,
    intervals: usize,
    f: impl Fn(f64) -> f64,
) -> f64 {
    let angle = |y: f64| {
        ((y - center) / radius)
            .clamp(-1.0, 1.0)
            .asin()
            .clamp(-FRAC_PI_2, FRAC_PI_2)
    };
    let (from, to) = (angle(low), angle(high));
    if !(to > from) {
        return 0.0;
    }
    let step = (to - from) / intervals as f64;
    let sum: f64 = (0..=intervals)
        .map(|i| {
            let cos = (from + i as f64 * step).cos().max(0.0);
            let weight = if i == 0 || i == intervals {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            };
            weight * f(radius * cos) * radius * cos
        })
        .sum();
    sum * step / 3.0
}

/// Returns the volume of the part of a half-space in a box: Σ over the corners v of
/// (−1)^|v| (c − n·v)₊ᵈ / (d! Π n). The box is mapped to the unit box, the normal is made positive, and d
/// counts the axes along which the normal has a component.
pub(super) fn half_space_volume<const D: usize>(
    point: &[f64; D],
    normal: &[f64; D],
    clip: &Bounds<D>,
) -> f64 {
    let mut c = (0..D).map(|i| point[i] * normal[i]).sum::<f64>();
    let mut slopes = Vec::new();
    for i in 0..D {
        let slope = normal[i] * clip.side(i);
        c -= normal[i]
            * if slope >= 0.0 {
                clip.min[i]
            } else {
                clip.max[i]
            };
        slopes.push(slope.abs());
    }
    let steepest = slopes.iter().fold(0.0_f64, |a, &b| a.max(b));
    for slope in slopes.iter().filter(|&&slope| slope <= 1e-7 * steepest) {
        c -= 0.5 * slope;
    }
    slopes.retain(|&slope| slope > 1e-7 * steepest);
    let d = slopes.len();
    let mut sum = 0.0;
    for bits in 0..1_usize << d {
        let reach: f64 = (0..d)
            .filter(|i| bits >> i & 1 == 1)
            .map(|i| slopes[i])
            .sum();
        let sign = if bits.count_ones() % 2 == 0 {
            1.0
        } else {
            -1.0
        };
        sum += sign * (c - reach).max(0.0).powi(d as i32);
    }
    let below: f64 = (1..=d).map(|i| i as f64).product::<f64>() * slopes.iter().product::<f64>();
    clip.volume() * (sum / below).clamp(0.0, 1.0)
}

/// Returns the smallest box around the part of a half-space in a box: around the corners inside, and the
/// points where edges cross the plane.
pub(super) fn half_space_bounds<const D: usize>(
    point: &[f64; D],
    normal: &[f64; D],
    clip: &Bounds<D>,
) -> Bounds<D> {
    let height = |p: &[f64; D]| (0..D).map(|i| (p[i] - point[i]) * normal[i]).sum::<f64>();
    let mut bounds = Bounds {
        min: [f64::INFINITY; D],
        max: [f64::NEG_INFINITY; D],
    };
    let mut take = |p: [f64; D]| {
        for i in 0..D {
            bounds.min[i] = bounds.min[i].min(p[i]);
            bounds.max[i] = bounds.max[i].max(p[i]);
        }
    };
    for corner in clip.corners() {
        let here = height(&corner);
        if here > 0.0 {
            continue;
        }
        take(corner);
        for i in 0..D {
            let mut other = corner;
            other[i] = clip.min[i] + clip.max[i] - corner[i];
            let there = height(&other);
            if there > 0.0 {
                other[i] = corner[i] + (other[i] - corner[i]) * here / (here - there);
                take(other);
            }
        }
    }
    bounds
}
