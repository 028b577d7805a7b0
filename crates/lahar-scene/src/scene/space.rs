//! Two dimensions as a part of three.

use lahar::geometry::Bounds;

/// Returns a vector in three dimensions; in 2D its third component is 0.
pub(super) fn vector_in_3d<const D: usize>(v: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|i| if i < D { v[i] } else { 0.0 })
}

/// Returns a box in three dimensions; in 2D it is flat.
pub(super) fn bounds_in_3d<const D: usize>(bounds: &Bounds<D>) -> Bounds<3> {
    Bounds {
        min: vector_in_3d(bounds.min),
        max: vector_in_3d(bounds.max),
    }
}
