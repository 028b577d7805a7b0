//! The volume rules of fluids, node by node: (7g)–(7i).

use super::law::law;
use super::transfer::Touch;
use super::{Grid, Particle, Reference};
use crate::material::rheology::shear_rate;
use crate::material::{VolumeCorrection, VolumeRule};
use crate::setup::CORRECTION_INTERVAL;
use crate::volume::filling::OUTSIDE;

impl<const D: usize> Reference<D> {
    /// Sets J of the fluids that gather it from the grid: (7g).
    pub(super) fn gather_volumes(&mut self) {
        let gathers = |p: &Particle<D>| self.law(p).volume_rule() == VolumeRule::Gathered;
        if !self.particles.iter().any(gathers) {
            return;
        }
        let gathered = self.gathered_jacobians();
        let mut particles = core::mem::take(&mut self.particles);
        for (particle, j) in particles.iter_mut().zip(gathered) {
            if self.law(particle).volume_rule() == VolumeRule::Gathered {
                particle.strain = vec![j - 1.0];
            }
        }
        self.particles = particles;
    }

    /// Corrects J of the fluids that ask for it, every [`CORRECTION_INTERVAL`].
    pub(super) fn correct_volumes(&mut self, dt: f64) {
        self.uncorrected += dt;
        let time = self.uncorrected;
        let rates: Vec<_> = self
            .setup
            .materials
            .iter()
            .map(|material| match law::<D>(&material.model).volume_rule() {
                VolumeRule::Corrected(rates) => Some(rates),
                VolumeRule::Jacobian | VolumeRule::Gathered => None,
            })
            .collect();
        let cells = self
            .particles
            .iter()
            .filter(|p| rates[p.material].is_some());
        let cells = cells.map(|p| {
            let sound =
                (self.law(p).rest_modulus() / self.setup.materials[p.material].density).sqrt();
            time * sound / self.setup.dx
        });
        if cells.fold(0.0, f64::max) < CORRECTION_INTERVAL {
            return;
        }
        self.uncorrected = 0.0;
        for (material, rates) in rates.into_iter().enumerate() {
            if let Some(rates) = rates {
                self.correct_volume_of(material, rates, time);
            }
        }
    }

    /// Corrects one fluid, `time` \[s\] after the last correction: (7h) and (7i).
    fn correct_volume_of(&mut self, material: usize, rates: VolumeCorrection, time: f64) {
        // V⁰ and V⁰(J − 1) of all particles, then of this fluid.
        let mut nodes = Grid::<[f64; 4], D>::new();
        for p in &self.particles {
            let e = (1.0 + self.jacobian_minus_one(p)) * self.plastic_jacobian(p) - 1.0;
            let own = if p.material == material { 1.0 } else { 0.0 };
            for Touch { node, w, .. } in self.touched_nodes(p) {
                let sums = nodes.entry(node).or_default();
                for (sum, factor) in sums.iter_mut().zip([1.0, e, own, own * e]) {
                    *sum += w * p.volume0 * factor;
                }
            }
        }
        self.mirror_volumes(&mut nodes);
        let cell = self.setup.dx.powi(D as i32);
        let full = |node: &[i64; D]| {
            nodes
                .get(node)
                .is_some_and(|sums| sums[0] >= OUTSIDE * cell)
        };
        let excess = |node: &[i64; D], sums: &[f64; 4]| {
            let mut around = (0..3_i64.pow(D as u32)).map(|number| {
                core::array::from_fn(|axis| node[axis] + number / 3_i64.pow(axis as u32) % 3 - 1)
            });
            let inside = around.all(|beside| {
                self.walls.is_beyond_plane(beside) || full(&self.walls.canonical(beside))
            });
            if inside && full(node) {
                (sums[0] + sums[1]) / cell - 1.0
            } else {
                0.0
            }
        };
        let mut filling: Grid<_, D> = nodes
            .iter()
            .map(|(node, sums)| {
                let mean = if sums[2] > 0.0 {
                    sums[3] / sums[2]
                } else {
                    0.0
                };
                (*node, (mean, excess(node, sums)))
            })
            .collect();
        for wall in &self.walls.planes {
            let nodes = nodes.keys().copied();
            for node in nodes.filter(|node| node[wall.axis] + i64::from(wall.inward) == wall.node) {
                let mut image = node;
                image[wall.axis] += 2 * i64::from(wall.inward);
                let excess = filling.get(&image).map_or(0.0, |found| found.1);
                filling.entry(node).and_modify(|found| found.1 = excess);
            }
        }
        let mut particles = core::mem::take(&mut self.particles);
        for p in particles.iter_mut().filter(|p| p.material == material) {
            let (mut mean, mut excess) = (0.0, 0.0);
            for Touch { node, w, .. } in self.touched_nodes(p) {
                let found = filling[&node];
                mean += w * found.0;
                excess += w * found.1;
            }
            let strained = time * shear_rate(p.affine);
            let share = |rate: f64| rate * strained / (1.0 + rate * strained);
            let e = self.jacobian_minus_one(p);
            let smoothed = e + share(rates.smoothing) * (mean - e); // (7h)
            p.strain = vec![smoothed - share(rates.correction) * excess]; // (7i)
        }
        self.particles = particles;
    }

    /// Adds the volumes of the mirror images behind walls to those of the nodes near them.
    fn mirror_volumes(&self, nodes: &mut Grid<[f64; 4], D>) {
        for wall in &self.walls.planes {
            let on_plane = nodes.keys().filter(|node| node[wall.axis] == wall.node);
            for node in on_plane.copied().collect::<Vec<_>>() {
                let beside = [-1, 1].map(|step| {
                    let mut place = node;
                    place[wall.axis] += step;
                    place
                });
                let of = |place| nodes.get(place).copied().unwrap_or_default();
                let [one, other] = [of(&beside[0]), of(&beside[1])];
                let both: [f64; 4] = core::array::from_fn(|lane| one[lane] + other[lane]);
                let twice = of(&node).map(|sum| sum + sum);
                nodes.insert(node, twice);
                for place in beside {
                    nodes.insert(place, both);
                }
            }
        }
    }

    /// Returns J of each particle as the grid tells it: dxᴰ over the rest volume around the particle.
    pub(super) fn gathered_jacobians(&self) -> Vec<f64> {
        let mut volume = Grid::<f64, D>::new();
        for particle in &self.particles {
            for Touch { node, w, .. } in self.touched_nodes(particle) {
                *volume.entry(node).or_default() += w * particle.volume0;
            }
        }
        let cell = self.setup.dx.powi(D as i32);
        let of = |particle: &Particle<D>| {
            let touched = self.touched_nodes(particle).into_iter();
            let around: f64 = touched.map(|touch| touch.w * volume[&touch.node]).sum();
            cell / around // (7g)
        };
        self.particles.iter().map(of).collect()
    }
}
