//! The motion of bodies at the start, given to their particles in parts: velocities and their gradients take most
//! of the memory of a particle at the start.

use super::plan::{Body, Plan};
use crate::parallel::*;
use core::ops::Range;
use lahar::geometry::Bounds;
use lahar::geometry::sampling::Random;
use lahar::{Deformation, ParticleBatch};

/// Particles per part.
const A_PART: usize = 1 << 18;

/// Particles whose formulas are evaluated together.
const AT_A_TIME: usize = 1 << 14;

/// Iterates over the particles of bodies with their motion: body after body, in parts.
pub(crate) struct InMotion<'a, const D: usize> {
    plan: &'a Plan<D>,
    seed: u64,
    batches: std::iter::Enumerate<std::vec::IntoIter<ParticleBatch<D>>>,
    current: Option<Moving<'a, D>>,
}

/// The rest of a body of which parts have been returned.
struct Moving<'a, const D: usize> {
    body: &'a Body<D>,
    batch: ParticleBatch<D>,
    center: [f64; D],
    /// A stream of its own, so that positions do not depend on the velocity spread.
    random: Random,
    next: usize,
}

impl<'a, const D: usize> InMotion<'a, D> {
    /// Starts with `batches`, the particles of the plan's bodies at rest.
    pub(crate) fn new(plan: &'a Plan<D>, batches: Vec<ParticleBatch<D>>, seed: u64) -> Self {
        Self {
            plan,
            seed,
            batches: batches.into_iter().enumerate(),
            current: None,
        }
    }
}

impl<const D: usize> Iterator for InMotion<'_, D> {
    type Item = ParticleBatch<D>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(moving) = &mut self.current {
                if let Some(part) = moving.next_part(self.plan.dx) {
                    return Some(part);
                }
                self.current = None;
            }
            let (index, mut batch) = self.batches.next()?;
            let body = &self.plan.bodies[index];
            if is_uniform(body) {
                add_velocity(&mut batch, body.velocity.constants());
                return Some(batch);
            }
            self.current = Some(Moving {
                body,
                center: center_of_mass(&batch),
                random: Random::new(!self.seed, index as u64),
                batch,
                next: 0,
            });
        }
    }
}

/// Returns true if all particles of a body have the same velocity.
fn is_uniform<const D: usize>(body: &Body<D>) -> bool {
    let turns = body.gradient.iter().flatten().any(|g| *g != 0.0);
    !turns && body.velocity.is_constant() && body.velocity_spread == [0.0; D]
}

fn add_velocity<const D: usize>(batch: &mut ParticleBatch<D>, velocity: [f64; D]) {
    if batch.velocity.is_empty() {
        batch.velocity = vec![velocity];
        return;
    }
    for v in &mut batch.velocity {
        *v = core::array::from_fn(|i| v[i] + velocity[i]);
    }
}

impl<const D: usize> Moving<'_, D> {
    /// Returns the next particles, if there are more. Their velocities have v(x) + G (x − center of mass) added, and
    /// their affine matrices ∂v/∂x + G.
    fn next_part(&mut self, dx: f64) -> Option<ParticleBatch<D>> {
        let end = self.batch.position.len().min(self.next + A_PART);
        if self.next == end {
            return None;
        }
        let mut part = part_of(&self.batch, self.next..end);
        let count = end - self.next;
        self.next = end;
        let one = match part.velocity[..] {
            [one] => one,
            _ => [0.0; D],
        };
        part.velocity.resize(count, one);
        part.affine.resize(count, [[0.0; D]; D]);
        let positions = part.position.par_chunks(AT_A_TIME);
        let velocities = part.velocity.par_chunks_mut(AT_A_TIME);
        let affine = part.affine.par_chunks_mut(AT_A_TIME);
        positions
            .zip(velocities)
            .zip(affine)
            .for_each(|((position, velocity), affine)| {
                move_by(self.body, self.center, dx, position, velocity, affine);
            });
        self.add_spread(&mut part.velocity);
        Some(part)
    }

    /// Adds a random number up to the body's spread to each velocity.
    fn add_spread(&mut self, velocities: &mut [[f64; D]]) {
        if self.body.velocity_spread == [0.0; D] {
            return;
        }
        for v in velocities {
            for (v, spread) in v.iter_mut().zip(self.body.velocity_spread) {
                *v += spread * (2.0 * self.random.unit() - 1.0);
            }
        }
    }
}

/// Returns a part of the particles of `batch`.
fn part_of<const D: usize>(batch: &ParticleBatch<D>, range: Range<usize>) -> ParticleBatch<D> {
    fn some<T: Clone>(values: &[T], range: Range<usize>, count: usize) -> Vec<T> {
        if values.len() == count {
            values[range].to_vec()
        } else {
            values.to_vec() // One value for all particles, or none.
        }
    }
    let count = batch.position.len();
    ParticleBatch {
        material: batch.material,
        body: batch.body,
        position: batch.position[range.clone()].to_vec(),
        velocity: some(&batch.velocity, range.clone(), count),
        volume: some(&batch.volume, range.clone(), count),
        measure_volume: batch.measure_volume,
        mass: some(&batch.mass, range.clone(), count),
        affine: some(&batch.affine, range.clone(), count),
        deformation: match &batch.deformation {
            Deformation::Rest => Deformation::Rest,
            Deformation::Jacobian(j) => Deformation::Jacobian(j[range.clone()].to_vec()),
            Deformation::Gradient(f) => Deformation::Gradient(f[range.clone()].to_vec()),
        },
        variables: (batch.variables.iter())
            .map(|given| given.part(range.clone(), count))
            .collect(),
    }
}

/// Adds the motion of a body to a part of its particles.
fn move_by<const D: usize>(
    body: &Body<D>,
    center: [f64; D],
    dx: f64,
    position: &[[f64; D]],
    velocity: &mut [[f64; D]],
    affine: &mut [[[f64; D]; D]],
) {
    let given = body.velocity.at(position);
    for (((x, v), c), given) in position.iter().zip(velocity).zip(&mut *affine).zip(given) {
        for i in 0..D {
            v[i] += given[i]
                + (0..D)
                    .map(|j| body.gradient[i][j] * (x[j] - center[j]))
                    .sum::<f64>();
            for j in 0..D {
                c[i][j] += body.gradient[i][j];
            }
        }
    }
    if body.velocity.is_constant() {
        return;
    }
    // The gradient over a cell: the grid resolves no finer one.
    for j in 0..D {
        let beside = |step: f64| -> Vec<[f64; D]> {
            let mut places = position.to_vec();
            places.iter_mut().for_each(|x| x[j] += step);
            body.velocity.at(&places)
        };
        let (low, high) = (beside(-0.5 * dx), beside(0.5 * dx));
        for ((c, low), high) in affine.iter_mut().zip(low).zip(high) {
            for i in 0..D {
                c[i][j] += (high[i] - low[i]) / dx;
            }
        }
    }
}

fn center_of_mass<const D: usize>(batch: &ParticleBatch<D>) -> [f64; D] {
    // Volumes serve as weights: all particles of a body have the same density.
    let weights = if batch.mass.is_empty() {
        &batch.volume
    } else {
        &batch.mass
    };
    let weight = |i: usize| {
        if weights.len() == batch.position.len() {
            weights[i]
        } else {
            1.0
        }
    };
    // The sum is relative to the middle of the bounds, so that no digits are lost far from the origin.
    let bounds = Bounds::around_points(&batch.position);
    let middle: [f64; D] = core::array::from_fn(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
    let mut total = 0.0;
    let mut sum = [0.0; D];
    for (i, x) in batch.position.iter().enumerate() {
        total += weight(i);
        for k in 0..D {
            sum[k] += weight(i) * (x[k] - middle[k]);
        }
    }
    core::array::from_fn(|k| middle[k] + sum[k] / total)
}
