//! Shapes whose signed distance has a closed formula.

use super::volume::ball_volume;
use super::{Bounds, polygon};
use crate::math::Vector;
use core::f64::consts::PI;

/// A shape whose signed distance has a closed formula.
///
/// Colliders are unions of primitives; [`Shape`](super::Shape) builds other shapes from them.
///
/// ```
/// use lahar::geometry::Primitive;
///
/// let ball = Primitive::Ball { center: [0.0, 1.0], radius: 0.5 };
/// let (distance, normal) = ball.signed_distance([0.0, 3.0]);
/// assert_eq!((distance, normal), (1.5, [0.0, 1.0]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Primitive<const D: usize> {
    /// A box turned any way.
    Box {
        /// The middle \[m\].
        center: [f64; D],
        /// Half of each side \[m\].
        half: [f64; D],
        /// The directions of the sides: orthogonal unit vectors.
        axes: [[f64; D]; D],
    },
    /// A ball; a disc in 2D.
    Ball {
        /// The middle \[m\].
        center: [f64; D],
        /// The radius \[m\].
        radius: f64,
    },
    /// Everything on one side of a plane.
    HalfSpace {
        /// A point on the plane \[m\].
        point: [f64; D],
        /// The unit vector out of the half-space.
        normal: [f64; D],
    },
    /// Everything within a radius of the line between two points: a capsule if its ends are round, else
    /// a cylinder. In 2D it is a strip.
    Rod {
        /// One end of the line \[m\].
        from: [f64; D],
        /// The other end \[m\].
        to: [f64; D],
        /// Distance of the surface from the line \[m\].
        radius: f64,
        /// True for a capsule, which has half-balls beyond the ends of the line.
        round: bool,
    },
    /// A polygon in the first two coordinates; in 3D it has no end along the third.
    Polygon {
        /// The corners in order \[m\]: at least three, and the sides must not cross.
        points: Vec<[f64; D]>,
    },
}

impl<const D: usize> Primitive<D> {
    /// Returns the middle \[m\]; for a half-space a point on the plane, for a polygon its first corner.
    pub fn center(&self) -> [f64; D] {
        match self {
            Self::Box { center, .. } | Self::Ball { center, .. } => *center,
            Self::HalfSpace { point, .. } => *point,
            Self::Rod { from, to, .. } => core::array::from_fn(|i| 0.5 * (from[i] + to[i])),
            Self::Polygon { points } => points.first().copied().unwrap_or([0.0; D]),
        }
    }

    /// Returns the largest distance of a point of it from [`Self::center`] \[m\]; `None` for a half-space.
    /// Polygons are measured within the first two coordinates.
    pub fn reach(&self) -> Option<f64> {
        match self {
            Self::Box { half, .. } => Some(Vector(*half).norm()),
            Self::Ball { radius, .. } => Some(*radius),
            Self::HalfSpace { .. } => None,
            Self::Rod {
                from, to, radius, ..
            } => Some(0.5 * (Vector(*to) - Vector(*from)).norm() + radius),
            Self::Polygon { points } => {
                let from_first = |x: &[f64; D]| (Vector(*x) - Vector(self.center())).norm();
                Some(points.iter().map(from_first).fold(0.0, f64::max))
            }
        }
    }

    /// Returns the thickness of the thinnest part \[m\]; `None` for half-spaces and polygons.
    pub fn thickness(&self) -> Option<f64> {
        match self {
            Self::Box { half, .. } => {
                Some(2.0 * half.iter().copied().fold(f64::INFINITY, f64::min))
            }
            Self::Ball { radius, .. } | Self::Rod { radius, .. } => Some(2.0 * radius),
            Self::HalfSpace { .. } | Self::Polygon { .. } => None,
        }
    }

    /// Returns a box around it \[m\].
    pub fn bounds(&self) -> Bounds<D> {
        match self {
            Self::Box { center, half, axes } => {
                let reach = |i: usize| -> f64 {
                    (0..D).map(|axis| (axes[axis][i] * half[axis]).abs()).sum()
                };
                Bounds {
                    min: core::array::from_fn(|i| center[i] - reach(i)),
                    max: core::array::from_fn(|i| center[i] + reach(i)),
                }
            }
            Self::Ball { center, radius } => Bounds {
                min: center.map(|c| c - radius),
                max: center.map(|c| c + radius),
            },
            Self::HalfSpace { .. } => Bounds::EVERYTHING,
            Self::Rod {
                from,
                to,
                radius,
                round,
            } => {
                let squared: f64 = (0..D).map(|i| (to[i] - from[i]).powi(2)).sum();
                // Half of a flat end's extent along an axis.
                let reach = |i: usize| {
                    let along = (to[i] - from[i]).powi(2);
                    if *round || squared == 0.0 {
                        *radius
                    } else {
                        radius * (1.0 - along / squared).max(0.0).sqrt()
                    }
                };
                Bounds {
                    min: core::array::from_fn(|i| from[i].min(to[i]) - reach(i)),
                    max: core::array::from_fn(|i| from[i].max(to[i]) + reach(i)),
                }
            }
            Self::Polygon { points } => {
                let mut bounds = Bounds::around_points(points);
                for i in 2..D {
                    (bounds.min[i], bounds.max[i]) = (f64::NEG_INFINITY, f64::INFINITY);
                }
                bounds
            }
        }
    }

    /// Returns true if `p` \[m\] is inside. Points that rounding puts on the surface may count either way.
    pub fn contains(&self, p: &[f64; D]) -> bool {
        match self {
            Self::Box { center, half, axes } => {
                let y = Vector(*p) - Vector(*center);
                (0..D).all(|i| y.dot(Vector(axes[i])).abs() <= half[i])
            }
            Self::Ball { center, radius } => {
                (0..D).map(|i| (p[i] - center[i]).powi(2)).sum::<f64>() <= radius * radius
            }
            Self::HalfSpace { point, normal } => {
                (0..D).map(|i| (p[i] - point[i]) * normal[i]).sum::<f64>() <= 0.0
            }
            Self::Rod {
                from,
                to,
                radius,
                round,
            } => rod_contains(p, (from, to), *radius, *round),
            Self::Polygon { points } => polygon::contains(points, p),
        }
    }

    /// Returns the volume \[m³; m² in 2D\]; `None` for a half-space, and for a polygon in 3D, which has no end.
    pub fn volume(&self) -> Option<f64> {
        match self {
            Self::Box { half, .. } => Some(half.iter().map(|half| 2.0 * half).product()),
            Self::Ball { radius, .. } => Some(ball_volume::<D>(*radius)),
            Self::HalfSpace { .. } => None,
            Self::Rod {
                from,
                to,
                radius,
                round,
            } => {
                let length = (0..D)
                    .map(|i| (to[i] - from[i]).powi(2))
                    .sum::<f64>()
                    .sqrt();
                let section = if D == 2 {
                    2.0 * radius
                } else {
                    PI * radius * radius
                };
                let ends = if *round {
                    ball_volume::<D>(*radius)
                } else {
                    0.0
                };
                Some(section * length + ends)
            }
            Self::Polygon { points } => (D == 2).then(|| polygon::polygon_area(points).abs()),
        }
    }

    /// Returns the same primitive with all lengths divided by `unit` and counted from `origin`.
    pub(crate) fn in_units(&self, unit: f64, origin: [f64; D]) -> Self {
        let place = |x: [f64; D]| core::array::from_fn(|i| (x[i] - origin[i]) / unit);
        self.mapped(place, |v| v, 1.0 / unit)
    }

    /// Returns the primitive with its points at `place(x)`, its directions along `turned(v)` and its
    /// lengths multiplied by `factor`.
    #[must_use]
    pub fn mapped(
        &self,
        place: impl Fn([f64; D]) -> [f64; D],
        turned: impl Fn([f64; D]) -> [f64; D],
        factor: f64,
    ) -> Self {
        match self {
            Self::Box { center, half, axes } => Self::Box {
                center: place(*center),
                half: half.map(|h| h * factor),
                axes: axes.map(turned),
            },
            Self::Ball { center, radius } => Self::Ball {
                center: place(*center),
                radius: radius * factor,
            },
            Self::HalfSpace { point, normal } => Self::HalfSpace {
                point: place(*point),
                normal: turned(*normal),
            },
            Self::Rod {
                from,
                to,
                radius,
                round,
            } => Self::Rod {
                from: place(*from),
                to: place(*to),
                radius: radius * factor,
                round: *round,
            },
            Self::Polygon { points } => Self::Polygon {
                points: points.iter().copied().map(place).collect(),
            },
        }
    }

    /// Returns the distance of `p` \[m\] from the surface \[m\], negative inside, and the unit vector out of
    /// the primitive there: the gradient of the distance.
    pub fn signed_distance(&self, p: [f64; D]) -> (f64, [f64; D]) {
        let (distance, normal) = self.distance_from_center(Vector(p) - Vector(self.center()));
        (distance, normal.0)
    }

    /// [`Self::signed_distance`] at the point `y` from [`Self::center`]: exact far from the origin too.
    pub(crate) fn distance_from_center(&self, y: Vector<f64, D>) -> (f64, Vector<f64, D>) {
        match self {
            Self::Ball { radius, .. } => {
                let (r, out) = length_and_direction(y);
                (r - radius, out)
            }
            Self::HalfSpace { normal, .. } => (y.dot(Vector(*normal)), Vector(*normal)),
            Self::Box { half, axes, .. } => {
                let along = axes.map(|axis| y.dot(Vector(axis)));
                let beyond: [f64; D] = core::array::from_fn(|i| along[i].abs() - half[i]);
                let (distance, out) = distance_from_corner(beyond);
                let mut normal = Vector([0.0; D]);
                for i in 0..D {
                    normal += Vector(axes[i]) * (out[i] * along[i].signum());
                }
                (distance, normal)
            }
            Self::Rod {
                from,
                to,
                radius,
                round,
            } => {
                let (length, axis) = length_and_direction(Vector(*to) - Vector(*from));
                let along = y.dot(axis);
                let half = 0.5 * length;
                if *round {
                    let nearest = axis * along.clamp(-half, half);
                    let (r, out) = length_and_direction(y - nearest);
                    return (r - radius, out);
                }
                let (r, side) = length_and_direction(y - axis * along);
                let (distance, out) = distance_from_corner([along.abs() - half, r - radius]);
                (distance, axis * (out[0] * along.signum()) + side * out[1])
            }
            Self::Polygon { points } => polygon::signed_distance(points, y),
        }
    }
}

/// Returns true if `p` is within `radius` of the line between two points, and between its flat ends.
fn rod_contains<const D: usize>(
    p: &[f64; D],
    (from, to): (&[f64; D], &[f64; D]),
    radius: f64,
    round: bool,
) -> bool {
    let (mut along, mut squared) = (0.0, 0.0);
    for i in 0..D {
        along += (p[i] - from[i]) * (to[i] - from[i]);
        squared += (to[i] - from[i]).powi(2);
    }
    let part = if squared > 0.0 { along / squared } else { 0.0 };
    if !round && !(0.0..=1.0).contains(&part) {
        return false;
    }
    let part = part.clamp(0.0, 1.0);
    let distance = (0..D).map(|i| (p[i] - from[i] - part * (to[i] - from[i])).powi(2));
    distance.sum::<f64>() <= radius * radius
}

/// Returns |v| and v/|v|; for v = 0 the unit vector along the last axis.
fn length_and_direction<const D: usize>(v: Vector<f64, D>) -> (f64, Vector<f64, D>) {
    let length = v.norm();
    if length > 0.0 {
        (length, v * (1.0 / length))
    } else {
        (0.0, Vector::from_fn(|i| f64::from(i == D - 1)))
    }
}

/// Returns the distance from the corner at 0 of a solid that fills the negative numbers, and the unit
/// vector out of the solid.
fn distance_from_corner<const N: usize>(beyond: [f64; N]) -> (f64, [f64; N]) {
    let outside = beyond.map(|x| x.max(0.0));
    let length = outside.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 {
        return (length, outside.map(|x| x / length));
    }
    let mut nearest = 0;
    for i in 1..N {
        if beyond[i] > beyond[nearest] {
            nearest = i;
        }
    }
    (
        beyond[nearest],
        core::array::from_fn(|i| f64::from(i == nearest)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::transform::rotation;

    fn primitives() -> Vec<Primitive<3>> {
        let axes = rotation::<3>([0.3, -0.4, 0.5]).0.map(|column| column.0);
        let center = [0.1, -0.2, 0.3];
        let (from, to) = ([-0.4, 0.1, 0.2], [0.5, -0.3, 0.4]);
        let rod = |round| Primitive::Rod {
            from,
            to,
            radius: 0.3,
            round,
        };
        vec![
            Primitive::Box {
                center,
                half: [0.5, 0.3, 0.7],
                axes,
            },
            Primitive::Ball {
                center,
                radius: 0.6,
            },
            Primitive::HalfSpace {
                point: center,
                normal: axes[1],
            },
            rod(true),
            rod(false),
            Primitive::Polygon {
                // Concave, and not counter-clockwise.
                points: vec![
                    [0.5, 0.4, 0.0],
                    [0.4, -0.6, 0.0],
                    [-0.1, 0.1, 0.0],
                    [-0.7, -0.3, 0.0],
                ],
            },
        ]
    }

    /// A step along the normal by the distance ends on the surface, the normal is the gradient of the
    /// distance, and the sign of the distance agrees with `contains`.
    #[test]
    fn distance_and_normal_belong_together() {
        for primitive in primitives() {
            for n in 0..200_i32 {
                let wave = |k: i32| f64::from((37 * n + 101 * k) % 97) / 48.5 - 1.0;
                let y = Vector::<f64, 3>::from_fn(|i| wave(i as i32));
                let (distance, normal) = primitive.distance_from_center(y);
                assert!((normal.norm() - 1.0).abs() < 1e-12, "{primitive:?}");
                let (left, _) = primitive.distance_from_center(y - normal * distance);
                assert!(left.abs() < 1e-12, "{primitive:?} {y:?}: {left}");
                let p = (Vector(primitive.center()) + y).0;
                assert_eq!(
                    primitive.contains(&p),
                    distance <= 0.0,
                    "{primitive:?} {y:?}"
                );
                // There is no gradient at points from which the nearest point jumps; none of these is one.
                for i in 0..3 {
                    let mut step = Vector([0.0; 3]);
                    step[i] = 1e-6;
                    let distance = |y| primitive.distance_from_center(y).0;
                    let slope = (distance(y + step) - distance(y - step)) / 2e-6;
                    assert!((slope - normal[i]).abs() < 1e-5, "{primitive:?} {y:?}");
                }
            }
        }
    }

    /// The part of random points that are inside is the volume.
    #[test]
    fn volumes_agree_with_contains() {
        for primitive in primitives() {
            let bounds = primitive.bounds();
            let Some(volume) = primitive.volume() else {
                continue;
            };
            let n = 60_usize;
            let place = |step: usize, i: usize| {
                bounds.min[i] + bounds.side(i) * (step as f64 + 0.5) / n as f64
            };
            let inside = (0..n.pow(3))
                .map(|k| [place(k % n, 0), place(k / n % n, 1), place(k / n / n, 2)])
                .filter(|p| primitive.contains(p))
                .count();
            let counted = bounds.volume() * inside as f64 / n.pow(3) as f64;
            assert!(
                (counted / volume - 1.0).abs() < 0.01,
                "{primitive:?}: {counted} {volume}"
            );
        }
    }
}
