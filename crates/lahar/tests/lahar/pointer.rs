//! The pointer's actions: against formulas, and the engine against the oracle.

use crate::fixtures::{self, brawl};
use lahar::reference::Reference;
use lahar::{
    Bounds, Command, Contact, Cushion, Domain, Field, Instance, ParticleBatch, Pointer,
    PointerAction, Setup, Sides, Simulate, Simulation, TimeStep, Transfer, WallStyle,
};

fn dust<const D: usize>(dx: f64, dt: f64) -> Setup<D> {
    Setup {
        time_step: TimeStep::Fixed(dt),
        gravity: [0.0; D],
        ..Setup::new(dx, vec![fixtures::dust()])
    }
}

/// The pointer attracts each node by a d/(|d| + softening) at any distance, as mpm128 does.
#[test]
fn the_pointer_attracts_by_its_law() {
    let (dx, dt, pull, softening) = (0.1, 1e-3, 100.0, 0.01);
    // The particle lies on a node, so the weights along an axis are 1/8, 3/4, 1/8.
    let batch = ParticleBatch {
        position: vec![[0.3, 0.5]],
        volume: vec![dx * dx],
        ..ParticleBatch::default()
    };
    let place = [0.32, 0.1];
    let mut simulation = Simulation::<f64, 2>::new(dust(dx, dt), &[batch]).unwrap();
    simulation.command(Command::Pointer(Some(Pointer {
        position: [place[0], place[1], 0.0],
        radius: f64::INFINITY,
        softening,
        action: PointerAction::Attract(pull),
    })));
    simulation.substep().unwrap();
    let weights = [0.125, 0.75, 0.125];
    let mut expected = [0.0; 2];
    for (i, w_i) in weights.iter().enumerate() {
        for (j, w_j) in weights.iter().enumerate() {
            let node = [0.2 + 0.1 * i as f64, 0.4 + 0.1 * j as f64];
            let d = [place[0] - node[0], place[1] - node[1]];
            let softened = d[0].hypot(d[1]) + softening;
            for axis in 0..2 {
                expected[axis] += w_i * w_j * pull * dt * d[axis] / softened;
            }
        }
    }
    let snapshot = simulation.snapshot(&[Field::Velocity]);
    let velocity = snapshot.columns[0].1.to_f64();
    for axis in 0..2 {
        let error = (velocity[axis] - expected[axis]).abs();
        assert!(error < 1e-12, "{velocity:?}, not {expected:?}");
    }
}

/// Returns the change of velocity per substep that incremental_mpm gives a particle at `x` by a mouse at `mouse`:
/// ½ (|d|/10)⁴ d/|d|.
fn published_push<const D: usize>(x: [f64; D], mouse: [f64; D]) -> [f64; D] {
    let squared: f64 = (0..D).map(|i| (x[i] - mouse[i]) * (x[i] - mouse[i])).sum();
    let distance = squared.sqrt();
    if distance >= 10.0 {
        return [0.0; D];
    }
    let factor = (distance / 10.0).sqrt().powi(8);
    core::array::from_fn(|i| (x[i] - mouse[i]) / distance * factor * 0.5)
}

fn at<const D: usize>(position: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|i| position.get(i).copied().unwrap_or(0.0))
}

/// Checks that a single grain of dust is pushed at the place to which the substep has moved it.
fn grains_are_pushed_as_published<T: Instance<D>, const D: usize>(tolerance: f64) {
    let dt = 0.1;
    let mouse: [f64; D] = core::array::from_fn(|i| [31.0, 27.5, 30.25][i]);
    let offsets = [[3.0, 4.0, 0.0], [-6.5, 7.0, 1.0], [9.0, 5.0, 0.0], [0.0; 3]];
    for offset in offsets {
        let position = core::array::from_fn(|i| mouse[i] + offset[i]);
        let velocity: [f64; D] = core::array::from_fn(|i| [0.5, -0.25, 0.125][i]);
        let batch = ParticleBatch {
            position: vec![position],
            velocity: vec![velocity],
            volume: vec![1.0],
            ..ParticleBatch::default()
        };
        let mut simulation = Simulation::<T, D>::new(dust(1.0, dt), &[batch]).unwrap();
        simulation.command(Command::Pointer(Some(Pointer {
            position: at(mouse),
            radius: 10.0,
            softening: 0.0,
            action: PointerAction::Push {
                acceleration: 0.5 / dt,
                power: 4.0,
            },
        })));
        simulation.substep().unwrap();
        let moved = core::array::from_fn(|i| position[i] + dt * velocity[i]);
        let push = published_push(moved, mouse);
        let snapshot = simulation.snapshot(&[Field::Position, Field::Velocity]);
        let found: Vec<_> = (snapshot.columns.iter().map(|(_, c)| c.to_f64())).collect();
        for axis in 0..D {
            let expected = velocity[axis] + push[axis];
            assert!(
                (found[0][axis] - moved[axis]).abs() < 100.0 * tolerance,
                "{offset:?}"
            );
            assert!(
                (found[1][axis] - expected).abs() < tolerance,
                "{offset:?}: {found:?}"
            );
        }
    }
}

#[test]
fn grains_are_pushed_as_published_2d() {
    grains_are_pushed_as_published::<f64, 2>(1e-13);
    grains_are_pushed_as_published::<f32, 2>(1e-6);
}

#[test]
fn grains_are_pushed_as_published_3d() {
    grains_are_pushed_as_published::<f64, 3>(1e-13);
    grains_are_pushed_as_published::<f32, 3>(1e-6);
}

/// A cushion slows down after the pointer has pushed, as in incremental_mpm.
#[test]
fn a_cushion_acts_after_the_pointer() {
    let setup = Setup {
        cushion: Some(Cushion {
            inside: Bounds {
                min: [3.0; 2],
                max: [60.0; 2],
            },
            time: 1.0,
        }),
        ..dust::<2>(1.0, 0.2)
    };
    let batch = ParticleBatch {
        position: vec![[59.5, 30.0]],
        volume: vec![1.0],
        ..ParticleBatch::default()
    };
    let mut simulation = Simulation::<f64, 2>::new(setup, &[batch]).unwrap();
    simulation.command(Command::Pointer(Some(Pointer {
        position: [55.5, 27.0, 0.0],
        radius: 10.0,
        softening: 0.0,
        action: PointerAction::Push {
            acceleration: 5.0,
            power: 0.0,
        },
    })));
    simulation.substep().unwrap();
    let velocity = simulation.snapshot(&[Field::Velocity]).columns[0]
        .1
        .to_f64();
    // The push is (0.8, 0.6); a velocity of 0.5 keeps the grain inside for a second.
    assert!((velocity[0] - 0.5).abs() < 1e-13 && (velocity[1] - 0.6).abs() < 1e-13);
}

/// Compares engine and oracle with every action and every transfer, on bodies of every material.
fn the_engine_is_the_oracle<const D: usize>(cells: usize, steps: usize)
where
    f64: Instance<D>,
{
    let (mut setup, batches) = brawl::<D>(cells);
    setup.time_step = TimeStep::Fixed(4e-4);
    let size = setup.dx * cells as f64;
    let sides = Sides::Walls {
        low: Contact::Separate { friction: 0.1 },
        high: Contact::Sticky,
    };
    setup.domain = Some(Domain {
        min: [0.0; D],
        max: [size; D],
        sides: [sides; D],
        style: WallStyle::Plane,
    });
    let actions = [
        PointerAction::Attract(300.0),
        PointerAction::Drag([1.0, 2.0, 3.0]),
        PointerAction::Push {
            acceleration: 400.0,
            power: 0.5,
        },
    ];
    let transfers = [
        Transfer::Pic,
        Transfer::Flip { blend: 0.95 },
        Transfer::Apic,
    ];
    for (transfer, action) in transfers.into_iter().zip(actions) {
        setup.transfer = transfer;
        let pointer = Pointer {
            position: at([0.45 * size; D]),
            radius: 0.3 * size,
            softening: 0.01,
            action,
        };
        let mut fast = Simulation::<f64, D>::new(setup.clone(), &batches).unwrap();
        let untouched = &fast.snapshot(&[Field::Velocity]).columns[0].1.to_f64();
        let mut oracle = Reference::new(&setup, &batches).unwrap();
        fast.command(Command::Pointer(Some(pointer)));
        oracle.set_pointer(Some(pointer));
        for _ in 0..steps {
            Simulate::substep(&mut fast).unwrap();
            oracle.substep(4e-4);
        }
        let velocity = fast.snapshot(&[Field::Velocity]).columns[0].1.to_f64();
        let (mut worst, mut stirred) = (0.0_f64, 0.0_f64);
        for (p, v) in oracle.particles().iter().zip(velocity.chunks_exact(D)) {
            for axis in 0..D {
                worst = worst.max((p.velocity[axis] - v[axis]).abs());
                stirred = stirred.max((v[axis] - untouched[p.id as usize * D + axis]).abs());
            }
        }
        assert!(stirred > 0.5, "{action:?}: {stirred}");
        assert!(worst < 1e-9, "{action:?}: {worst:e}");
    }
}

#[test]
fn the_engine_is_the_oracle_2d() {
    the_engine_is_the_oracle::<2>(32, 60);
}

#[test]
fn the_engine_is_the_oracle_3d() {
    the_engine_is_the_oracle::<3>(16, 12);
}
