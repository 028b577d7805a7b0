//! A run that is resumed from a checkpoint has the bits of one that was never interrupted.

use crate::fixtures::{ALL, bits, brawl, colliders_of_all_kinds};
use lahar::checkpoint::{Array, Values};
use lahar::{
    AccelerationField, Checkpoint, Command, Contact, Diagnostics, Force, Gauge, Instance,
    ParticleBatch, Plate, Pointer, PointerAction, Probe, ProbeSamples, Setup, Simulate, Simulation,
    TimeStep, frame,
};
use std::sync::Arc;

const FRAME: f64 = 0.02;

/// Pulls each particle toward its starting position.
#[derive(Debug)]
struct Spring;

impl<const D: usize> AccelerationField<D> for Spring {
    fn accelerations(&self, _: f64, x: &[[f64; D]], start: &[[f64; D]], out: &mut [[f64; D]]) {
        for ((out, x), start) in out.iter_mut().zip(x).zip(start) {
            *out = core::array::from_fn(|axis| 5.0 * (start[axis] - x[axis]));
        }
    }
    fn depends_on_start(&self) -> bool {
        true
    }
}

/// A scene with every kind of state: colliders, forces that depend on starting positions, and gauges.
fn eventful<const D: usize>(cells: usize) -> (Setup<D>, Vec<ParticleBatch<D>>) {
    let (mut setup, batches) = brawl::<D>(cells);
    let size = setup.dx * cells as f64;
    setup.colliders = colliders_of_all_kinds(size, Contact::Separate { friction: 0.3 });
    setup.forces = vec![Force::Field(Arc::new(Spring))];
    let probe = |name: &str, rate, gauge| Probe {
        name: name.into(),
        rate,
        gauge,
    };
    let mut low = [0.5 * size; D];
    low[1] = 0.0;
    let mut up = [0.0; D];
    up[1] = 1.0;
    setup.probes = vec![
        probe(
            "floor",
            173.0,
            Gauge::Pressure {
                at: low,
                radius: 3.0 * setup.dx,
                plate: Some(Plate {
                    normal: up,
                    width: 4.0 * setup.dx,
                }),
            },
        ),
        probe(
            "height",
            60.0,
            Gauge::Height {
                up: 1,
                column: None,
            },
        ),
        probe(
            "load",
            90.0,
            Gauge::Force {
                on: "bottom".into(),
            },
        ),
    ];
    (setup, batches)
}

/// The results of a frame: bits of the particles, totals, probe samples, and the number of substeps.
type FrameResult = (Vec<u64>, Diagnostics, Vec<ProbeSamples>, u64);

/// Runs the frames with these numbers on `threads` threads.
fn frames(
    simulation: &mut dyn Simulate,
    threads: usize,
    numbers: core::ops::RangeInclusive<u32>,
) -> Vec<FrameResult> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().expect("a pool");
    pool.install(|| {
        numbers
            .map(|number| {
                let end = f64::from(number) * FRAME;
                frame(&mut *simulation, |s| s.advance_to(end), |_| {}).expect("it runs");
                (
                    bits(&simulation.snapshot(ALL)),
                    simulation.diagnostics(),
                    simulation.take_probe_samples(),
                    simulation.substeps(),
                )
            })
            .collect()
    })
}

fn fresh<T: Instance<D>, const D: usize>(
    (setup, batches): &(Setup<D>, Vec<ParticleBatch<D>>),
) -> Simulation<T, D> {
    Simulation::new(setup.clone(), batches).expect("a good setup")
}

/// Checks that a run resumed from a checkpoint at any frame, on another number of threads, has the same results, and
/// that a run that writes checkpoints has the results of one that does not.
fn resumes_with_the_same_bits<T: Instance<D>, const D: usize>(
    scene: &(Setup<D>, Vec<ParticleBatch<D>>),
) {
    const FRAMES: u32 = 6;
    let unbroken = frames(&mut fresh::<T, D>(scene), 1, 1..=FRAMES);
    let mut first = fresh::<T, D>(scene);
    let mut drifted = 0;
    for stop in 0..FRAMES {
        let checkpoint = first.checkpoint();
        let drift = checkpoint.arrays.iter().find(|array| array.name == "drift");
        drifted += usize::from(drift.expect("it is there").values != Values::F64(vec![0.0]));
        let mut second = fresh::<T, D>(scene);
        second
            .resume(checkpoint.clone())
            .expect("a sound checkpoint");
        assert_eq!(second.checkpoint(), checkpoint);
        let threads = 1 + stop as usize % 2;
        let mut left = frames(&mut second, threads, stop + 1..=FRAMES);
        let mut expected = unbroken[stop as usize..].to_vec();
        if stop == 0 {
            // Nobody has taken the readings at the start yet, so both runs still return them.
            assert!(left[0].2.iter().all(|probe| probe.samples[0].time == 0.0));
        }
        assert!(left == expected, "from frame {stop}");
        assert_eq!(
            first.boundary_impulses().len(),
            2 * D + scene.0.colliders.len()
        );
        // The resumed run is interrupted and resumed once more.
        let mut third = fresh::<T, D>(scene);
        third.resume(checkpoint).expect("a sound checkpoint");
        left = frames(&mut third, 1, stop + 1..=stop + 1);
        expected.truncate(1);
        assert!(left == expected, "frame {} alone", stop + 1);
        let went_on = frames(&mut first, 2, stop + 1..=stop + 1);
        assert!(went_on[0] == unbroken[stop as usize], "with checkpoints");
    }
    assert!(
        drifted > 2,
        "only {drifted} checkpoints lie between two sorts"
    );
}

#[test]
fn resumes_with_the_same_bits_2d() {
    resumes_with_the_same_bits::<f32, 2>(&eventful(32));
    resumes_with_the_same_bits::<f64, 2>(&eventful(32));
}

#[test]
fn resumes_with_the_same_bits_3d() {
    resumes_with_the_same_bits::<f32, 3>(&eventful(16));
    resumes_with_the_same_bits::<f64, 3>(&eventful(16));
}

/// A checkpoint keeps a step that a retry has shortened, and how far it has recovered.
#[test]
fn a_shortened_step_survives_a_checkpoint() {
    let (mut setup, batches) = brawl::<2>(16);
    setup.time_step = TimeStep::Fixed(FRAME / 4.0);
    let scene = (setup, batches);
    let unbroken = frames(&mut fresh::<f32, 2>(&scene), 1, 1..=12);
    let retried = unbroken.iter().filter(|left| left.1.dt_limit == "retry");
    assert!(retried.count() > 3, "too few frames fail at this step");
    let mut simulation = fresh::<f32, 2>(&scene);
    for number in 1..=12 {
        let checkpoint = simulation.checkpoint();
        simulation = fresh(&scene);
        simulation.resume(checkpoint).expect("a sound checkpoint");
        let left = frames(&mut simulation, 1, number..=number);
        assert!(left[0] == unbroken[number as usize - 1], "frame {number}");
    }
}

/// A checkpoint keeps gravity, the stiffness of fluids and the pointer as commands have set them.
#[test]
fn commands_survive_a_checkpoint() {
    let scene = brawl::<2>(32);
    let mut one = fresh::<f32, 2>(&scene);
    one.command(Command::Gravity([3.0, 0.5, 0.0]));
    let usual_dt = one.next_dt().0;
    for material in 0..one.materials().len() {
        let speed = 2e3;
        one.command(Command::SoundSpeed { material, speed });
    }
    assert!(one.next_dt().0 < 0.5 * usual_dt, "there is a fluid");
    for action in [
        PointerAction::Attract(20.0),
        PointerAction::Drag([1.0, 2.0, 0.0]),
        PointerAction::Push {
            acceleration: 30.0,
            power: 2.0,
        },
    ] {
        one.command(Command::Pointer(Some(Pointer {
            position: [0.5, 0.5, 0.0],
            radius: 0.3,
            softening: 0.01,
            action,
        })));
        let mut two = fresh::<f32, 2>(&scene);
        two.resume(one.checkpoint()).expect("a sound checkpoint");
        assert_eq!(two.gravity(), [3.0, 0.5, 0.0]);
        let from = (one.time() / FRAME).round() as u32;
        let ends = [&mut one, &mut two].map(|s| frames(s, 1, from + 1..=from + 2));
        assert!(ends[0] == ends[1], "{action:?}");
    }
}

/// A frame that is stopped can be taken back to its start, and the run then continues as if it had not begun.
#[test]
fn a_frame_that_is_given_up_leaves_no_trace() {
    let scene = eventful::<2>(32);
    let unbroken = frames(&mut fresh::<f32, 2>(&scene), 1, 1..=3);
    let mut simulation = fresh::<f32, 2>(&scene);
    assert!(!simulation.give_up_frame(), "no frame has begun");
    frames(&mut simulation, 1, 1..=1);
    let before = simulation.checkpoint();
    let mut left = 3;
    let stop = &mut || {
        left -= 1;
        left >= 0
    };
    simulation.begin_frame();
    let done = simulation
        .advance_while(2.0 * FRAME, stop)
        .expect("it runs");
    assert_eq!(done.substeps, 3);
    assert!(simulation.time() < 2.0 * FRAME);
    assert!(simulation.give_up_frame());
    assert_eq!(simulation.checkpoint(), before);
    let left = frames(&mut simulation, 1, 2..=3);
    assert!(left == unbroken[1..]);
}

/// Returns the checkpoint with one array missing or altered in one of five ways.
fn damaged(checkpoint: &Checkpoint, index: usize, how: usize) -> Checkpoint {
    let mut checkpoint = checkpoint.clone();
    let array = &mut checkpoint.arrays[index];
    let longer = |array: &mut Array| match &mut array.values {
        Values::F32(values) => values.push(1.0),
        Values::F64(values) => values.push(1.0),
        Values::U32(values) => values.push(1),
        Values::I32(values) => values.push(1),
        Values::U64(values) => values.push(1),
    };
    match how {
        0 => drop(checkpoint.arrays.remove(index)),
        1 => longer(array), // more values than the shape says
        2 => {
            longer(array);
            array.shape = vec![array.values.len()];
        }
        3 => {
            let other = Values::F32(vec![0.5; array.values.len()]);
            array.values = match array.values {
                Values::F32(_) => Values::U32(vec![0; array.values.len()]),
                _ => other,
            };
        }
        _ => array.name.push('x'),
    }
    checkpoint
}

/// Every array is required and checked: the error names a wrong one, and the simulation stays as it was.
#[test]
fn damaged_arrays_are_named_and_nothing_changes() {
    let scene = eventful::<2>(32);
    let mut simulation = fresh::<f32, 2>(&scene);
    frames(&mut simulation, 1, 1..=2);
    let good = simulation.checkpoint();
    let mut other = fresh::<f32, 2>(&scene);
    let before = other.checkpoint();
    for index in 0..good.arrays.len() {
        for how in 0..5 {
            let name = &good.arrays[index].name;
            let error = other.resume(damaged(&good, index, how));
            let error = error.expect_err(&format!("{name} damaged by {how}"));
            assert!(!error.problem.is_empty() && error.to_string().contains(&error.array));
        }
    }
    let mut more = good.clone();
    more.arrays.push(Array {
        name: "more".into(),
        shape: vec![],
        values: Values::U32(vec![1]),
    });
    assert_eq!(other.resume(more).expect_err("too much").array, "more");
    assert!(other.checkpoint() == before);
    other.resume(good).expect("a sound checkpoint");
}

/// Values that no run produces are refused.
#[test]
fn impossible_values_are_refused() {
    let scene = brawl::<3>(16);
    let mut simulation = fresh::<f64, 3>(&scene);
    let good = simulation.checkpoint();
    let mut refused = |name: &str, change: &dyn Fn(&mut Values)| {
        let mut bad = good.clone();
        let array = bad.arrays.iter_mut().find(|array| array.name == name);
        change(&mut array.unwrap_or_else(|| panic!("there is no {name}")).values);
        let error = simulation.resume(bad).expect_err(name);
        assert!(error.to_string().contains(name), "{error}");
    };
    let set = |index: usize, to: f64| {
        move |values: &mut Values| match values {
            Values::F64(values) => values[index] = to,
            other => panic!("{other:?}"),
        }
    };
    refused("materials.0.position.1", &set(3, 100.0));
    refused("materials.0.velocity.0", &set(0, f64::NAN));
    refused("materials.1.strain.4", &set(0, f64::INFINITY));
    refused("materials.2.mass", &set(0, -1.0));
    refused("drift", &set(0, f64::NAN));
    refused("drift", &set(0, 1e9));
    refused("step", &set(8, 0.3)); // not a power of two
    refused("step", &set(6, -1.0));
    refused("counts", &|values| {
        *values = Values::U64(vec![0, 99, 0, 0, 0])
    });
    refused("counts", &|values| {
        *values = Values::U64(vec![u64::MAX, 0, 0, 0, 0]) // the next substep would have no number
    });
    refused("counts", &|values| {
        *values = Values::U64(vec![0, 0, u64::from(u32::MAX), 0, 0])
    });
    refused("next_id", &|values| {
        *values = Values::U32(vec![u32::MAX]) // a snapshot would take 32 GB
    });
    refused("materials.0.id", &|values| {
        *values = Values::U32(vec![u32::MAX])
    });
    refused("materials.0.runs.start", &|values| match values {
        Values::U32(starts) => starts[0] = 1,
        other => panic!("{other:?}"),
    });
    refused("materials.0.runs.block", &|values| match values {
        Values::I32(blocks) => blocks[0] = i32::MIN,
        other => panic!("{other:?}"),
    });
    let twice = &|values: &mut Values| match values {
        Values::U32(ids) => ids[1] = ids[0],
        other => panic!("{other:?}"),
    };
    let mut bad = good.clone();
    let ids = bad
        .arrays
        .iter_mut()
        .find(|array| array.name == "materials.3.id");
    twice(&mut ids.expect("there are").values);
    assert!(
        simulation
            .resume(bad)
            .expect_err("twice")
            .problem
            .contains("two particles")
    );
}

/// Found by changing arrays at random: the first substep moved particles of a block far outside the walls back inside,
/// beyond their tile.
#[test]
fn particles_outside_the_walls_are_refused() {
    let mut simulation = fresh::<f32, 2>(&brawl::<2>(32));
    let mut bad = simulation.checkpoint();
    let name = "materials.1.runs.block";
    let blocks = bad.arrays.iter_mut().find(|array| array.name == name);
    match &mut blocks.expect("it is there").values {
        Values::I32(blocks) => blocks[0] = -129,
        other => panic!("{other:?}"),
    }
    let error = simulation
        .resume(bad)
        .expect_err("no particle can be there");
    assert!(
        error.array == name && error.problem.contains("walls"),
        "{error}"
    );
}

/// A drift that is too small would let particles leave their tile before they are sorted.
#[test]
fn particles_beyond_their_drift_are_refused() {
    let scene = brawl::<2>(32);
    let mut simulation = fresh::<f64, 2>(&scene);
    frames(&mut simulation, 1, 1..=2);
    let mut bad = simulation.checkpoint();
    let drift = bad.arrays.iter_mut().find(|array| array.name == "drift");
    let drift = &mut drift.expect("it is there").values;
    assert_ne!(*drift, Values::F64(vec![0.0]));
    *drift = Values::F64(vec![0.0]);
    let error = simulation.resume(bad).expect_err("particles have moved");
    assert!(error.array.contains("position"), "{error}");
}
