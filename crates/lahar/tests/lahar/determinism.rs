//! The same scene gives the same bits: on any number of threads, shifted by whole blocks, and whether or not it is read.

use crate::fixtures::{ALL, bits, brawl, brawl_with_all_options, colliders_of_all_kinds, run_on};
use lahar::Instance;
use lahar::particles::Field;
use lahar::{Collider, Contact, Isa, Motion, ParticleBatch, Setup, Simulate, Simulation, Transfer};

/// Compares bits on 1, 2, 3 and 8 threads, over so many sorts that particles change blocks and order.
fn same_bits_on_any_number_of_threads<T: Instance<D>, const D: usize>(
    (mut setup, batches): (Setup<D>, Vec<ParticleBatch<D>>),
    time: f64,
    transfer: Transfer,
) {
    setup.transfer = transfer;
    let one = run_on::<T, D>(1, &setup, &batches, time);
    assert!(
        one.phase_times().sorts >= 7,
        "only {} sorts",
        one.phase_times().sorts
    );
    let start = Simulation::<T, D>::new(setup.clone(), &batches).expect("a good setup");
    let moved = (
        start.snapshot(&[Field::Position]).columns,
        one.snapshot(&[Field::Position]).columns,
    );
    let (before, after) = (moved.0[0].1.to_f64(), moved.1[0].1.to_f64());
    let block = setup.dx * 8.0;
    let crossed = before
        .iter()
        .zip(&after)
        .filter(|(a, b)| (*a / block).floor() != (*b / block).floor())
        .count();
    assert!(
        crossed > before.len() / 20,
        "only {crossed} of {} coordinates changed block",
        before.len()
    );
    for threads in [2, 3, 8] {
        let other = run_on::<T, D>(threads, &setup, &batches, time);
        assert!(
            bits(&one.snapshot(ALL)) == bits(&other.snapshot(ALL)),
            "{threads} threads differ from one"
        );
        assert_eq!(
            one.boundary_impulses(),
            other.boundary_impulses(),
            "{threads} threads differ from one in the impulses of walls"
        );
    }
}

#[test]
fn threads_do_not_change_bits_2d() {
    same_bits_on_any_number_of_threads::<f32, 2>(brawl(64), 0.4, Transfer::Apic);
}

#[test]
fn threads_do_not_change_bits_2d_f64_flip() {
    same_bits_on_any_number_of_threads::<f64, 2>(brawl(64), 0.4, Transfer::Flip { blend: 0.97 });
}

#[test]
fn threads_do_not_change_bits_3d() {
    same_bits_on_any_number_of_threads::<f32, 3>(brawl(32), 0.3, Transfer::Apic);
}

#[test]
fn threads_do_not_change_bits_among_colliders() {
    let (mut setup, batches) = brawl(64);
    let contact = Contact::Separate { friction: 0.2 };
    setup.colliders = colliders_of_all_kinds(64.0 * setup.dx, contact);
    same_bits_on_any_number_of_threads::<f32, 2>((setup, batches), 0.4, Transfer::Apic);
    let (mut setup, batches) = brawl(32);
    setup.colliders = colliders_of_all_kinds(32.0 * setup.dx, contact);
    same_bits_on_any_number_of_threads::<f32, 3>((setup, batches), 0.3, Transfer::Apic);
}

#[test]
fn threads_do_not_change_bits_with_all_options() {
    same_bits_on_any_number_of_threads::<f32, 2>(brawl_with_all_options(64), 0.4, Transfer::Apic);
}

/// Moves a collider as [`same_bits_elsewhere`] moves particles.
fn move_by<const D: usize>(collider: &mut Collider<D>, by: f64) {
    let shift = |x: &mut [f64; D]| {
        x[0] += by;
        x[D - 1] -= by;
    };
    shift(&mut collider.center);
    for primitive in &mut collider.primitives {
        *primitive = primitive.mapped(
            |mut x| {
                shift(&mut x);
                x
            },
            |v| v,
            1.0,
        );
    }
    if let Motion::Keyframes(frames) = &mut collider.motion {
        frames
            .iter_mut()
            .for_each(|frame| shift(&mut frame.position));
    }
}

/// Checks that everything but positions keeps its bits when the scene is shifted by `shift_cells` cells.
fn same_bits_elsewhere<T: Instance<D>, const D: usize>(shift_cells: f64) {
    let (mut setup, batches) = brawl::<D>(32);
    setup.domain = None;
    setup.gravity = [0.0; D];
    setup.colliders = colliders_of_all_kinds(32.0 * setup.dx, Contact::Separate { friction: 0.2 });
    let moved: Vec<_> = batches
        .iter()
        .cloned()
        .map(|mut batch| {
            for position in &mut batch.position {
                // Rounded to numbers that are exact at both places.
                position
                    .iter_mut()
                    .for_each(|x| *x = (*x * 1_048_576.0).round() / 1_048_576.0);
            }
            batch
        })
        .collect();
    let shifted: Vec<_> = moved
        .iter()
        .cloned()
        .map(|mut batch| {
            for position in &mut batch.position {
                position[0] += shift_cells * setup.dx;
                position[D - 1] -= shift_cells * setup.dx;
            }
            batch
        })
        .collect();
    let mut there = setup.clone();
    for collider in &mut there.colliders {
        move_by(collider, shift_cells * setup.dx);
    }
    let fields = &[
        Field::Velocity,
        Field::Affine,
        Field::Jacobian,
        Field::DeformationGradient,
        Field::Mass,
        Field::Id,
    ];
    let here = run_on::<T, D>(2, &setup, &moved, 0.25);
    let there = run_on::<T, D>(2, &there, &shifted, 0.25);
    assert!(
        here.phase_times().sorts >= 5,
        "only {} sorts",
        here.phase_times().sorts
    );
    assert!(
        bits(&here.snapshot(fields)) == bits(&there.snapshot(fields)),
        "by {shift_cells} cells"
    );
}

#[test]
fn a_shift_by_whole_blocks_does_not_change_bits() {
    same_bits_elsewhere::<f32, 2>(8.0);
    same_bits_elsewhere::<f32, 2>(-8.0 * 125_001.0);
    same_bits_elsewhere::<f32, 3>(4.0);
    same_bits_elsewhere::<f64, 3>(4.0 * 250_001.0);
}

#[test]
fn reading_does_not_change_bits() {
    let (setup, batches) = brawl::<2>(48);
    let run = |read: bool| {
        let mut simulation =
            Simulation::<f32, 2>::new(setup.clone(), &batches).expect("a good setup");
        for frame in 1..=30 {
            simulation
                .advance_to(f64::from(frame) / 100.0)
                .expect("it runs");
            if read {
                let _ = simulation.diagnostics();
                let _ = simulation.snapshot(ALL);
            }
        }
        simulation.snapshot(ALL)
    };
    assert!(bits(&run(true)) == bits(&run(false)));
}

#[test]
fn instruction_sets_agree_closely() {
    let (mut setup, batches) = brawl::<3>(32);
    setup.isa = Isa::Portable;
    let portable = run_on::<f64, 3>(2, &setup, &batches, 0.1);
    let reference = portable.snapshot(&[Field::Position]).columns[0].1.to_f64();
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        setup.isa = isa;
        let other = run_on::<f64, 3>(2, &setup, &batches, 0.1);
        let positions = other.snapshot(&[Field::Position]).columns[0].1.to_f64();
        let worst = reference
            .iter()
            .zip(&positions)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(worst < 1e-9, "{}: {worst:e} m", isa.name());
    }
}

#[test]
fn distance_costs_no_memory() {
    let memory = |apart: f64| {
        let (mut setup, batches) = brawl::<3>(32);
        setup.domain = None;
        let mut drops = vec![batches[0].clone(), batches[0].clone()];
        for position in &mut drops[1].position {
            position[0] += apart * setup.dx;
        }
        Simulation::<f32, 3>::new(setup, &drops)
            .expect("a good setup")
            .memory()
    };
    assert_eq!(memory(64.0), memory(1_000_000.0));
}
