//! Particles: the one table of their fields, and their storage in groups, sorted by block.
//!
//! ```text
//! batch ──append──▶ new rows ──sort──▶ by block ──merge──▶ group ──sort, lazily──▶ group
//! ```

mod append;
mod chunk;
mod columns;
mod fields;
mod group;
mod lattice;
mod merge;
mod per_particle;
mod run;
mod sort;

pub use crate::array::Data;
pub use crate::math::Shape;
pub(crate) use append::Placement;
pub(crate) use chunk::{AHEAD, CHUNK, Chunk, Largest, Padded, Rows, close_chunk, open_chunk, pad};
pub(crate) use columns::{ColumnsMut, MOST_COLUMNS, slices};
pub use fields::{FIELDS, Field, FieldInfo, Snapshot};
pub(crate) use group::{Group, Layout, copy_columns};
pub(crate) use lattice::{Lattice, block_edge};
pub(crate) use per_particle::PerParticle;
pub(crate) use run::{Run, split_runs};
pub(crate) use sort::{DRIFT_LIMIT, Escaped, Sorter, in_range};
