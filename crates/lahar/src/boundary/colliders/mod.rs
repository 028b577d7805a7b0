//! Colliders: where they are during a substep, how they act on the nodes around them, and how particles inside of them
//! are projected out.

pub(crate) mod contact;
mod extended;
pub(crate) mod nodes;
pub(crate) mod placed;
pub(crate) mod projection;

pub use placed::Placed;
