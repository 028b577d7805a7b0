//! A substep allocates no memory once its buffers have grown.

#[path = "lahar/fixtures.rs"]
#[expect(dead_code, reason = "the other tests of the crate use the rest")]
mod fixtures;

use fixtures::{brawl, brawl_with_all_options, colliders_of_all_kinds};
use lahar::{
    AccelerationField, Contact, Force, Instance, ParticleBatch, Pull, Setup, Simulate, Simulation,
    Transfer,
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Pulls each particle toward its starting position.
#[derive(Debug)]
struct Homesick;

impl AccelerationField<2> for Homesick {
    fn accelerations(&self, _: f64, at: &[[f64; 2]], starts: &[[f64; 2]], out: &mut [[f64; 2]]) {
        for ((a, x), start) in out.iter_mut().zip(at).zip(starts) {
            *a = [0, 1].map(|i| 3.0 * (start[i] - x[i]));
        }
    }

    fn depends_on_start(&self) -> bool {
        true
    }
}

/// Runs 600 substeps and looks at those of the second half that do not sort: returns how many of them allocate, and
/// how many there are.
fn allocating<T: Instance<D>, const D: usize>(
    (setup, batches): (Setup<D>, Vec<ParticleBatch<D>>),
) -> (usize, usize) {
    let mut simulation = Simulation::<T, D>::new(setup, &batches).expect("a good setup");
    let (mut allocating, mut unsorted) = (0, 0);
    for substep in 0..600 {
        let sorts = simulation.phase_times().sorts;
        let region = Region::new(ALLOCATOR);
        simulation.substep().expect("a substep");
        let change = region.change();
        if substep >= 300 && simulation.phase_times().sorts == sorts {
            unsorted += 1;
            allocating += usize::from(change.allocations + change.reallocations > 0);
        }
    }
    assert!(
        simulation.phase_times().sorts > 2,
        "the buffers have not been used twice"
    );
    (allocating, unsorted)
}

/// All scenes are one test, since a test that runs at the same time would be counted too. It runs inside a thread pool:
/// rayon allocates now and then when a call comes from outside.
#[test]
fn a_substep_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    pool.expect("two threads").install(|| {
        let none = |scene: &str, (allocating, of): (usize, usize)| {
            assert!(of > 200, "{scene}: only {of} substeps without a sort");
            assert_eq!(allocating, 0, "{scene}: substeps of {of} that allocate");
        };
        none("2D", allocating::<f32, 2>(brawl(64)));
        none("3D", allocating::<f32, 3>(brawl(24)));
        none(
            "all options",
            allocating::<f32, 2>(brawl_with_all_options(64)),
        );
        let (mut setup, batches) = brawl(64);
        setup.transfer = Transfer::Flip { blend: 0.95 };
        setup.forces = vec![Force::Central(Pull {
            center: [1.0, 1.0],
            acceleration: 5.0,
            distance: 1.0,
            power: 2.0,
            softening: 0.1,
        })];
        none("FLIP in a field", allocating::<f64, 2>((setup, batches)));

        let (mut setup, batches) = brawl(64);
        setup.forces = vec![Force::Field(Arc::new(Homesick))];
        none("pushed home", allocating::<f32, 2>((setup, batches)));

        // The number of nodes near colliders varies, so buffers grow until they have held the largest number.
        let (mut setup, batches) = brawl(64);
        setup.colliders =
            colliders_of_all_kinds(64.0 * setup.dx, Contact::Separate { friction: 0.2 });
        let (allocating, of) = allocating::<f32, 2>((setup, batches));
        assert!(
            allocating * 10 < of,
            "colliders: {allocating} of {of} substeps allocate"
        );
    });
}
