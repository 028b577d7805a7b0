//! Colliders: their surface lies where it is drawn even between nodes, their impulse is the momentum that the material
//! loses, material can leave a `separate` surface freely, and no particle passes through.

use crate::fixtures::{CONTACTS, ball, brawl, colliders_of_all_kinds, one_of_each};

use crate::walled::{SEPARATE, SLIP, both, field, fluid, jelly};
use lahar::geometry::Primitive;
use lahar::particles::Field;
use lahar::{
    Collider, Contact, Deformation, Domain, Instance, Motion, ParticleBatch, Setup, Simulate,
    Simulation, TimeStep, Transfer, WallStyle,
};
use lahar_lab::method::random::Random;

const G: f64 = 9.81; // m/s²

/// A tank 1 m wide whose floor is a half-space through (0.5, height) with the slope `angle` \[rad\], filled to 0.5 m above
/// that point and at rest under its pressure.
fn tank(dx: f64, height: f64, angle: f64, floor: Contact) -> (Setup<2>, ParticleBatch<2>) {
    let sound_speed = 30.0;
    let normal = [-angle.sin(), angle.cos()];
    let surface = height + 0.5;
    let mut setup = Setup {
        gravity: [0.0, -G],
        domain: Some(Domain {
            min: [0.0; 2],
            max: [1.0, 1.5],
            sides: [both(SEPARATE); 2],
            style: WallStyle::Plane,
        }),
        ..Setup::new(dx, vec![fluid(sound_speed, 0.0)])
    };
    setup.colliders = vec![Collider::still(
        "floor",
        vec![Primitive::HalfSpace {
            point: [0.5, height],
            normal,
        }],
        floor,
    )];
    let step = dx / 2.0;
    let mut batch = ParticleBatch::default();
    let n = (1.0 / step).round() as usize;
    for i in 0..n {
        let x = (i as f64 + 0.5) * step;
        let bottom = height + (x - 0.5) * angle.tan();
        let rows = ((surface - bottom) / step).round() as usize;
        for j in 0..rows {
            let y = surface - (j as f64 + 0.5) * (surface - bottom) / rows as f64;
            batch.position.push([x, y]);
            batch.volume.push(step * (surface - bottom) / rows as f64);
        }
    }
    let jacobian = |x: &[f64; 2]| (-G * (surface - x[1]) / (sound_speed * sound_speed)).exp();
    batch.deformation = Deformation::Jacobian(batch.position.iter().map(jacobian).collect());
    (setup, batch)
}

/// Readings of a tank at rest after 1.5 s.
struct Rest {
    /// Force on the floor over the weight.
    force: [f64; 2],
    /// Mean height of the particles over the height at the start.
    height: f64,
    /// Distance of the lowest particle from the floor \[cells\].
    gap: f64,
    /// Largest speed over √(gH).
    speed: f64,
}

fn rest(dx: f64, height: f64, angle: f64, floor: Contact) -> Rest {
    let (setup, batch) = tank(dx, height, angle, floor);
    let mean = |p: &[[f64; 2]]| p.iter().map(|x| x[1]).sum::<f64>() / p.len() as f64;
    let before = mean(&batch.position) - height;
    let mut simulation = Simulation::<f32, 2>::new(setup, &[batch]).unwrap();
    let weight = simulation.diagnostics().mass * G;
    let on_floor = |simulation: &mut Simulation<f32, 2>, time| {
        simulation.advance_to(time).unwrap();
        let floor = simulation.boundary_impulses().pop().unwrap();
        assert_eq!(floor.name, "floor");
        floor.impulse
    };
    let early = on_floor(&mut simulation, 0.5);
    let late = on_floor(&mut simulation, 1.5);
    let end = field::<2>(&simulation, Field::Position);
    let above = |x: &[f64; 2]| (x[1] - height) * angle.cos() - (x[0] - 0.5) * angle.sin();
    Rest {
        force: [0, 1].map(|axis| (late[axis] - early[axis]) / weight),
        height: (mean(&end) - height) / before,
        gap: end.iter().map(above).fold(f64::INFINITY, f64::min) / dx,
        speed: field::<2>(&simulation, Field::Velocity)
            .iter()
            .map(|v| v[0].hypot(v[1]))
            .fold(0.0, f64::max)
            / (G * 0.5_f64).sqrt(),
    }
}

/// Water rests on a level floor between nodes as on a wall on its plane: 0, 0.3, 0.5 and 0.8 of a cell above a node.
#[test]
fn a_floor_between_nodes_carries_a_tank() {
    for height in [0.25, 0.265, 0.275, 0.29] {
        for contact in [SLIP, SEPARATE, Contact::Sticky] {
            let found = rest(0.05, height, 0.0, contact);
            let at = format!("{height} {contact:?}");
            assert!(
                (found.force[1] + 1.0).abs() < 1e-4,
                "{at}: {:?}",
                found.force
            );
            assert!(found.force[0].abs() < 1e-4, "{at}: {:?}", found.force);
            assert!((found.height - 1.0).abs() < 1e-4, "{at}: {}", found.height);
            assert!((found.gap - 0.25).abs() < 1e-3, "{at}: {} cells", found.gap);
            assert!(found.speed < 1e-3, "{at}: {} √(gH)", found.speed);
        }
    }
}

/// On a slope the rows of particles do not follow the floor, so an error remains that is as large as the steps between
/// neighbors in a row.
#[test]
fn a_sloping_floor_carries_a_tank() {
    for (angle, height, force) in [(0.2, 2e-3, 5e-3), (0.5, 1e-2, 2e-2)] {
        for contact in [SLIP, SEPARATE, Contact::Sticky] {
            let found = rest(0.05, 0.45, angle, contact);
            let at = format!("{angle} {contact:?}");
            assert!(
                (found.force[1] + 1.0).abs() < force,
                "{at}: {:?}",
                found.force
            );
            assert!(
                (found.height - 1.0).abs() < height,
                "{at}: {}",
                found.height
            );
            assert!(found.gap > -1e-4, "{at}: {} cells", found.gap);
            if contact != Contact::Sticky {
                // Pressure is normal to the floor: its horizontal part over its vertical part is the slope.
                let slope = -found.force[0] / found.force[1];
                assert!((slope / angle.tan() - 1.0).abs() < 0.05, "{at}: {slope}");
            }
        }
    }
}

/// Returns by how much the change of the brawl's momentum differs from the impulse of gravity less the impulses of walls
/// and colliders, relative to the latter.
fn imbalance<const D: usize>(cells: usize, contact: Contact, transfer: Transfer) -> f64
where
    f64: Instance<D>,
{
    let (mut setup, batches) = brawl::<D>(cells);
    setup.colliders = colliders_of_all_kinds(setup.dx * cells as f64, contact);
    setup.transfer = transfer;
    let dt = 4e-4;
    setup.time_step = TimeStep::Fixed(dt);
    let mut simulation = Simulation::<f64, D>::new(setup, &batches).unwrap();
    let before = simulation.diagnostics();
    let steps = 250;
    for _ in 0..steps {
        simulation.substep().unwrap();
    }
    let after = simulation.diagnostics();
    let boundaries = simulation.boundary_impulses();
    assert_eq!(boundaries.len(), 2 * D + 5);
    for collider in &boundaries[2 * D..2 * D + 4] {
        let touched = collider.impulse.iter().any(|&x| x != 0.0);
        assert!(touched, "nothing has touched {}", collider.name);
    }
    let (mut worst, mut all) = (0.0_f64, 0.0);
    for axis in 0..D {
        let taken: f64 = boundaries.iter().map(|b| b.impulse[axis]).sum();
        all += boundaries
            .iter()
            .map(|b| b.impulse[axis].abs())
            .sum::<f64>();
        let g = if axis == 1 { -G } else { 0.0 };
        let given = after.mass * g * dt * f64::from(steps);
        let gained = after.momentum[axis] - before.momentum[axis];
        worst = worst.max((gained + taken - given).abs());
    }
    worst / all
}

#[test]
fn impulses_of_colliders_are_the_momentum_that_the_material_loses() {
    for contact in CONTACTS {
        for transfer in [Transfer::Flip { blend: 0.9 }, Transfer::Apic] {
            let error = imbalance::<2>(40, contact, transfer);
            assert!(error < 1e-12, "{contact:?} {transfer:?}: {error:e}");
        }
        let error = imbalance::<3>(20, contact, Transfer::Apic);
        assert!(error < 1e-12, "3D {contact:?}: {error:e}");
    }
}

/// Returns how deep a particle ever is inside a collider during the brawl \[cells\].
fn deepest<T: Instance<D>, const D: usize>(cells: usize, contact: Contact) -> f64 {
    let (mut setup, batches) = brawl::<D>(cells);
    let (dx, size) = (setup.dx, setup.dx * cells as f64);
    setup.colliders = colliders_of_all_kinds(size, contact);
    let colliders = setup.colliders.clone();
    let mut simulation = Simulation::<T, D>::new(setup, &batches).unwrap();
    let mut deepest = 0.0_f64;
    while simulation.time() < 0.25 {
        for _ in 0..10 {
            simulation.substep().unwrap();
        }
        let now: Vec<_> = colliders.iter().map(|c| c.at(simulation.time())).collect();
        for x in field::<D>(&simulation, Field::Position) {
            let inside = x.iter().all(|&x| (-1e-9..=size + 1e-9).contains(&x));
            assert!(inside, "{contact:?}: a particle at {x:?}");
            for collider in &now {
                deepest = deepest.max(-collider.distance(x).0 / dx);
            }
        }
    }
    deepest
}

#[test]
fn nothing_is_inside_a_collider() {
    for contact in CONTACTS {
        let depth = deepest::<f32, 2>(40, contact);
        assert!(depth < 0.1, "2D {contact:?}: {depth} cells");
        let depth = deepest::<f32, 3>(20, contact);
        assert!(depth < 0.1, "3D {contact:?}: {depth} cells");
    }
}

/// Lets a block of jelly move off a half-space of any slope and returns the largest change of a particle's velocity
/// \[m/s\].
fn leave<const D: usize>(normal: [f64; D], friction: f64, transfer: Transfer) -> f64
where
    f64: Instance<D>,
{
    let dx = 0.05;
    let mut setup = Setup {
        transfer,
        time_step: TimeStep::Fixed(1e-3),
        ..Setup::new(dx, vec![jelly(1e4)])
    };
    let point = [0.013; D];
    setup.colliders = vec![Collider::still(
        "floor",
        vec![Primitive::HalfSpace { point, normal }],
        Contact::Separate { friction },
    )];
    let floor = setup.colliders[0].at(0.0);
    let n = 16_usize;
    let place = |number: usize| {
        core::array::from_fn(|i| (number / n.pow(i as u32) % n) as f64 * dx / 2.0 - 0.2)
    };
    let batch = ParticleBatch {
        position: (0..n.pow(D as u32))
            .map(place)
            .filter(|x: &[f64; D]| floor.distance(*x).0 > 0.0)
            .collect(),
        velocity: vec![core::array::from_fn(|i| {
            0.4 * normal[i] + [0.2, -0.1, 0.1][i]
        })],
        volume: vec![(dx / 2.0).powi(D as i32)],
        ..ParticleBatch::default()
    };
    assert!(batch.position.len() > 50);
    let velocity = batch.velocity[0];
    let mut simulation = Simulation::<f64, D>::new(setup, &[batch]).unwrap();
    for _ in 0..150 {
        simulation.substep().unwrap();
    }
    let change = |v: [f64; D]| {
        (0..D)
            .map(|i| (v[i] - velocity[i]).abs())
            .fold(0.0, f64::max)
    };
    let velocities = field::<D>(&simulation, Field::Velocity);
    velocities.into_iter().map(change).fold(0.0, f64::max)
}

#[test]
fn a_body_that_leaves_a_separate_collider_keeps_its_velocity() {
    for transfer in [Transfer::Pic, Transfer::Flip { blend: 1.0 }, Transfer::Apic] {
        for friction in [0.0, 0.5] {
            for normal in [[0.0, 1.0], [0.6, 0.8], [-1.0, 0.0]] {
                let change = leave::<2>(normal, friction, transfer);
                assert!(change < 1e-12, "{normal:?} {transfer:?}: {change:e}");
            }
            let normal = [0.48, 0.6, 0.64];
            let change = leave::<3>(normal, friction, transfer);
            assert!(change < 1e-12, "{normal:?} {transfer:?}: {change:e}");
        }
    }
}

/// Returns how far a block has slid down a slope half a second and one second after its release \[m\].
fn slide(angle: f64, friction: f64) -> [f64; 2] {
    let dx = 0.1;
    let setup = Setup {
        gravity: [0.0, -G],
        colliders: vec![Collider::still(
            "slope",
            vec![Primitive::HalfSpace {
                point: [0.0, 0.0],
                normal: [angle.sin(), angle.cos()],
            }],
            Contact::Separate { friction },
        )],
        ..Setup::new(dx, vec![jelly(5e6)])
    };
    let down = [angle.cos(), -angle.sin()];
    let step = dx / 2.0;
    let mut batch = ParticleBatch {
        volume: vec![step * step],
        ..ParticleBatch::default()
    };
    for i in 0..20 {
        for j in 0..10 {
            let (s, h) = ((f64::from(i) + 0.5) * step, (f64::from(j) + 0.5) * step);
            batch
                .position
                .push([s * down[0] - h * down[1], s * down[1] + h * down[0]]);
        }
    }
    let mut simulation = Simulation::<f64, 2>::new(setup, &[batch]).unwrap();
    let along = |simulation: &Simulation<f64, 2>| {
        let x = field::<2>(simulation, Field::Position);
        let along = x.iter().map(|x| x[0] * down[0] + x[1] * down[1]);
        along.sum::<f64>() / x.len() as f64
    };
    let start = along(&simulation);
    [0.5, 1.0].map(|time| {
        simulation.advance_to(time).unwrap();
        along(&simulation) - start
    })
}

/// The block of validation case S3. It starts without stress, so for its first milliseconds it is not pressed onto the
/// slope and friction is too small. The acceleration is therefore taken from three places, which cancels the speed that
/// the block gains in that time.
#[test]
fn a_block_slides_down_a_slope_by_coulomb_s_law() {
    let angle = 24.0_f64.to_radians();
    for friction in [0.0, 15.0_f64.to_radians().tan()] {
        let [half, whole] = slide(angle, friction);
        let acceleration = G * (angle.sin() - friction * angle.cos());
        let part = (whole - 2.0 * half) / (0.25 * acceleration);
        assert!(
            (part - 1.0).abs() < 2e-3,
            "{friction}: {part} of the exact acceleration"
        );
    }
}

#[test]
fn a_block_stays_on_a_slope_within_the_friction_angle() {
    let [half, whole] = slide(10.0_f64.to_radians(), 15.0_f64.to_radians().tan());
    assert!(half.abs() < 1e-3, "the block sags by {half} m");
    assert!(
        (whole - half).abs() < 1e-5,
        "the block moves on by {} m",
        whole - half
    );
}

/// A fast piston takes a ball of dust along, and no particle stays behind.
#[test]
fn a_fast_piston_passes_no_particle() {
    let mut random = Random(3);
    let dx = 0.05;
    let mut setup = Setup::<2>::new(dx, one_of_each());
    setup.colliders = vec![Collider {
        motion: Motion::Steady {
            velocity: [0.0, 40.0],
            spin: [0.0; 3],
        },
        ..Collider::still(
            "piston",
            vec![Primitive::Box {
                center: [0.0, -3.0],
                half: [1.0, 0.11],
                axes: [[1.0, 0.0], [0.0, 1.0]],
            }],
            SEPARATE,
        )
    }];
    let dust = ball(4, [0.0, 0.0], 0.3, dx, [0.0; 2], &mut random);
    let mut simulation = Simulation::<f32, 2>::new(setup.clone(), &[dust]).unwrap();
    assert_eq!(simulation.next_dt().1.name(), "collider");
    simulation.advance_to(0.1).unwrap();
    let top = setup.colliders[0].at(0.1).distance([0.0, 0.0]).0;
    assert!(top > 0.5, "the piston has passed where the dust was: {top}");
    for x in field::<2>(&simulation, Field::Position) {
        assert!(x[1] > 1.1 - 1e-3, "left behind at {x:?}");
    }
}

/// Runs fluid along the floor against an obstacle for 0.25 s. Returns the particles' positions and the impulse on the
/// obstacle.
fn stream<const D: usize>(obstacle: Primitive<D>, motion: Motion<D>) -> (Vec<[f64; D]>, [f64; 3])
where
    f32: Instance<D>,
{
    let (dx, sound_speed) = (1.0 / 32.0, 20.0);
    let mut setup = Setup {
        gravity: core::array::from_fn(|i| if i == 1 { -G } else { 0.0 }),
        domain: Some(Domain {
            min: [0.0; D],
            max: core::array::from_fn(|i| [1.0, 0.75, 0.5][i]),
            sides: [both(SEPARATE); D],
            style: WallStyle::Plane,
        }),
        ..Setup::new(dx, vec![fluid(sound_speed, 0.0)])
    };
    setup.colliders = vec![Collider {
        motion,
        ..Collider::still("obstacle", vec![obstacle], SEPARATE)
    }];
    let cells = [12, 6, 16];
    let mut batch = ParticleBatch::default();
    let count: usize = cells[..D].iter().map(|n| 2 * n).product();
    for index in 0..count {
        let mut rest = index;
        batch.position.push(core::array::from_fn(|i| {
            let place = rest % (2 * cells[i]);
            rest /= 2 * cells[i];
            (place as f64 + 0.5) * dx / 2.0
        }));
    }
    batch.volume = vec![(dx / 2.0).powi(D as i32)];
    batch.velocity = vec![core::array::from_fn(|i| if i == 0 { 2.0 } else { 0.0 })];
    let mut simulation = Simulation::<f32, D>::new(setup, &[batch]).unwrap();
    simulation.advance_to(0.25).unwrap();
    let obstacle = simulation.boundary_impulses().pop().unwrap();
    assert!(
        obstacle.impulse[0] > 0.0,
        "the stream has reached the obstacle"
    );
    (field::<D>(&simulation, Field::Position), obstacle.impulse)
}

/// An obstacle on the floor acts as if it continued below: the bits are those of the same obstacle extended downward by
/// 5 cells.
#[test]
fn an_obstacle_that_stands_on_the_floor_has_no_face_there() {
    let below = -5.0 / 32.0;
    let block = |bottom: f64| Primitive::Box {
        center: [0.5625, 0.5 * (0.25 + bottom)],
        half: [0.0625, 0.5 * (0.25 - bottom)],
        axes: [[1.0, 0.0], [0.0, 1.0]],
    };
    let steady = |velocity| Motion::Steady {
        velocity,
        spin: [0.0; 3],
    };
    for motion in [Motion::Still, steady([-0.25, 0.0])] {
        let lower = stream(block(below), motion.clone());
        assert_eq!(stream(block(0.0), motion.clone()), lower, "{motion:?}");
        assert_eq!(stream(block(-0.5 / 32.0), motion), lower);
    }
    let wedge = |bottom: f64| Primitive::Polygon {
        points: vec![
            [0.5, bottom],
            [0.6875, bottom],
            [0.6875, 0.0],
            [0.625, 0.25],
            [0.5, 0.0],
        ],
    };
    let on_floor = Primitive::Polygon {
        points: vec![[0.6875, 0.0], [0.625, 0.25], [0.5, 0.0]],
    };
    assert_eq!(
        stream(on_floor, Motion::Still),
        stream(wedge(10.0 * below), Motion::Still)
    );
    let column = |bottom: f64| Primitive::Rod {
        from: [0.5625, bottom, 0.25],
        to: [0.5625, 0.5, 0.25],
        radius: 0.0625,
        round: false,
    };
    assert_eq!(
        stream(column(0.0), Motion::Still),
        stream(column(below), Motion::Still)
    );
    // A gate that is lifted does have a lower face.
    let (_, standing) = stream(block(0.0), Motion::Still);
    let (_, lifted) = stream(block(0.0), steady([0.0, 1.0]));
    assert!(lifted[0] < 0.9 * standing[0], "{lifted:?} {standing:?}");
}
