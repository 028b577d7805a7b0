//! Measures how fast sparkl computes the benchmark's column of fluid, and prints particle-steps per second.
//!
//! The scene is that of speed_scene.py: 8 jittered particles per cell, in motion, f32, quadratic kernel, APIC, pressure from
//! J, slip walls.

use sparkl3d::na::{Point3, Vector3};
use sparkl3d::pipelines::MpmPipeline;
use sparkl3d::prelude::{
    BoundaryHandling, MonaghanSphEos, Particle, ParticleModel, ParticleModelSet, ParticleSet,
    RigidWorld, SolverParameters, SpGrid,
};
use sparkl3d::rapier::geometry::{ColliderBuilder, ColliderSet};
use std::time::Instant;

/// Walls stand this many cells inside the grid.
const PAD: f32 = 3.0;
const DENSITY: f32 = 1000.0;
const GRAVITY: Vector3<f32> = Vector3::new(0.0, -9.81, 0.0);
/// Rate of the stretching flow at the start [1/s].
const RATE: f32 = 5.0;

fn main() {
    let numbers: Vec<f64> = std::env::args()
        .skip(1)
        .map(|text| text.parse().expect("numbers"))
        .collect();
    let [cells, threads, seconds, sound_speed, dt] = numbers[..] else {
        panic!("usage: peer-sparkl CELLS THREADS SECONDS SOUND_SPEED DT");
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads as usize)
        .build_global()
        .expect("threads");

    let dx = 1.0 / cells as f32;
    let mut models = ParticleModelSet::new();
    let modulus = DENSITY * (sound_speed * sound_speed) as f32;
    let mut water = MonaghanSphEos::new(modulus, 1, 0.0);
    water.max_neg_pressure = 0.0;
    let model = models.insert(ParticleModel::new(water));
    let mut particles = ParticleSet::new();
    let mut random = Random(1);
    let along = 2 * cells as u32;
    for i in 0..along / 2 {
        for j in 0..along / 2 {
            for k in 0..along {
                let mut place = |index: u32| 0.5 * dx * (index as f32 + random.next());
                let x = Vector3::new(place(i), place(j), place(k));
                let pad = Vector3::repeat(PAD * dx);
                let mut particle = Particle::new(model, Point3::from(x + pad), 0.25 * dx, DENSITY);
                particle.velocity = Vector3::new(RATE * x.x, -RATE * x.y, 0.0);
                particles.insert(particle);
            }
        }
    }

    let mut colliders = ColliderSet::new();
    let (low, high) = (PAD * dx, PAD * dx + 1.0);
    for axis in 0..3 {
        for (at, sign) in [(low, 1.0), (high, -1.0)] {
            if axis == 1 && sign < 0.0 {
                continue; // there is no lid, since no particle reaches it
            }
            let mut normal = Vector3::zeros();
            normal[axis] = sign;
            let mut foot = Vector3::zeros();
            foot[axis] = at;
            let wall = ColliderBuilder::halfspace(sparkl3d::na::Unit::new_unchecked(normal));
            colliders.insert(wall.translation(foot).friction(0.0));
        }
    }

    let params = SolverParameters {
        dt: dt as f32,
        max_substep_dt: dt as f32,
        boundary_handling: BoundaryHandling::Friction,
        stop_after_one_substep: true,
        ..SolverParameters::default()
    };
    let mut grid = SpGrid::new(dx).expect("room for a grid");
    let mut phases = SpGrid::new(dx).expect("room for a second grid");
    let mut pipeline = MpmPipeline::new();
    let mut substeps = |count: usize| {
        let began = Instant::now();
        for _ in 0..count {
            let world = RigidWorld {
                colliders: &colliders,
            };
            pipeline.step(
                &params,
                &GRAVITY,
                &world,
                &mut grid,
                &mut phases,
                &mut particles,
                &models,
                &mut (),
            );
        }
        began.elapsed().as_secs_f64()
    };
    substeps(2);
    let steps = (seconds * 4.0 / substeps(4)).round().max(4.0) as usize;
    substeps(steps);
    let time = substeps(steps);

    // The speed of a run that has blown up means nothing.
    let count = particles.len();
    let mean = particles
        .iter()
        .map(|p| f64::from(p.fluid_deformation_gradient_det()))
        .sum::<f64>()
        / count as f64;
    let fastest = particles
        .iter()
        .map(|p| p.velocity.norm())
        .fold(0.0, f32::max);
    assert!(
        particles
            .iter()
            .all(|p| !p.failed && p.position.coords.norm().is_finite())
    );
    assert!(
        fastest < 50.0 && (mean - 1.0).abs() < 0.1,
        "the fluid is no longer one: {fastest} m/s, J {mean}"
    );
    println!("{}", count as f64 * steps as f64 / time);
}

/// Numbers from 0 to 1 by a linear congruence.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }
}
