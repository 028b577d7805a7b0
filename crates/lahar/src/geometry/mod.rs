//! Shapes: the space that bodies fill at the start, and that colliders take up.
//!
//! - [`Shape`] describes: boxes, primitives, meshes, set operations and transforms, nested in any way.
//! - [`Primitive`] is a shape with a closed formula for its signed distance; colliders are unions of them.
//! - [`Region`] is a shape cut off at a box, with its volume.
//! - [`sampling`] places particles in a region.
//!
//! ```text
//!   Shape ──Region::new──▶ Region ──sampling::sample──▶ positions of a body's particles
//!     └─────primitives───▶ Vec<Primitive> ────────────▶ signed distance and normal of a collider
//! ```

mod bounds;
mod mesh;
mod polygon;
mod primitive;
mod region;
pub mod sampling;
mod shape;
mod transform;
mod volume;

pub use bounds::Bounds;
pub use mesh::{Mesh, MeshError};
pub use polygon::{crossing_sides, polygon_area};
pub use primitive::Primitive;
pub use region::Region;
pub use shape::{NotPrimitive, Shape};
pub use transform::Transform;
pub(crate) use transform::rotation;
