//! Shapes of colliders: how far a point is from their surface, and which way is out.

use crate::math::{Matrix, Vector};

/// A simple shape at rest.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid<const D: usize> {
    /// A box.
    Box {
        /// Its middle \[m\].
        center: [f64; D],
        /// Half of its sides \[m\].
        half: [f64; D],
        /// The directions of its sides: orthogonal unit vectors.
        axes: [[f64; D]; D],
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
        /// Unit vector out of it.
        normal: [f64; D],
    },
    /// All within a radius of a line between two points; its ends are round if it is a capsule, else
    /// flat.
    Rod {
        /// One end \[m\].
        from: [f64; D],
        /// The other \[m\].
        to: [f64; D],
        /// Distance of the surface from the line \[m\].
        radius: f64,
        /// Whether there are half-balls beyond the ends.
        round: bool,
    },
    /// A polygon in the first two coordinates, without end along a third.
    Polygon {
        /// Its corners in order \[m\]; at least three, sides must not cross.
        points: Vec<[f64; D]>,
    },
}

impl<const D: usize> Solid<D> {
    /// Its middle; a point on the plane for a half-space, the first corner of a polygon.
    pub fn center(&self) -> [f64; D] {
        match self {
            Self::Box { center, .. } | Self::Ball { center, .. } => *center,
            Self::HalfSpace { point, .. } => *point,
            Self::Rod { from, to, .. } => core::array::from_fn(|i| 0.5 * (from[i] + to[i])),
            Self::Polygon { points } => points.first().copied().unwrap_or([0.0; D]),
        }
    }

    /// How far its farthest point is from [`Self::center`]; `None` for a half-space.
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

    /// The thickness of its thinnest part; `None` for half-spaces and polygons.
    pub fn thickness(&self) -> Option<f64> {
        match self {
            Self::Box { half, .. } => {
                Some(2.0 * half.iter().copied().fold(f64::INFINITY, f64::min))
            }
            Self::Ball { radius, .. } | Self::Rod { radius, .. } => Some(2.0 * radius),
            Self::HalfSpace { .. } | Self::Polygon { .. } => None,
        }
    }

    /// All lengths divided by `unit` and counted from `origin`.
    pub(crate) fn in_units(&self, unit: f64, origin: [f64; D]) -> Self {
        let place = |x: [f64; D]| core::array::from_fn(|i| (x[i] - origin[i]) / unit);
        self.mapped(place, |v| v, 1.0 / unit)
    }

    /// The solid with its points at `place(x)`, its directions along `turned(v)` and its lengths times
    /// `factor`.
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

    /// Distance from the surface, negative inside, and the unit vector out of the shape, of the point
    /// at `y` from [`Self::center`].
    pub(crate) fn distance(&self, y: Vector<f64, D>) -> (f64, Vector<f64, D>) {
        match self {
            Self::Ball { radius, .. } => {
                let (r, out) = length_and_direction(y);
                (r - radius, out)
            }
            Self::HalfSpace { normal, .. } => (y.dot(Vector(*normal)), Vector(*normal)),
            Self::Box { half, axes, .. } => {
                let along = axes.map(|axis| y.dot(Vector(axis)));
                let beyond: [f64; D] = core::array::from_fn(|i| along[i].abs() - half[i]);
                let (distance, out) = corner(beyond);
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
                let (distance, out) = corner([along.abs() - half, r - radius]);
                (distance, axis * (out[0] * along.signum()) + side * out[1])
            }
            Self::Polygon { points } => polygon_distance(points, y),
        }
    }
}

/// [`Solid::distance`] of a polygon, `y` from its first corner.
fn polygon_distance<const D: usize>(
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
        // Crossings of the ray to the right.
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
        // On a side: across it, out by the sense of the corners.
        let length = (side[0] * side[0] + side[1] * side[1]).sqrt() * area.signum();
        (out[0], out[1]) = (side[1] / length, -side[0] / length);
    }
    (sign * distance, out)
}

/// |v| and v/|v|; some unit vector if v = 0.
fn length_and_direction<const D: usize>(v: Vector<f64, D>) -> (f64, Vector<f64, D>) {
    let length = v.norm();
    if length > 0.0 {
        (length, v * (1.0 / length))
    } else {
        (0.0, Vector::from_fn(|i| f64::from(i == D - 1)))
    }
}

/// Distance from the corner where all numbers are zero, with the solid where all are negative, and
/// the unit vector out of it.
fn corner<const N: usize>(beyond: [f64; N]) -> (f64, [f64; N]) {
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

/// The rotation by the angle |`turn`| \[rad\] about the direction of `turn`, counter-clockwise
/// (Rodrigues): R = cos I + (1 − cos) n nᵀ + sin \[n\]×. In 2D the third component is the angle.
pub(crate) fn rotation<const D: usize>(turn: [f64; 3]) -> Matrix<f64, D> {
    let angle = Vector(turn).norm();
    let n = turn.map(|t| if angle > 0.0 { t / angle } else { 0.0 });
    let (sin, cos) = libm::sincos(angle);
    let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    Matrix::from_fn(|i, j| {
        let unit = if i == j { cos } else { 0.0 };
        unit + (1.0 - cos) * n[i] * n[j] + sin * cross[i][j]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solids() -> Vec<Solid<3>> {
        let axes = rotation::<3>([0.3, -0.4, 0.5]).0.map(|column| column.0);
        let center = [0.1, -0.2, 0.3];
        let (from, to) = ([-0.4, 0.1, 0.2], [0.5, -0.3, 0.4]);
        let rod = |round| Solid::Rod {
            from,
            to,
            radius: 0.3,
            round,
        };
        vec![
            Solid::Box {
                center,
                half: [0.5, 0.3, 0.7],
                axes,
            },
            Solid::Ball {
                center,
                radius: 0.6,
            },
            Solid::HalfSpace {
                point: center,
                normal: axes[1],
            },
            rod(true),
            rod(false),
            Solid::Polygon {
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

    /// A step along the normal of the length of the distance ends on the surface, and the normal is
    /// the distance's gradient.
    #[test]
    fn distance_and_normal_belong_together() {
        for solid in solids() {
            for n in 0..200_i32 {
                let wave = |k: i32| f64::from((37 * n + 101 * k) % 97) / 48.5 - 1.0;
                let y = Vector::<f64, 3>::from_fn(|i| wave(i as i32));
                let (distance, normal) = solid.distance(y);
                assert!((normal.norm() - 1.0).abs() < 1e-12, "{solid:?}");
                let (left, _) = solid.distance(y - normal * distance);
                assert!(left.abs() < 1e-12, "{solid:?} {y:?}: {left}");
                // Where the nearest point jumps there is no gradient; none of these points is there.
                for i in 0..3 {
                    let mut step = Vector([0.0; 3]);
                    step[i] = 1e-6;
                    let rise = solid.distance(y + step).0 - solid.distance(y - step).0;
                    assert!((rise / 2e-6 - normal[i]).abs() < 1e-5, "{solid:?} {y:?}");
                }
            }
        }
    }
}
