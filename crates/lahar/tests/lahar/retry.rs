//! A frame that fails is retried from its start with half the time step: the report, the retries, and the state that is
//! left.

use crate::fixtures::{ALL, bits, brawl, dust};
use lahar::material::{Corotated, Fluid, lame};
use lahar::{
    AccelerationField, Command, DtLimit, Failure, Force, Instance, Material, Model, ParticleBatch,
    Pointer, PointerAction, Retry, Setup, Simulate, Simulation, TimeStep, frame,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Returns a ball of jelly thrown at a wall, with a fixed step.
fn stiff_brawl<const D: usize>(dt: f64) -> (Setup<D>, Vec<ParticleBatch<D>>) {
    let (mut setup, mut batches) = brawl::<D>(16);
    batches.retain(|batch| batch.material == 1);
    let (lambda, mu) = lame(2e4, 0.3);
    setup.materials[1].model = Model::Corotated(Corotated { lambda, mu });
    setup.time_step = TimeStep::Fixed(dt);
    (setup, batches)
}

const TOO_LONG: f64 = 8e-3;
const FRAME: f64 = 64.0 * TOO_LONG;

/// Runs `count` frames and returns the bits after each and all retries.
fn frames<T: Instance<D>, const D: usize>(
    threads: usize,
    (setup, batches): &(Setup<D>, Vec<ParticleBatch<D>>),
    count: usize,
) -> (Vec<Vec<u64>>, Vec<Retry>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().expect("a pool").install(|| {
        let mut simulation = Simulation::<T, D>::new(setup.clone(), batches).expect("a good setup");
        let (mut all, mut retries) = (Vec::new(), Vec::new());
        for k in 1..=count {
            let end = k as f64 * FRAME;
            frame(
                &mut simulation,
                |simulation| simulation.advance_to(end),
                |retry| retries.push(retry.clone()),
            )
            .expect("a shorter step helps");
            all.push(bits(&simulation.snapshot(ALL)));
        }
        (all, retries)
    })
}

/// Checks that a retried frame has the bits of a frame that took the shorter step from the first, on any number of
/// threads.
fn a_retried_frame_is_a_frame_of_the_shorter_step<T: Instance<D>, const D: usize>() {
    let (retried, retries) = frames::<T, D>(1, &stiff_brawl(TOO_LONG), 2);
    let first = &retries[0];
    assert_eq!((first.time, first.part), (0.0, 0.5));
    assert_eq!(first.failure.material, "jelly");
    assert_eq!(first.failure.dt_limit, DtLimit::Fixed);
    assert!((1..=64).contains(&first.failure.substep), "{first}");
    let mut of_first = retries.iter().filter(|retry| retry.time == 0.0);
    let part = of_first.next_back().expect("a retry").part;
    let (direct, none) = frames::<T, D>(1, &stiff_brawl(TOO_LONG * part), 1);
    assert_eq!(none, []);
    assert!(direct[0] == retried[0], "{part}");
    for threads in [2, 3] {
        let (others, reported) = frames::<T, D>(threads, &stiff_brawl(TOO_LONG), 2);
        assert_eq!(reported, retries);
        assert!(others == retried, "{threads} threads");
    }
}

#[test]
fn a_retried_frame_is_a_frame_of_the_shorter_step_2d() {
    a_retried_frame_is_a_frame_of_the_shorter_step::<f32, 2>();
    a_retried_frame_is_a_frame_of_the_shorter_step::<f64, 2>();
}

#[test]
fn a_retried_frame_is_a_frame_of_the_shorter_step_3d() {
    a_retried_frame_is_a_frame_of_the_shorter_step::<f32, 3>();
    a_retried_frame_is_a_frame_of_the_shorter_step::<f64, 3>();
}

/// A force field that returns NaN while it is armed, from 0.1 s on.
#[derive(Debug, Default)]
struct Fault(AtomicBool);

impl<const D: usize> AccelerationField<D> for Fault {
    fn accelerations(&self, time: f64, _: &[[f64; D]], _: &[[f64; D]], out: &mut [[f64; D]]) {
        let fails = self.0.load(Ordering::Relaxed) && time >= 0.1;
        out.fill([if fails { f64::NAN } else { 0.0 }; D]);
    }
}

/// The brawl with a fault that ends when a frame has been retried a given number of times.
struct Faulty<const D: usize>
where
    f32: Instance<D>,
{
    fault: Arc<Fault>,
    simulation: Simulation<f32, D>,
}

impl<const D: usize> Faulty<D>
where
    f32: Instance<D>,
{
    fn new() -> Self {
        let fault = Arc::new(Fault::default());
        let (mut setup, batches) = brawl::<D>(16);
        setup.forces = vec![Force::Field(fault.clone())];
        Self {
            fault,
            simulation: Simulation::new(setup, &batches).unwrap(),
        }
    }

    /// Runs a frame of 0.02 s that fails `faults` times. Returns what limited its last substep, and its retries.
    fn frame(&mut self, number: u32, faults: usize) -> (Result<DtLimit, Failure>, Vec<Retry>) {
        self.fault.0.store(faults > 0, Ordering::Relaxed);
        let mut retries = Vec::new();
        let end = f64::from(number) * 0.02;
        let done = frame(
            &mut self.simulation,
            |simulation| simulation.advance_to(end),
            |retry: &Retry| {
                retries.push(retry.clone());
                self.fault
                    .0
                    .store(retries.len() < faults, Ordering::Relaxed);
            },
        );
        (done.map(|advance| advance.limit), retries)
    }
}

/// The time step doubles after every four good frames until it is restored.
#[test]
fn the_time_step_recovers() {
    let mut faulty = Faulty::<2>::new();
    for number in 1..=5 {
        assert_eq!(faulty.frame(number, 0).1, []);
    }
    let (done, retries) = faulty.frame(6, 2);
    assert_eq!(done, Ok(DtLimit::Retry));
    let parts: Vec<f64> = retries.iter().map(|retry| retry.part).collect();
    assert_eq!(parts, [0.5, 0.25]);
    assert!((retries[0].time - 0.1).abs() < 1e-12 && retries[1].time == retries[0].time);
    let text = retries[1].to_string();
    assert!(text.contains("with 1/4 of the time step"), "{text}");
    assert!(text.contains("limited by retry"), "{text}");
    let mut substeps = Vec::new();
    for number in 7..=15 {
        let before = faulty.simulation.substeps();
        let (done, retries) = faulty.frame(number, 0);
        assert_eq!(retries, []);
        substeps.push((faulty.simulation.substeps() - before, done.unwrap()));
    }
    let limits: Vec<bool> = (substeps.iter().map(|(_, limit)| *limit == DtLimit::Retry)).collect();
    assert_eq!(limits, [[true; 7].as_slice(), &[false; 2]].concat());
    let ratio = |a: usize, b: usize| substeps[a].0 as f64 / substeps[b].0 as f64;
    assert!(
        (ratio(2, 3) - 2.0).abs() < 0.3 && (ratio(6, 7) - 2.0).abs() < 0.3,
        "{substeps:?}"
    );
}

/// Checks that a frame that fails even with 1/64 of the step leaves the state of its start.
fn a_hopeless_frame_leaves_the_state_of_its_start<const D: usize>()
where
    f32: Instance<D>,
{
    let mut faulty = Faulty::<D>::new();
    for number in 1..=5 {
        assert_eq!(faulty.frame(number, 0).1, []);
    }
    let before = bits(&faulty.simulation.snapshot(ALL));
    let totals = faulty.simulation.diagnostics();
    let (done, retries) = faulty.frame(6, usize::MAX);
    let failure = done.unwrap_err();
    assert_eq!(
        retries.last().map(|retry| (retries.len(), retry.part)),
        Some((6, 1.0 / 64.0))
    );
    let text = failure.to_string();
    for word in [
        "finite number",
        "substep",
        "particle",
        "material \"",
        "limited by retry",
    ] {
        assert!(text.contains(word), "{text}");
    }
    assert!(before == bits(&faulty.simulation.snapshot(ALL)));
    assert_eq!(totals, faulty.simulation.diagnostics());
    // Without the fault, the run continues as if nothing had happened.
    let mut untouched = Faulty::<D>::new();
    for number in 1..=5 {
        assert_eq!(untouched.frame(number, 0).1, []);
    }
    let limits = [&mut faulty, &mut untouched].map(|one| one.frame(6, 0));
    assert_eq!(limits[0], limits[1]);
    let ends = [&faulty, &untouched].map(|one| bits(&one.simulation.snapshot(ALL)));
    assert!(ends[0] == ends[1]);
}

#[test]
fn a_hopeless_frame_leaves_the_state_of_its_start_2d() {
    a_hopeless_frame_leaves_the_state_of_its_start::<2>();
}

#[test]
fn a_hopeless_frame_leaves_the_state_of_its_start_3d() {
    a_hopeless_frame_leaves_the_state_of_its_start::<3>();
}

fn thrown<T: Instance<2>>(from: f64, speed: f64) -> Result<(), Failure> {
    let mut setup = Setup::<2>::new(0.1, vec![dust()]);
    setup.time_step = TimeStep::Fixed(1e-3);
    let batch = ParticleBatch {
        position: vec![[from, 0.0]],
        velocity: vec![[speed, 0.0]],
        volume: vec![1e-2],
        ..ParticleBatch::default()
    };
    let mut simulation = Simulation::<T, 2>::new(setup, &[batch]).unwrap();
    frame(&mut simulation, |s| s.advance_to(1.0), |_| {})?;
    Ok(())
}

/// A particle that moves too far for its place to be represented stops the run with a failure that says so.
#[test]
fn a_particle_out_of_range_is_a_failure() {
    for failure in [thrown::<f32>(0.0, 1e30), thrown::<f64>(0.0, 1e30)] {
        let text = failure.unwrap_err().to_string();
        assert!(
            text.contains("jumped") && text.contains("particle 0"),
            "{text}"
        );
    }
    // 90 cells per substep, from 1000 cells before the last block that can be numbered.
    let near = 0.1 * (8.0 * f64::from(1 << 27) - 1000.0);
    for failure in [thrown::<f32>(near, 9e3), thrown::<f64>(near, 9e3)] {
        let failure = failure.unwrap_err();
        assert!(failure.problem.contains("too far"), "{failure}");
    }
    for fine in [thrown::<f32>(0.0, 9e3), thrown::<f64>(0.0, 9e3)] {
        assert_eq!(fine, Ok(()));
    }
}

/// Commands that were given during a failed frame stay in force when it is retried.
#[test]
fn commands_outlast_a_retry() {
    let water = Material {
        name: "water".into(),
        density: 1000.0,
        model: Model::Fluid(Fluid::inviscid(1e5)),
    };
    let batch = ParticleBatch {
        position: (0..400)
            .map(|i| [0.05 * f64::from(i % 20), 0.05 * f64::from(i / 20)])
            .collect(),
        volume: vec![0.0025],
        ..ParticleBatch::default()
    };
    let mut simulation = Simulation::<f64, 2>::new(Setup::new(0.1, vec![water]), &[batch]).unwrap();
    simulation.begin_frame();
    simulation.substep().unwrap();
    simulation.command(Command::Gravity([0.0, -2.0, 0.0]));
    simulation.command(Command::SoundSpeed {
        material: 0,
        speed: 40.0,
    });
    let stiffer_dt = simulation.next_dt().0;
    simulation.command(Command::Pointer(Some(Pointer {
        position: [0.5, 0.5, 0.0],
        radius: 1.0,
        softening: 0.0,
        action: PointerAction::Attract(f64::NAN),
    })));
    let failure = simulation.substep().unwrap_err();
    let retry = simulation.retry_frame(&failure).unwrap();
    assert_eq!((retry.time, simulation.substeps()), (0.0, 0));
    assert_eq!(simulation.gravity(), [0.0, -2.0, 0.0]);
    assert_eq!(simulation.next_dt().0, 0.5 * stiffer_dt);
    assert!(simulation.substep().is_err(), "the pointer still acts");
    simulation.command(Command::Pointer(None));
    simulation.retry_frame(&failure).unwrap();
    simulation.substep().unwrap();
}

#[test]
fn a_retry_needs_the_start_of_a_frame_whose_copy_counts_as_memory() {
    let (setup, batches) = brawl::<3>(16);
    let mut simulation = Simulation::<f32, 3>::new(setup, &batches).unwrap();
    let particles = simulation.particle_count();
    assert_eq!(simulation.memory().retry_bytes, 0);
    let failure = Failure {
        problem: String::new(),
        particle: 0,
        material: String::new(),
        body: 0,
        position: [0.0; 3],
        count: 1,
        substep: 1,
        time: 0.0,
        dt: 1.0,
        dt_limit: DtLimit::Fixed,
    };
    assert_eq!(simulation.retry_frame(&failure), None);
    simulation.begin_frame();
    let bytes = simulation.memory().retry_bytes / particles;
    assert!((64..160).contains(&bytes), "{bytes} bytes per particle");
}
