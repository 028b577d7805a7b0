//! The space that a body fills: a shape, cut off at the domain.

mod mesh;
mod parts;
mod primitive;
pub mod sampling;
mod transform;
mod volume;

pub use mesh::{Mesh, MeshError};
pub use primitive::Solid;
pub(crate) use primitive::rotation;
pub use transform::Motion;

use core::f64::consts::PI;
use std::sync::Arc;
pub use volume::area;
use volume::{
    ball_volume, clip_polygon, clipped_ball, counted, half_space_bounds, half_space_volume,
};

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
    /// All within a radius of a line between two points; its ends are round if it is a capsule, else
    /// flat. In 2D a capsule is a strip.
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
    /// The inside of a closed surface, in 3D.
    Mesh(Arc<Mesh>),
    /// All that is in any of them.
    Union(Vec<Shape<D>>),
    /// All that is in every one of them.
    Intersection(Vec<Shape<D>>),
    /// All that is in the first and in no other.
    Difference(Vec<Shape<D>>),
    /// A shape that was scaled, turned or moved.
    Moved {
        /// The shape as it was.
        shape: Box<Shape<D>>,
        /// From where it was to where it is.
        motion: Motion<D>,
        /// A box around where it is \[m\].
        bounds: Bounds<D>,
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
    pub fn around(boxes: &[Self]) -> Self {
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
            Self::Mesh(mesh) => {
                let (min, max) = mesh.bounds();
                Bounds {
                    min: core::array::from_fn(|i| min[i.min(2)]),
                    max: core::array::from_fn(|i| max[i.min(2)]),
                }
            }
            Self::Union(shapes) => {
                let all: Vec<Bounds<D>> = shapes.iter().map(Self::bounds).collect();
                Bounds::around(&all)
            }
            Self::Intersection(shapes) => shapes.iter().fold(Bounds::EVERYTHING, |sum, shape| {
                sum.intersection(&shape.bounds())
            }),
            Self::Difference(shapes) => shapes.first().map_or(Bounds::EVERYTHING, Self::bounds),
            Self::Moved { bounds, .. } => *bounds,
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
            Self::Rod {
                from,
                to,
                radius,
                round,
            } => in_rod(p, (from, to), *radius, *round),
            Self::Mesh(mesh) => {
                mesh.contains(core::array::from_fn(|i| if i < D { p[i] } else { 0.0 }))
            }
            Self::Union(shapes) => shapes.iter().any(|shape| shape.contains(p)),
            Self::Intersection(shapes) => shapes.iter().all(|shape| shape.contains(p)),
            Self::Difference(shapes) => shapes.split_first().is_some_and(|(first, others)| {
                first.contains(p) && !others.iter().any(|shape| shape.contains(p))
            }),
            Self::Moved {
                shape,
                motion,
                bounds,
            } => bounds.contains(p) && shape.contains(&motion.back(p)),
        }
    }

    /// Whether it is known to have all that is between any two of its points.
    fn is_convex(&self) -> bool {
        match self {
            Self::Box { .. } | Self::Ball { .. } | Self::HalfSpace { .. } | Self::Rod { .. } => {
                true
            }
            Self::Polygon { .. } | Self::Mesh(_) | Self::Union(_) | Self::Difference(_) => false,
            Self::Intersection(shapes) => shapes.iter().all(Self::is_convex),
            Self::Moved { shape, .. } => shape.is_convex(),
        }
    }

    /// The shape after `motion`: of the same kind where there is one, so that its bounds are tight.
    #[must_use]
    pub fn moved(self, motion: Motion<D>) -> Self {
        let all = |shapes: Vec<Self>| {
            shapes
                .into_iter()
                .map(|shape| shape.moved(motion))
                .collect()
        };
        match (self, motion.factor()) {
            (Self::Ball { center, radius }, Some(factor)) => Self::Ball {
                center: motion.forth(&center),
                radius: radius * factor,
            },
            (
                Self::Rod {
                    from,
                    to,
                    radius,
                    round,
                },
                Some(factor),
            ) => Self::Rod {
                from: motion.forth(&from),
                to: motion.forth(&to),
                radius: radius * factor,
                round,
            },
            (Self::HalfSpace { point, normal }, Some(_)) => Self::HalfSpace {
                point: motion.forth(&point),
                normal: motion.turned(&normal),
            },
            (Self::Polygon { points }, _) => Self::Polygon {
                points: points.iter().map(|p| motion.forth(p)).collect(),
            },
            (Self::Box { min, max }, _) if !motion.turns() => Self::Box {
                min: motion.forth(&min),
                max: motion.forth(&max),
            },
            (Self::Box { min, max }, _) if D == 2 => {
                let corners: Vec<[f64; D]> = Bounds { min, max }.corners().collect();
                let around = [0, 1, 3, 2];
                Self::Polygon {
                    points: around.map(|i| motion.forth(&corners[i])).to_vec(),
                }
            }
            (Self::Union(shapes), _) => Self::Union(all(shapes)),
            (Self::Intersection(shapes), _) => Self::Intersection(all(shapes)),
            (Self::Difference(shapes), _) => Self::Difference(all(shapes)),
            (shape, _) => {
                let points: Vec<[f64; D]> = match &shape {
                    Self::Mesh(mesh) => mesh
                        .vertices()
                        .map(|v| core::array::from_fn(|i| v[i.min(2)]))
                        .collect(),
                    _ => shape.bounds().corners().collect(),
                };
                let bounds = if shape.bounds().volume().is_finite() {
                    Self::Polygon {
                        points: points.iter().map(|p| motion.forth(p)).collect(),
                    }
                    .bounds()
                } else {
                    Bounds::EVERYTHING
                };
                Self::Moved {
                    shape: Box::new(shape),
                    motion,
                    bounds,
                }
            }
        }
    }

    /// Its volume \[m³; m² in 2D\], if a formula has it.
    fn exact_volume(&self) -> Option<f64> {
        match self {
            Self::Box { .. } => Some(self.bounds().volume()),
            Self::Ball { radius, .. } => Some(ball_volume::<D>(*radius)),
            Self::Polygon { points } => Some(area(points).abs()),
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
            Self::Mesh(mesh) => mesh.exact_volume(),
            Self::Moved { shape, motion, .. } => Some(shape.exact_volume()? * motion.stretch()),
            Self::Union(shapes) => {
                // Copies that do not touch.
                let bounds: Vec<Bounds<D>> = shapes.iter().map(Self::bounds).collect();
                let apart = |a: &Bounds<D>, b: &Bounds<D>| {
                    (0..D).any(|i| a.min[i] >= b.max[i] || b.min[i] >= a.max[i])
                };
                let all_apart =
                    (1..bounds.len()).all(|i| (0..i).all(|j| apart(&bounds[i], &bounds[j])));
                (all_apart && bounds.len() <= 100)
                    .then(|| shapes.iter().map(Self::exact_volume).sum())?
            }
            Self::HalfSpace { .. } | Self::Intersection(_) | Self::Difference(_) => None,
        }
    }

    /// Primitive shapes in it.
    pub fn parts(&self) -> usize {
        match self {
            Self::Union(shapes) | Self::Intersection(shapes) | Self::Difference(shapes) => {
                shapes.iter().map(Self::parts).sum()
            }
            Self::Moved { shape, .. } => shape.parts(),
            _ => 1,
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
        if let Shape::HalfSpace { point, normal } = &shape
            && clip.volume().is_finite()
        {
            bounds = half_space_bounds(point, normal, &clip);
        }
        let volume = match (&shape, shape.exact_volume()) {
            (_, Some(exact)) if inside => exact,
            (Shape::Box { .. }, _) => bounds.volume(),
            (Shape::Ball { center, radius }, _) => clipped_ball(center, *radius, &bounds),
            (Shape::HalfSpace { point, normal }, _) => half_space_volume(point, normal, &clip),
            (Shape::Polygon { points }, _) => area(&clip_polygon(points, &clip)).abs(),
            _ => counted(&shape, &bounds),
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

    /// A box around it \[m\].
    pub fn bounds(&self) -> &Bounds<D> {
        &self.bounds
    }

    /// Its volume \[m³; m² in 2D\]: exact for whole boxes, balls, polygons, rods and meshes, and for
    /// cut boxes, polygons and half-spaces; to 1e-6 of the whole for cut balls; else counted on a
    /// lattice.
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

    /// Whether it is known to have all that is between any two of its points.
    pub fn is_convex(&self) -> bool {
        self.shape.is_convex()
    }
}

/// Whether `p` is within `radius` of the line between two points, and between its flat ends.
fn in_rod<const D: usize>(
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

/// The first two sides of a polygon that cross, by the numbers of their first corners.
pub fn crossing<const D: usize>(points: &[[f64; D]]) -> Option<(usize, usize)> {
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
