//! Particles of the oracle from batches.

use super::law::law;
use super::{Particle, Reference};
use crate::error::SetupError;
use crate::math::{Matrix, Vector};
use crate::setup::check::CheckedSetup;
use crate::setup::{Deformation, ParticleBatch, Setup};

impl<const D: usize> Reference<D> {
    /// Makes the oracle of a setup, with the particles of `batches`. It ignores [`Setup::time_step`] and [`Setup::isa`].
    ///
    /// # Errors
    /// Names the key that cannot be simulated.
    pub fn new(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Result<Self, SetupError> {
        let scene = CheckedSetup::new(setup.clone())?;
        let mut particles = Vec::new();
        let mut measured = Vec::new();
        for batch in batches {
            add(setup, batch, &mut particles)?;
            measured.resize(particles.len(), batch.measure_volume);
        }
        let mut reference = Self {
            starts: particles
                .iter()
                .map(|p: &Particle<D>| p.position.0)
                .collect(),
            time: 0.0,
            pointer: None,
            uncorrected: 0.0,
            origin: Vector(scene.lattice.origin),
            setup: scene.setup,
            colliders: scene.colliders,
            walls: scene.walls,
            particles,
            escaped: Vec::new(),
        };
        let mut particles = core::mem::take(&mut reference.particles);
        let colliders = reference.moving(0.0);
        for particle in &mut particles {
            reference.clamp(particle);
            // The velocity of a new particle is the one that its batch gives.
            let given = particle.velocity;
            reference.project_out(particle, &colliders);
            particle.velocity = given;
        }
        reference.particles = particles;
        if measured.contains(&true) {
            let gathered = reference.gathered_jacobians();
            let each = reference.particles.iter_mut().zip(gathered).zip(measured);
            for ((particle, j), measured) in each {
                particle.volume0 *= if measured { j } else { 1.0 };
            }
        }
        Ok(reference)
    }
}

/// Adds the particles of `batch`, with ids that go on from the last.
fn add<const D: usize>(
    setup: &Setup<D>,
    batch: &ParticleBatch<D>,
    particles: &mut Vec<Particle<D>>,
) -> Result<(), SetupError> {
    let variables = |material: usize| setup.materials[material].model.variables();
    batch.check(setup, particles.len() as u32, variables)?;
    let material = &setup.materials[batch.material];
    let law = law::<D>(&material.model);
    for (i, &position) in batch.position.iter().enumerate() {
        // One for all, or one per particle.
        let pick = |all: &[f64]| all.get(i).or(all.first()).copied();
        let volume0 = pick(&batch.volume).unwrap_or_default();
        let mass = pick(&batch.mass).unwrap_or(material.density * volume0);
        let velocity = batch.velocity.get(i).or(batch.velocity.first());
        let affine = batch.affine.get(i);
        let h = match &batch.deformation {
            Deformation::Rest => Matrix::scaled_identity(0.0),
            Deformation::Jacobian(j) => {
                Matrix::scaled_identity(libm::expm1(j[i].ln() / D as f64)) // J^(1/D) − 1
            }
            Deformation::Gradient(f) => {
                Matrix::from_fn(|row, column| f[i][row][column]) - Matrix::identity(1.0)
            }
        };
        particles.push(Particle {
            id: particles.len() as u32,
            material: batch.material,
            body: batch.body,
            mass,
            volume0,
            position: Vector(position),
            velocity: Vector(velocity.copied().unwrap_or([0.0; D])),
            affine: Matrix::from_fn(|row, column| affine.map_or(0.0, |c| c[row][column])),
            strain: law.start(h, &batch.variables_of(i)),
        });
    }
    Ok(())
}
