//! Walls on their planes: waves are reflected where the walls are drawn, a body at rest stays at rest, and a body leaves a
//! `separate` wall as if there were none.

use crate::walled::{DENSITY, SEPARATE, SLIP, both, field, fluid, jelly};
use lahar::particles::Field;
use lahar::{
    Contact, Deformation, Domain, Instance, ParticleBatch, Setup, Sides, Simulate, Simulation,
    TimeStep, Transfer, WallStyle,
};
use std::f64::consts::PI;

/// Returns two particles per cell and axis on a lattice that fills `min .. max` (a whole number of half cells).
fn lattice<const D: usize>(min: [f64; D], max: [f64; D], dx: f64) -> ParticleBatch<D> {
    let counts: [usize; D] =
        core::array::from_fn(|axis| ((max[axis] - min[axis]) / dx * 2.0).round() as usize);
    let place = |mut number: usize| {
        core::array::from_fn(|axis| {
            let k = number % counts[axis];
            number /= counts[axis];
            min[axis] + (k as f64 + 0.5) * dx / 2.0
        })
    };
    ParticleBatch {
        position: (0..counts.iter().product()).map(place).collect(),
        volume: vec![(dx / 2.0).powi(D as i32)],
        ..ParticleBatch::default()
    }
}

/// Runs the first acoustic mode between two walls `cells` apart. Returns its period over 2L/c, less 1, and the part of the
/// amplitude that is left eight and a half periods after the first quarter.
fn acoustic_mode<T: Instance<D>, const D: usize>(
    transfer: Transfer,
    cells: usize,
    low: Contact,
    high: Contact,
) -> (f64, f64) {
    let (length, sound_speed, speed) = (1.0, 10.0, 0.01);
    let dx = length / cells as f64;
    let dt = 0.2 * dx / sound_speed;
    let mut max = [4.0 * dx; D];
    max[0] = length;
    let mut sides = [Sides::Periodic; D];
    sides[0] = Sides::Walls { low, high };
    let setup = Setup {
        transfer,
        time_step: TimeStep::Fixed(dt),
        domain: Some(Domain {
            min: [0.0; D],
            max,
            sides,
            style: WallStyle::Plane,
        }),
        ..Setup::new(dx, vec![fluid(sound_speed, f64::INFINITY)])
    };
    let mut batch = lattice([0.0; D], max, dx);
    let mode: Vec<f64> = batch
        .position
        .iter()
        .map(|x| (PI * x[0] / length).sin())
        .collect();
    for x in &batch.position {
        let k = PI / length;
        let mut v = [0.0; D];
        v[0] = speed * (k * x[0]).sin();
        batch.velocity.push(v);
        let mut c = [[0.0; D]; D];
        c[0][0] = speed * k * (k * x[0]).cos();
        batch.affine.push(c);
    }
    let mut simulation = Simulation::<T, D>::new(setup, &[batch]).unwrap();
    let period = 2.0 * length / sound_speed;
    let (mut last, mut time, mut peak) = (1.0, 0.0, 0.0_f64);
    let (mut zeros, mut peaks) = (vec![], vec![]);
    while zeros.len() < 19 {
        simulation.substep().unwrap();
        time += dt;
        let velocity = field::<D>(&simulation, Field::Velocity);
        let products = velocity.iter().zip(&mode).map(|(v, mode)| v[0] * mode);
        let now = products.sum::<f64>() * 2.0 / (mode.len() as f64 * speed);
        if now * last < 0.0 {
            zeros.push(time - dt * now / (now - last));
            peaks.push(peak);
            peak = 0.0;
        }
        peak = peak.max(now.abs());
        last = now;
        assert!(
            time < 12.0 * period,
            "no wave: {transfer:?} {low:?} {zeros:?} {peaks:?}"
        );
    }
    (
        (zeros[18] - zeros[0]) / 9.0 / period - 1.0,
        peaks[18] / peaks[1],
    )
}

/// Validation case F6. Walls that zero the velocity of nodes give an error of 0.93 %.
#[test]
fn f6_waves_are_reflected_on_the_plane_of_a_wall() {
    for (transfer, kept) in [
        (Transfer::Apic, 0.995),
        (Transfer::Flip { blend: 1.0 }, 0.999),
    ] {
        for (low, high) in [(SLIP, SLIP), (Contact::Sticky, SLIP)] {
            let (period, amplitude) = acoustic_mode::<f64, 2>(transfer, 40, low, high);
            assert!(period.abs() < 2e-3, "{transfer:?}: period off by {period}");
            assert!(amplitude > kept, "{transfer:?}: {amplitude} is left");
        }
    }
    let (period, amplitude) = acoustic_mode::<f32, 3>(Transfer::Apic, 40, SLIP, SLIP);
    assert!(period.abs() < 2e-3, "3D f32: period off by {period}");
    assert!(amplitude > 0.995, "3D f32: {amplitude} is left");
}

/// The error is of second order: a quarter at half the spacing.
#[test]
fn the_error_of_walls_is_of_second_order() {
    let error = |cells| acoustic_mode::<f64, 2>(Transfer::Apic, cells, SLIP, SLIP).0;
    let ratio = error(20) / error(40);
    assert!((3.5..4.5).contains(&ratio), "{ratio}");
}

/// Lets a block of jelly move out of a corner and returns the largest change of a velocity \[m/s\]. Nothing presses it
/// against the walls.
fn leave<T: Instance<D>, const D: usize>(transfer: Transfer, towards: f64, friction: f64) -> f64 {
    let dx = 0.05;
    let setup = Setup {
        transfer,
        time_step: TimeStep::Fixed(1e-3),
        domain: Some(Domain {
            min: [0.0; D],
            max: [1.0; D],
            sides: [both(Contact::Separate { friction }); D],
            style: WallStyle::Plane,
        }),
        ..Setup::new(dx, vec![jelly(1e4)])
    };
    let (min, max) = if towards > 0.0 {
        (0.0, 0.3)
    } else {
        (0.7, 1.0)
    };
    let mut batch = lattice([min; D], [max; D], dx);
    let mut velocity = [0.5 * towards; D];
    velocity[1] = 0.2 * towards;
    batch.velocity = vec![velocity];
    let mut simulation = Simulation::<T, D>::new(setup, &[batch]).unwrap();
    for _ in 0..200 {
        simulation.substep().unwrap();
    }
    let velocities = field::<D>(&simulation, Field::Velocity);
    let mut worst = 0.0_f64;
    for v in velocities {
        for axis in 0..D {
            worst = worst.max((v[axis] - velocity[axis]).abs());
        }
    }
    worst
}

/// A mirror image would hold the body back, so a `separate` wall acts only where it pushes.
#[test]
fn a_body_that_leaves_a_separate_wall_keeps_its_velocity() {
    for transfer in [Transfer::Pic, Transfer::Flip { blend: 1.0 }, Transfer::Apic] {
        for towards in [1.0, -1.0] {
            for friction in [0.0, 0.5] {
                let change = leave::<f64, 2>(transfer, towards, friction);
                assert!(change < 1e-12, "{transfer:?} {towards}: {change:e}");
                let change = leave::<f64, 3>(transfer, towards, friction);
                assert!(change < 1e-12, "3D {transfer:?} {towards}: {change:e}");
            }
        }
    }
}

const DEPTH: f64 = 0.5; // m
const GRAVITY: f64 = 9.81; // m/s²

/// Returns a tank filled from wall to wall, at rest under its pressure.
fn filled<const D: usize>(walls: Contact) -> (Setup<D>, ParticleBatch<D>) {
    let (dx, depth, g, sound_speed) = (0.05, DEPTH, GRAVITY, 20.0);
    let mut gravity = [0.0; D];
    gravity[D - 1] = -g;
    let setup = Setup {
        gravity,
        domain: Some(Domain {
            min: [0.0; D],
            max: [1.0; D],
            sides: [both(walls); D],
            style: WallStyle::Plane,
        }),
        ..Setup::new(dx, vec![fluid(sound_speed, 0.0)])
    };
    let mut filled = [1.0; D];
    filled[D - 1] = depth;
    let mut batch = lattice([0.0; D], filled, dx);
    // p = ρ₀c² (e^{g(H−y)/c²} − 1)
    let jacobian = |x: &[f64; D]| (-g * (depth - x[D - 1]) / (sound_speed * sound_speed)).exp();
    batch.deformation = Deformation::Jacobian(batch.position.iter().map(jacobian).collect());
    (setup, batch)
}

/// Returns a filled tank after `time` \[s\].
fn resting<T: Instance<D>, const D: usize>(walls: Contact, time: f64) -> Simulation<T, D> {
    let (setup, batch) = filled(walls);
    let mut simulation = Simulation::new(setup, &[batch]).unwrap();
    simulation.advance_to(time).unwrap();
    simulation
}

/// Returns the largest speed over √(gH) and the largest displacement over H in a filled tank after 0.5 s.
fn tank<T: Instance<D>, const D: usize>(walls: Contact) -> (f64, f64) {
    let start = filled::<D>(walls).1.position;
    let simulation = resting::<T, D>(walls, 0.5);
    let (depth, g) = (DEPTH, GRAVITY);
    let speed = field::<D>(&simulation, Field::Velocity)
        .iter()
        .map(|v| v.iter().map(|v| v * v).sum::<f64>().sqrt())
        .fold(0.0, f64::max);
    let moved = field::<D>(&simulation, Field::Position)
        .iter()
        .zip(&start)
        .map(|(x, start)| (x[D - 1] - start[D - 1]).abs())
        .fold(0.0, f64::max);
    (speed / (g * depth).sqrt(), moved / depth)
}

#[test]
fn a_tank_at_rest_stays_at_rest() {
    for walls in [SLIP, SEPARATE, Contact::Sticky] {
        let (speed, moved) = tank::<f32, 2>(walls);
        assert!(speed < 1e-3, "2D {walls:?}: {speed:e} √(gH)");
        assert!(
            moved < 1e-3,
            "2D {walls:?}: moved by {moved:e} of the depth"
        );
    }
    let (speed, moved) = tank::<f32, 3>(SEPARATE);
    assert!(speed < 1e-3, "3D: {speed:e} √(gH)");
    assert!(moved < 1e-3, "3D: moved by {moved:e} of the depth");
}

/// Friction slows a block of jelly that slides on the floor by μ times its weight.
#[test]
fn friction_follows_coulomb_s_law() {
    let (dx, g, friction, speed) = (0.025, 10.0, 0.3, 2.0);
    let setup = Setup {
        gravity: [0.0, -g],
        domain: Some(Domain {
            min: [0.0; 2],
            max: [4.0, 0.5],
            sides: [both(Contact::Separate { friction }); 2],
            style: WallStyle::Plane,
        }),
        ..Setup::new(dx, vec![jelly(1e6)])
    };
    let mut batch = lattice([0.5, 0.0], [1.0, 0.1], dx);
    batch.velocity = vec![[speed, 0.0]];
    let mut simulation = Simulation::<f64, 2>::new(setup, &[batch]).unwrap();
    let mean = |simulation: &Simulation<f64, 2>| {
        let v = field::<2>(simulation, Field::Velocity);
        v.iter().map(|v| v[0]).sum::<f64>() / v.len() as f64
    };
    let time = 0.4;
    simulation.advance_to(time).unwrap();
    let slowed = (speed - mean(&simulation)) / (friction * g * time);
    assert!((slowed - 1.0).abs() < 0.01, "{slowed} of μ g t");
    simulation.advance_to(1.0).unwrap();
    assert!(mean(&simulation).abs() < 0.01, "{}", mean(&simulation));
}

/// Throws a block of water into a corner of a tank. Returns by how much the change of its momentum differs from the impulse
/// of gravity less the impulses of the walls, relative to the sum of the latter.
fn imbalance<T: Instance<D>, const D: usize>(
    transfer: Transfer,
    style: WallStyle,
    contact: Contact,
) -> f64 {
    let (dx, dt, steps) = (0.05, 5e-4, 400);
    let mut gravity = [0.0; D];
    gravity[1] = -9.81;
    let setup = Setup {
        gravity,
        transfer,
        time_step: TimeStep::Fixed(dt),
        domain: Some(Domain {
            min: [-0.3; D],
            max: [0.3; D],
            sides: [both(contact); D],
            style,
        }),
        ..Setup::new(dx, vec![fluid(20.0, 0.0)])
    };
    let mut batch = lattice([-0.2; D], [0.05; D], dx);
    let mut velocity = [-1.0; D];
    velocity[0] = -3.0;
    batch.velocity = vec![velocity];
    let mut simulation = Simulation::<T, D>::new(setup, &[batch]).unwrap();
    let before = simulation.diagnostics();
    for _ in 0..steps {
        simulation.substep().unwrap();
    }
    let after = simulation.diagnostics();
    let walls = simulation.boundary_impulses();
    assert_eq!(walls.len(), 2 * D);
    let (mut worst, mut all) = (0.0_f64, 0.0_f64);
    for axis in 0..D {
        let taken: f64 = walls.iter().map(|wall| wall.impulse[axis]).sum();
        all += walls.iter().map(|w| w.impulse[axis].abs()).sum::<f64>();
        let given = after.mass * gravity[axis] * dt * f64::from(steps);
        let gained = after.momentum[axis] - before.momentum[axis];
        worst = worst.max((gained + taken - given).abs());
    }
    assert!(
        all > 0.5 * after.mass,
        "the water has hardly touched the walls"
    );
    worst / all
}

/// Only gravity and walls change the momentum, and the impulses of walls account for it exactly.
#[test]
fn impulses_of_walls_are_the_momentum_that_the_material_loses() {
    let nodes = WallStyle::Nodes { padding: 2 };
    for contact in [
        SLIP,
        SEPARATE,
        Contact::Sticky,
        Contact::Slip { friction: 0.3 },
        Contact::Separate { friction: 0.3 },
    ] {
        for transfer in [
            Transfer::Pic,
            Transfer::Flip { blend: 0.95 },
            Transfer::Apic,
        ] {
            for style in [WallStyle::Plane, nodes] {
                let error = imbalance::<f64, 2>(transfer, style, contact);
                assert!(
                    error < 1e-12,
                    "{contact:?} {transfer:?} {style:?}: {error:e}"
                );
            }
        }
        for style in [WallStyle::Plane, nodes] {
            let error = imbalance::<f64, 3>(Transfer::Apic, style, contact);
            assert!(error < 1e-12, "3D {contact:?} {style:?}: {error:e}");
        }
        let error = imbalance::<f32, 3>(Transfer::Apic, WallStyle::Plane, contact);
        assert!(error < 1e-4, "3D f32 {contact:?}: {error:e}");
    }
}

/// In a tank at rest the floor carries the weight and each side the pressure on it; their torques are those of a pressure
/// that grows with depth.
#[test]
fn walls_of_a_tank_at_rest_carry_its_pressure() {
    let (simulation, time) = (resting::<f32, 2>(SEPARATE, 0.5), 0.5);
    let (depth, g) = (DEPTH, GRAVITY);
    let weight = DENSITY * g * depth;
    let thrust = 0.5 * DENSITY * g * depth * depth;
    // Name, force, torque about the lower left corner.
    let expected = [
        ("left", [-thrust, 0.0], thrust * depth / 3.0),
        ("right", [thrust, 0.0], -thrust * depth / 3.0),
        ("bottom", [0.0, -weight], -0.5 * weight),
        ("top", [0.0, 0.0], 0.0),
    ];
    let found = simulation.boundary_impulses();
    assert_eq!(found.len(), expected.len());
    for (wall, (name, force, torque)) in found.iter().zip(expected) {
        assert_eq!(wall.name, name);
        for axis in 0..2 {
            let error = (wall.impulse[axis] / time - force[axis]) / weight;
            assert!(error.abs() < 2e-3, "{name}: force off by {error} weights");
        }
        let error = (wall.angular_impulse[2] / time - torque) / weight;
        assert!(error.abs() < 2e-3, "{name}: torque off by {error}");
    }
}
