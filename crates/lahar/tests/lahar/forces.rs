//! Forces besides gravity and stress: against formulas, against the oracle, and by their bits.

use crate::fixtures::{self, brawl, dust};
use lahar::{
    AccelerationField, Force, Instance, ParticleBatch, Pull, Setup, Simulate, Simulation, TimeStep,
    Transfer,
};
use lahar_lab::method::engine::{Build, Engine, Fast, Oracle, ParticleState};
use std::sync::Arc;

/// The acceleration −k (x − X), where X is the particle's starting position plus an offset, or the origin for all.
#[derive(Debug)]
struct Spring<const D: usize> {
    k: f64,
    to_start: Option<[f64; D]>,
}

impl<const D: usize> AccelerationField<D> for Spring<D> {
    fn accelerations(
        &self,
        _: f64,
        positions: &[[f64; D]],
        starts: &[[f64; D]],
        out: &mut [[f64; D]],
    ) {
        for (i, (a, x)) in out.iter_mut().zip(positions).enumerate() {
            for axis in 0..D {
                let rest = self
                    .to_start
                    .map_or(0.0, |offset| starts[i][axis] + offset[axis]);
                a[axis] = -self.k * (x[axis] - rest);
            }
        }
    }
    fn depends_on_start(&self) -> bool {
        self.to_start.is_some()
    }
}

/// The acceleration A cos(ω t) along every axis.
#[derive(Debug)]
struct Shake {
    amplitude: f64,
    frequency: f64,
}

impl<const D: usize> AccelerationField<D> for Shake {
    fn accelerations(&self, time: f64, _: &[[f64; D]], _: &[[f64; D]], out: &mut [[f64; D]]) {
        out.fill([self.amplitude * (self.frequency * time).cos(); D]);
    }
}

const DT: f64 = 2e-3;

/// Returns a scene with a single grain of dust.
fn grain<const D: usize>(
    transfer: Transfer,
    forces: Vec<Force<D>>,
    position: [f64; D],
    velocity: [f64; D],
) -> (Setup<D>, ParticleBatch<D>) {
    let setup = Setup {
        time_step: TimeStep::Fixed(DT),
        transfer,
        forces,
        ..Setup::new(0.1, vec![dust()])
    };
    let batch = ParticleBatch {
        position: vec![position],
        velocity: vec![velocity],
        volume: vec![1e-4],
        ..ParticleBatch::default()
    };
    (setup, batch)
}

/// Returns the largest distance along an axis between an engine's only particle and the course that `expected` gives
/// substep by substep, over `steps` substeps \[m\].
fn off_course<E: Build<D>, const D: usize>(
    (setup, batch): (Setup<D>, ParticleBatch<D>),
    steps: u32,
    mut expected: impl FnMut() -> [f64; D],
) -> f64 {
    let mut engine = E::build(&setup, &[batch]).expect("a good setup");
    let mut worst = 0.0_f64;
    for _ in 0..steps {
        engine.substep().expect("a substep");
        let x = engine.particles()[0].position;
        let wanted = expected();
        for axis in 0..D {
            worst = worst.max((x[axis] - wanted[axis]).abs());
        }
    }
    worst
}

const TRANSFERS: [Transfer; 3] = [Transfer::Pic, Transfer::Flip { blend: 1.0 }, Transfer::Apic];

/// Checks that a single grain in a field linear in x moves as symplectic Euler has it, v += Δt a(x), x += Δt v, in every
/// transfer scheme: the weights reproduce linear functions exactly.
fn grains_follow_linear_fields<E: Build<D>, const D: usize>(tolerance: f64) {
    let start: [f64; D] = core::array::from_fn(|axis| 0.33 - 0.21 * axis as f64);
    let velocity: [f64; D] = core::array::from_fn(|axis| 0.4 + 0.3 * axis as f64);
    let k = 30.0;
    let spring = |to_start: Option<[f64; D]>| {
        Force::Field(Arc::new(Spring { k, to_start }) as Arc<dyn AccelerationField<D>>)
    };
    let pull = Pull {
        center: [0.0; D],
        acceleration: k * 0.5,
        distance: 0.5,
        power: -1.0,
        softening: 0.2,
    };
    let shake = Force::Field(Arc::new(Shake {
        amplitude: 3.0,
        frequency: 40.0,
    }) as Arc<dyn AccelerationField<D>>);
    let offset: [f64; D] = core::array::from_fn(|axis| 0.1 * axis as f64 - 0.07);
    for transfer in TRANSFERS {
        let course = |forces: Vec<Force<D>>, a: &dyn Fn(f64, [f64; D], [f64; D]) -> [f64; D]| {
            let (mut n, mut x, mut v) = (0.0, start, velocity);
            let worst = off_course::<E, D>(grain(transfer, forces, start, velocity), 400, || {
                let a = a(n * DT, x, v);
                n += 1.0;
                for axis in 0..D {
                    v[axis] += DT * a[axis];
                    x[axis] += DT * v[axis];
                }
                x
            });
            assert!(worst < tolerance, "{transfer:?}: {worst:e} m");
        };
        let to_origin = |_: f64, x: [f64; D], _: [f64; D]| x.map(|x| -k * x);
        course(vec![spring(None)], &to_origin);
        course(vec![Force::Central(pull)], &to_origin);
        course(vec![spring(Some(offset))], &|_, x, _| {
            core::array::from_fn(|i| -k * (x[i] - start[i] - offset[i]))
        });
        course(vec![shake.clone()], &|t, _, _| [3.0 * (40.0 * t).cos(); D]);
        // v − u decays by exp(−K Δt) for any Δt.
        let wind: [f64; D] = core::array::from_fn(|axis| 2.0 - axis as f64);
        let drags =
            [(3.0, wind), (2.0, [0.0; D])].map(|(rate, velocity)| Force::Drag { rate, velocity });
        course(drags.to_vec(), &|_, _, v| {
            let kept = (-5.0 * DT).exp();
            core::array::from_fn(|i| (0.6 * wind[i] - v[i]) * (1.0 - kept) / DT)
        });
        let mut axis = [0.0, 0.0, 1.0];
        if D == 3 {
            axis = [0.0, 0.6, 0.8];
        }
        course(vec![Force::Vortex { pull, axis }], &|_, x, _| {
            let x: [f64; 3] = core::array::from_fn(|i| if i < D { x[i] } else { 0.0 });
            core::array::from_fn(|i| {
                let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                k * (axis[j] * x[l] - axis[l] * x[j])
            })
        });
    }
}

#[test]
fn grains_follow_linear_fields_2d() {
    grains_follow_linear_fields::<Oracle<2>, 2>(1e-11);
    grains_follow_linear_fields::<Fast<f64, 2>, 2>(1e-11);
    grains_follow_linear_fields::<Fast<f32, 2>, 2>(3e-5);
}

#[test]
fn grains_follow_linear_fields_3d() {
    grains_follow_linear_fields::<Oracle<3>, 3>(1e-11);
    grains_follow_linear_fields::<Fast<f64, 3>, 3>(1e-11);
    grains_follow_linear_fields::<Fast<f32, 3>, 3>(3e-5);
}

/// One force of each kind.
fn all_forces<const D: usize>(middle: f64) -> Vec<Force<D>> {
    let pull = |acceleration, power| Pull {
        center: [middle; D],
        acceleration,
        distance: 0.2,
        power,
        softening: 0.05,
    };
    vec![
        Force::Central(pull(4.0, 2.0)),
        Force::Vortex {
            pull: pull(6.0, 1.0),
            axis: [0.0, 0.0, 1.0],
        },
        Force::Drag {
            rate: 1.5,
            velocity: [0.3; D],
        },
        Force::Field(Arc::new(Shake {
            amplitude: 3.0,
            frequency: 40.0,
        })),
        Force::Field(Arc::new(Spring {
            k: 20.0,
            to_start: Some([0.01; D]),
        })),
    ]
}

fn engine_is_the_oracle<const D: usize>(cells: usize, steps: usize)
where
    f64: Instance<D>,
{
    let (mut setup, batches) = brawl::<D>(cells);
    setup.time_step = TimeStep::Fixed(4e-4);
    setup.forces = all_forces(0.5 * setup.dx * cells as f64);
    for transfer in [
        Transfer::Pic,
        Transfer::Flip { blend: 0.95 },
        Transfer::Apic,
    ] {
        setup.transfer = transfer;
        let (mut fast, mut oracle) = (
            Fast::<f64, D>::build(&setup, &batches).expect("a good setup"),
            Oracle::<D>::build(&setup, &batches).expect("a good setup"),
        );
        for _ in 0..steps {
            fast.substep().expect("a substep");
            oracle.substep().expect("a substep");
        }
        let largest = |of: &dyn Fn(&ParticleState<D>, &ParticleState<D>) -> f64| {
            let pairs = fast.particles().into_iter().zip(oracle.particles());
            pairs.map(|(a, b)| of(&a, &b)).fold(0.0, f64::max)
        };
        let moved = largest(&|a, b| (a.position[0] - b.position[0]).abs());
        let sped = largest(&|a, b| (a.velocity[1] - b.velocity[1]).abs());
        assert!(
            moved < 1e-12 && sped < 1e-9,
            "{transfer:?}: {moved:e} {sped:e}"
        );
    }
}

#[test]
fn the_engine_is_the_oracle_2d() {
    engine_is_the_oracle::<2>(32, 60);
}

#[test]
fn the_engine_is_the_oracle_3d() {
    engine_is_the_oracle::<3>(16, 12);
}

#[test]
fn threads_change_no_bits() {
    let (mut setup, batches) = brawl::<2>(32);
    setup.forces = all_forces(0.5);
    let bits = |threads| {
        let simulation = fixtures::run_on::<f32, 2>(threads, &setup, &batches, 0.2);
        fixtures::bits(&simulation.snapshot(fixtures::ALL))
    };
    let one = bits(1);
    assert_eq!(one, bits(2));
    assert_eq!(one, bits(5));
}

/// Dust carries no sound, so only the force itself can shorten a substep.
#[test]
fn a_strong_force_shortens_the_first_substep() {
    let pull = Pull {
        center: [0.0; 2],
        acceleration: 1e4,
        distance: 1.0,
        power: 0.0,
        softening: 0.01,
    };
    let (mut setup, batch) = grain(
        Transfer::Apic,
        vec![Force::Central(pull)],
        [1.0; 2],
        [0.0; 2],
    );
    setup.time_step = TimeStep::default();
    let simulation = Simulation::<f64, 2>::new(setup, &[batch]).expect("a good setup");
    // The grain crosses 0.4 of a cell of 0.1 m with √(0.4 × 0.1 × 1e4) = 20 m/s.
    let (dt, _) = simulation.next_dt();
    assert!((dt / (0.04 / 20.0) - 1.0).abs() < 1e-3, "{dt}");
}

#[test]
fn an_impossible_force_is_named() {
    let bad = Force::Drag {
        rate: -1.0,
        velocity: [0.0; 2],
    };
    let (setup, batch) = grain(Transfer::Apic, vec![bad], [0.0; 2], [0.0; 2]);
    let error = Simulation::<f32, 2>::new(setup, &[batch]).err();
    assert_eq!(error.map(|error| error.key), Some("forces.0".to_owned()));
}
