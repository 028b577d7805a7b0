//! The cases of the method itself, K1–K4 and K6–K8: what must hold whatever the scene.
//!
//! Each check is a function over [`Engine`]; the table at the end runs all of them on each engine.

use crate::engine::{Engine, Fast, Oracle, State, oracle_of, times};
use crate::fixtures::Random;
use lahar::boundary::{Contact, Domain, Sides, WallStyle};
use lahar::kernel::{BSpline, Cubic, Linear, Quadratic};
use lahar::material::{
    ConstitutiveModel, Corotated, Dust, Eos, Fluid, HardeningFrom, Material, Model, NeoHookean,
    PlasticGradient, Snow, Strain, lame,
};
use lahar::math::{Matrix, Scalar};
use lahar::{Deformation, ForceForm, Kernel, ParticleBatch, Setup, TimeStep, Transfer};

const TRANSFERS: [Transfer; 4] = [
    Transfer::Pic,
    Transfer::Flip { blend: 0.95 },
    Transfer::Flip { blend: 1.0 },
    Transfer::Apic,
];

/// Every kernel with every force that it can be used with.
const FORMS: [(Kernel, ForceForm); 5] = [
    (Kernel::Linear, ForceForm::Classic),
    (Kernel::Quadratic, ForceForm::Classic),
    (Kernel::Quadratic, ForceForm::Mls),
    (Kernel::Cubic, ForceForm::Classic),
    (Kernel::Cubic, ForceForm::Mls),
];

// ---- scenes ----

const YOUNGS_MODULUS: f64 = 1000.0; // Pa
const POISSON_RATIO: f64 = 0.3;

fn dust() -> Model {
    Model::Dust(Dust)
}

/// The mpm88 fluid, which pulls as well as it pushes.
fn fluid(bulk_modulus: f64, viscosity: f64) -> Model {
    Model::Fluid(Fluid {
        eos: Eos::Tait { gamma: 1.0 },
        viscosity,
        bulk_viscosity: viscosity,
        tension: f64::INFINITY,
        ..Fluid::inviscid(bulk_modulus)
    })
}

fn corotated() -> Model {
    let (lambda, mu) = lame(YOUNGS_MODULUS, POISSON_RATIO);
    Model::Corotated(Corotated { lambda, mu })
}

fn neo_hookean() -> Model {
    let (lambda, mu) = lame(YOUNGS_MODULUS, POISSON_RATIO);
    Model::NeoHookean(NeoHookean::from_lame(lambda, mu))
}

fn snow() -> Model {
    let (lambda, mu) = lame(YOUNGS_MODULUS, POISSON_RATIO);
    Model::Snow(Snow {
        lambda,
        mu,
        critical_compression: 2.5e-2,
        critical_stretch: 7.5e-3,
        hardening: 10.0,
        hardening_range: [0.1, 5.0],
        plastic_jacobian_range: [0.6, 20.0],
        hardening_from: HardeningFrom::Updated,
    })
}

fn setup<const D: usize>(dx: f64, dt: f64, model: Model) -> Setup<D> {
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

/// A ball of radius `radius` cells around `centre` \[m\], two particles a cell and axis, jittered.
fn ball<const D: usize>(
    centre: [f64; D],
    radius: f64,
    dx: f64,
    jitter: f64,
    random: &mut Random,
) -> ParticleBatch<D> {
    let side = (4.0 * radius).ceil() as usize;
    let mut position = Vec::new();
    for number in 0..side.pow(D as u32) {
        // From the centre, in cells.
        let offset: [f64; D] = core::array::from_fn(|axis| {
            let k = number / side.pow(axis as u32) % side;
            (k as f64 + 0.5) / 2.0 - radius + 0.25 * jitter * random.signed()
        });
        if offset.iter().map(|x| x * x).sum::<f64>() <= radius * radius {
            position.push(core::array::from_fn(|axis| {
                centre[axis] + offset[axis] * dx
            }));
        }
    }
    ParticleBatch {
        position,
        volume: vec![(dx / 2.0).powi(D as i32)],
        ..ParticleBatch::default()
    }
}

/// A ball with a different velocity, C and F on each particle, up to 1 m/s, 1/s and 3 %.
fn stirred_ball<const D: usize>(dx: f64) -> ParticleBatch<D> {
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

fn norm<const D: usize>(a: [f64; D]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Figures that miss their targets, and the best that was measured: docs/known-misses.md says what
/// was tried. Held to strictly: one that gets worse fails, and so does one that meets its target,
/// until it is taken off here and there.
const KNOWN_MISSES: &[KnownMiss] = &[
    KnownMiss {
        what: "K2 3D Cubic Classic C [1/s]",
        target: 1e-5,
        best: 1.2e-5,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 0.99 Cubic Classic cfl 0.5 staggered",
        target: 1e-2,
        best: 1.447e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 0.99 Cubic Mls cfl 0.5 staggered",
        target: 1e-2,
        best: 1.517e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Cubic Classic cfl 0.1 staggered",
        target: 1e-2,
        best: 4.011e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Cubic Classic cfl 0.5 staggered",
        target: 1e-2,
        best: 2.087e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Cubic Mls cfl 0.1 staggered",
        target: 1e-2,
        best: 4.038e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Cubic Mls cfl 0.5 staggered",
        target: 1e-2,
        best: 2.156e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Quadratic Classic cfl 0.1 staggered",
        target: 1e-2,
        best: 2.521e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Quadratic Classic cfl 0.5 staggered",
        target: 1e-2,
        best: 1.106e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Quadratic Mls cfl 0.1 staggered",
        target: 1e-2,
        best: 2.600e-02,
    },
    KnownMiss {
        what: "K4 Stretching FLIP 1 Quadratic Mls cfl 0.5 staggered",
        target: 1e-2,
        best: 1.221e-02,
    },
];

struct KnownMiss {
    what: &'static str,
    target: f64,
    best: f64,
}

/// Checks `value` ≤ `limit`, and tells it to who asks by `--nocapture`.
fn at_most(what: &str, value: f64, limit: f64) {
    report(what, value);
    if let Some(miss) = KNOWN_MISSES
        .iter()
        .find(|miss| miss.what == what && miss.target == limit)
    {
        assert!(
            value > limit,
            "{what}: {value:.3e} meets its target: take it off the known misses"
        );
        assert!(
            value <= miss.best,
            "{what}: {value:.3e}, known to miss by no more than {:.1e}",
            miss.best
        );
        return;
    }
    assert!(value <= limit, "{what}: {value:.3e}, allowed {limit:.1e}");
}

#[expect(
    clippy::print_stdout,
    reason = "measured figures, shown by --nocapture"
)]
fn report(what: &str, value: f64) {
    println!("{what}: {value:.3e}");
}

// ---- K1: kernels ----

/// The largest error of Σw = 1, Σ w r = 0, Σ w r rᵀ = D, Σ ∇w = 0 and Σ r ∇wᵀ = I over the cell, in
/// cells and units of `epsilon`. Sums are taken in `f64` over what `T` gives.
fn moment_errors<K: BSpline, T: Scalar>() -> [f64; 5] {
    let mut worst = [0.0_f64; 5];
    let cells = 10_000;
    let ends = [1e-300, 1e-30, 1e-9, 1e-5, 1.0 - T::EPSILON.to_f64() / 2.0];
    let inside = (0..cells).map(|i| f64::from(i) / f64::from(cells));
    for frac in inside.chain(ends).map(T::from_f64) {
        let s = frac.to_f64() + K::OFFSET;
        let (w, g) = (K::weights(frac), K::gradients(frac));
        let sum = |f: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
            (0..K::NODES)
                .map(|k| f(w[k].to_f64(), g[k].to_f64(), k as f64 - s))
                .sum()
        };
        let inertia = if K::INVERSE_INERTIA.is_finite() {
            1.0 / K::INVERSE_INERTIA
        } else {
            (1.0 - frac.to_f64()) * frac.to_f64()
        };
        let errors = [
            sum(&|w, _, _| w) - 1.0,
            sum(&|w, _, r| w * r),
            sum(&|w, _, r| w * r * r) - inertia,
            sum(&|_, g, _| g),
            sum(&|_, g, r| g * r) - 1.0,
        ];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error.abs() / T::EPSILON.to_f64());
        }
    }
    worst
}

#[test]
fn k1_kernel_moments() {
    for (kernel, double, single) in [
        (
            "linear",
            moment_errors::<Linear, f64>(),
            moment_errors::<Linear, f32>(),
        ),
        (
            "quadratic",
            moment_errors::<Quadratic, f64>(),
            moment_errors::<Quadratic, f32>(),
        ),
        (
            "cubic",
            moment_errors::<Cubic, f64>(),
            moment_errors::<Cubic, f32>(),
        ),
    ] {
        for (precision, errors) in [("f64", double), ("f32", single)] {
            for (moment, error) in ["Σw", "Σwr", "Σwrr", "Σg", "Σgr"].iter().zip(errors) {
                at_most(
                    &format!("K1 {kernel} {precision} {moment} [ulp]"),
                    error,
                    4.0,
                );
            }
        }
    }
}

/// Rows of numbers of a table with `#` comments and a line of column names.
fn table(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().expect("a line of names").split(',').collect();
    let number = |x: &str| x.parse().expect("a number");
    (
        names,
        lines
            .map(|line| line.split(',').map(number).collect())
            .collect(),
    )
}

/// Weights, their gradients, and what moving least squares puts in their place: D⁻¹ w r.
#[test]
fn k1_quadratic_kernel_table() {
    let (_, rows) = table(include_str!("../data/kernel_mls_reference.csv"));
    assert_eq!(rows.len(), 9);
    let mut worst = 0.0_f64;
    for row in rows {
        let frac = row[0] + 0.5; // the table's d is from the middle node
        let (w, g) = (Quadratic::weights(frac), Quadratic::gradients(frac));
        for k in 0..3 {
            let r = k as f64 - (frac + Quadratic::OFFSET);
            let mls = Quadratic::INVERSE_INERTIA * w[k] * r;
            for (ours, theirs) in [(w[k], row[1 + k]), (g[k], row[4 + k]), (mls, row[7 + k])] {
                worst = worst.max((ours - theirs).abs() / f64::EPSILON);
            }
        }
    }
    at_most("K1 table [ulp]", worst, 4.0);
}

// ---- K2: affine fields ----

/// P2G then G2P of v = v⁰ + A x with C = A returns v and C.
fn k2_affine_field<E: Engine<D>, const D: usize>() {
    let (dx, dt) = (0.1, 1e-3);
    let mut random = Random(3);
    let (v0, a) = (random.vector::<D>(), random.rows::<D>(1.0));
    for (kernel, force) in FORMS {
        let setup = Setup {
            kernel,
            force,
            ..setup(dx, dt, dust())
        };
        let mut batch = ball([0.4; D], 3.0, dx, 1.0, &mut random);
        let field = |x: [f64; D]| {
            let ax = times(a, x);
            core::array::from_fn(|i| v0[i] + ax[i])
        };
        batch.velocity = batch.position.iter().map(|&x| field(x)).collect();
        batch.affine = vec![a; batch.position.len()];
        let mut engine = E::new(&setup, &[batch]);
        let before = engine.particles();
        engine.substep();
        let (mut of_velocity, mut of_affine) = (0.0_f64, 0.0_f64);
        for (old, new) in before.iter().zip(engine.particles()) {
            let difference = |a: &[f64], b: &[f64]| {
                a.iter()
                    .zip(b)
                    .fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()))
            };
            of_velocity = of_velocity.max(difference(&new.velocity, &old.velocity));
            of_affine = of_affine.max(difference(new.affine.as_flattened(), a.as_flattened()));
        }
        let limit = E::tolerance(1e-13, 1e-5);
        let name = format!("K2 {D}D {kernel:?} {force:?}");
        at_most(&format!("{name} v [m/s]"), of_velocity, limit);
        at_most(&format!("{name} C [1/s]"), of_affine, limit);
    }
}

// ---- K3: momentum ----

/// Linear momentum a substep, every scheme, kernel, force and law.
fn k3_linear_momentum<E: Engine<D>, const D: usize>() {
    let mut worst = 0.0_f64;
    for transfer in TRANSFERS {
        for (kernel, force) in FORMS {
            for model in [fluid(400.0, 0.1), corotated(), neo_hookean(), snow()] {
                let setup = Setup {
                    kernel,
                    force,
                    transfer,
                    ..setup(0.1, 1e-4, model)
                };
                let mut engine = E::new(&setup, &[stirred_ball(0.1)]);
                let mut old = engine.particles();
                for _ in 0..10 {
                    engine.substep();
                    let new = engine.particles();
                    let momentum = |p: &[State<D>]| oracle_of(&setup, p).momentum();
                    let change = (momentum(&new) - momentum(&old)).norm();
                    let scale: f64 = old.iter().map(|p| p.mass * norm(p.velocity)).sum();
                    worst = worst.max(change / scale);
                    old = new;
                }
            }
        }
    }
    at_most(
        &format!("K3 {D}D momentum"),
        worst,
        E::tolerance(1e-12, 1e-5),
    );
}

/// Angular momentum a substep, what the affine matrices carry included, APIC with both forces.
fn k3_angular_momentum<E: Engine<D>, const D: usize>() {
    let mut worst = 0.0_f64;
    for (kernel, force) in FORMS {
        if kernel == Kernel::Linear {
            continue; // its D is not one matrix, so Σ v ∇wᵀ is not B D⁻¹
        }
        for model in [fluid(400.0, 0.1), corotated(), neo_hookean(), snow()] {
            let setup = Setup {
                kernel,
                force,
                ..setup(0.1, 1e-4, model)
            };
            let mut engine = E::new(&setup, &[stirred_ball(0.1)]);
            let mut old = engine.particles();
            for _ in 0..10 {
                engine.substep();
                let new = engine.particles();
                let [before, after] = [&old, &new].map(|p| oracle_of(&setup, p).angular_momentum());
                let change = norm([0, 1, 2].map(|k| after[k] - before[k]));
                let scale: f64 = old
                    .iter()
                    .map(|p| p.mass * norm(p.position) * norm(p.velocity))
                    .sum();
                worst = worst.max(change / scale);
                old = new;
            }
        }
    }
    at_most(
        &format!("K3 {D}D angular momentum"),
        worst,
        E::tolerance(1e-12, 1e-5),
    );
}

// ---- K4: energy of free bodies ----

/// How a free body starts: ∂v/∂x \[1/s\] of its velocity field.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// Stretches and squeezes by some 20 %, and spins a little.
    Stretching,
    /// Spins once in half a second, and stretches by some 5 %.
    Spinning,
}

impl Start {
    fn velocity_gradient(self) -> [[f64; 2]; 2] {
        match self {
            Self::Stretching => [[12.0, -2.5], [2.5, -12.0]],
            Self::Spinning => [[3.0, -12.0], [12.0, -3.0]],
        }
    }
}

/// Energies \[J/m\] of a disc before each substep, over several oscillations.
struct Energies {
    /// U(Fⁿ) + ½ Σ m_i v_i·v_i⁺.
    staggered: Vec<f64>,
    /// U(Fⁿ) + the particles' kinetic energy + ½ Σ m_i v_i·(v_i⁺ − v_i).
    staggered_by_particles: Vec<f64>,
    /// U(Fⁿ) + the particles' kinetic energy, that of affine matrices included.
    of_particles: Vec<f64>,
}

/// A disc of four cells' radius that starts to move, in substeps of `dt` \[s\].
fn moving_disc<E: Engine<2>>(start: Start, scheme: Setup<2>, dt: f64) -> (Setup<2>, E) {
    let setup = Setup {
        time_step: TimeStep::Fixed(dt),
        ..scheme
    };
    let mut batch = ball([0.0; 2], 4.0, setup.dx, 0.0, &mut Random(1));
    let a = start.velocity_gradient();
    batch.velocity = batch.position.iter().map(|&x| times(a, x)).collect();
    batch.affine = vec![a; batch.position.len()];
    let engine = E::new(&setup, &[batch]);
    (setup, engine)
}

/// `cfl` = c dt/dx, c the speed of pressure waves.
fn energies<E: Engine<2>>(start: Start, scheme: Setup<2>, cfl: f64) -> Energies {
    const TIME: f64 = 0.12; // s; nine oscillations of the fastest
    let (lambda, mu) = lame(YOUNGS_MODULUS, POISSON_RATIO);
    let sound_speed = (lambda + 2.0 * mu).sqrt(); // at a density of 1
    let dt = cfl * scheme.dx / sound_speed;
    let (setup, mut engine) = moving_disc::<E>(start, scheme, dt);
    let mut energies = Energies {
        staggered: vec![],
        staggered_by_particles: vec![],
        of_particles: vec![],
    };
    for _ in 0..(TIME / dt) as usize {
        let now = oracle_of(&setup, &engine.particles());
        let of_particles =
            now.elastic_energy() + now.kinetic_energy() + now.affine_kinetic_energy();
        energies.of_particles.push(of_particles);
        energies.staggered.push(now.staggered_energy(dt));
        energies
            .staggered_by_particles
            .push(of_particles + now.staggered_work(dt));
        engine.substep();
    }
    energies
}

/// The largest of `energy` over its first, less 1.
fn excess(energy: &[f64]) -> f64 {
    energy
        .iter()
        .fold(f64::MIN, |most, e| most.max(e / energy[0] - 1.0))
}

fn solid(model: Model, kernel: Kernel, force: ForceForm, transfer: Transfer) -> Setup<2> {
    Setup {
        kernel,
        force,
        transfer,
        ..setup(0.05, 0.0, model)
    }
}

/// The linear kernel is left out: rounding grows from its free surfaces, see [`k8_free_fall`].
fn smooth_forms() -> impl Iterator<Item = (Kernel, ForceForm)> {
    FORMS
        .into_iter()
        .filter(|(kernel, _)| *kernel != Kernel::Linear)
}

/// APIC: staggered energy is never above its start. Energy as particles have it wobbles by O(dt):
/// it shrinks with dt, and each oscillation's maximum is below the one before.
fn k4_energy_apic<E: Engine<2>>(start: Start, model: Model) {
    for (kernel, force) in smooth_forms() {
        let name = format!("K4 {start:?} {} {kernel:?} {force:?}", model.name());
        let mut wobble = vec![];
        for cfl in [0.5, 0.25, 0.1] {
            let energies = energies::<E>(start, solid(model, kernel, force, Transfer::Apic), cfl);
            let what = format!("{name} cfl {cfl}");
            let limit = E::tolerance(1e-9, 1e-5);
            at_most(
                &format!("{what} staggered"),
                excess(&energies.staggered),
                limit,
            );
            let kept = energies.staggered.last().unwrap() / energies.staggered[0];
            report(&format!("{what} kept"), kept);
            wobble.push(excess(&energies.of_particles));
            report(&format!("{what} particles"), excess(&energies.of_particles));
            let triples = energies.of_particles.windows(3);
            let maxima: Vec<f64> = triples
                .filter(|e| e[1] > e[0] && e[1] >= e[2])
                .map(|e| e[1])
                .collect();
            let grows = maxima.windows(2).any(|pair| pair[1] > pair[0]);
            assert!(!grows, "{what}: a maximum above the one before: {maxima:?}");
        }
        let halved = wobble[0] / wobble[1];
        assert!(
            (1.8..2.6).contains(&halved),
            "{name}: {wobble:?} at half dt"
        );
        assert!(
            wobble[2] < wobble[1] / 2.5,
            "{name}: {wobble:?} at dt / 2.5"
        );
    }
}

/// FLIP: the grid does not see all of the particles' kinetic energy, so its staggered energy may
/// exceed its start by what the grid comes to see (measured: up to 4 % of a strongly stretching body).
/// With the particles' own kinetic energy in its place it is never above its start.
fn k4_energy_flip<E: Engine<2>>(start: Start) {
    for (blend, cfl) in [(1.0, 0.5), (1.0, 0.1), (0.99, 0.5)] {
        for (kernel, force) in smooth_forms() {
            let setup = solid(neo_hookean(), kernel, force, Transfer::Flip { blend });
            let energies = energies::<E>(start, setup, cfl);
            let name = format!("K4 {start:?} FLIP {blend} {kernel:?} {force:?} cfl {cfl}");
            let by_particles = excess(&energies.staggered_by_particles);
            let limit = E::tolerance(1e-9, 1e-5);
            at_most(
                &format!("{name} staggered by particles"),
                by_particles,
                limit,
            );
            at_most(
                &format!("{name} staggered"),
                excess(&energies.staggered),
                1e-2,
            );
            report(&format!("{name} particles"), excess(&energies.of_particles));
        }
    }
}

/// Snow, which yields: staggered energy plus dissipation is never above its start, and no substep
/// gives dissipation back. Dissipation is what the stress has worked, less what is stored; the
/// work of a substep is V⁰ ½(τⁿ + τⁿ⁺¹) : Δt C, as the leapfrog has it.
fn k4_energy_plastic<E: Engine<2>>(start: Start) {
    const TIME: f64 = 0.12; // s
    let Model::Snow(law) = snow() else {
        unreachable!()
    };
    let strain = |p: &State<2>| {
        let h = Matrix::<f64, 2>::from_fn(|i, j| p.deformation_gradient[i][j] - f64::from(i == j));
        PlasticGradient {
            plastic_jacobian_minus_one: p.plastic_jacobian - 1.0,
            ..PlasticGradient::from_displacement_gradient(h)
        }
        .with_hidden_variables()
    };
    for (kernel, force) in smooth_forms() {
        for cfl in [0.5, 0.1] {
            let scheme = solid(snow(), kernel, force, Transfer::Apic);
            // The hardest snow carries sound fastest: h up to the top of its range.
            let sound_speed = (law.hardening_range[1] * (law.lambda + 2.0 * law.mu)).sqrt();
            let dt = cfl * scheme.dx / sound_speed;
            let (setup, mut engine) = moving_disc::<E>(start, scheme, dt);
            let mut before = engine.particles();
            let (mut energy, mut dissipated, mut given_back) = (vec![], 0.0, 0.0_f64);
            for _ in 0..(TIME / dt) as usize {
                energy.push(oracle_of(&setup, &before).staggered_energy(dt) + dissipated);
                engine.substep();
                let after = engine.particles();
                let mut of_substep = 0.0;
                for (old, new) in before.iter().zip(&after) {
                    let c = Matrix::<f64, 2>::from_fn(|i, j| new.affine[i][j]);
                    let (old, new, volume0) = (strain(old), strain(new), new.volume0);
                    let stress = law.kirchhoff_stress(old, c) + law.kirchhoff_stress(new, c);
                    let power = (stress.transpose() * c).trace() * 0.5;
                    let stored = law.energy_density(new) - law.energy_density(old);
                    of_substep += volume0 * (power * dt - stored);
                }
                dissipated += of_substep;
                given_back = given_back.max(-of_substep);
                before = after;
            }
            let name = format!("K4 {start:?} snow {kernel:?} {force:?} cfl {cfl}");
            report(&format!("{name} dissipated"), dissipated / energy[0]);
            assert!(
                dissipated > 0.02 * energy[0],
                "{name}: this check is about snow that yields"
            );
            let limit = E::tolerance(1e-9, 1e-5);
            at_most(&format!("{name} staggered"), excess(&energy), limit);
            at_most(
                &format!("{name} dissipation given back"),
                given_back / energy[0],
                // The work is exact to second order in dt only: a turning body shows it.
                2e-4 * cfl * cfl,
            );
        }
    }
}

// ---- K6: nothing is lost ----

/// Count, ids and masses stay, to the bit, in a closed box with each contact and style of wall.
fn k6_mass_and_count<E: Engine<D>, const D: usize>() {
    let walls = |contact| Sides::Walls {
        low: contact,
        high: contact,
    };
    let slip = walls(Contact::Slip { friction: 0.2 });
    let separate = walls(Contact::Separate { friction: 0.2 });
    for sides in [walls(Contact::Sticky), slip, separate, Sides::Periodic] {
        for style in [WallStyle::Plane, WallStyle::Nodes { padding: 2 }] {
            for transfer in TRANSFERS {
                let setup = Setup {
                    transfer,
                    gravity: [-20.0; D],
                    domain: Some(Domain {
                        min: [0.0; D],
                        max: [0.8; D],
                        sides: [sides; D],
                        style,
                    }),
                    ..setup(0.1, 1e-3, fluid(400.0, 0.0))
                };
                let batch = ball([0.45; D], 2.0, 0.1, 1.0, &mut Random(5));
                let mut engine = E::new(&setup, &[batch]);
                let mass = |p: &[State<D>]| p.iter().map(|p| (p.id, p.mass)).collect::<Vec<_>>();
                let start = mass(&engine.particles());
                for _ in 0..100 {
                    engine.substep();
                }
                let end = engine.particles();
                assert_eq!(
                    start,
                    mass(&end),
                    "K6 {D}D {sides:?} {style:?} {transfer:?}"
                );
                let inside = |p: &State<D>| p.position.iter().all(|&x| (0.0..=0.8).contains(&x));
                assert!(
                    end.iter().all(inside),
                    "K6 {D}D {sides:?} {style:?} {transfer:?}: outside"
                );
            }
        }
    }
}

// ---- K7: a regression of the mpm88 example ----

/// The table's row of an engine's particles, from com_x on.
fn mpm88_row(particles: &[State<2>]) -> Vec<f64> {
    let count = particles.len() as f64;
    let mean = |f: &dyn Fn(&State<2>) -> f64| particles.iter().map(f).sum::<f64>() / count;
    let largest = |f: &dyn Fn(&State<2>) -> f64| particles.iter().map(f).fold(f64::MIN, f64::max);
    let moment = |k| mean(&|p| 0.5 * (p.position[0].powi(k) + (2.0 * p.position[1]).powi(k)));
    vec![
        mean(&|p| p.position[0]),
        mean(&|p| p.position[1]),
        mean(&|p| p.velocity[0]),
        mean(&|p| p.velocity[1]),
        count * mean(&|p| 0.5 * p.mass * norm(p.velocity).powi(2)),
        largest(&|p| p.position[0]),
        largest(&|p| p.position[1]),
        1.0 - largest(&|p| -p.jacobian_minus_one),
        1.0 + largest(&|p| p.jacobian_minus_one),
        moment(1),
        moment(2),
        moment(3),
        moment(4),
    ]
}

/// Half of the last of the nine digits that the table is printed with.
fn half_digit(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    0.5 * 10.0_f64.powf(value.abs().log10().floor() - 8.0)
}

/// 500 substeps of the example against a run of its own kernels.
fn k7_mpm88<E: Engine<2>>() {
    let (names, rows) = table(include_str!("../data/peer_taichi_mpm88_regression.csv"));
    let (cells, dt) = (128.0, 2e-4);
    let dx = 1.0 / cells;
    let separate = Contact::Separate { friction: 0.0 };
    let setup = Setup {
        gravity: [0.0, -9.8],
        domain: Some(Domain {
            min: [0.0; 2],
            max: [1.0; 2],
            sides: [Sides::Walls {
                low: separate,
                high: separate,
            }; 2],
            style: WallStyle::Nodes { padding: 3 },
        }),
        ..setup(dx, dt, fluid(400.0, 0.0))
    };
    let start = |i: u32| {
        let (x, y) = (f64::from(i % 64) / 64.0, f64::from(i) / 4096.0);
        [x * 0.4 + 0.2, y * 0.4 + 0.05]
    };
    let mut engine = E::new(
        &setup,
        &[ParticleBatch {
            position: (0..4096).map(start).collect(),
            velocity: vec![[0.0, -3.0]],
            volume: vec![(dx / 2.0).powi(2)],
            ..ParticleBatch::default()
        }],
    );
    let columns = names.len();
    let mut worst = vec![0.0_f64; columns];
    let mut unrounded = worst.clone();
    let range: Vec<f64> = (0..columns)
        .map(|k| {
            let values = rows.iter().map(|row| row[k]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        })
        .collect();
    let mut step = 0.0;
    for row in &rows {
        while step < row[0] {
            engine.substep();
            step += 1.0;
        }
        for (k, ours) in (2..).zip(mpm88_row(&engine.particles())) {
            let error = ((ours - row[k]).abs() - half_digit(row[k])).max(0.0);
            worst[k] = worst[k].max(error / range[k]);
            unrounded[k] = unrounded[k].max((ours - row[k]).abs() / range[k]);
        }
        if step == 500.0 {
            let ours = mpm88_row(&engine.particles());
            for (k, name) in names.iter().enumerate().skip(11) {
                let error = (ours[k - 2] - row[k]).abs() / row[k];
                at_most(
                    &format!("K7 {name} at step 500"),
                    error,
                    E::tolerance(1e-8, 1e-5),
                );
            }
        }
    }
    for ((name, worst), unrounded) in names.iter().zip(worst).zip(unrounded).skip(2) {
        report(
            &format!("K7 {name} over its range, the table's rounding included"),
            unrounded,
        );
        let single = if name.starts_with('J') { 1e-3 } else { 1e-5 };
        at_most(
            &format!("K7 {name} over its range"),
            worst,
            E::tolerance(1e-8, single),
        );
    }
}

// ---- K8: free fall ----

fn k8_free_fall<E: Engine<D>, const D: usize>() {
    let (dt, steps, g, v0) = (1e-3, 500, 9.81, 1.5);
    let mut worst = 0.0_f64;
    for transfer in TRANSFERS {
        for (kernel, force) in FORMS {
            // Linear weights let a node of no mass to speak of be pushed with all of the stress:
            // rounding grows from a free surface, whatever the time step.
            let model = if kernel == Kernel::Linear {
                dust()
            } else {
                corotated()
            };
            let mut gravity = [0.0; D];
            gravity[1] = -g;
            let setup = Setup {
                kernel,
                force,
                transfer,
                gravity,
                ..setup(0.1, dt, model)
            };
            let mut batch = ball([0.3; D], 1.5, 0.1, 1.0, &mut Random(9));
            let mut velocity = [0.25; D];
            velocity[1] = v0;
            batch.velocity = vec![velocity];
            let start = batch.position.clone();
            let mut engine = E::new(&setup, &[batch]);
            for _ in 0..steps {
                engine.substep();
            }
            let n = f64::from(steps);
            for (p, start) in engine.particles().iter().zip(start) {
                for axis in 0..D {
                    let fallen =
                        velocity[axis] * n * dt + gravity[axis] * dt * dt * n * (n + 1.0) / 2.0;
                    worst = worst.max((p.position[axis] - (start[axis] + fallen)).abs());
                }
            }
        }
    }
    at_most(&format!("K8 {D}D [m]"), worst, E::tolerance(1e-12, 1e-5));
}

/// Every check of the method on an engine.
macro_rules! method {
    ($name:ident, $engine:ident) => {
        mod $name {
            use super::*;

            #[test]
            fn k2_affine_field_2d() {
                k2_affine_field::<$engine<2>, 2>();
            }
            #[test]
            fn k2_affine_field_3d() {
                k2_affine_field::<$engine<3>, 3>();
            }
            #[test]
            fn k3_linear_momentum_2d() {
                k3_linear_momentum::<$engine<2>, 2>();
            }
            #[test]
            fn k3_linear_momentum_3d() {
                k3_linear_momentum::<$engine<3>, 3>();
            }
            #[test]
            fn k3_angular_momentum_2d() {
                k3_angular_momentum::<$engine<2>, 2>();
            }
            #[test]
            fn k3_angular_momentum_3d() {
                k3_angular_momentum::<$engine<3>, 3>();
            }
            #[test]
            fn k4_energy_apic_stretching() {
                k4_energy_apic::<$engine<2>>(Start::Stretching, neo_hookean());
            }
            #[test]
            fn k4_energy_apic_spinning() {
                k4_energy_apic::<$engine<2>>(Start::Spinning, corotated());
            }
            #[test]
            fn k4_energy_flip_stretching() {
                k4_energy_flip::<$engine<2>>(Start::Stretching);
            }
            #[test]
            fn k4_energy_flip_spinning() {
                k4_energy_flip::<$engine<2>>(Start::Spinning);
            }
            #[test]
            fn k4_energy_plastic_stretching() {
                k4_energy_plastic::<$engine<2>>(Start::Stretching);
            }
            #[test]
            fn k4_energy_plastic_spinning() {
                k4_energy_plastic::<$engine<2>>(Start::Spinning);
            }
            #[test]
            fn k6_mass_and_count_2d() {
                k6_mass_and_count::<$engine<2>, 2>();
            }
            #[test]
            fn k6_mass_and_count_3d() {
                k6_mass_and_count::<$engine<3>, 3>();
            }
            #[test]
            fn k7_mpm88() {
                super::k7_mpm88::<$engine<2>>();
            }
            #[test]
            fn k8_free_fall_2d() {
                k8_free_fall::<$engine<2>, 2>();
            }
            #[test]
            fn k8_free_fall_3d() {
                k8_free_fall::<$engine<3>, 3>();
            }
        }
    };
}

type Fast64<const D: usize> = Fast<f64, D>;
type Fast32<const D: usize> = Fast<f32, D>;

method!(oracle, Oracle);
method!(fast_f64, Fast64);
method!(fast_f32, Fast32);
