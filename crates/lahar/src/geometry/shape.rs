//! Shapes: primitives, meshes, set operations on shapes, and transforms.

use super::{Bounds, Mesh, Primitive, Transform};
use core::fmt;
use std::sync::Arc;

/// A shape in `D` dimensions: the space that a body fills at the start, or that a collider takes up.
///
/// ```
/// use lahar::geometry::{Bounds, Primitive, Region, Shape};
///
/// let block = Shape::Box { min: [0.0, 0.0], max: [1.0, 1.0] };
/// let hole = Shape::from(Primitive::Ball { center: [0.5, 0.5], radius: 0.25 });
/// let plate = Shape::Difference(vec![block, hole]);
/// assert!(plate.contains(&[0.1, 0.1]) && !plate.contains(&[0.5, 0.5]));
///
/// let area = Region::new(plate, Bounds::EVERYTHING).volume();
/// assert!((area - (1.0 - std::f64::consts::PI / 16.0)).abs() < 1e-3);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Shape<const D: usize> {
    /// A box with sides along the axes, its surface included.
    Box {
        /// Lower corner \[m\].
        min: [f64; D],
        /// Upper corner \[m\].
        max: [f64; D],
    },
    /// A ball, half-space, rod or polygon, or a turned box.
    Primitive(Primitive<D>),
    /// The inside of a closed surface of triangles; 3D only.
    Mesh(Arc<Mesh>),
    /// The points that are in any of the shapes.
    Union(Vec<Shape<D>>),
    /// The points that are in all of the shapes.
    Intersection(Vec<Shape<D>>),
    /// The points that are in the first shape and in none of the others.
    Difference(Vec<Shape<D>>),
    /// A transformed shape that no other variant can express. [`Shape::transformed`] makes it.
    Transformed {
        /// The shape before the transform.
        shape: Box<Shape<D>>,
        /// The transform of the shape.
        transform: Transform<D>,
        /// A box around the transformed shape \[m\].
        bounds: Bounds<D>,
    },
}

/// The part of a shape that keeps it from being a union of [`Primitive`]s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotPrimitive {
    /// A mesh of triangles.
    Mesh,
    /// An intersection of shapes.
    Intersection,
    /// A difference of shapes.
    Difference,
    /// A primitive scaled by different factors along the axes.
    UnevenScale,
}

impl fmt::Display for NotPrimitive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mesh => "mesh",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
            Self::UnevenScale => "shape scaled by different factors",
        })
    }
}

impl core::error::Error for NotPrimitive {}

impl<const D: usize> From<Primitive<D>> for Shape<D> {
    fn from(primitive: Primitive<D>) -> Self {
        Self::Primitive(primitive)
    }
}

impl<const D: usize> Shape<D> {
    /// Returns a box around the shape \[m\]: the smallest one, but for turned shapes and differences.
    pub fn bounds(&self) -> Bounds<D> {
        match self {
            Self::Box { min, max } => Bounds {
                min: *min,
                max: *max,
            },
            Self::Primitive(primitive) => primitive.bounds(),
            Self::Mesh(mesh) => {
                let (min, max) = mesh.bounds();
                Bounds {
                    min: core::array::from_fn(|i| min[i.min(2)]),
                    max: core::array::from_fn(|i| max[i.min(2)]),
                }
            }
            Self::Union(shapes) => Bounds::around(shapes.iter().map(Self::bounds)),
            Self::Intersection(shapes) => shapes.iter().fold(Bounds::EVERYTHING, |sum, shape| {
                sum.intersection(&shape.bounds())
            }),
            Self::Difference(shapes) => shapes.first().map_or(Bounds::EVERYTHING, Self::bounds),
            Self::Transformed { bounds, .. } => *bounds,
        }
    }

    /// Returns true if `p` \[m\] is inside.
    pub fn contains(&self, p: &[f64; D]) -> bool {
        match self {
            Self::Box { min, max } => Bounds {
                min: *min,
                max: *max,
            }
            .contains(p),
            Self::Primitive(primitive) => primitive.contains(p),
            Self::Mesh(mesh) => {
                mesh.contains(core::array::from_fn(|i| if i < D { p[i] } else { 0.0 }))
            }
            Self::Union(shapes) => shapes.iter().any(|shape| shape.contains(p)),
            Self::Intersection(shapes) => shapes.iter().all(|shape| shape.contains(p)),
            Self::Difference(shapes) => shapes.split_first().is_some_and(|(first, others)| {
                first.contains(p) && !others.iter().any(|shape| shape.contains(p))
            }),
            Self::Transformed {
                shape,
                transform,
                bounds,
            } => bounds.contains(p) && shape.contains(&transform.invert(p)),
        }
    }

    /// Returns the distance of `p` \[m\] from the surface \[m\], negative inside, and the unit vector out of
    /// the shape. Inside a union, where its parts overlap, the distance is a lower bound on the true one.
    ///
    /// This makes the list of [`Shape::primitives`] for each call; for many points, make it once.
    ///
    /// # Errors
    /// The part of the shape that has no such distance.
    ///
    /// ```
    /// use lahar::geometry::Shape;
    ///
    /// let block = Shape::Box { min: [0.0, 0.0], max: [2.0, 1.0] };
    /// assert_eq!(block.signed_distance([1.0, 1.5])?, (0.5, [0.0, 1.0]));
    /// # Ok::<(), lahar::geometry::NotPrimitive>(())
    /// ```
    pub fn signed_distance(&self, p: [f64; D]) -> Result<(f64, [f64; D]), NotPrimitive> {
        let mut nearest = (f64::INFINITY, [0.0; D]);
        for primitive in self.primitives()? {
            let found = primitive.signed_distance(p);
            if found.0 < nearest.0 {
                nearest = found;
            }
        }
        Ok(nearest)
    }

    /// Returns the primitives that the shape is the union of.
    ///
    /// # Errors
    /// The part of the shape that is no union of primitives.
    pub fn primitives(&self) -> Result<Vec<Primitive<D>>, NotPrimitive> {
        match self {
            Self::Box { min, max } => Ok(vec![Primitive::Box {
                center: core::array::from_fn(|i| 0.5 * (min[i] + max[i])),
                half: core::array::from_fn(|i| 0.5 * (max[i] - min[i])),
                axes: core::array::from_fn(|i| core::array::from_fn(|j| f64::from(i == j))),
            }]),
            Self::Primitive(primitive) => Ok(vec![primitive.clone()]),
            Self::Union(shapes) => {
                let mut all = Vec::new();
                for shape in shapes {
                    all.extend(shape.primitives()?);
                }
                Ok(all)
            }
            Self::Transformed {
                shape, transform, ..
            } => {
                let primitives = shape.primitives()?;
                primitives
                    .iter()
                    .map(|primitive| transformed_primitive(primitive, transform))
                    .collect()
            }
            Self::Mesh(_) => Err(NotPrimitive::Mesh),
            Self::Intersection(_) => Err(NotPrimitive::Intersection),
            Self::Difference(_) => Err(NotPrimitive::Difference),
        }
    }

    /// Returns true if the shape is known to contain every line between two of its points.
    pub fn is_convex(&self) -> bool {
        match self {
            Self::Box { .. } => true,
            Self::Primitive(primitive) => !matches!(primitive, Primitive::Polygon { .. }),
            Self::Mesh(_) | Self::Union(_) | Self::Difference(_) => false,
            Self::Intersection(shapes) => shapes.iter().all(Self::is_convex),
            Self::Transformed { shape, .. } => shape.is_convex(),
        }
    }

    /// Returns the shape after `transform`: of the same kind where it can be, so that its bounds are
    /// tight.
    #[must_use]
    pub fn transformed(self, transform: Transform<D>) -> Self {
        let all = |shapes: Vec<Self>| {
            shapes
                .into_iter()
                .map(|shape| shape.transformed(transform))
                .collect()
        };
        match self {
            Self::Union(shapes) => Self::Union(all(shapes)),
            Self::Intersection(shapes) => Self::Intersection(all(shapes)),
            Self::Difference(shapes) => Self::Difference(all(shapes)),
            Self::Box { min, max } if !transform.rotates() => Self::Box {
                min: transform.apply(&min),
                max: transform.apply(&max),
            },
            Self::Box { min, max } if D == 2 => {
                let corners: Vec<[f64; D]> = Bounds { min, max }.corners().collect();
                let around = [0, 1, 3, 2];
                Self::Primitive(Primitive::Polygon {
                    points: around.map(|i| transform.apply(&corners[i])).to_vec(),
                })
            }
            Self::Primitive(primitive)
                if transform.uniform_scale().is_some()
                    || matches!(primitive, Primitive::Polygon { .. }) =>
            {
                Self::Primitive(primitive.mapped(
                    |x| transform.apply(&x),
                    |v| transform.rotate(&v),
                    transform.uniform_scale().unwrap_or(1.0),
                ))
            }
            shape => Self::wrapped(shape, transform),
        }
    }

    /// Keeps `shape` and its transform side by side, with a box around the result.
    fn wrapped(shape: Self, transform: Transform<D>) -> Self {
        let points: Vec<[f64; D]> = match &shape {
            Self::Mesh(mesh) => mesh
                .vertices()
                .map(|v| core::array::from_fn(|i| v[i.min(2)]))
                .collect(),
            _ => shape.bounds().corners().collect(),
        };
        let bounds = if shape.bounds().volume().is_finite() {
            let points: Vec<[f64; D]> = points.iter().map(|p| transform.apply(p)).collect();
            Bounds::around_points(&points)
        } else {
            Bounds::EVERYTHING
        };
        Self::Transformed {
            shape: Box::new(shape),
            transform,
            bounds,
        }
    }

    /// Returns the volume \[m³; m² in 2D\] if there is a formula for it.
    pub(super) fn exact_volume(&self) -> Option<f64> {
        match self {
            Self::Box { .. } => Some(self.bounds().volume()),
            Self::Primitive(primitive) => primitive.volume(),
            Self::Mesh(mesh) => mesh.exact_volume(),
            Self::Transformed {
                shape, transform, ..
            } => Some(shape.exact_volume()? * transform.volume_factor()),
            Self::Union(shapes) => {
                /// Parts up to which all pairs are tested.
                const TESTED: usize = 100;
                let bounds: Vec<Bounds<D>> = shapes.iter().map(Self::bounds).collect();
                let apart = |a: &Bounds<D>, b: &Bounds<D>| {
                    (0..D).any(|i| a.min[i] >= b.max[i] || b.min[i] >= a.max[i])
                };
                let all_apart =
                    (1..bounds.len()).all(|i| (0..i).all(|j| apart(&bounds[i], &bounds[j])));
                // Parts that do not touch add up.
                (all_apart && bounds.len() <= TESTED)
                    .then(|| shapes.iter().map(Self::exact_volume).sum())?
            }
            Self::Intersection(_) | Self::Difference(_) => None,
        }
    }

    /// Returns the number of boxes, primitives and meshes in the shape.
    pub fn part_count(&self) -> usize {
        match self {
            Self::Union(shapes) | Self::Intersection(shapes) | Self::Difference(shapes) => {
                shapes.iter().map(Self::part_count).sum()
            }
            Self::Transformed { shape, .. } => shape.part_count(),
            Self::Box { .. } | Self::Primitive(_) | Self::Mesh(_) => 1,
        }
    }
}

fn transformed_primitive<const D: usize>(
    primitive: &Primitive<D>,
    transform: &Transform<D>,
) -> Result<Primitive<D>, NotPrimitive> {
    let (place, turned) = (
        |x: [f64; D]| transform.apply(&x),
        |v: [f64; D]| transform.rotate(&v),
    );
    match (transform.uniform_scale(), primitive) {
        (Some(factor), _) => Ok(primitive.mapped(place, turned, factor)),
        (None, Primitive::Polygon { .. }) => Ok(primitive.mapped(place, turned, 1.0)),
        // A box along the axes is scaled along its own sides.
        (None, Primitive::Box { half, axes, .. })
            if (0..D).all(|i| (0..D).all(|j| i == j || axes[i][j] == 0.0)) =>
        {
            let mut stretched = primitive.mapped(place, turned, 1.0);
            let factors = transform.scale();
            if let Primitive::Box { half: new, .. } = &mut stretched {
                *new = core::array::from_fn(|i| half[i] * factors[i]);
            }
            Ok(stretched)
        }
        (None, _) => Err(NotPrimitive::UnevenScale),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_turned_and_stretched_keeps_its_inside() {
        let shape = Shape::Box {
            min: [0.0, 0.0, 0.0],
            max: [1.0, 2.0, 3.0],
        }
        .transformed(Transform::new(
            [2.0, 1.0, 0.5],
            [0.3, -0.4, 0.5],
            [0.5; 3],
            [0.1, 0.2, 0.3],
        ));
        let primitives = shape.primitives().unwrap();
        for n in 0..500_i32 {
            let p: [f64; 3] = core::array::from_fn(|i| {
                f64::from((37 * n + 101 * i as i32) % 97) / 97.0 * 5.0 - 2.0
            });
            let inside = shape.contains(&p);
            assert_eq!(primitives[0].contains(&p), inside, "{p:?}");
            assert_eq!(shape.signed_distance(p).unwrap().0 < 0.0, inside, "{p:?}");
        }
    }

    #[test]
    fn shapes_without_a_distance_name_the_part() {
        let ball = Shape::from(Primitive::Ball {
            center: [0.0; 2],
            radius: 1.0,
        });
        let pair = vec![ball.clone(), ball.clone()];
        let error = |shape: Shape<2>| shape.primitives().unwrap_err();
        assert_eq!(
            error(Shape::Intersection(pair.clone())),
            NotPrimitive::Intersection
        );
        assert_eq!(
            error(Shape::Union(vec![Shape::Difference(pair)])),
            NotPrimitive::Difference
        );
        let squeeze = Transform::new([2.0, 1.0], [0.0; 3], [0.0; 2], [0.0; 2]);
        assert_eq!(error(ball.transformed(squeeze)), NotPrimitive::UnevenScale);
    }
}
