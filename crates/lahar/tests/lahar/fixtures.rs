//! Scenes and helpers that several tests share.

use lahar::geometry::Primitive;
use lahar::material::{
    Corotated, Dust, Eos, Fluid, HardeningFrom, NeoHookean, PLASTIC_JACOBIAN, Snow, ViscousStress,
    VolumeCorrection, VolumeRule, lame,
};
use lahar::particles::{Data, Field, Snapshot};
use lahar::{
    Bounds, Collider, Contact, Cushion, Domain, Keyframe, Material, Model, Motion, ParticleBatch,
    Setup, Sides, Simulate, Simulation, TimeStep, WallStyle,
};
use lahar_lab::method::random::Random;

/// Returns dust, which has no stress.
pub(crate) fn dust() -> Material {
    Material {
        name: "dust".into(),
        density: 1.0,
        model: Model::Dust(Dust),
    }
}

/// One material of each model, so soft that waves and particles have similar speeds.
pub(crate) fn one_of_each() -> Vec<Material> {
    let (lambda, mu) = lame(2e3, 0.3);
    let material = |name: &str, density, model| Material {
        name: name.into(),
        density,
        model,
    };
    vec![
        material(
            "water",
            1000.0,
            Model::Fluid(Fluid {
                eos: Eos::Tait { gamma: 7.0 },
                viscosity: 0.5,
                bulk_viscosity: 0.1,
                volume: VolumeRule::Corrected(VolumeCorrection::default()),
                ..Fluid::inviscid(1000.0 * 5.0 * 5.0)
            }),
        ),
        material("jelly", 500.0, Model::Corotated(Corotated { lambda, mu })),
        material(
            "rubber",
            800.0,
            Model::NeoHookean(NeoHookean::from_lame(lambda, mu)),
        ),
        material(
            "snow",
            400.0,
            Model::Snow(Snow {
                lambda,
                mu,
                ..Snow::new(1.4e5, 0.2)
            }),
        ),
        material("dust", 100.0, Model::Dust(Dust)),
    ]
}

/// A ball of jittered particles of material `material`.
pub(crate) fn ball<const D: usize>(
    material: usize,
    center: [f64; D],
    radius: f64,
    dx: f64,
    velocity: [f64; D],
    random: &mut Random,
) -> ParticleBatch<D> {
    let spacing = dx / 2.0;
    let n = (radius / spacing).ceil() as i32;
    let mut position = Vec::new();
    let mut index = [-n; D];
    loop {
        let offset: [f64; D] = core::array::from_fn(|a| f64::from(index[a]) * spacing);
        if offset.iter().map(|x| x * x).sum::<f64>() < radius * radius {
            position.push(core::array::from_fn(|a| {
                center[a] + offset[a] + random.between(-0.2, 0.2) * spacing
            }));
        }
        let Some(axis) = (0..D).rev().find(|&a| index[a] < n) else {
            break;
        };
        index[axis] += 1;
        index[axis + 1..].fill(-n);
    }
    ParticleBatch {
        material,
        body: material as u32,
        position,
        velocity: vec![velocity],
        volume: vec![spacing.powi(D as i32)],
        ..ParticleBatch::default()
    }
}

/// Balls of all materials, thrown at each other in a box of `cells` cells per side with `separate` walls.
pub(crate) fn brawl<const D: usize>(cells: usize) -> (Setup<D>, Vec<ParticleBatch<D>>) {
    let dx = 1.0 / 32.0;
    let size = dx * cells as f64;
    let mut random = Random(7);
    let materials = one_of_each();
    let batches = (0..materials.len())
        .map(|k| {
            let angle = k as f64 * 1.3;
            let mut center = [0.5 * size; D];
            center[0] += 0.27 * size * angle.cos();
            center[1] += 0.27 * size * angle.sin();
            let mut velocity = [0.3; D];
            velocity[0] = -2.0 * angle.cos();
            velocity[1] = -2.0 * angle.sin();
            ball(k, center, 0.13 * size, dx, velocity, &mut random)
        })
        .collect();
    let mut setup = Setup::new(dx, materials);
    let wall = Sides::Walls {
        low: Contact::Separate { friction: 0.1 },
        high: Contact::Separate { friction: 0.0 },
    };
    setup.domain = Some(Domain {
        min: [0.0; D],
        max: [size; D],
        sides: [wall; D],
        style: WallStyle::Plane,
    });
    setup.gravity[1] = -9.81;
    setup.time_step = TimeStep::Automatic {
        cfl: 0.3,
        longest: f64::INFINITY,
    };
    (setup, batches)
}

/// The brawl with options that are off by default: water with gathered J and engineering viscous stress, solids with
/// measured volumes, snow that hardens by the previous strain, and a clamp and a cushion that some particles start
/// outside of.
pub(crate) fn brawl_with_all_options<const D: usize>(
    cells: usize,
) -> (Setup<D>, Vec<ParticleBatch<D>>) {
    let (mut setup, mut batches) = brawl::<D>(cells);
    let size = setup.dx * cells as f64;
    for material in &mut setup.materials {
        match &mut material.model {
            Model::Fluid(fluid) => {
                fluid.volume = VolumeRule::Gathered;
                fluid.viscous_stress = ViscousStress::Engineering;
                fluid.tension = 100.0;
            }
            Model::Snow(snow) => {
                snow.hardening_from = HardeningFrom::Previous;
                snow.hardening_range = [0.1, 5.0];
            }
            _ => {}
        }
    }
    for batch in &mut batches {
        batch.measure_volume = matches!(
            setup.materials[batch.material].model,
            Model::Corotated(_) | Model::NeoHookean(_)
        );
    }
    setup.clamp = Some(Bounds {
        min: [0.14 * size; D],
        max: [0.86 * size; D],
    });
    setup.cushion = Some(Cushion {
        inside: Bounds {
            min: [0.2 * size; D],
            max: [0.8 * size; D],
        },
        time: 0.05,
    });
    (setup, batches)
}

/// Colliders of every shape and motion, some of them overlapping, all with the contact law `contact`.
pub(crate) fn colliders_of_all_kinds<const D: usize>(
    size: f64,
    contact: Contact,
) -> Vec<Collider<D>> {
    // Rounded to multiples of 1/1024, which floating-point numbers represent exactly even far from the origin.
    let exact = |x: f64| (size * x * 1024.0).round() / 1024.0;
    let place = |x: f64, y: f64| -> [f64; D] { core::array::from_fn(|i| exact([x, y, 0.5][i])) };
    let along = |i: usize| core::array::from_fn(|j| f64::from(i == j));
    let axes: [[f64; D]; D] = core::array::from_fn(along);
    let slope: [f64; D] = core::array::from_fn(|i| [0.6, 0.8, 0.0][i]);
    let paddle = Primitive::Box {
        center: place(0.5, 0.3),
        half: core::array::from_fn(|i| size * [0.3, 0.07, 0.2][i]),
        axes,
    };
    let frame = |time, x, y, turn| Keyframe {
        time,
        position: place(x, y),
        turn: [0.0, 0.0, turn],
    };
    let ball = Primitive::Ball {
        center: place(0.3, 0.7),
        radius: 0.13 * size,
    };
    let rod = |round| Primitive::Rod {
        from: place(0.62, 0.62),
        to: place(0.85, 0.7),
        radius: 0.08 * size,
        round: round || D == 2,
    };
    vec![
        Collider::still(
            "slope",
            vec![Primitive::HalfSpace {
                point: place(0.0, 0.4),
                normal: slope,
            }],
            contact,
        ),
        Collider {
            motion: Motion::Steady {
                velocity: place(0.1, 0.05),
                spin: [0.0, 0.0, 6.0],
            },
            ..Collider::still("paddle", vec![paddle], contact)
        },
        Collider {
            motion: Motion::Keyframes(vec![
                frame(0.02, 0.3, 0.7, 0.0),
                frame(0.07, 0.4, 0.6, 1.0),
                frame(0.2, 0.2, 0.6, -1.0),
            ]),
            ..Collider::still("ball", vec![ball], contact)
        },
        Collider::still("rods", vec![rod(true), rod(false)], contact),
        Collider::still(
            "wedge",
            vec![Primitive::Polygon {
                points: vec![place(0.25, 0.0), place(0.5, 0.1), place(0.6, 0.0)],
            }],
            contact,
        ),
    ]
}

/// Every contact law, with friction and without.
pub(crate) const CONTACTS: [Contact; 4] = [
    Contact::Sticky,
    Contact::Slip { friction: 0.0 },
    Contact::Slip { friction: 0.4 },
    Contact::Separate { friction: 0.4 },
];

/// All fields of a particle.
pub(crate) const ALL: &[Field] = &[
    Field::Position,
    Field::Velocity,
    Field::Affine,
    Field::Jacobian,
    Field::DeformationGradient,
    Field::Variable(&PLASTIC_JACOBIAN),
    Field::Mass,
    Field::Material,
    Field::Body,
    Field::Id,
];

/// Returns the bits of a snapshot, column after column.
pub(crate) fn bits(snapshot: &Snapshot) -> Vec<u64> {
    let mut all = vec![snapshot.time.to_bits()];
    for (_, data) in &snapshot.columns {
        match data {
            Data::F32(v) => all.extend(v.iter().map(|x| u64::from(x.to_bits()))),
            Data::F64(v) => all.extend(v.iter().map(|x| x.to_bits())),
            Data::U32(v) => all.extend(v.iter().map(|&x| u64::from(x))),
        }
    }
    all
}

/// Runs a scene to `time` \[s\] on `threads` threads.
pub(crate) fn run_on<T: lahar::Instance<D>, const D: usize>(
    threads: usize,
    setup: &Setup<D>,
    batches: &[ParticleBatch<D>],
    time: f64,
) -> Simulation<T, D> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool");
    pool.install(|| {
        let mut simulation = Simulation::<T, D>::new(setup.clone(), batches).expect("a good setup");
        simulation.set_clock(|| 0.0);
        simulation.advance_to(time).expect("it runs");
        simulation
    })
}
