//! The space that a body fills: a shape, cut off at the domain.

use core::f64::consts::{FRAC_PI_2, PI};

/// A shape in `D` dimensions.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape<const D: usize> {
    /// A box along the axes.
    Box {
        /// Lower corner \[m\].
        min: [f64; D],
        /// Upper corner \[m\].
        max: [f64; D],
    },
    /// A ball; a disc in 2D.
    Ball {
        /// Its centre \[m\].
        center: [f64; D],
        /// Its radius \[m\].
        radius: f64,
    },
    /// All on one side of a plane.
    HalfSpace {
        /// A point on the plane \[m\].
        point: [f64; D],
        /// Unit vector out of the body.
        normal: [f64; D],
    },
    /// A polygon in the first two coordinates.
    Polygon {
        /// Its corners in order \[m\].
        points: Vec<[f64; D]>,
    },
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const D: usize> {
    /// Lower corner \[m\].
    pub min: [f64; D],
    /// Upper corner \[m\].
    pub max: [f64; D],
}

impl<const D: usize> Bounds<D> {
    /// All of space.
    pub const EVERYTHING: Self = Self {
        min: [f64::NEG_INFINITY; D],
        max: [f64::INFINITY; D],
    };

    /// The smallest box around all of `boxes`.
    pub(crate) fn around(boxes: &[Self]) -> Self {
        let nothing = Self {
            min: [f64::INFINITY; D],
            max: [f64::NEG_INFINITY; D],
        };
        boxes.iter().fold(nothing, |sum, b| Self {
            min: core::array::from_fn(|i| sum.min[i].min(b.min[i])),
            max: core::array::from_fn(|i| sum.max[i].max(b.max[i])),
        })
    }

    /// What both have; its sides may be negative.
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            min: core::array::from_fn(|i| self.min[i].max(other.min[i])),
            max: core::array::from_fn(|i| self.max[i].min(other.max[i])),
        }
    }

    /// Whether `p` is inside or on the surface.
    pub fn contains(&self, p: &[f64; D]) -> bool {
        (0..D).all(|i| self.min[i] <= p[i] && p[i] <= self.max[i])
    }

    /// Length along axis `i` \[m\]; 0 if there is none.
    pub fn side(&self, i: usize) -> f64 {
        (self.max[i] - self.min[i]).max(0.0)
    }

    /// Product of the sides \[m³; m² in 2D\].
    pub fn volume(&self) -> f64 {
        (0..D).map(|i| self.side(i)).product()
    }

    /// Whether `other` lies in it.
    pub fn encloses(&self, other: &Self) -> bool {
        self.contains(&other.min) && self.contains(&other.max)
    }

    /// The 2ᴰ corners \[m\].
    fn corners(&self) -> impl Iterator<Item = [f64; D]> + '_ {
        (0..1_usize << D).map(|bits| {
            core::array::from_fn(|i| {
                if bits >> i & 1 == 0 {
                    self.min[i]
                } else {
                    self.max[i]
                }
            })
        })
    }
}

impl<const D: usize> Shape<D> {
    /// The smallest box around it \[m\].
    pub fn bounds(&self) -> Bounds<D> {
        match self {
            Self::Box { min, max } => Bounds {
                min: *min,
                max: *max,
            },
            Self::Ball { center, radius } => Bounds {
                min: center.map(|c| c - radius),
                max: center.map(|c| c + radius),
            },
            Self::HalfSpace { .. } => Bounds::EVERYTHING,
            Self::Polygon { points } => points.iter().fold(
                Bounds {
                    min: [f64::INFINITY; D],
                    max: [f64::NEG_INFINITY; D],
                },
                |b, p| Bounds {
                    min: core::array::from_fn(|i| b.min[i].min(p[i])),
                    max: core::array::from_fn(|i| b.max[i].max(p[i])),
                },
            ),
        }
    }

    /// Whether `p` is inside.
    pub fn contains(&self, p: &[f64; D]) -> bool {
        match self {
            Self::Box { min, max } => Bounds {
                min: *min,
                max: *max,
            }
            .contains(p),
            Self::Ball { center, radius } => {
                (0..D).map(|i| (p[i] - center[i]).powi(2)).sum::<f64>() <= radius * radius
            }
            Self::HalfSpace { point, normal } => {
                (0..D).map(|i| (p[i] - point[i]) * normal[i]).sum::<f64>() <= 0.0
            }
            Self::Polygon { points } => in_polygon(points, p),
        }
    }
}

/// A shape cut off at a box.
#[derive(Clone, Debug)]
pub struct Region<const D: usize> {
    shape: Shape<D>,
    clip: Bounds<D>,
    bounds: Bounds<D>,
    volume: f64,
}

impl<const D: usize> Region<D> {
    /// The part of `shape` inside `clip`.
    pub fn new(shape: Shape<D>, clip: Bounds<D>) -> Self {
        let whole = shape.bounds();
        let mut bounds = whole.intersection(&clip);
        let inside = clip.encloses(&whole);
        let volume = match &shape {
            Shape::Box { .. } => bounds.volume(),
            Shape::Ball { center, radius } if inside => ball_volume::<D>(*radius, center),
            Shape::Ball { center, radius } => clipped_ball(center, *radius, &bounds),
            Shape::HalfSpace { point, normal } => {
                bounds = half_space_bounds(point, normal, &clip);
                half_space_volume(point, normal, &clip)
            }
            Shape::Polygon { points } => area(&clip_polygon(points, &clip)).abs(),
        };
        Self {
            shape,
            clip,
            bounds,
            volume,
        }
    }

    /// The shape before it was cut.
    pub fn shape(&self) -> &Shape<D> {
        &self.shape
    }

    /// A box around it \[m\]; the smallest but for cut balls and polygons.
    pub fn bounds(&self) -> &Bounds<D> {
        &self.bounds
    }

    /// Its volume \[m³; m² in 2D\]: exact, but for balls that are cut (1e-6 of the whole).
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Whether something was cut off (a half-space always is, and does not count).
    pub fn is_cut(&self) -> bool {
        !matches!(self.shape, Shape::HalfSpace { .. }) && !self.clip.encloses(&self.shape.bounds())
    }

    /// Whether `p` is inside.
    pub fn contains(&self, p: &[f64; D]) -> bool {
        self.clip.contains(p) && self.shape.contains(p)
    }
}

fn ball_volume<const D: usize>(radius: f64, _: &[f64; D]) -> f64 {
    if D == 2 {
        PI * radius * radius
    } else {
        4.0 / 3.0 * PI * radius.powi(3)
    }
}

/// Intervals of Simpson's rule along an axis: errors below 1e-6 of the ball with the kinks that
/// faces of the box make.
const INTERVALS: usize = 2048;

/// Volume of the ball in the box, by slices along the last axis.
fn clipped_ball<const D: usize>(center: &[f64; D], radius: f64, bounds: &Bounds<D>) -> f64 {
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

/// ∫ f(√(r² − (y−c)²)) dy over `low..high`, in y = c + r sin θ, where the ends of a ball are smooth.
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

/// Volume of a half-space in a box: Σ over corners v of (−1)^|v| (c − n·v)₊ᵈ / (d! Π n), over the d
/// axes that the normal leans to, the box mapped to the unit box and the normal made positive.
fn half_space_volume<const D: usize>(point: &[f64; D], normal: &[f64; D], clip: &Bounds<D>) -> f64 {
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

/// The smallest box around a half-space in a box: around the corners inside and the points where
/// edges cross the plane.
fn half_space_bounds<const D: usize>(
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

fn in_polygon<const D: usize>(points: &[[f64; D]], p: &[f64; D]) -> bool {
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

/// Sutherland and Hodgman: parts that a concave polygon falls into stay joined by edges along the
/// box, which have no area.
fn clip_polygon<const D: usize>(points: &[[f64; D]], clip: &Bounds<D>) -> Vec<[f64; D]> {
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

/// Area of a polygon \[m²\], positive if counter-clockwise.
pub(crate) fn area<const D: usize>(points: &[[f64; D]]) -> f64 {
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

/// The first two sides of a polygon that cross, by the numbers of their first corners.
pub(crate) fn crossing<const D: usize>(points: &[[f64; D]]) -> Option<(usize, usize)> {
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

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Bounds<2> = Bounds {
        min: [0.0, 0.0],
        max: [1.0, 1.0],
    };
    const CUBE: Bounds<3> = Bounds {
        min: [0.0; 3],
        max: [1.0; 3],
    };

    fn volume<const D: usize>(shape: Shape<D>, clip: Bounds<D>) -> f64 {
        Region::new(shape, clip).volume()
    }

    #[test]
    fn volumes() {
        let close =
            |a: f64, b: f64, tolerance: f64| assert!((a - b).abs() < tolerance, "{a} is not {b}");
        close(
            volume(
                Shape::Box {
                    min: [-1.0, 0.5],
                    max: [0.5, 2.0],
                },
                UNIT,
            ),
            0.25,
            1e-15,
        );
        close(
            volume(
                Shape::Ball {
                    center: [0.5, 0.5],
                    radius: 0.5,
                },
                UNIT,
            ),
            PI / 4.0,
            1e-12,
        );
        close(
            volume(
                Shape::Ball {
                    center: [0.0, 0.0],
                    radius: 0.5,
                },
                UNIT,
            ),
            PI / 16.0,
            1e-6,
        );
        close(
            volume(
                Shape::Ball {
                    center: [0.0, 0.5],
                    radius: 0.5,
                },
                UNIT,
            ),
            PI / 8.0,
            1e-6,
        );
        close(
            volume(
                Shape::Ball {
                    center: [0.0; 3],
                    radius: 1.0,
                },
                CUBE,
            ),
            PI / 6.0,
            1e-5,
        );
        close(
            volume(
                Shape::Ball {
                    center: [0.5, 0.5],
                    radius: 5.0,
                },
                UNIT,
            ),
            1.0,
            1e-6,
        );
        close(
            volume(
                Shape::HalfSpace {
                    point: [0.0, 0.25],
                    normal: [0.0, 1.0],
                },
                UNIT,
            ),
            0.25,
            1e-12,
        );
        let tilted = [0.6, 0.8];
        close(
            volume(
                Shape::HalfSpace {
                    point: [0.5, 0.5],
                    normal: tilted,
                },
                UNIT,
            ),
            0.5,
            1e-12,
        );
        close(
            volume(
                Shape::HalfSpace {
                    point: [0.0, 1.0],
                    normal: [-0.6, -0.8],
                },
                UNIT,
            ),
            0.375,
            1e-12,
        );
        let third = 1.0 / 3.0_f64.sqrt();
        close(
            volume(
                Shape::HalfSpace {
                    point: [1.0, 0.0, 0.0],
                    normal: [third; 3],
                },
                CUBE,
            ),
            1.0 / 6.0,
            1e-12,
        );
        close(
            volume(
                Shape::HalfSpace {
                    point: [0.0, -1.0],
                    normal: [0.0, 1.0],
                },
                UNIT,
            ),
            0.0,
            1e-12,
        );
        let arrow = vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.25], [0.5, 2.0]];
        close(
            volume(
                Shape::Polygon {
                    points: arrow.clone(),
                },
                Bounds::EVERYTHING,
            ),
            area(&arrow).abs(),
            1e-15,
        );
        close(
            volume(
                Shape::Polygon {
                    points: vec![[-1.0, -1.0], [2.0, -1.0], [2.0, 0.5], [-1.0, 0.5]],
                },
                UNIT,
            ),
            0.5,
            1e-12,
        );
    }

    #[test]
    fn half_space_bounds_are_tight() {
        let region = Region::new(
            Shape::HalfSpace {
                point: [0.5, 0.0],
                normal: [0.6, 0.8],
            },
            UNIT,
        );
        let bounds = region.bounds();
        assert!(
            (bounds.max[0] - 0.5).abs() < 1e-12 && (bounds.max[1] - 0.375).abs() < 1e-12,
            "{bounds:?}"
        );
    }

    #[test]
    fn crossing_sides_are_found() {
        assert_eq!(
            crossing(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
            None
        );
        assert!(crossing(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]).is_some());
    }
}
