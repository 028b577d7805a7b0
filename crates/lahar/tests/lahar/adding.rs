//! Particles that are added: in any number of batches, at the start or later, with the same bits.

use crate::fixtures::{ALL, ball, bits, brawl};
use lahar::particles::Field;
use lahar::{Deformation, Instance, ParticleBatch, Setup, Simulate, Simulation};
use lahar_lab::method::random::Random;

fn fresh<T: Instance<D>, const D: usize>(
    setup: &Setup<D>,
    batches: &[ParticleBatch<D>],
) -> Simulation<T, D> {
    Simulation::new(setup.clone(), batches).expect("a good setup")
}

/// Splits a batch into one per particle.
fn singles<const D: usize>(batch: &ParticleBatch<D>) -> Vec<ParticleBatch<D>> {
    let one = |position: &[f64; D]| ParticleBatch {
        position: vec![*position],
        ..batch.clone()
    };
    batch.position.iter().map(one).collect()
}

/// A small ball that falls, with its center at `x` and `y` as parts of the box of a brawl of `cells` cells.
fn falling_ball<const D: usize>(
    material: usize,
    cells: usize,
    seed: u64,
    [x, y]: [f64; 2],
) -> ParticleBatch<D> {
    let size = cells as f64 / 32.0;
    let mut center = [0.5 * size; D];
    (center[0], center[1]) = (x * size, y * size);
    let mut velocity = [0.1; D];
    velocity[1] = -1.0;
    let (radius, dx) = (0.05 * size, 1.0 / 32.0);
    ball(material, center, radius, dx, velocity, &mut Random(seed))
}

/// Adds `batches` one after the other, runs on, and returns all bits and the checkpoint at the end.
fn bits_after<T: Instance<D>, const D: usize>(
    mut simulation: Simulation<T, D>,
    batches: &[ParticleBatch<D>],
) -> (Vec<u64>, lahar::Checkpoint) {
    for batch in batches {
        simulation.add(batch).expect("a good batch");
    }
    let end = simulation.time() + 0.1;
    simulation.advance_to(end).expect("it runs");
    (bits(&simulation.snapshot(ALL)), simulation.checkpoint())
}

fn batches_at_once_or_one_by_one<T: Instance<D>, const D: usize>(cells: usize) {
    let (setup, batches) = brawl::<D>(cells);
    let at_once = bits_after(fresh::<T, D>(&setup, &batches), &[]);
    let (first, rest) = batches.split_first().expect("some");
    let one_by_one = bits_after(fresh::<T, D>(&setup, core::slice::from_ref(first)), rest);
    assert!(at_once == one_by_one);
}

#[test]
fn batches_at_once_or_one_by_one_have_the_same_bits() {
    batches_at_once_or_one_by_one::<f32, 2>(32);
    batches_at_once_or_one_by_one::<f64, 2>(32);
    batches_at_once_or_one_by_one::<f32, 3>(16);
}

/// Particles are added between two sorts, some to blocks that have particles of the same material.
fn adding_under_way<T: Instance<D>, const D: usize>(cells: usize) {
    let (setup, batches) = brawl::<D>(cells);
    let running = || {
        let mut simulation = fresh::<T, D>(&setup, &batches);
        simulation.advance_to(0.05).expect("it runs");
        let checkpoint = simulation.checkpoint();
        let drift = checkpoint.arrays.iter().find(|array| array.name == "drift");
        let lahar::checkpoint::Values::F64(drift) = &drift.expect("it is there").values else {
            panic!("the drift is a real number");
        };
        assert!(drift[0] > 0.0, "the last substep has sorted");
        simulation
    };
    // Beside water and jelly that are there, and elsewhere.
    let new = [
        falling_ball(0, cells, 3, [0.86, 0.55]),
        falling_ball(1, cells, 4, [0.545, 0.9]),
        falling_ball(0, cells, 5, [0.9, 0.9]),
    ];
    let whole = bits_after(running(), &new);
    let parts: Vec<_> = new.iter().flat_map(singles).collect();
    assert!(parts.len() > 30, "only {} particles", parts.len());
    assert!(whole == bits_after(running(), &parts));
}

#[test]
fn adding_under_way_in_any_parts_has_the_same_bits() {
    adding_under_way::<f32, 2>(32);
    adding_under_way::<f32, 3>(16);
}

/// A checkpoint says where every row is, and is read back only if all of it is sound.
#[test]
fn a_run_that_has_grown_goes_on_from_a_checkpoint() {
    let (setup, batches) = brawl::<2>(32);
    let mut simulation = fresh::<f32, 2>(&setup, &batches);
    let mut lighter = falling_ball::<2>(0, 32, 6, [0.9, 0.9]);
    lighter.mass = (0..lighter.position.len())
        .map(|i| 1e-3 * (1.0 + i as f64))
        .collect();
    lighter.body = 17;
    let mut squeezed = falling_ball::<2>(2, 32, 7, [0.9, 0.9]);
    squeezed.deformation = Deformation::Jacobian(vec![0.99; squeezed.position.len()]);
    for batch in [lighter, squeezed] {
        simulation
            .advance_to(simulation.time() + 0.03)
            .expect("it runs");
        let before = simulation.snapshot(ALL);
        let first_id = before.count;
        simulation.add(&batch).expect("a good batch");
        let after = simulation.snapshot(ALL);
        assert_eq!(after.count, before.count + batch.position.len());
        // Everyone who was there is as before, and the new ones are as they were given.
        for ((field, before), (_, after)) in before.columns.iter().zip(&after.columns) {
            let (before, after) = (before.to_f64(), after.to_f64());
            assert_eq!(before, after[..before.len()], "{field:?}");
        }
        let masses = after.get(Field::Mass).expect("it was asked for").to_f64();
        for (mass, given) in masses[first_id..].iter().zip(&batch.mass) {
            assert!((mass / given - 1.0).abs() < 1e-6);
        }
        let mut other = fresh::<f32, 2>(&setup, &batches);
        let checkpoint = simulation.checkpoint();
        other.resume(checkpoint.clone()).expect("it is whole");
        assert_eq!(other.checkpoint(), checkpoint);
        let end = simulation.time() + 0.02;
        for simulation in [&mut simulation, &mut other] {
            simulation.advance_to(end).expect("it runs");
        }
        assert!(simulation.checkpoint() == other.checkpoint());
    }
}

#[test]
fn a_bad_batch_adds_nothing() {
    let (setup, batches) = brawl::<2>(32);
    let mut simulation = fresh::<f32, 2>(&setup, &batches);
    let before = simulation.checkpoint();
    let good = falling_ball::<2>(0, 32, 8, [0.9, 0.9]);
    let mut no_material = good.clone();
    no_material.material = 99;
    let mut not_a_number = good.clone();
    not_a_number.position[3][0] = f64::NAN;
    for (bad, key) in [(no_material, "material"), (not_a_number, "position")] {
        let error = simulation.add(&bad).expect_err("a bad batch");
        assert_eq!(error.key, key);
        assert!(simulation.checkpoint() == before, "{error}");
    }
}

#[test]
fn a_batch_without_its_dimension_is_the_same() {
    let (setup, batches) = brawl::<2>(32);
    let batch = ParticleBatch {
        affine: vec![[[0.1, 0.2], [0.3, 0.4]]; 2],
        deformation: Deformation::Gradient(vec![[[1.01, 0.02], [0.0, 0.98]]; 2]),
        position: vec![[0.5, 0.7], [0.52, 0.7]],
        ..falling_ball::<2>(1, 32, 9, [0.9, 0.9])
    };
    let pad = |x: &[f64; 2]| [x[0], x[1], 7.0];
    let pad_rows = |m: &[[f64; 2]; 2]| [pad(&m[0]), pad(&m[1]), [8.0; 3]];
    let erased = ParticleBatch::<3> {
        material: batch.material,
        body: batch.body,
        position: batch.position.iter().map(pad).collect(),
        velocity: batch.velocity.iter().map(pad).collect(),
        volume: batch.volume.clone(),
        affine: batch.affine.iter().map(pad_rows).collect(),
        deformation: match &batch.deformation {
            Deformation::Gradient(f) => Deformation::Gradient(f.iter().map(pad_rows).collect()),
            Deformation::Rest | Deformation::Jacobian(_) => panic!("it is deformed"),
        },
        ..ParticleBatch::default()
    };
    let mut typed = fresh::<f32, 2>(&setup, &batches);
    typed.add(&batch).expect("a good batch");
    let mut other: Box<dyn Simulate> = Box::new(fresh::<f32, 2>(&setup, &batches));
    other.add_particles(&erased).expect("a good batch");
    assert!(typed.checkpoint() == other.checkpoint());
}
