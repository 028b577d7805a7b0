//! Shapes cut off at a box, with their volume.

use super::volume::{clipped_ball, half_space_bounds, half_space_volume};
use super::{Bounds, Primitive, Shape, polygon};

/// A shape cut off at a box: the space that a body fills in the domain.
///
/// ```
/// use lahar::geometry::{Bounds, Primitive, Region, Shape};
///
/// // Water up to a height of 0.25 m in a tank of 2 m × 1 m.
/// let water = Shape::from(Primitive::HalfSpace { point: [0.0, 0.25], normal: [0.0, 1.0] });
/// let tank = Bounds { min: [0.0, 0.0], max: [2.0, 1.0] };
/// assert_eq!(Region::new(water, tank).volume(), 0.5);
/// ```
#[derive(Clone, Debug)]
pub struct Region<const D: usize> {
    shape: Shape<D>,
    clip: Bounds<D>,
    bounds: Bounds<D>,
    volume: f64,
}

impl<const D: usize> Region<D> {
    /// Cuts `shape` off at `clip`.
    pub fn new(shape: Shape<D>, clip: Bounds<D>) -> Self {
        let whole = shape.bounds();
        let mut bounds = whole.intersection(&clip);
        let inside = clip.encloses(&whole);
        if let Shape::Primitive(Primitive::HalfSpace { point, normal }) = &shape
            && clip.volume().is_finite()
        {
            bounds = half_space_bounds(point, normal, &clip);
        }
        let volume = match (&shape, shape.exact_volume()) {
            (_, Some(exact)) if inside => exact,
            (Shape::Box { .. }, _) => bounds.volume(),
            (Shape::Primitive(Primitive::Ball { center, radius }), _) => {
                clipped_ball(center, *radius, &bounds)
            }
            (Shape::Primitive(Primitive::HalfSpace { point, normal }), _) => {
                half_space_volume(point, normal, &clip)
            }
            (Shape::Primitive(Primitive::Polygon { points }), _) => {
                polygon::polygon_area(&polygon::clip(points, &clip)).abs()
            }
            _ => counted_volume(&shape, &bounds),
        };
        Self {
            shape,
            clip,
            bounds,
            volume,
        }
    }

    /// Returns the shape before it was cut.
    pub fn shape(&self) -> &Shape<D> {
        &self.shape
    }

    /// Returns a box around the region \[m\].
    pub fn bounds(&self) -> &Bounds<D> {
        &self.bounds
    }

    /// Returns the volume \[m³; m² in 2D\]: exact for whole boxes, primitives and meshes, and for cut
    /// boxes, polygons and half-spaces; within 1e-6 of the whole ball for cut balls; otherwise counted on
    /// a lattice, to about 0.1 % for smooth shapes.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Returns true if a part of the shape is cut off. Half-spaces always are, and do not count.
    pub fn is_cut(&self) -> bool {
        let is_half_space = matches!(self.shape, Shape::Primitive(Primitive::HalfSpace { .. }));
        !is_half_space && !self.clip.encloses(&self.shape.bounds())
    }

    /// Returns true if `p` \[m\] is inside.
    pub fn contains(&self, p: &[f64; D]) -> bool {
        self.clip.contains(p) && self.shape.contains(p)
    }

    /// Returns true if the region is known to contain every line between two of its points.
    pub fn is_convex(&self) -> bool {
        self.shape.is_convex()
    }
}

/// Points along an axis of a box at which shapes without a formula are tested.
const LATTICE_2D: usize = 768;
const LATTICE_3D: usize = 80;

/// Returns the volume of the part of `shape` in `bounds`: the part of a lattice's points that are inside.
fn counted_volume<const D: usize>(shape: &Shape<D>, bounds: &Bounds<D>) -> f64 {
    let volume = bounds.volume();
    if !(volume > 0.0 && volume.is_finite()) {
        return 0.0;
    }
    let n = if D == 2 { LATTICE_2D } else { LATTICE_3D };
    let place = |axis: usize, step: usize| {
        bounds.min[axis] + bounds.side(axis) * (step as f64 + 0.5) / n as f64
    };
    let total = n.pow(D as u32);
    let inside = (0..total)
        .filter(|number| {
            let p = core::array::from_fn(|axis| place(axis, number / n.pow(axis as u32) % n));
            shape.contains(&p)
        })
        .count();
    volume * inside as f64 / total as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    const UNIT: Bounds<2> = Bounds {
        min: [0.0, 0.0],
        max: [1.0, 1.0],
    };
    const CUBE: Bounds<3> = Bounds {
        min: [0.0; 3],
        max: [1.0; 3],
    };

    fn assert_volume<const D: usize>(
        shape: impl Into<Shape<D>>,
        clip: Bounds<D>,
        expected: f64,
        tolerance: f64,
    ) {
        let shape = shape.into();
        let volume = Region::new(shape.clone(), clip).volume();
        assert!(
            (volume - expected).abs() < tolerance,
            "{shape:?}: {volume} is not {expected}"
        );
    }

    #[test]
    fn volumes_of_boxes_and_balls() {
        let corner = Shape::Box {
            min: [-1.0, 0.5],
            max: [0.5, 2.0],
        };
        assert_volume(corner, UNIT, 0.25, 1e-15);
        let ball = |center, radius| Primitive::Ball { center, radius };
        assert_volume(ball([0.5, 0.5], 0.5), UNIT, PI / 4.0, 1e-12);
        assert_volume(ball([0.0, 0.0], 0.5), UNIT, PI / 16.0, 1e-6);
        assert_volume(ball([0.0, 0.5], 0.5), UNIT, PI / 8.0, 1e-6);
        assert_volume(ball([0.5, 0.5], 5.0), UNIT, 1.0, 1e-6);
        let ball = Primitive::Ball {
            center: [0.0; 3],
            radius: 1.0,
        };
        assert_volume(ball, CUBE, PI / 6.0, 1e-5);
    }

    #[test]
    fn volumes_of_half_spaces() {
        let half_space = |point, normal| Primitive::HalfSpace { point, normal };
        assert_volume(half_space([0.0, 0.25], [0.0, 1.0]), UNIT, 0.25, 1e-12);
        assert_volume(half_space([0.5, 0.5], [0.6, 0.8]), UNIT, 0.5, 1e-12);
        assert_volume(half_space([0.0, 1.0], [-0.6, -0.8]), UNIT, 0.375, 1e-12);
        assert_volume(half_space([0.0, -1.0], [0.0, 1.0]), UNIT, 0.0, 1e-12);
        let third = 1.0 / 3.0_f64.sqrt();
        let corner = Primitive::HalfSpace {
            point: [1.0, 0.0, 0.0],
            normal: [third; 3],
        };
        assert_volume(corner, CUBE, 1.0 / 6.0, 1e-12);
    }

    #[test]
    fn volumes_of_polygons() {
        let arrow = vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.25], [0.5, 2.0]];
        let area = polygon::polygon_area(&arrow).abs();
        let polygon = |points| Primitive::Polygon { points };
        assert_volume(polygon(arrow), Bounds::EVERYTHING, area, 1e-15);
        let wide = vec![[-1.0, -1.0], [2.0, -1.0], [2.0, 0.5], [-1.0, 0.5]];
        assert_volume(polygon(wide), UNIT, 0.5, 1e-12);
    }

    #[test]
    fn half_space_bounds_are_tight() {
        let half_space = Primitive::HalfSpace {
            point: [0.5, 0.0],
            normal: [0.6, 0.8],
        };
        let region = Region::new(half_space.into(), UNIT);
        let bounds = region.bounds();
        assert!(
            (bounds.max[0] - 0.5).abs() < 1e-12 && (bounds.max[1] - 0.375).abs() < 1e-12,
            "{bounds:?}"
        );
    }
}
