//! Probes read the right values when they are due, and do not change the simulation.

use lahar::material::Fluid;
use lahar::particles::Field;
use lahar::{
    Contact, Deformation, Domain, Gauge, Instance, Material, Model, ParticleBatch, Plate, Probe,
    Setup, Sides, Simulate, Simulation, TimeStep, WallStyle,
};
use lahar_lab::method::random::Random;

const DENSITY: f64 = 1000.0; // kg/m³
const SOUND_SPEED: f64 = 50.0; // m/s
const DX: f64 = 0.05; // m

/// Returns a box 1 m wide with walls on their planes, and water as its material.
fn tank<const D: usize>(probes: Vec<Probe<D>>) -> Setup<D> {
    let slip = Contact::Slip { friction: 0.0 };
    let water = Material {
        name: "water".into(),
        density: DENSITY,
        model: Model::Fluid(Fluid::inviscid(DENSITY * SOUND_SPEED * SOUND_SPEED)),
    };
    Setup {
        domain: Some(Domain {
            min: [-1.0; D],
            max: [0.0; D],
            sides: [Sides::Walls {
                low: slip,
                high: slip,
            }; D],
            style: WallStyle::Plane,
        }),
        probes,
        ..Setup::new(DX, vec![water])
    }
}

/// Returns two particles per cell and axis in `min .. max`, each up to half of `jitter` cells off its lattice point, under
/// the pressure that `pressure` gives at their place \[Pa\].
fn column<const D: usize>(
    min: [f64; D],
    max: [f64; D],
    jitter: f64,
    pressure: impl Fn([f64; D]) -> f64,
) -> ParticleBatch<D> {
    let counts: [usize; D] =
        core::array::from_fn(|axis| ((max[axis] - min[axis]) / DX * 2.0).round() as usize);
    let mut random = Random(1);
    let mut position = Vec::new();
    for number in 0..counts.iter().product() {
        let mut number: usize = number;
        position.push(core::array::from_fn(|axis| {
            let k = number % counts[axis];
            number /= counts[axis];
            min[axis] + (k as f64 + 0.5) * DX / 2.0 + jitter * DX * random.between(-0.5, 0.5)
        }));
    }
    let fluid = Fluid::inviscid(DENSITY * SOUND_SPEED * SOUND_SPEED);
    let jacobian = position
        .iter()
        .map(|&x| 1.0 + fluid.jacobian_minus_one_at(pressure(x)))
        .collect();
    ParticleBatch {
        position,
        volume: vec![(DX / 2.0).powi(D as i32)],
        deformation: Deformation::Jacobian(jacobian),
        ..ParticleBatch::default()
    }
}

fn probe<const D: usize>(gauge: Gauge<D>) -> Probe<D> {
    Probe {
        name: "probe".into(),
        rate: 100.0,
        gauge,
    }
}

fn pressure<const D: usize>(at: [f64; D], plate: Option<Plate<D>>) -> Probe<D> {
    probe(Gauge::Pressure {
        at,
        radius: 1.5 * DX,
        plate,
    })
}

/// Returns the first value that each probe reads at the start.
fn at_start<T: Instance<D>, const D: usize>(
    probes: Vec<Probe<D>>,
    particles: &ParticleBatch<D>,
) -> Vec<f64> {
    let mut simulation =
        Simulation::<T, D>::new(tank(probes), core::slice::from_ref(particles)).unwrap();
    let read = simulation.take_probe_samples();
    read.iter()
        .map(|probe| probe.samples[0].values[0])
        .collect()
}

/// A pressure that is linear in x is read exactly but for the regularization of the slope (a few ten-thousandths of it):
/// inside, on a wall, in a corner, and over a plate on the wall as at its center.
#[test]
fn linear_pressure() {
    let rising = |x: [f64; 2]| 5000.0 - 9810.0 * x[1] + 3000.0 * x[0];
    for jitter in [0.0, 0.4] {
        let particles = column([-1.0, -1.0], [0.0, -0.4], jitter, rising);
        let places = [[-0.5, -0.7], [-0.5, -1.0], [-1.0, -1.0], [-0.312, -0.981]];
        let mut probes: Vec<_> = places.iter().map(|&at| pressure(at, None)).collect();
        probes.push(pressure(
            [-1.0, -0.7],
            Some(Plate {
                normal: [2.0, 0.0],
                width: 0.3,
            }),
        ));
        let exact: Vec<f64> = places
            .iter()
            .copied()
            .chain([[-1.0, -0.7]])
            .map(rising)
            .collect();
        for (read, exact) in at_start::<f64, 2>(probes, &particles).iter().zip(exact) {
            assert!(
                (read - exact).abs() < 0.004 * 9810.0 * DX,
                "{read} for {exact}, jitter {jitter}"
            );
        }
    }
}

#[test]
fn linear_pressure_in_3d_and_zero_in_the_air() {
    let rising = |x: [f64; 3]| 5000.0 - 9810.0 * x[1] + 3000.0 * x[2];
    let particles = column([-1.0; 3], [-0.4, -0.4, -0.4], 0.3, rising);
    let at = [-0.7, -1.0, -0.7];
    let plate = Plate {
        normal: [0.0, 1.0, 0.0],
        width: 0.25,
    };
    let read = at_start::<f64, 3>(
        vec![
            pressure(at, None),
            pressure(at, Some(plate)),
            pressure([-0.1; 3], None),
        ],
        &particles,
    );
    let exact = rising(at);
    assert!(
        (read[0] - exact).abs() < 0.004 * 9810.0 * DX,
        "{read:?} for {exact}"
    );
    assert!(
        (read[1] - exact).abs() < 0.004 * 9810.0 * DX,
        "{read:?} for {exact}"
    );
    assert_eq!(read[2], 0.0);
}

/// Checks that a velocity linear in x is read exactly but for the regularization of the slope, inside, on a wall and in a
/// corner; that 0 is read where there are no particles; and that readings across an impact stay near the particles'
/// velocities.
fn velocities<T: Instance<D>, const D: usize>() {
    // Shear, rotation and stretch [1/s]: each component depends on all coordinates.
    let gradient = |i: usize, j: usize| 1.0 + i as f64 - 0.7 * j as f64;
    let exact = |x: [f64; D]| -> [f64; D] {
        core::array::from_fn(|i| {
            0.5 - i as f64 + (0..D).map(|j| gradient(i, j) * x[j]).sum::<f64>()
        })
    };
    let gauge = |at| {
        probe(Gauge::Velocity {
            at,
            radius: 2.0 * DX,
        })
    };
    let mut on_wall = [-0.7; D];
    on_wall[1] = -1.0;
    let places = [[-0.612; D], on_wall, [-1.0; D], [-0.1; D]];
    let mut batch = column([-1.0; D], [-0.4; D], 0.4, |_| 1000.0);
    batch.velocity = batch.position.iter().map(|&x| exact(x)).collect();
    let read = |setup: Setup<D>, batch: &ParticleBatch<D>| -> Vec<Vec<f64>> {
        let mut simulation = Simulation::<T, D>::new(setup, core::slice::from_ref(batch)).unwrap();
        let read = simulation.take_probe_samples();
        let values = read.iter().map(|probe| probe.samples[0].values.clone());
        assert!(
            read.iter()
                .all(|probe| probe.columns[D - 1].starts_with("velocity_"))
        );
        values.collect()
    };
    let values = read(tank(places.map(gauge).into()), &batch);
    for (values, x) in values.iter().zip(places).take(3) {
        for (i, (read, exact)) in values.iter().zip(exact(x)).enumerate() {
            let slope: f64 = (0..D).map(|j| gradient(i, j).abs()).sum();
            assert!(
                (read - exact).abs() < 0.004 * slope * DX,
                "{x:?}: {read} for {exact}"
            );
        }
    }
    assert_eq!(values[3], [0.0; D]);

    // One half of the fluid runs into the other: a reading overshoots either side by at most half of the jump.
    batch.velocity = batch
        .position
        .iter()
        .map(|x| {
            let mut v = [0.0; D];
            v[0] = if x[0] < -0.7 { 2.0 } else { 1.0 };
            v
        })
        .collect();
    let across: Vec<_> = (0..20)
        .map(|k| {
            let mut at = on_wall;
            at[0] = -0.8 + 0.01 * f64::from(k);
            gauge(at)
        })
        .collect();
    for values in read(tank(across), &batch) {
        assert!((0.5..=2.5).contains(&values[0]), "{values:?}");
        assert!(values[1..].iter().all(|v| *v == 0.0), "{values:?}");
    }
}

#[test]
fn linear_velocity() {
    velocities::<f64, 2>();
    velocities::<f32, 3>();
}

/// A flat surface is found at its height, beside walls too; the mean height follows from the filled volume.
#[test]
fn heights() {
    let top = -0.35;
    let column_at = |x: f64| Gauge::Height {
        up: 1,
        column: Some([x, 0.0]),
    };
    let mean = Gauge::Height {
        up: 1,
        column: None,
    };
    let read = at_start::<f64, 2>(
        [column_at(-0.5), column_at(-1.0), column_at(-0.013), mean]
            .map(probe)
            .into(),
        &column([-1.0, -1.0], [0.0, top], 0.0, |_| 0.0),
    );
    for height in &read {
        assert!((height - top).abs() < 0.02 * DX, "{read:?} for {top}");
    }
    // Half of the floor is wet, 2 cells deep.
    let read = at_start::<f64, 2>(
        [column_at(-0.75), column_at(-0.2)].map(probe).into(),
        &column([-1.0, -1.0], [-0.5, -0.9], 0.0, |_| 0.0),
    );
    assert!((read[0] + 0.9).abs() < 0.02 * DX, "{read:?}");
    assert_eq!(read[1], -1.0);
}

/// The front of a step of fluid is found at its rising and at its falling side.
#[test]
fn fronts() {
    let front = |rising| {
        probe(Gauge::Front {
            along: 0,
            rising,
            up: 1,
            depth: 0.05,
        })
    };
    let particles = column([-0.7, -1.0], [-0.3, -0.5], 0.0, |_| 0.0);
    let read = at_start::<f64, 2>(vec![front(true), front(false)], &particles);
    // The front lies between the center of the last wet column and that of the first dry one.
    assert!((read[0] + 0.3 - 0.4 * DX).abs() < 0.01 * DX, "{read:?}");
    assert!((read[1] + 0.7 + 0.4 * DX).abs() < 0.01 * DX, "{read:?}");
    let thin = column([-0.7, -1.0], [-0.3, -0.975], 0.0, |_| 0.0);
    assert_eq!(
        at_start::<f64, 2>(vec![front(true), front(false)], &thin),
        [-1.0, 0.0]
    );
}

/// Each probe is read at its own rate, at the end of the first substep that reaches the time when it is due, and the
/// particles have the bits of a run without probes.
#[test]
fn probes_are_read_when_due_and_change_nothing() {
    let run = |probes: Vec<Probe<2>>| {
        let mut setup = tank(probes);
        setup.gravity = [0.0, -9.81];
        setup.time_step = TimeStep::Automatic {
            cfl: 0.4,
            longest: f64::INFINITY,
        };
        let column = column([-1.0, -1.0], [-0.6, -0.3], 0.3, |_| 0.0);
        let mut simulation = Simulation::<f32, 2>::new(setup, &[column]).unwrap();
        for frame in 1..=10 {
            simulation.advance_to(f64::from(frame) * 0.02).unwrap();
        }
        let state = simulation.snapshot(&[Field::Position, Field::Velocity]);
        (
            simulation.take_probe_samples(),
            state,
            simulation.next_dt().0,
        )
    };
    let mut fast = pressure([-0.8, -1.0], None);
    fast.rate = 333.0;
    let mut slow = probe(Gauge::Height {
        up: 1,
        column: None,
    });
    slow.rate = 50.0;
    let (read, with, dt) = run(vec![fast, slow]);
    let (none, without, _) = run(Vec::new());
    assert!(none.is_empty());
    assert_eq!(with.columns, without.columns);
    assert_eq!(read[0].samples.len(), 1 + (0.2_f64 * 333.0) as usize);
    for (number, sample) in read[0].samples.iter().enumerate() {
        let due = number as f64 / 333.0;
        assert!(
            sample.time >= due - 1e-9 && sample.time < due + 1.5 * dt,
            "{number}: {}",
            sample.time
        );
    }
    // Frames end at the times of this probe.
    assert_eq!(read[1].samples.len(), 11);
    for (frame, sample) in read[1].samples.iter().enumerate() {
        assert!((sample.time - 0.02 * frame as f64).abs() < 1e-12);
    }
}

/// The force on a wall is the mean between two readings: its impulse over the time between them.
#[test]
fn forces_add_up_to_the_impulse() {
    let mut setup = tank(vec![Probe {
        name: "floor".into(),
        rate: 130.0,
        gauge: Gauge::Force {
            on: "bottom".into(),
        },
    }]);
    setup.gravity = [0.0, -9.81];
    let particles = column([-1.0, -1.0], [-0.6, -0.3], 0.3, |_| 0.0);
    let mut simulation = Simulation::<f64, 2>::new(setup, &[particles]).unwrap();
    simulation.advance_to(0.1).unwrap();
    let read = &simulation.take_probe_samples()[0];
    assert_eq!(read.columns, ["force_x", "force_y"]);
    assert_eq!(read.samples[0].values, [0.0, 0.0]);
    let steps = read.samples.windows(2);
    let sum: f64 = steps
        .map(|s| s[1].values[1] * (s[1].time - s[0].time))
        .sum();
    let walls = simulation.boundary_impulses();
    let floor = walls.iter().find(|wall| wall.name == "bottom").unwrap();
    let last = read.samples.last().unwrap();
    assert_eq!(read.samples.len(), 14);
    assert!(sum < 0.0 && (simulation.time() - last.time) < 1.0 / 130.0);
    // The impulse since the last reading is not in the sum.
    assert!(
        (sum / floor.impulse[1] - last.time / simulation.time()).abs() < 0.02,
        "{sum} of {floor:?}"
    );
}

/// Checks that pressure gauges in walls read the hydrostatic pressure: on the floor, in corners, on the sides, and over
/// plates.
fn gauges_in_walls<T: Instance<D>, const D: usize>() {
    let g = 9.81;
    let depth = |x: [f64; D]| -0.4 - x[1];
    let weight = |x: [f64; D]| DENSITY * g * depth(x);
    let mut normal = [0.0; D];
    normal[1] = -1.0;
    let width = 4.0 * DX;
    let mut at_side = [-0.52; D];
    (at_side[0], at_side[1]) = (0.0, -0.8);
    let mut on_floor = [-0.52; D];
    on_floor[1] = -1.0;
    let places = [on_floor, [-1.0; D], at_side];
    let mut probes: Vec<_> = places.iter().map(|&at| pressure(at, None)).collect();
    probes.push(pressure(on_floor, Some(Plate { normal, width })));
    let mut setup = tank(probes);
    setup.gravity[1] = -g;
    let mut top = [0.0; D];
    top[1] = -0.4;
    let particles = column([-1.0; D], top, 0.0, weight);
    let mut simulation = Simulation::<T, D>::new(setup, &[particles]).unwrap();
    simulation.advance_to(0.2).unwrap();
    let read = simulation.take_probe_samples();
    // A gauge in the corner reaches up the side: its center is half a cell above the floor.
    let mut in_corner = [-1.0; D];
    in_corner[1] += 0.5 * DX;
    for (probe, x) in read.iter().zip([on_floor, in_corner, at_side, on_floor]) {
        let late = &probe.samples[1..];
        let mean = late.iter().map(|s| s.values[0]).sum::<f64>() / late.len() as f64;
        let wanted = weight(x);
        assert!(
            (mean / wanted - 1.0).abs() < 0.02,
            "{x:?}: {mean} of {wanted}"
        );
    }
}

#[test]
fn gauges_in_walls_read_the_hydrostatic_pressure() {
    gauges_in_walls::<f64, 2>();
    gauges_in_walls::<f32, 3>();
}

#[test]
fn impossible_probes_are_refused_by_their_key() {
    let particles = column([-1.0, -1.0], [-0.6, -0.3], 0.0, |_| 0.0);
    let refused = |probe: Probe<2>| {
        let setup = tank(vec![probe]);
        let error = Simulation::<f32, 2>::new(setup, core::slice::from_ref(&particles)).err();
        error.expect("an error").key
    };
    let mut never = pressure([0.0; 2], None);
    never.rate = 0.0;
    assert_eq!(refused(never), "probes.probe.rate");
    assert_eq!(
        refused(pressure([f64::NAN, 0.0], None)),
        "probes.probe.pressure"
    );
    let sideways = Gauge::Front {
        along: 1,
        rising: true,
        up: 1,
        depth: 0.1,
    };
    assert_eq!(refused(probe(sideways)), "probes.probe.front");
    let flat = Gauge::Velocity {
        at: [0.0; 2],
        radius: 0.0,
    };
    assert_eq!(refused(probe(flat)), "probes.probe.velocity");
    let nowhere = Gauge::Force { on: "back".into() };
    assert_eq!(refused(probe(nowhere)), "probes.probe.force");
}
