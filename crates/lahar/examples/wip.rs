#![allow(missing_docs, clippy::all, clippy::print_stdout)]
use lahar::material::{Eos, Fluid, JacobianUpdate};
use lahar::*;
fn now() -> f64 {
    use std::time::*;
    static mut T: Option<Instant> = None;
    #[allow(unsafe_code, static_mut_refs)]
    unsafe {
        T.get_or_insert_with(Instant::now).elapsed().as_secs_f64()
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: usize = a[1].parse().unwrap();
    let steps: usize = a[2].parse().unwrap();
    let th: usize = a[3].parse().unwrap();
    rayon::ThreadPoolBuilder::new()
        .num_threads(th)
        .build_global()
        .unwrap();
    let dx = 1.0 / n as f64;
    let c0 = 20.0;
    let water = Material {
        name: "water".into(),
        density: 1000.0,
        model: Model::Fluid(Fluid {
            eos: Eos::Tait { gamma: 7.0 },
            bulk_modulus: 1000.0 * c0 * c0,
            viscosity: 0.0,
            bulk_viscosity: 0.0,
            tension: 0.0,
            jacobian_update: JacobianUpdate::Trace,
        }),
    };
    let mut s = Setup::<3>::new(dx, vec![water]);
    let wall = Sides::Walls {
        low: Contact::Separate { friction: 0.0 },
        high: Contact::Separate { friction: 0.0 },
    };
    s.domain = Some(Domain {
        min: [0.0; 3],
        max: [1.0; 3],
        sides: [wall; 3],
        style: WallStyle::Plane,
    });
    s.gravity = [0.0, -9.81, 0.0];
    s.time_step = TimeStep::Automatic {
        cfl: 0.2,
        longest: f64::INFINITY,
    };
    if let Some(i) = a.get(4) {
        s.isa = *Isa::ALL.iter().find(|x| x.name() == i).unwrap();
    }
    let mut pos = vec![];
    let mut seed = 12345u32;
    let mut rnd = || {
        seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
        (seed >> 8) as f64 / 16777216.0
    };
    let (nx, ny, nz) = (n / 2, n / 2, n);
    for i in 0..nx {
        for j in 0..ny {
            for k in 0..nz {
                for _ in 0..8 {
                    pos.push([
                        (i as f64 + rnd()) * dx,
                        (j as f64 + rnd()) * dx,
                        (k as f64 + rnd()) * dx,
                    ]);
                }
            }
        }
    }
    let np = pos.len();
    let b = ParticleBatch {
        position: pos,
        volume: vec![dx * dx * dx / 8.0],
        ..Default::default()
    };
    let t = now();
    let mut sim = Simulation::<f32, 3>::new(s, &[b]).unwrap();
    println!(
        "{} particles, {} isa, setup {:.2}",
        np,
        sim.isa().name(),
        now() - t
    );
    for _ in 0..3 {
        sim.substep().unwrap();
    }
    sim.set_clock(now);
    let t = now();
    for _ in 0..steps {
        sim.substep().unwrap();
    }
    let e = now() - t;
    let p = sim.phase_times();
    let k = 1e9 / (np * steps) as f64;
    println!(
        "{:.2} M/s; ns/particle: sort {:.1} ({} sorts) scatter {:.1} grid {:.1} gather {:.1}",
        np as f64 * steps as f64 / e / 1e6,
        p.sort * k,
        p.sorts,
        p.scatter * k,
        p.grid * k,
        p.gather * k
    );
    let d = sim.diagnostics();
    println!("{d:?} {:?}", sim.memory());
}
