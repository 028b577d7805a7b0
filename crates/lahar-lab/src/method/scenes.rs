//! Setups and bodies that the checks of the method run.

use lahar::material::{
    Corotated, Dust, Eos, Fluid, HardeningFrom, Material, Model, NeoHookean, Snow, lame,
};
use lahar::{Contact, Domain, Sides, WallStyle};
use lahar::{Deformation, ForceForm, Kernel, ParticleBatch, Setup, TimeStep, Transfer};

use super::random::Random;

/// Transfer schemes to check.
pub const TRANSFERS: [Transfer; 4] = [
    Transfer::Pic,
    Transfer::Flip { blend: 0.95 },
    Transfer::Flip { blend: 1.0 },
    Transfer::Apic,
];

/// Every kernel with every form of the force that it can be used with.
pub const FORMS: [(Kernel, ForceForm); 5] = [
    (Kernel::Linear, ForceForm::Classic),
    (Kernel::Quadratic, ForceForm::Classic),
    (Kernel::Quadratic, ForceForm::Mls),
    (Kernel::Cubic, ForceForm::Classic),
    (Kernel::Cubic, ForceForm::Mls),
];

/// Young's modulus of the solids \[Pa\].
const YOUNGS_MODULUS: f64 = 1000.0;
/// Poisson's ratio of the solids.
const POISSON_RATIO: f64 = 0.3;

/// Lamé's constants λ and μ of the solids \[Pa\].
pub fn solid_moduli() -> (f64, f64) {
    lame(YOUNGS_MODULUS, POISSON_RATIO)
}

/// Returns dust, which has no stress.
pub fn dust() -> Model {
    Model::Dust(Dust)
}

/// Returns the fluid of mpm88 with a bulk modulus \[Pa\] and a viscosity \[Pa s\]. It pulls as well as it pushes.
pub fn fluid(bulk_modulus: f64, viscosity: f64) -> Model {
    Model::Fluid(Fluid {
        eos: Eos::Tait { gamma: 1.0 },
        viscosity,
        bulk_viscosity: viscosity,
        tension: f64::INFINITY,
        ..Fluid::inviscid(bulk_modulus)
    })
}

/// Returns the corotated solid.
pub fn corotated() -> Model {
    let (lambda, mu) = solid_moduli();
    Model::Corotated(Corotated { lambda, mu })
}

/// Returns the neo-Hookean solid.
pub fn neo_hookean() -> Model {
    let (lambda, mu) = solid_moduli();
    Model::NeoHookean(NeoHookean::from_lame(lambda, mu))
}

/// Returns snow with the solids' moduli.
pub fn snow() -> Snow {
    let (lambda, mu) = solid_moduli();
    Snow {
        lambda,
        mu,
        critical_compression: 2.5e-2,
        critical_stretch: 7.5e-3,
        hardening: 10.0,
        hardening_range: [0.1, 5.0],
        plastic_jacobian_range: [0.6, 20.0],
        hardening_from: HardeningFrom::Updated,
    }
}

/// Returns a setup with one material of density 1 and a fixed dt \[s\].
pub fn setup<const D: usize>(dx: f64, dt: f64, model: Model) -> Setup<D> {
    let material = Material {
        name: "material".into(),
        density: 1.0,
        model,
    };
    Setup {
        time_step: TimeStep::Fixed(dt),
        ..Setup::new(dx, vec![material])
    }
}

/// Returns a ball of radius `radius` cells around `center` \[m\], with two particles per cell and axis that are up to an
/// eighth of `jitter` cells off their lattice.
pub fn ball<const D: usize>(
    center: [f64; D],
    radius: f64,
    dx: f64,
    jitter: f64,
    random: &mut Random,
) -> ParticleBatch<D> {
    let side = (4.0 * radius).ceil() as usize;
    let mut position = Vec::new();
    for number in 0..side.pow(D as u32) {
        // From the center, in cells.
        let offset: [f64; D] = core::array::from_fn(|axis| {
            let k = number / side.pow(axis as u32) % side;
            (k as f64 + 0.5) / 2.0 - radius + 0.25 * jitter * random.signed()
        });
        if offset.iter().map(|x| x * x).sum::<f64>() <= radius * radius {
            position.push(core::array::from_fn(|axis| {
                center[axis] + offset[axis] * dx
            }));
        }
    }
    ParticleBatch {
        position,
        volume: vec![(dx / 2.0).powi(D as i32)],
        ..ParticleBatch::default()
    }
}

/// Returns a ball whose particles have random velocities, C and F, up to 1 m/s, 1/s and 3 %.
pub fn stirred_ball<const D: usize>(dx: f64) -> ParticleBatch<D> {
    let mut random = Random(7);
    let mut batch = ball([0.4; D], 2.5, dx, 1.0, &mut random);
    let count = batch.position.len();
    batch.velocity = (0..count).map(|_| random.vector()).collect();
    batch.affine = (0..count).map(|_| random.rows(1.0)).collect();
    let mut gradient = || {
        let mut f = random.rows(0.03);
        for (axis, row) in f.iter_mut().enumerate() {
            row[axis] += 1.0;
        }
        f
    };
    batch.deformation = Deformation::Gradient((0..count).map(|_| gradient()).collect());
    batch
}

/// Returns a ball with the velocity v⁰ + A x \[m/s\] and C = A \[1/s\].
pub fn affine_ball<const D: usize>(
    v0: [f64; D],
    a: [[f64; D]; D],
    dx: f64,
    random: &mut Random,
) -> ParticleBatch<D> {
    let mut batch = ball([0.4; D], 3.0, dx, 1.0, random);
    let field = |x: [f64; D]| {
        let ax = times(a, x);
        core::array::from_fn(|i| v0[i] + ax[i])
    };
    batch.velocity = batch.position.iter().map(|&x| field(x)).collect();
    batch.affine = vec![a; batch.position.len()];
    batch
}

/// Returns a disc of radius 4 cells around the origin with the velocity gradient `a` \[1/s\].
pub fn moving_disc(a: [[f64; 2]; 2], dx: f64) -> ParticleBatch<2> {
    let mut batch = ball([0.0; 2], 4.0, dx, 0.0, &mut Random(1));
    batch.velocity = batch.position.iter().map(|&x| times(a, x)).collect();
    batch.affine = vec![a; batch.position.len()];
    batch
}

/// Returns the scene of Taichi's test of mpm88: a falling square of 4096 particles on a grid of 128² cells.
pub fn mpm88() -> (Setup<2>, ParticleBatch<2>) {
    let (cells, dt) = (128.0, 2e-4);
    let dx = 1.0 / cells;
    let separate = Contact::Separate { friction: 0.0 };
    let sides = Sides::Walls {
        low: separate,
        high: separate,
    };
    let setup = Setup {
        gravity: [0.0, -9.8],
        domain: Some(Domain {
            min: [0.0; 2],
            max: [1.0; 2],
            sides: [sides; 2],
            style: WallStyle::Nodes { padding: 3 },
        }),
        ..setup(dx, dt, fluid(400.0, 0.0))
    };
    let start = |i: u32| {
        let (x, y) = (f64::from(i % 64) / 64.0, f64::from(i) / 4096.0);
        [x * 0.4 + 0.2, y * 0.4 + 0.05]
    };
    let batch = ParticleBatch {
        position: (0..4096).map(start).collect(),
        velocity: vec![[0.0, -3.0]],
        volume: vec![(dx / 2.0).powi(2)],
        ..ParticleBatch::default()
    };
    (setup, batch)
}

/// Returns the product of a matrix and a vector.
fn times<const D: usize>(matrix: [[f64; D]; D], vector: [f64; D]) -> [f64; D] {
    let row_times = |row: [f64; D]| row.iter().zip(vector).map(|(m, x)| m * x).sum();
    matrix.map(row_times)
}
