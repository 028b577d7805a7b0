//! Draws colliders as lines: their edges and, in 2D, a hatching that fills them.

use lahar::geometry::Primitive;
use lahar_io::image::COLLIDER;
use lahar_scene::scene::ColliderInfo;

use crate::camera::{V3, add, cross, length, normalize, scale, sub};
use crate::renderer::Line;

/// Number of sides of a circle, and of parts of a segment.
const SIDES: usize = 48;

/// Distance of the lines of a hatching, in parts of the scene's longer side.
const HATCHING: f64 = 1.0 / 80.0;

/// The lines of `colliders` at `time` \[s\], in a scene of this dimension within the box `extent` \[m\], relative to
/// `origin` \[m\].
pub(crate) fn collider_lines(
    colliders: &[ColliderInfo],
    time: f64,
    dimension: usize,
    extent: (V3, V3),
    origin: V3,
) -> Vec<Line> {
    let mut lines = vec![];
    for info in colliders {
        let placed = info.collider.at(time);
        let [r, g, b] = info.color.unwrap_or(COLLIDER);
        let mut draw = |start: V3, end: V3, half_width: f32, opacity: u8| {
            let local = |p: V3| sub(p, origin).map(|x| x as f32);
            lines.push(Line {
                start: local(start),
                half_width,
                end: local(end),
                color: [r, g, b, opacity],
            });
        };
        for primitive in placed.primitives() {
            for path in outline(&primitive, dimension, extent) {
                for pair in path.windows(2) {
                    // An edge inside another primitive of the same collider is not drawn.
                    let middle = scale(add(pair[0], pair[1]), 0.5);
                    let (distance, _) = placed.distance(middle);
                    if distance > -1e-3 * longest(extent) {
                        draw(pair[0], pair[1], 1.2, 255);
                    }
                }
            }
        }
        if dimension == 2 {
            let inside = |p: V3| placed.distance(p).0 < 0.0;
            for [start, end] in hatching(extent, inside) {
                draw(start, end, 0.8, 150);
            }
        }
    }
    lines
}

/// The longest side of a box.
fn longest((min, max): (V3, V3)) -> f64 {
    sub(max, min).into_iter().fold(0.0, f64::max)
}

/// Slanted segments over the box, where `inside` is true.
fn hatching((min, max): (V3, V3), inside: impl Fn(V3) -> bool) -> Vec<[V3; 2]> {
    let step = HATCHING * longest((min, max));
    let [width, height, _] = sub(max, min);
    let mut lines = vec![];
    for k in 1..((width + height) / step) as usize {
        // Along a line, x + y is constant.
        let sum = k as f64 * step;
        let (low, high) = ((sum - height).max(0.0), sum.min(width));
        let place = |x: f64| [min[0] + x, min[1] + sum - x, 0.0];
        let count = ((high - low) / (0.25 * step)).ceil().max(1.0) as usize;
        let mut began = None;
        for i in 0..=count {
            let at = place(low + (high - low) * i as f64 / count as f64);
            match (inside(at), began) {
                (true, None) => began = Some(at),
                (true, Some(start)) if i == count => lines.push([start, at]),
                (false, Some(start)) => {
                    lines.push([start, at]);
                    began = None;
                }
                _ => {}
            }
        }
    }
    lines
}

/// The edges of a primitive, as paths.
fn outline(primitive: &Primitive<3>, dimension: usize, extent: (V3, V3)) -> Vec<Vec<V3>> {
    match primitive {
        Primitive::Box { center, half, axes } => box_edges(*center, *half, *axes, dimension),
        Primitive::Ball { center, radius } => great_circles(*center, *radius, dimension),
        Primitive::HalfSpace { point, normal } => {
            let corners = half_space_corners(*point, *normal, dimension, longest(extent) * 3.0);
            within(&corners, extent)
        }
        Primitive::Polygon { points } => (0..points.len())
            .map(|i| divided(points[i], points[(i + 1) % points.len()]))
            .collect(),
        Primitive::Rod {
            from,
            to,
            radius,
            round,
        } => rod_edges([*from, *to], *radius, *round, dimension),
    }
}

fn box_edges(center: V3, half: V3, axes: [V3; 3], dimension: usize) -> Vec<Vec<V3>> {
    // Bit i of a corner's number is its side along axis i.
    let corner = |bits: usize| {
        (0..dimension).fold(center, |at, i| {
            let sign = if bits >> i & 1 == 1 { 1.0 } else { -1.0 };
            add(at, scale(axes[i], sign * half[i]))
        })
    };
    let mut edges = vec![];
    for bits in 0..1_usize << dimension {
        for axis in 0..dimension {
            if bits >> axis & 1 == 0 {
                edges.push(divided(corner(bits), corner(bits | 1 << axis)));
            }
        }
    }
    edges
}

/// One circle in 2D; in 3D, one in each plane of two axes.
fn great_circles(center: V3, radius: f64, dimension: usize) -> Vec<Vec<V3>> {
    let unit = |i: usize| core::array::from_fn(|j| f64::from(i == j));
    let planes: &[(usize, usize)] = if dimension == 2 {
        &[(0, 1)]
    } else {
        &[(0, 1), (1, 2), (2, 0)]
    };
    planes
        .iter()
        .map(|&(i, j)| circle(center, unit(i), unit(j), radius))
        .collect()
}

/// A part of the surface that reaches beyond the scene: a segment in 2D, a square in 3D.
fn half_space_corners(point: V3, normal: V3, dimension: usize, reach: f64) -> Vec<V3> {
    let [side, other] = across(normal, dimension);
    let corners: &[(f64, f64)] = if dimension == 2 {
        &[(-1.0, 0.0), (1.0, 0.0)]
    } else {
        &[
            (1.0, 1.0),
            (1.0, -1.0),
            (-1.0, -1.0),
            (-1.0, 1.0),
            (1.0, 1.0),
        ]
    };
    let corner = |(a, b): &(f64, f64)| {
        let along_surface = add(scale(side, a * reach), scale(other, b * reach));
        add(point, along_surface)
    };
    corners.iter().map(corner).collect()
}

/// Lines along a cylinder or capsule, and circles at its ends.
fn rod_edges(ends: [V3; 2], radius: f64, round: bool, dimension: usize) -> Vec<Vec<V3>> {
    let [from, to] = ends;
    let axis = sub(to, from);
    let [side, other] = across(axis, dimension);
    let sides: Vec<V3> = if dimension == 2 {
        vec![side, scale(side, -1.0)]
    } else {
        vec![side, other, scale(side, -1.0), scale(other, -1.0)]
    };
    let mut paths: Vec<Vec<V3>> = sides
        .iter()
        .map(|side| {
            let out = scale(*side, radius);
            divided(add(from, out), add(to, out))
        })
        .collect();
    let length = length(axis);
    let along = if length > 0.0 {
        scale(axis, 1.0 / length)
    } else {
        other
    };
    for end in ends {
        if dimension == 3 {
            paths.push(circle(end, side, other, radius));
        }
        if round {
            paths.push(circle(end, side, along, radius));
            if dimension == 3 {
                paths.push(circle(end, other, along, radius));
            }
        }
    }
    paths
}

/// Divides a segment, so that parts of it can be left out.
fn divided(a: V3, b: V3) -> Vec<V3> {
    (0..=SIDES)
        .map(|i| add(a, scale(sub(b, a), i as f64 / SIDES as f64)))
        .collect()
}

/// The circle about `center` in the plane of the unit vectors `x` and `y`.
fn circle(center: V3, x: V3, y: V3, radius: f64) -> Vec<V3> {
    (0..=SIDES)
        .map(|i| {
            let (sin, cos) = (core::f64::consts::TAU * i as f64 / SIDES as f64).sin_cos();
            add(center, add(scale(x, radius * cos), scale(y, radius * sin)))
        })
        .collect()
}

/// Two unit vectors perpendicular to `axis`. In 2D the first lies in the plane.
fn across(axis: V3, dimension: usize) -> [V3; 2] {
    let helper = if dimension == 2 || axis[2].abs() < axis[0].abs().max(axis[1].abs()) {
        [0.0, 0.0, 1.0]
    } else {
        [1.0, 0.0, 0.0]
    };
    if axis == [0.0; 3] {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    }
    let side = normalize(cross(axis, helper));
    [side, normalize(cross(axis, side))]
}

/// The parts of a path that are in the box.
fn within(path: &[V3], (min, max): (V3, V3)) -> Vec<Vec<V3>> {
    let inside = |p: &V3| (0..3).all(|i| (min[i] - 1e-9..=max[i] + 1e-9).contains(&p[i]));
    let fine: Vec<V3> = path
        .windows(2)
        .flat_map(|pair| {
            (0..=20 * SIDES).map(|i| {
                let part = i as f64 / (20 * SIDES) as f64;
                add(pair[0], scale(sub(pair[1], pair[0]), part))
            })
        })
        .collect();
    fine.split(|p| !inside(p))
        .filter(|piece| piece.len() > 1)
        .map(<[V3]>::to_vec)
        .collect()
}
