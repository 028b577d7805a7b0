//! Tests of the oracle by itself.

use super::transfer::Touch;
use super::{Particle, Reference};
use crate::material::{Corotated, Dust, Material, Model};
use crate::math::Vector;
use crate::setup::{
    Contact, Deformation, Domain, ForceForm, Kernel, ParticleBatch, Setup, Sides, Transfer,
    WallStyle,
};

/// A handful of particles that differ in everything.
fn handful<const D: usize>(shift: [f64; D]) -> ParticleBatch<D> {
    let wave = |i: usize, k: usize| ((7 * i + 3 * k) as f64 * 1.7).sin();
    let matrix = |i, scale: f64, diagonal: f64| {
        core::array::from_fn(|row| {
            core::array::from_fn(|column| {
                let one = if row == column { diagonal } else { 0.0 };
                one + scale * wave(i, D * row + column)
            })
        })
    };
    let each = 0..20_usize;
    ParticleBatch {
        position: each
            .clone()
            .map(|i| core::array::from_fn(|k| 0.5 + shift[k] + 0.15 * wave(i, k)))
            .collect(),
        velocity: each
            .clone()
            .map(|i| core::array::from_fn(|k| wave(i, k + 5)))
            .collect(),
        volume: each.clone().map(|i| 1e-3 * (2.0 + wave(i, 1))).collect(),
        affine: each.clone().map(|i| matrix(i, 2.0, 0.0)).collect(),
        deformation: Deformation::Gradient(each.map(|i| matrix(i, 0.05, 1.0)).collect()),
        ..ParticleBatch::default()
    }
}

fn jelly<const D: usize>() -> Setup<D> {
    let model = Model::Corotated(Corotated {
        lambda: 500.0,
        mu: 400.0,
    });
    Setup::new(
        0.1,
        vec![Material {
            name: "jelly".into(),
            density: 1.0,
            model,
        }],
    )
}

fn schemes<const D: usize>() -> impl Iterator<Item = Setup<D>> {
    let kernels = [Kernel::Linear, Kernel::Quadratic, Kernel::Cubic];
    let transfers = [Transfer::Pic, Transfer::Flip { blend: 0.9 }, Transfer::Apic];
    let forces = [ForceForm::Classic, ForceForm::Mls];
    kernels.into_iter().flat_map(move |kernel| {
        transfers.into_iter().flat_map(move |transfer| {
            let usable = forces
                .into_iter()
                .take(if kernel == Kernel::Linear { 1 } else { 2 });
            usable.map(move |force| Setup {
                kernel,
                transfer,
                force,
                ..jelly()
            })
        })
    })
}

/// Mass, momentum and angular momentum of particles are what P2G gives the nodes, and the
/// kinetic energies what it gives particle by particle; the impulses of stress add to nothing.
fn totals_are_the_grids<const D: usize>() {
    for setup in schemes::<D>() {
        let reference = Reference::new(&setup, &[handful([0.0; D])]).unwrap();
        let grid = reference.particles_to_grid(1e-3);
        let mass: f64 = grid.values().map(|n| n.mass).sum();
        assert!((mass - reference.mass()).abs() < 1e-15);
        let mut momentum = Vector([0.0; D]);
        let (mut angular, mut torque) = ([0.0; 3], [0.0; 3]);
        for (node, n) in &grid {
            momentum += n.momentum;
            for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                if i < D && j < D {
                    let x = node.map(|index| index as f64 * setup.dx);
                    angular[k] += x[i] * n.momentum[j] - x[j] * n.momentum[i];
                    torque[k] += x[i] * n.impulse[j] - x[j] * n.impulse[i];
                }
            }
        }
        assert!((momentum - reference.momentum()).norm() < 1e-15);
        let expected = reference.angular_momentum();
        for k in 0..3 {
            assert!((angular[k] - expected[k]).abs() < 1e-15, "{setup:?}");
            assert!(torque[k].abs() < 1e-15, "{setup:?}");
        }
        let apic = setup.transfer == Transfer::Apic;
        let mut energy = 0.0;
        for p in reference.particles() {
            for Touch { w, r, .. } in reference.touched_nodes(p) {
                let v = if apic {
                    p.velocity + p.affine * r
                } else {
                    p.velocity
                };
                energy += 0.5 * w * p.mass * v.dot(v);
            }
        }
        let expected = reference.kinetic_energy() + reference.affine_kinetic_energy();
        assert!((energy - expected).abs() < 1e-14, "{setup:?}");
    }
}

#[test]
fn totals_are_the_grids_2d() {
    totals_are_the_grids::<2>();
}

#[test]
fn totals_are_the_grids_3d() {
    totals_are_the_grids::<3>();
}

/// What happens across a periodic seam is what happens in the middle.
#[test]
fn a_periodic_seam_is_nowhere() {
    for scheme in schemes::<2>() {
        let (min, max) = ([-0.3, 0.1], [0.7, 1.1]);
        let (sides, style) = ([Sides::Periodic; 2], WallStyle::Plane);
        let setup = Setup {
            domain: Some(Domain {
                min,
                max,
                sides,
                style,
            }),
            ..scheme
        };
        let mut middle = Reference::new(&setup, &[handful([-0.3, 0.1])]).unwrap();
        let mut seam = Reference::new(&setup, &[handful([0.2, 0.6])]).unwrap();
        for _ in 0..20 {
            middle.substep(1e-4);
            seam.substep(1e-4);
        }
        for (a, b) in middle.particles().iter().zip(seam.particles()) {
            assert!((a.velocity - b.velocity).norm() < 1e-12, "{setup:?}");
            for (axis, x) in b.position.0.iter().enumerate() {
                assert!((min[axis]..max[axis]).contains(x), "{setup:?}");
                let apart = x - a.position[axis];
                assert!((apart.abs() - 0.5).abs() < 1e-14, "{setup:?}");
            }
        }
    }
}

/// Particles that pass an open side are kept count of.
#[test]
fn open_sides_let_particles_out() {
    let domain = Domain {
        min: [0.0; 2],
        max: [1.0; 2],
        sides: [Sides::Walls {
            low: Contact::Open,
            high: Contact::Sticky,
        }; 2],
        style: WallStyle::Plane,
    };
    let dust = Material {
        name: "dust".into(),
        density: 1.0,
        model: Model::Dust(Dust),
    };
    let setup = Setup {
        domain: Some(domain),
        ..Setup::new(0.1, vec![dust])
    };
    let batch = ParticleBatch {
        position: vec![[0.05, 0.5], [0.5, 0.5], [0.95, 0.5]],
        velocity: vec![[-2.0, 0.0], [0.0; 2], [2.0, 0.0]],
        volume: vec![1e-3],
        ..ParticleBatch::default()
    };
    let mut reference = Reference::new(&setup, &[batch]).unwrap();
    for _ in 0..10 {
        reference.substep(0.01);
    }
    let ids = |particles: &[Particle<2>]| particles.iter().map(|p| p.id).collect::<Vec<_>>();
    assert_eq!(ids(reference.escaped()), [0]);
    assert_eq!(ids(reference.particles()), [1, 2]);
    assert!(reference.particles()[1].position[0] <= 1.0);
}

#[test]
fn what_cannot_be_simulated_is_named() {
    let key = |setup: &Setup<2>, batch: &ParticleBatch<2>| {
        Reference::new(setup, core::slice::from_ref(batch))
            .unwrap_err()
            .key
    };
    let (setup, batch) = (jelly::<2>(), handful([0.0; 2]));
    assert_eq!(
        key(
            &Setup {
                dx: f64::NAN,
                ..setup.clone()
            },
            &batch
        ),
        "dx"
    );
    let linear = Setup {
        kernel: Kernel::Linear,
        ..setup.clone()
    };
    assert_eq!(key(&linear, &batch), "kernel");
    let other = ParticleBatch {
        material: 1,
        ..batch.clone()
    };
    assert_eq!(key(&setup, &other), "material");
    let short = ParticleBatch {
        velocity: vec![[0.0; 2]; 3],
        ..batch.clone()
    };
    assert_eq!(key(&setup, &short), "velocity");
    let empty = ParticleBatch {
        volume: vec![0.0],
        ..batch.clone()
    };
    assert_eq!(key(&setup, &empty), "volume");
    let nowhere = ParticleBatch {
        position: vec![[f64::NAN; 2]; 20],
        ..batch
    };
    assert_eq!(key(&setup, &nowhere), "position");
}
