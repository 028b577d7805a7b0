//! Totals of the oracle: mass, momentum and energy.

use super::transfer::{Touch, outer};
use super::{Particle, Reference, Velocity};
use crate::math::{Matrix, Vector};
use crate::setup::Transfer;

impl<const D: usize> Reference<D> {
    /// Returns the mass Σ m \[kg\].
    pub fn mass(&self) -> f64 {
        self.particles.iter().map(|p| p.mass).sum()
    }

    /// Returns the momentum Σ m v \[kg m/s\].
    pub fn momentum(&self) -> Vector<f64, D> {
        let mut sum = Vector([0.0; D]);
        for p in &self.particles {
            sum += p.velocity * p.mass;
        }
        sum
    }

    /// Returns the angular momentum about the origin of coordinates that the grid will have after P2G \[kg m²/s\]; in 2D
    /// only its third component is not zero.
    ///
    /// A particle brings node i the momentum w m (v + C r). With Σ w = 1, Σ w r = 0 and
    /// Σ w r rᵀ = D I, Σ_i x_i × w m (v + C r) = m x × v + m D (C_yx − C_xy) about z, and so on in
    /// turn. Only APIC has the second part.
    pub fn angular_momentum(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for p in &self.particles {
            let spin = match self.setup.transfer {
                Transfer::Pic | Transfer::Flip { .. } => Matrix([Vector([0.0; D]); D]),
                Transfer::Apic => p.affine * self.inertia(p),
            };
            // (x × v)_k = x_i v_j − x_j v_i, with (i, j, k) a turn of (x, y, z).
            for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                if i < D && j < D {
                    let (x, v) = (p.position, p.velocity);
                    let orbital = x[i] * v[j] - x[j] * v[i];
                    sum[k] += p.mass * (orbital + (spin[(j, i)] - spin[(i, j)]));
                }
            }
        }
        sum
    }

    /// Returns the kinetic energy Σ ½ m v² \[J\].
    pub fn kinetic_energy(&self) -> f64 {
        let of = |p: &Particle<D>| 0.5 * p.mass * p.velocity.dot(p.velocity);
        self.particles.iter().map(of).sum()
    }

    /// Returns the energy of APIC's matrices, Σ ½ m C D : C \[J\], which is not in [`Self::kinetic_energy`]; 0 in other
    /// schemes.
    pub fn affine_kinetic_energy(&self) -> f64 {
        let of = |p: &Particle<D>| {
            let spin = p.affine * self.inertia(p);
            let dots = (0..D).map(|j| spin.0[j].dot(p.affine.0[j]));
            0.5 * p.mass * dots.sum::<f64>()
        };
        match self.setup.transfer {
            Transfer::Pic | Transfer::Flip { .. } => 0.0,
            Transfer::Apic => self.particles.iter().map(of).sum(),
        }
    }

    /// Returns the elastic energy Σ V⁰ Φ \[J\].
    pub fn elastic_energy(&self) -> f64 {
        let of = |p: &Particle<D>| p.volume0 * self.law(p).energy_density(&p.strain);
        self.particles.iter().map(of).sum()
    }

    /// Returns the energy of the leapfrog of positions and velocities \[J\], for a substep of `dt` \[s\] that is not taken:
    /// the present elastic energy + ½ Σ m_i v_i·v_i⁺, with node velocities before and after forces. With APIC and without
    /// gravity and walls, it never grows on an elastic body.
    pub fn staggered_energy(&self, dt: f64) -> f64 {
        let of = |n: &Velocity<D>| 0.5 * n.mass * n.before.dot(n.after);
        self.elastic_energy() + self.over_nodes(dt, of)
    }

    /// Returns ½ Σ m_i v_i·(v_i⁺ − v_i) \[J\]: the difference of [`Self::staggered_energy`] and the energy of the nodes
    /// before forces. FLIP particles have motion that the grid does not see. With FLIP it is the sum of this and of the
    /// *particles'* energies that does not grow.
    pub fn staggered_work(&self, dt: f64) -> f64 {
        self.over_nodes(dt, |n| 0.5 * n.mass * n.before.dot(n.after - n.before))
    }

    /// Sums `term` over the nodes of a substep that is not taken.
    fn over_nodes(&self, dt: f64, term: impl Fn(&Velocity<D>) -> f64) -> f64 {
        let velocity = self.update_grid(&self.particles_to_grid(dt), dt);
        velocity.values().map(term).sum()
    }

    /// Returns D_p = Σ_i w r rᵀ \[m²\] of (3), which is diagonal.
    fn inertia(&self, particle: &Particle<D>) -> Matrix<f64, D> {
        let mut d = Matrix([Vector([0.0; D]); D]);
        for Touch { w, r, .. } in self.touched_nodes(particle) {
            d += outer(r, r) * w;
        }
        d
    }
}
