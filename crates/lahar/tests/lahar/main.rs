//! Tests of the simulator through its public interface, in one binary, so that the crate is linked once.
//!
//! The test of allocations is a binary of its own: its global allocator would count the allocations of other tests.

mod adding;
mod against_reference;
mod checkpoint;
mod colliders;
mod decompositions;
mod determinism;
mod equations;
mod fixtures;
mod fluids;
mod forces;
mod materials;
mod pointer;
mod probes;
mod retry;
mod tutorial;
mod walled;
mod walls;
