//! The engine against the oracle, in every combination of dimension, kernel, transfer, force and material: storage,
//! lanes, rows, sorting and threads must not change the results beyond rounding.

use crate::fixtures::{self, ball, brawl, brawl_with_all_options};
use lahar::Instance;
use lahar::material::{LinearElastic, VolumeRule};
use lahar::{
    Contact, Domain, ForceForm, Isa, Kernel, Material, Model, ParticleBatch, Setup, Sides,
    Simulate, Simulation, TimeStep, Transfer, WallStyle,
};
use lahar_lab::method::engine::{Build, Engine, Fast, Oracle, ParticleState};
use lahar_lab::method::random::Random;

/// The smallest scale that the difference of a field is divided by, so that noise is not compared with noise: a cell,
/// a slow speed, that speed over a cell, F, and a strain of one percent.
const SCALES: [f64; 5] = [1.0 / 32.0, 0.1, 3.2, 1.0, 0.01];

/// Returns the largest difference of any field, relative to that field's own largest value.
fn worst<const D: usize>(a: &[ParticleState<D>], b: &[ParticleState<D>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let fields = |p: &ParticleState<D>| -> Vec<Vec<f64>> {
        vec![
            p.position.to_vec(),
            p.velocity.to_vec(),
            p.affine.concat(),
            p.deformation_gradient.concat(),
            vec![p.jacobian_minus_one],
        ]
    };
    let (a, b): (Vec<_>, Vec<_>) = (
        a.iter().map(fields).collect(),
        b.iter().map(fields).collect(),
    );
    (0..a[0].len())
        .map(|field| {
            let (mut scale, mut worst) = (SCALES[field], 0.0_f64);
            for (p, q) in a.iter().zip(&b) {
                for (x, y) in p[field].iter().zip(&q[field]) {
                    scale = scale.max(x.abs());
                    worst = worst.max((x - y).abs());
                }
            }
            worst / scale
        })
        .fold(0.0, f64::max)
}

/// Runs engine and oracle for `steps` substeps and returns the worst difference.
fn compare<T: Instance<D>, const D: usize>(
    setup: &Setup<D>,
    batches: &[ParticleBatch<D>],
    steps: usize,
) -> f64 {
    let mut fast = Fast::<T, D>::build(setup, batches).expect("a good setup");
    let mut oracle = Oracle::<D>::build(setup, batches).expect("a good setup");
    for _ in 0..steps {
        fast.substep().expect("a substep");
        oracle.substep().expect("a substep");
    }
    worst(&oracle.particles(), &fast.particles())
}

/// Compares on balls of every material in a small box, with all kernels, forces and transfers.
fn every_scheme<T: Instance<D>, const D: usize>(cells: usize, steps: usize, limit: f64) {
    let (mut setup, batches) = brawl::<D>(cells);
    setup.time_step = TimeStep::Fixed(4e-4);
    let combinations = [
        (Kernel::Quadratic, ForceForm::Mls),
        (Kernel::Quadratic, ForceForm::Classic),
        (Kernel::Cubic, ForceForm::Mls),
        (Kernel::Cubic, ForceForm::Classic),
        (Kernel::Linear, ForceForm::Classic),
    ];
    for (kernel, force) in combinations {
        for transfer in [
            Transfer::Pic,
            Transfer::Flip { blend: 0.95 },
            Transfer::Apic,
        ] {
            (setup.kernel, setup.force, setup.transfer) = (kernel, force, transfer);
            // Stress is not stable at free surfaces with the linear kernel, so it is tested with dust only.
            let batches: Vec<_> = batches
                .iter()
                .filter(|b| kernel != Kernel::Linear || b.material == 4)
                .cloned()
                .collect();
            let difference = compare::<T, D>(&setup, &batches, steps);
            assert!(
                difference < limit,
                "{kernel:?} {force:?} {transfer:?}: {difference:e}"
            );
        }
    }
}

#[test]
fn every_scheme_2d_f64() {
    every_scheme::<f64, 2>(32, 60, 1e-9);
}

#[test]
fn every_scheme_2d_f32() {
    every_scheme::<f32, 2>(32, 20, 2e-4);
}

#[test]
fn every_scheme_3d_f64() {
    every_scheme::<f64, 3>(16, 12, 1e-10);
}

#[test]
fn every_scheme_3d_f32() {
    every_scheme::<f32, 3>(16, 8, 2e-4);
}

/// Compares each material alone on each instruction set, for so long that particles are sorted several times.
fn every_material<const D: usize>(cells: usize, steps: usize)
where
    f64: Instance<D>,
{
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        let (mut setup, mut batches) = brawl::<D>(cells);
        setup.time_step = TimeStep::Fixed(5e-4);
        setup.isa = isa;
        batches.push(ParticleBatch {
            material: setup.materials.len(),
            ..batches[1].clone()
        });
        setup.materials.push(Material {
            name: "linear elastic".into(),
            density: 500.0,
            model: Model::LinearElastic(LinearElastic::new(2e3, 0.3)),
        });
        for batch in &batches {
            let difference = compare::<f64, D>(&setup, core::slice::from_ref(batch), steps);
            let name = &setup.materials[batch.material].name;
            assert!(
                difference < 1e-8,
                "{name} on {}: {difference:e}",
                isa.name()
            );
        }
    }
}

#[test]
fn every_material_2d() {
    every_material::<2>(32, 150);
}

#[test]
fn every_material_3d() {
    every_material::<3>(16, 40);
}

/// Compares with the options that are off by default, in every kernel and transfer.
fn all_options<T: Instance<D>, const D: usize>(cells: usize, steps: usize, limit: f64) {
    let (mut setup, batches) = brawl_with_all_options::<D>(cells);
    setup.time_step = TimeStep::Fixed(4e-4);
    for kernel in [Kernel::Quadratic, Kernel::Cubic] {
        for transfer in [Transfer::Flip { blend: 0.95 }, Transfer::Apic] {
            (setup.kernel, setup.transfer) = (kernel, transfer);
            let difference = compare::<T, D>(&setup, &batches, steps);
            assert!(
                difference < limit,
                "{kernel:?} {transfer:?}: {difference:e}"
            );
        }
    }
}

#[test]
fn all_options_2d_f64() {
    all_options::<f64, 2>(32, 60, 1e-9);
}

#[test]
fn all_options_2d_f32() {
    all_options::<f32, 2>(32, 20, 2e-4);
}

#[test]
fn all_options_3d_f64() {
    all_options::<f64, 3>(16, 12, 1e-9);
}

#[test]
fn all_options_3d_f32() {
    all_options::<f32, 3>(16, 8, 2e-4);
}

/// Compares among colliders of all shapes and motions, with every contact.
fn among_colliders<T: Instance<D>, const D: usize>(cells: usize, steps: usize, limit: f64) {
    for contact in fixtures::CONTACTS {
        for transfer in [Transfer::Flip { blend: 0.95 }, Transfer::Apic] {
            let (mut setup, batches) = brawl::<D>(cells);
            setup.time_step = TimeStep::Fixed(4e-4);
            setup.transfer = transfer;
            setup.colliders = fixtures::colliders_of_all_kinds(setup.dx * cells as f64, contact);
            let difference = compare::<T, D>(&setup, &batches, steps);
            assert!(
                difference < limit,
                "{contact:?} {transfer:?}: {difference:e}"
            );
        }
    }
}

#[test]
fn among_colliders_2d_f64() {
    among_colliders::<f64, 2>(40, 60, 1e-9);
}

#[test]
fn among_colliders_3d_f64() {
    among_colliders::<f64, 3>(20, 12, 1e-9);
}

/// The tolerance is wider here: at some nodes rounding decides whether they stick.
#[test]
fn among_colliders_3d_f32() {
    among_colliders::<f32, 3>(20, 8, 2e-3);
}

/// Compares while particles cross a periodic axis several times; its length is not a whole number of blocks.
fn periodic<const D: usize>(cells: usize)
where
    f64: Instance<D>,
{
    let (mut setup, mut batches) = brawl::<D>(cells);
    let size = setup.dx * cells as f64;
    let wall = Sides::Walls {
        low: Contact::Sticky,
        high: Contact::Slip { friction: 0.2 },
    };
    let mut sides = [Sides::Periodic; D];
    sides[1] = wall;
    setup.domain = Some(Domain {
        min: [0.0; D],
        max: [size; D],
        sides,
        style: WallStyle::Plane,
    });
    setup.time_step = TimeStep::Fixed(5e-4);
    // Some colliders lie at the seam and move through it.
    setup.colliders = fixtures::colliders_of_all_kinds(size, Contact::Separate { friction: 0.1 });
    setup.colliders.remove(0);
    for batch in &mut batches {
        batch.velocity[0][0] = 6.0;
    }
    let steps = 260_u16;
    assert!(
        6.0 * 5e-4 * f64::from(steps) > 1.5 * size,
        "the particles must cross the seam"
    );
    let difference = compare::<f64, D>(&setup, &batches[..2], usize::from(steps));
    assert!(difference < 1e-7, "{difference:e}");
}

#[test]
fn periodic_2d() {
    periodic::<2>(14);
    periodic::<2>(16);
}

#[test]
fn periodic_3d() {
    periodic::<3>(13);
}

#[test]
fn particles_leave_through_open_sides_and_are_counted() {
    let (mut setup, batches) = brawl::<2>(32);
    let open = Sides::Walls {
        low: Contact::Open,
        high: Contact::Open,
    };
    let domain = setup.domain.as_mut().expect("the brawl has a domain");
    domain.sides = [open; 2];
    let total: usize = batches.iter().map(|b| b.position.len()).sum();
    let mut simulation = Simulation::<f32, 2>::new(setup, &batches).expect("a good setup");
    let mass = simulation.diagnostics().mass;
    simulation.advance_to(1.0).expect("it runs");
    let end = simulation.diagnostics();
    assert!(end.escaped > total as u64 / 2, "{} escaped", end.escaped);
    assert_eq!(end.particles + end.escaped, total as u64);
    assert!((end.mass + end.escaped_mass - mass).abs() < 1e-6 * mass);
}

#[test]
fn a_non_finite_value_stops_the_run_and_names_the_particle() {
    let (mut setup, mut batches) = brawl::<2>(32);
    // The step is far too long, so the solids blow up.
    setup.time_step = TimeStep::Fixed(0.2);
    batches[1].velocity = vec![[1e3, 0.0]];
    let mut simulation = Simulation::<f32, 2>::new(setup, &batches).expect("a good setup");
    let failure = (0..2000)
        .find_map(|_| simulation.substep().err())
        .expect("it must blow up");
    assert!(failure.position.iter().all(|x| x.is_finite()), "{failure}");
    let message = failure.to_string();
    assert!(
        message.contains("substep") && message.contains("limited by fixed"),
        "{message}"
    );
    // The state can still be read.
    let _ = simulation.snapshot(&[lahar::Field::Position, lahar::Field::Velocity]);
}

/// Compares on water that turns in a corner with snow in it. Its volume is corrected several times: at walls, in the
/// corner, at the free surface and beside the snow.
fn corrected_volume<T: Instance<D>, const D: usize>(limit: f64) {
    let (mut setup, mut batches) = brawl::<D>(16);
    setup.time_step = TimeStep::Fixed(1e-3);
    let size = setup.dx * 16.0;
    let mut random = Random(3);
    let water = ball(
        0,
        [0.3 * size; D],
        0.4 * size,
        setup.dx,
        [0.0; D],
        &mut random,
    );
    let inside = |x: &[f64; D]| x.iter().all(|x| *x > 0.0);
    let position: Vec<[f64; D]> = water.position.into_iter().filter(inside).collect();
    let turning = |x: &[f64; D]| {
        let mut velocity = [0.0; D];
        (velocity[0], velocity[1]) = (-6.0 * (x[1] - 0.3 * size), 2.0 * (x[0] - 0.3 * size));
        velocity
    };
    batches[0] = ParticleBatch {
        velocity: position.iter().map(turning).collect(),
        position,
        volume: water.volume,
        ..ParticleBatch::default()
    };
    batches[3] = ball(
        3,
        [0.35 * size; D],
        0.1 * size,
        setup.dx,
        [0.0; D],
        &mut random,
    );
    let batches = [batches[0].clone(), batches[3].clone()];
    let plain = |setup: &Setup<D>| {
        let mut plain = setup.clone();
        if let Model::Fluid(fluid) = &mut plain.materials[0].model {
            fluid.volume = VolumeRule::Jacobian;
        }
        plain
    };
    for kernel in [Kernel::Quadratic, Kernel::Cubic] {
        for transfer in [Transfer::Apic, Transfer::Flip { blend: 0.95 }] {
            (setup.kernel, setup.transfer) = (kernel, transfer);
            let steps = 70;
            let difference = compare::<T, D>(&setup, &batches, steps);
            assert!(
                difference < limit,
                "{kernel:?} {transfer:?}: {difference:e}"
            );
            let mut corrected = Fast::<T, D>::build(&setup, &batches).expect("a good setup");
            let mut uncorrected =
                Fast::<T, D>::build(&plain(&setup), &batches).expect("a good setup");
            for _ in 0..steps {
                corrected.substep().expect("a substep");
                uncorrected.substep().expect("a substep");
            }
            let effect = worst(&corrected.particles(), &uncorrected.particles());
            assert!(
                effect > 100.0 * limit,
                "the correction must have an effect: {effect:e}"
            );
        }
    }
}

#[test]
fn corrected_volume_2d_f64() {
    corrected_volume::<f64, 2>(1e-8);
}

#[test]
fn corrected_volume_2d_f32() {
    corrected_volume::<f32, 2>(1e-3);
}

#[test]
fn corrected_volume_3d_f64() {
    corrected_volume::<f64, 3>(1e-8);
}
