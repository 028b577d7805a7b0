//! Formulas of a scene allocate no memory while it runs, once buffers have grown.

use lahar::Isa;
use lahar_scene::scene::Scene;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// A scene whose gravity varies in time and space, with a force by place and one by starting positions.
const STIRRED: &str = r#"
dx = 0.02
gravity = ["0.3*sin(5*t)", "-9.81 - 0.1*y"]
[domain]
min = [0.0, 0.0]
max = [1.0, 1.0]
[materials.water]
preset = "water"
[[bodies]]
name = "pool"
material = "water"
shape = { box = { min = [0.1, 0.1], max = [0.7, 0.6] } }
[[forces]]
name = "wind"
acceleration = ["3*cos(8*x)*(y > 0.2)", "sin(t)*x*y"]
[[forces]]
name = "home"
acceleration = ["X*sin(3*t)", "Y - y"]
"#;

#[test]
fn formulas_allocate_nothing() {
    let scene = Scene::parse(STIRRED, "stirred.toml", &[]).unwrap_or_else(|e| panic!("{e}"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    pool.expect("two threads").install(|| {
        let built = scene.build(Isa::Portable).unwrap_or_else(|e| panic!("{e}"));
        let mut simulation = built.simulation;
        let mut unsorted = 0;
        for substep in 0..800 {
            let sorts = simulation.phase_times().sorts;
            let region = Region::new(ALLOCATOR);
            simulation.substep().expect("a substep");
            let change = region.change();
            if substep >= 400 && simulation.phase_times().sorts == sorts {
                unsorted += 1;
                let asked = change.allocations + change.reallocations;
                assert_eq!(asked, 0, "substep {substep} allocates");
            }
        }
        assert!(
            simulation.phase_times().sorts > 2,
            "the particles were sorted too rarely"
        );
        assert!(unsorted > 200, "only {unsorted} substeps without a sort");
    });
}
