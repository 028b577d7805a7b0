//! Speed of the phases of a substep: scatter, grid, gather, volume and sort, on one thread with the machine's widest
//! instruction set: `cargo bench -p lahar --bench phases`
//!
//! A simulation runs with a clock, and each measurement is the time of one phase in its substeps.

use criterion::{Criterion, Throughput};
use lahar::material::{Corotated, Dust, Snow, lame, preset};
use lahar::{Instance, Material, Model, ParticleBatch, PhaseTimes, Setup, Simulate, Simulation};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// Approximate number of particles of a body.
const PARTICLES: f64 = 1e5;

fn clock() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

fn one_thread() -> ThreadPool {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread can be started")
}

/// Builds a cube of a material with 2ᴰ particles per cell that flies and is sheared.
fn cube<T: Instance<D>, const D: usize>(model: Model) -> Box<dyn Simulate> {
    let cells = (PARTICLES / f64::powi(2.0, D as i32))
        .powf(1.0 / D as f64)
        .round();
    let (dx, per_side) = (1.0 / cells, 2 * cells as usize);
    let (mut position, mut velocity) = (Vec::new(), Vec::new());
    let mut state = 1_u64;
    for number in 0..per_side.pow(D as u32) {
        let mut rest = number;
        let x: [f64; D] = core::array::from_fn(|_| {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            let place = (rest % per_side) as f64 + (state >> 11) as f64 / (1_u64 << 53) as f64;
            rest /= per_side;
            0.5 * dx * place
        });
        velocity.push(core::array::from_fn(|axis| 1.0 + x[(axis + 1) % D]));
        position.push(x);
    }
    let material = Material {
        name: "cube".into(),
        density: 1000.0,
        model,
    };
    let batch = ParticleBatch {
        volume: vec![(0.5 * dx).powi(D as i32)],
        position,
        velocity,
        ..ParticleBatch::default()
    };
    let simulation = Simulation::<T, D>::new(Setup::new(dx, vec![material]), &[batch]);
    let mut simulation = simulation.expect("a cube can be simulated");
    simulation.set_clock(clock);
    Box::new(simulation)
}

/// Measures the time of `phase` in a substep, or in all substeps until the next sort.
fn time(
    criterion: &mut Criterion,
    name: &str,
    simulation: &mut Box<dyn Simulate>,
    phase: fn(&PhaseTimes) -> f64,
    until_sorted: bool,
) {
    let pool = one_thread();
    let mut group = criterion.benchmark_group("phases");
    group
        .sample_size(10)
        .throughput(Throughput::Elements(simulation.particle_count() as u64));
    group.bench_function(name, |bencher| {
        bencher.iter_custom(|count| {
            pool.install(|| {
                let start = simulation.phase_times();
                for _ in 0..count {
                    let sorts = simulation.phase_times().sorts;
                    loop {
                        simulation.substep().expect("the cube flies on");
                        if !until_sorted || simulation.phase_times().sorts > sorts {
                            break;
                        }
                    }
                }
                Duration::from_secs_f64(phase(&simulation.phase_times()) - phase(&start))
            })
        });
    });
    group.finish();
}

fn phases(criterion: &mut Criterion) {
    let (lambda, mu) = lame(1e5, 0.3);
    let water = || preset("water", 30.0).expect("water is a preset").model;
    let jelly = Model::Corotated(Corotated { lambda, mu });
    for (name, mut cube) in [
        ("water-2d", cube::<f32, 2>(water())),
        ("water-3d", cube::<f32, 3>(water())),
        ("water-3d-f64", cube::<f64, 3>(water())),
        ("jelly-3d", cube::<f32, 3>(jelly)),
        ("snow-3d", cube::<f32, 3>(Model::Snow(Snow::default()))),
    ] {
        let cube = &mut cube;
        time(
            criterion,
            &format!("scatter {name}"),
            cube,
            |times| times.scatter,
            false,
        );
        time(
            criterion,
            &format!("grid {name}"),
            cube,
            |times| times.grid,
            false,
        );
        time(
            criterion,
            &format!("gather {name}"),
            cube,
            |times| times.gather,
            false,
        );
        if name.starts_with("water") {
            time(
                criterion,
                &format!("volume {name}"),
                cube,
                |times| times.volume,
                false,
            );
        }
    }
    // Dust carries no sound, so its substeps are long: it crosses a cell in three.
    let mut dust = cube::<f32, 3>(Model::Dust(Dust));
    time(
        criterion,
        "sort dust-3d",
        &mut dust,
        |times| times.sort,
        true,
    );
    let mut dust = cube::<f32, 2>(Model::Dust(Dust));
    time(
        criterion,
        "sort dust-2d",
        &mut dust,
        |times| times.sort,
        true,
    );
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    phases(&mut criterion);
    criterion.final_summary();
}
