//! The simulator through its public interface. One program, so that the crate is linked once; only the count of
//! allocations is a program of its own, since its allocator counts what other tests ask for.

mod against_reference;
mod checkpoint;
mod colliders;
mod decompositions;
mod determinism;
mod engine;
mod equations;
mod fixtures;
mod forces;
mod materials;
mod method;
mod pointer;
mod probes;
mod retry;
mod walled;
mod walls;
