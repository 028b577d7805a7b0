//! Tests of scenes, from their text to the particles that they build, in one binary, so that the crate is linked once.
//!
//! The test of allocations is a binary of its own: its global allocator would count the allocations of other tests.

mod broken_scenes;
mod builtin;
mod formulas;
mod golden;
mod lineage;
mod scenes;
mod shapes;
mod support;
mod tutorial;
mod water;
