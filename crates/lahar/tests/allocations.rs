//! A substep asks the system for no memory, once its buffers have grown.

#[expect(dead_code, reason = "other tests use the rest")]
mod common;

use common::{brawl, brawl_with_all_options, crowd};
use lahar::{Contact, Instance, ParticleBatch, Setup, Simulate, Simulation, Transfer};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Substeps that allocate, of those that do not sort, and how many there are of these.
fn allocating<T: Instance<D>, const D: usize>(
    (setup, batches): (Setup<D>, Vec<ParticleBatch<D>>),
) -> (usize, usize) {
    let mut simulation = Simulation::<T, D>::new(setup, &batches).expect("a good setup");
    let (mut allocating, mut unsorted) = (0, 0);
    for substep in 0..400 {
        let sorts = simulation.phase_times().sorts;
        let region = Region::new(ALLOCATOR);
        simulation.substep().expect("a substep");
        let allocations = region.change().allocations + region.change().reallocations;
        // The first ones after a sort fill what has grown with it.
        if substep > 100 && simulation.phase_times().sorts == sorts {
            unsorted += 1;
            allocating += usize::from(allocations > 0);
            if allocations > 0 && allocating < 4 { eprintln!("{substep}: {allocations}"); }
        }
    }
    (allocating, unsorted)
}

/// One test, since others at the same time would be counted too.
#[test]
fn a_substep_allocates_nothing() {
    let flip = |(mut setup, batches): (Setup<2>, Vec<ParticleBatch<2>>)| {
        setup.transfer = Transfer::Flip { blend: 0.95 };
        (setup, batches)
    };
    let colliders = |(mut setup, batches): (Setup<2>, Vec<ParticleBatch<2>>)| {
        setup.colliders = crowd(64.0 * setup.dx, Contact::Separate { friction: 0.2 });
        (setup, batches)
    };
    eprintln!("2d {:?}", allocating::<f32, 2>(brawl(64)));
    eprintln!("3d {:?}", allocating::<f32, 3>(brawl(24)));
    eprintln!("flip {:?}", allocating::<f64, 2>(flip(brawl(64))));
    eprintln!("options {:?}", allocating::<f32, 2>(brawl_with_all_options(64)));
    eprintln!("colliders {:?}", allocating::<f32, 2>(colliders(brawl(64))));
}
