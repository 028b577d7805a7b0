//! The checks K1 to K8 on every engine, with every kernel, transfer scheme, form of the force and model, against limits.

use lahar::kernel::{BSpline, Cubic, Linear, Quadratic};
use lahar::{Contact, Domain, Sides, WallStyle};
use lahar::{ForceForm, Kernel, Model, Setup, Transfer};
use lahar_lab::method::conservation::{affine_change, free_fall, masses, momentum_change};
use lahar_lab::method::energy::{Disc, Energies, excess};
use lahar_lab::method::engine::{Build, Fast, Oracle, ParticleState};
use lahar_lab::method::random::Random;
use lahar_lab::method::scenes::{
    FORMS, TRANSFERS, affine_ball, ball, corotated, dust, fluid, neo_hookean, setup, snow,
    solid_moduli, stirred_ball,
};
use lahar_lab::method::{kernels, laws, mpm88, scenes};

/// Figures that miss their targets, with the best value measured. docs/known-misses.md says what was tried. A figure that
/// gets worse fails, and so does one that meets its target, until it is removed from this list and from that page.
const KNOWN_MISSES: &[KnownMiss] = &[
    KnownMiss {
        figure: "K2 3D Cubic Classic C [1/s]",
        target: 1e-5,
        best: 1.2e-5,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 0.99 Cubic Classic cfl 0.5 staggered",
        target: 1e-2,
        best: 1.447e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 0.99 Cubic Mls cfl 0.5 staggered",
        target: 1e-2,
        best: 1.517e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Cubic Classic cfl 0.1 staggered",
        target: 1e-2,
        best: 4.011e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Cubic Classic cfl 0.5 staggered",
        target: 1e-2,
        best: 2.087e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Cubic Mls cfl 0.1 staggered",
        target: 1e-2,
        best: 4.038e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Cubic Mls cfl 0.5 staggered",
        target: 1e-2,
        best: 2.156e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Quadratic Classic cfl 0.1 staggered",
        target: 1e-2,
        best: 2.521e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Quadratic Classic cfl 0.5 staggered",
        target: 1e-2,
        best: 1.106e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Quadratic Mls cfl 0.1 staggered",
        target: 1e-2,
        best: 2.600e-02,
    },
    KnownMiss {
        figure: "K4 Stretching FLIP 1 Quadratic Mls cfl 0.5 staggered",
        target: 1e-2,
        best: 1.221e-02,
    },
];

/// A figure that misses its target.
struct KnownMiss {
    figure: &'static str,
    target: f64,
    best: f64,
}

/// Checks that a figure is at most `limit`, or is known to miss it. `--nocapture` shows all figures.
fn at_most(figure: &str, value: f64, limit: f64) {
    report(figure, value);
    if let Some(miss) = KNOWN_MISSES
        .iter()
        .find(|miss| miss.figure == figure && miss.target == limit)
    {
        assert!(
            value > limit,
            "{figure}: {value:.3e} meets its target: take it off the known misses"
        );
        assert!(
            value <= miss.best,
            "{figure}: {value:.3e}, known to miss by no more than {:.1e}",
            miss.best
        );
        return;
    }
    assert!(value <= limit, "{figure}: {value:.3e}, allowed {limit:.1e}");
}

#[expect(
    clippy::print_stdout,
    reason = "measured figures, shown by --nocapture"
)]
fn report(figure: &str, value: f64) {
    println!("{figure}: {value:.3e}");
}

// ---- K1: kernels ----

#[test]
fn k1_kernel_moments() {
    fn check<K: BSpline>(kernel: &str) {
        let double = kernels::moment_errors::<K, f64>();
        let single = kernels::moment_errors::<K, f32>();
        for (precision, errors) in [("f64", double), ("f32", single)] {
            for (moment, error) in kernels::MOMENTS.iter().zip(errors) {
                let figure = format!("K1 {kernel} {precision} {moment} [ulp]");
                at_most(&figure, error, 4.0);
            }
        }
    }
    check::<Linear>("linear");
    check::<Quadratic>("quadratic");
    check::<Cubic>("cubic");
}

#[test]
fn k1_quadratic_kernel_table() {
    at_most("K1 table [ulp]", kernels::quadratic_table_error(), 4.0);
}

// ---- K2: affine fields ----

/// P2G and G2P of v = v⁰ + A x with C = A preserve v and C.
fn k2_affine_field<E: Build<D>, const D: usize>() {
    let (dx, dt) = (0.1, 1e-3);
    let mut random = Random(3);
    let (v0, a) = (random.vector::<D>(), random.rows::<D>(1.0));
    for (kernel, force) in FORMS {
        let setup = Setup {
            kernel,
            force,
            ..setup(dx, dt, dust())
        };
        let batch = affine_ball(v0, a, dx, &mut random);
        let mut engine = E::build(&setup, &[batch]).unwrap();
        let [velocities, affine] = affine_change(&mut engine).unwrap();
        let limit = E::tolerance(1e-13, 1e-5);
        let name = format!("K2 {D}D {kernel:?} {force:?}");
        at_most(&format!("{name} v [m/s]"), velocities, limit);
        at_most(&format!("{name} C [1/s]"), affine, limit);
    }
}

// ---- K3: momentum ----

/// The stirred ball's largest relative change of momentum and of angular momentum in a substep, over all models.
fn largest_change<E: Build<D>, const D: usize>(
    kernel: Kernel,
    force: ForceForm,
    transfer: Transfer,
) -> [f64; 2] {
    let models = [
        fluid(400.0, 0.1),
        corotated(),
        neo_hookean(),
        Model::Snow(snow()),
    ];
    models.into_iter().fold([0.0_f64; 2], |worst, model| {
        let setup = Setup {
            kernel,
            force,
            transfer,
            ..setup(0.1, 1e-4, model)
        };
        let mut engine = E::build(&setup, &[stirred_ball(0.1)]).unwrap();
        let change = momentum_change(&mut engine, 10).unwrap();
        [worst[0].max(change.linear), worst[1].max(change.angular)]
    })
}

/// Every scheme, kernel, force and model conserves momentum. APIC conserves angular momentum too, but with the linear
/// kernel, whose D is not one matrix, so that Σ v ∇wᵀ is not B D⁻¹.
fn k3_momenta<E: Build<D>, const D: usize>() {
    let (mut linear, mut angular) = (0.0_f64, 0.0_f64);
    for transfer in TRANSFERS {
        for (kernel, force) in FORMS {
            let change = largest_change::<E, D>(kernel, force, transfer);
            linear = linear.max(change[0]);
            if transfer == Transfer::Apic && kernel != Kernel::Linear {
                angular = angular.max(change[1]);
            }
        }
    }
    let limit = E::tolerance(1e-12, 1e-5);
    at_most(&format!("K3 {D}D momentum"), linear, limit);
    at_most(&format!("K3 {D}D angular momentum"), angular, limit);
}

// ---- K4: energy of free bodies ----

/// The velocity field with which a free body starts.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// The body stretches and squeezes by some 20 %, and spins a little.
    Stretching,
    /// The body spins once in half a second, and stretches by some 5 %.
    Spinning,
}

/// Returns a disc that runs for nine oscillations of its fastest mode; `cfl` is c dt/dx, with c the speed of pressure waves
/// of a material of this wave modulus \[Pa\].
fn disc(start: Start, scheme: Setup<2>, cfl: f64, wave_modulus: f64) -> Disc {
    Disc {
        velocity_gradient: match start {
            Start::Stretching => [[12.0, -2.5], [2.5, -12.0]],
            Start::Spinning => [[3.0, -12.0], [12.0, -3.0]],
        },
        dt: cfl * scheme.dx / wave_modulus.sqrt(), // at a density of 1
        scheme,
        time: 0.12,
    }
}

fn energies<E: Build<2>>(start: Start, scheme: Setup<2>, cfl: f64) -> Energies {
    let (lambda, mu) = solid_moduli();
    let disc = disc(start, scheme, cfl, lambda + 2.0 * mu);
    disc.energies::<E>().unwrap()
}

fn solid(model: Model, kernel: Kernel, force: ForceForm, transfer: Transfer) -> Setup<2> {
    Setup {
        kernel,
        force,
        transfer,
        ..setup(0.05, 0.0, model)
    }
}

/// All forms but those with the linear kernel, whose rounding errors grow from free surfaces: see [`k8_free_fall`].
fn smooth_forms() -> impl Iterator<Item = (Kernel, ForceForm)> {
    FORMS
        .into_iter()
        .filter(|(kernel, _)| *kernel != Kernel::Linear)
}

/// APIC: the staggered energy is never above its start. The energy of the particles oscillates by O(dt): the excess shrinks
/// with dt, and the maximum of each oscillation is below the one before.
fn k4_energy_apic<E: Build<2>>(start: Start, model: Model) {
    for (kernel, force) in smooth_forms() {
        let name = format!("K4 {start:?} {} {kernel:?} {force:?}", model.name());
        let mut excesses = vec![];
        for cfl in [0.5, 0.25, 0.1] {
            let energies = energies::<E>(start, solid(model, kernel, force, Transfer::Apic), cfl);
            let run = format!("{name} cfl {cfl}");
            let staggered = excess(&energies.staggered);
            at_most(
                &format!("{run} staggered"),
                staggered,
                E::tolerance(1e-9, 1e-5),
            );
            let kept = energies.staggered.last().unwrap() / energies.staggered[0];
            report(&format!("{run} kept"), kept);
            excesses.push(excess(&energies.of_particles));
            report(&format!("{run} particles"), excess(&energies.of_particles));
            let triples = energies.of_particles.windows(3);
            let maxima: Vec<f64> = triples
                .filter(|e| e[1] > e[0] && e[1] >= e[2])
                .map(|e| e[1])
                .collect();
            let grows = maxima.windows(2).any(|pair| pair[1] > pair[0]);
            assert!(!grows, "{run}: a maximum above the one before: {maxima:?}");
        }
        let halved = excesses[0] / excesses[1];
        assert!(
            (1.8..2.6).contains(&halved),
            "{name}: {excesses:?} at half dt"
        );
        assert!(
            excesses[2] < excesses[1] / 2.5,
            "{name}: {excesses:?} at dt / 2.5"
        );
    }
}

/// FLIP: the grid does not see all of the particles' kinetic energy, so the staggered energy can exceed its start by the
/// part that the grid comes to see (measured: up to 4 % for a strongly stretching body). With the particles' own kinetic
/// energy in its place, it is never above its start.
fn k4_energy_flip<E: Build<2>>(start: Start) {
    for (blend, cfl) in [(1.0, 0.5), (1.0, 0.1), (0.99, 0.5)] {
        for (kernel, force) in smooth_forms() {
            let setup = solid(neo_hookean(), kernel, force, Transfer::Flip { blend });
            let energies = energies::<E>(start, setup, cfl);
            let name = format!("K4 {start:?} FLIP {blend} {kernel:?} {force:?} cfl {cfl}");
            at_most(
                &format!("{name} staggered by particles"),
                excess(&energies.staggered_by_particles),
                E::tolerance(1e-9, 1e-5),
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

/// Snow, which yields: staggered plus dissipated energy is never above its start, and no substep gives dissipated energy
/// back.
fn k4_energy_plastic<E: Build<2>>(start: Start) {
    let law = snow();
    // The hardest snow has the fastest waves: its hardening factor is at the top of its range.
    let wave_modulus = law.hardening_range[1] * (law.lambda + 2.0 * law.mu);
    for (kernel, force) in smooth_forms() {
        for cfl in [0.5, 0.1] {
            let scheme = solid(Model::Snow(law), kernel, force, Transfer::Apic);
            let disc = disc(start, scheme, cfl, wave_modulus);
            let found = disc.dissipation::<E>(&law).unwrap();
            let first = found.staggered[0];
            let name = format!("K4 {start:?} snow {kernel:?} {force:?} cfl {cfl}");
            report(&format!("{name} dissipated"), found.dissipated / first);
            assert!(
                found.dissipated > 0.02 * first,
                "{name}: the snow must yield"
            );
            let limit = E::tolerance(1e-9, 1e-5);
            at_most(
                &format!("{name} staggered"),
                excess(&found.staggered),
                limit,
            );
            at_most(
                &format!("{name} dissipation given back"),
                found.given_back / first,
                // The work is exact to second order in dt only, as a rotating body shows.
                2e-4 * cfl * cfl,
            );
        }
    }
}

// ---- K5: constitutive models ----

#[test]
fn k5_solids_match_the_tables() {
    for (dimension, errors) in [
        (2, laws::solid_errors::<2>()),
        (3, laws::solid_errors::<3>()),
    ] {
        for (name, error) in errors.stress {
            at_most(&format!("K5 {dimension}D stress, {name}"), error, 1e-8);
        }
        let figure = format!("K5 {dimension}D yielded snow");
        at_most(&figure, errors.yielded_snow, 1e-8);
    }
}

#[test]
fn k5_equations_of_state_match_the_table() {
    for (name, error) in laws::eos_errors() {
        at_most(&format!("K5 pressure, {name}"), error, 1e-10);
    }
}

// ---- K6: mass and number of particles ----

/// Number, ids and masses of particles stay the same, to the bit, in a closed box with each contact and style of wall.
fn k6_mass_and_count<E: Build<D>, const D: usize>() {
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
                let mut engine = E::build(&setup, &[batch]).unwrap();
                let start = masses(&engine.particles());
                for _ in 0..100 {
                    engine.substep().unwrap();
                }
                let end = engine.particles();
                let name = format!("K6 {D}D {sides:?} {style:?} {transfer:?}");
                assert_eq!(start, masses(&end), "{name}");
                let inside =
                    |p: &ParticleState<D>| p.position.iter().all(|&x| (0.0..=0.8).contains(&x));
                assert!(end.iter().all(inside), "{name}: outside");
            }
        }
    }
}

// ---- K7: a regression of the mpm88 example ----

/// Returns half of the last of the nine digits that the table is printed with.
fn half_digit(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    0.5 * 10.0_f64.powf(value.abs().log10().floor() - 8.0)
}

/// 500 substeps of the example against a run of its own kernels.
fn k7_mpm88<E: Build<2>>() {
    let table = mpm88::reference();
    let (setup, batch) = scenes::mpm88();
    let mut engine = E::build(&setup, &[batch]).unwrap();
    let columns = table.names.len();
    let mut worst = vec![0.0_f64; columns];
    let mut unrounded = worst.clone();
    let range: Vec<f64> = (0..columns)
        .map(|k| {
            let values = table.rows.iter().map(|row| row[k]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        })
        .collect();
    let mut step = 0.0;
    for row in &table.rows {
        while step < row[0] {
            engine.substep().unwrap();
            step += 1.0;
        }
        let particles = engine.particles();
        for (k, ours) in (2..).zip(mpm88::row(&particles)) {
            let error = ((ours - row[k]).abs() - half_digit(row[k])).max(0.0);
            worst[k] = worst[k].max(error / range[k]);
            unrounded[k] = unrounded[k].max((ours - row[k]).abs() / range[k]);
        }
        if step == 500.0 {
            let published = mpm88::published_moments();
            for (ours, published) in mpm88::moments(&particles).into_iter().zip(published) {
                let figure = format!("K7 moment {published} at step 500");
                let error = (ours - published).abs() / published;
                at_most(&figure, error, E::tolerance(1e-8, 1e-5));
            }
        }
    }
    for ((name, worst), unrounded) in table.names.iter().zip(worst).zip(unrounded).skip(2) {
        report(
            &format!("K7 {name} over its range, with the rounding of the table"),
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

fn k8_free_fall<E: Build<D>, const D: usize>() {
    let (dt, steps, g, v0) = (1e-3, 500, 9.81, 1.5);
    let mut worst = 0.0_f64;
    for transfer in TRANSFERS {
        for (kernel, force) in FORMS {
            // With linear weights, the whole stress can act on a node of hardly any mass: rounding errors grow from a free
            // surface at any time step.
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
            let mut engine = E::build(&setup, &[batch]).unwrap();
            for _ in 0..steps {
                engine.substep().unwrap();
            }
            for (p, start) in engine.particles().iter().zip(start) {
                for axis in 0..D {
                    let fallen = free_fall(velocity[axis], gravity[axis], dt, f64::from(steps));
                    worst = worst.max((p.position[axis] - (start[axis] + fallen)).abs());
                }
            }
        }
    }
    at_most(&format!("K8 {D}D [m]"), worst, E::tolerance(1e-12, 1e-5));
}

/// Makes a module with all checks on one engine.
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
            fn k3_momenta_2d() {
                k3_momenta::<$engine<2>, 2>();
            }
            #[test]
            fn k3_momenta_3d() {
                k3_momenta::<$engine<3>, 3>();
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
