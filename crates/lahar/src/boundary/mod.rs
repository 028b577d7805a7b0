//! Boundaries: what stops the material. Walls and colliders constrain the velocities of nodes by contact laws; walls and
//! clamps keep particles inside; each boundary counts the impulse of the material on it.
//!
//! ```text
//! setup: Domain, Collider ──▶ Walls, Moving ──▶ Boundaries::constrain ──▶ nodes, impulses
//!                                         └───▶ project_out, bounds  ──▶ particles, impulses
//! ```

pub(crate) mod colliders;
pub(crate) mod constraint;
pub(crate) mod contact;
pub(crate) mod impulse;
pub(crate) mod pointer;
pub(crate) mod walls;

pub use colliders::Placed;
pub use impulse::BoundaryImpulse;
