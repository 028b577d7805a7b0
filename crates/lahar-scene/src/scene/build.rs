//! From a plan to the setup of a simulation, and the particles of bodies at rest.

use super::forces::lattice;
use super::plan::{Body, Plan, Source, Volume};
use crate::even::even_volumes;
use crate::parallel::*;
use lahar::boundary::Placed;
use lahar::geometry::sampling::{Random, Sampling, sample};
use lahar::material::Fluid;
use lahar::{Collider, Deformation, Model, ParticleBatch, Setup};

impl<const D: usize> Plan<D> {
    /// Returns the setup of the simulation.
    pub(crate) fn setup(&self, isa: lahar::Isa) -> Setup<D> {
        Setup {
            dx: self.dx,
            domain: self.domain.clone(),
            clamp: self.clamp,
            cushion: self.cushion,
            colliders: self.colliders.clone(),
            gravity: self.gravity,
            forces: self.forces.clone(),
            kernel: self.kernel,
            transfer: self.transfer,
            force: self.force,
            time_step: self.time_step,
            materials: self.materials.clone(),
            probes: self.probes.clone(),
            isa,
        }
    }

    /// Returns the particles of every body in the order of the scene, without their motion, which
    /// [`InMotion`](super::motion::InMotion) adds; and how many particles of each body were left out because
    /// they would be inside colliders. Particles of lists inside colliders are kept, with a warning.
    pub(crate) fn batches(
        &self,
        seed: u64,
        warnings: &mut Vec<String>,
    ) -> (Vec<ParticleBatch<D>>, Vec<usize>) {
        let inside = Inside(self.colliders.iter().map(|c| (c, c.at(0.0))).collect());
        self.bodies
            .iter()
            .enumerate()
            .map(|(index, body)| {
                if let Source::List(list) = &body.source
                    && let Some((count, names)) = inside.count(&list.position)
                {
                    warnings.push(format!("{count} particles of body \"{}\" are inside {names}: they start on the surface", body.name));
                }
                let material = &self.materials[body.material];
                let (mut batch, left_out) =
                    self.batch(body, index, seed, material.density, &inside);
                if let Model::Fluid(fluid) = &material.model
                    && self.starts_hydrostatic(body, fluid)
                {
                    put_under_pressure(&mut batch, body, fluid, material.density, self.gravity);
                }
                (batch, left_out)
            })
            .unzip()
    }

    /// Returns the expected number of particles of each body: an estimate where colliders take some of its space.
    pub(crate) fn expected_particles(&self) -> Vec<f64> {
        let inside = Inside(self.colliders.iter().map(|c| (c, c.at(0.0))).collect());
        // Points along an axis of a body that are tested.
        let places = if D == 2 { 200 } else { 40 };
        let free = |body: &Body<D>| match &body.source {
            Source::Shape { region, .. } if !self.colliders.is_empty() => {
                let all = lattice(region.bounds(), places);
                let filled = all.iter().filter(|x| region.contains(x));
                let (count, free) = filled.fold((0.0_f64, 0.0), |(count, free), x| {
                    let is_free = inside.of(x).is_none();
                    (count + 1.0, free + f64::from(u8::from(is_free)))
                });
                free / count.max(1.0)
            }
            _ => 1.0,
        };
        self.bodies
            .iter()
            .map(|body| body.expected_particles() * free(body))
            .collect()
    }

    /// Returns the pairs of bodies that share space: (first, second, particles of the second inside the first).
    pub(crate) fn overlaps(&self, batches: &[ParticleBatch<D>]) -> Vec<(usize, usize, usize)> {
        let mut found = Vec::new();
        for (i, body) in self.bodies.iter().enumerate() {
            let Source::Shape { region, .. } = &body.source else {
                continue;
            };
            for (j, batch) in batches.iter().enumerate() {
                let is_later = j > i || matches!(self.bodies[j].source, Source::List(_));
                let common = region.bounds().intersection(&self.bodies[j].bounds());
                if !is_later || (0..D).any(|axis| common.side(axis) <= 0.0) {
                    continue;
                }
                let inside = batch.position.iter().filter(|p| region.contains(p)).count();
                if inside > 0 {
                    found.push((i, j, inside));
                }
            }
        }
        found
    }

    /// Returns the particles of a body, and how many were left out because they would be inside colliders.
    fn batch(
        &self,
        body: &Body<D>,
        index: usize,
        seed: u64,
        density: f64,
        inside: &Inside<'_, D>,
    ) -> (ParticleBatch<D>, usize) {
        let mut left_out = 0;
        let mut batch = ParticleBatch {
            material: body.material,
            body: index as u32,
            ..ParticleBatch::default()
        };
        match &body.source {
            Source::Shape {
                region,
                spacing,
                count,
                sampling,
            } => {
                batch.position = sample(
                    region,
                    *spacing,
                    *count,
                    *sampling,
                    &mut Random::new(seed, index as u64),
                );
                batch.volume = if body.volume == Volume::Even && *sampling != Sampling::Lattice {
                    let origin = self.domain.as_ref().map_or([0.0; D], |domain| domain.min);
                    even_volumes(region, &batch.position, (origin, self.dx), self.kernel)
                } else {
                    vec![region.volume() / batch.position.len().max(1) as f64]
                };
                left_out = batch.position.len();
                let mut free = batch.position.iter().map(|x| inside.of(x).is_none());
                if batch.volume.len() > 1 {
                    batch.volume.retain(|_| free.next() == Some(true));
                }
                batch.position.retain(|x| inside.of(x).is_none());
                left_out -= batch.position.len();
            }
            Source::List(list) => {
                batch.position = list.position.clone();
                batch.velocity = list.velocity.clone();
                batch.mass = list.mass.clone();
                batch.volume = if list.volume.is_empty() {
                    list.mass.iter().map(|mass| mass / density).collect()
                } else {
                    list.volume.clone()
                };
                batch.affine = list.affine.clone();
                batch.variables = list.variables.clone();
                batch.deformation = if !list.deformation_gradient.is_empty() {
                    Deformation::Gradient(list.deformation_gradient.clone())
                } else if !list.jacobian.is_empty() {
                    Deformation::Jacobian(list.jacobian.clone())
                } else {
                    Deformation::Rest
                };
            }
        }
        match body.volume {
            Volume::Source | Volume::Even => {}
            Volume::Measured => batch.measure_volume = true,
            Volume::Body(volume) => {
                batch.volume = vec![volume / batch.position.len().max(1) as f64]
            }
            Volume::Particle(volume) => batch.volume = vec![volume],
        }
        (batch, left_out)
    }
}

/// Compresses the particles as the weight of a body at rest does, with a free surface at its highest point:
/// J follows from the depth, and rest volumes grow by 1/J, so that the particles still fill the body.
fn put_under_pressure<const D: usize>(
    batch: &mut ParticleBatch<D>,
    body: &Body<D>,
    fluid: &Fluid,
    density: f64,
    gravity: [f64; D],
) {
    let bounds = body.bounds();
    // −g·x of the highest corner: the potential of the surface [m²/s²].
    let surface: f64 = (0..D)
        .map(|i| (-gravity[i] * bounds.min[i]).max(-gravity[i] * bounds.max[i]))
        .sum();
    let jacobian: Vec<f64> = batch
        .position
        .par_iter()
        .with_min_len(1 << 12)
        .map(|x| {
            let potential: f64 = (0..D).map(|i| -gravity[i] * x[i]).sum();
            1.0 + fluid.jacobian_minus_one_below(surface - potential, density)
        })
        .collect();
    let of = |values: &[f64], i: usize| {
        if values.len() == 1 {
            values[0]
        } else {
            values[i]
        }
    };
    batch.volume = (0..jacobian.len())
        .map(|i| of(&batch.volume, i) / jacobian[i])
        .collect();
    batch.deformation = Deformation::Jacobian(jacobian);
}

/// The colliders at time 0.
struct Inside<'a, const D: usize>(Vec<(&'a Collider<D>, Placed<D>)>);

impl<const D: usize> Inside<'_, D> {
    /// Returns the name of the first collider that `x` is inside of.
    fn of(&self, x: &[f64; D]) -> Option<&str> {
        let all = self.0.iter();
        let found = all.filter(|(_, placed)| placed.distance(*x).0 < 0.0);
        found.map(|(collider, _)| collider.name.as_str()).next()
    }

    /// Returns how many of `positions` are inside colliders, and the names of these colliders; `None` if none are.
    fn count(&self, positions: &[[f64; D]]) -> Option<(usize, String)> {
        let found: Vec<&str> = positions.iter().filter_map(|x| self.of(x)).collect();
        let names = self.0.iter().map(|(collider, _)| &collider.name);
        let names: Vec<String> = names
            .filter(|name| found.contains(&name.as_str()))
            .map(|name| format!("\"{name}\""))
            .collect();
        (!found.is_empty()).then(|| (found.len(), names.join(", ")))
    }
}
