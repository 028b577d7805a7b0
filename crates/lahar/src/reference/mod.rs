//! The oracle: the method by its plain equations, to check the fast engine against.
//!
//! `f64`, one particle after the other, nodes in an ordered map, no blocks, tiles, lanes or threads.
//! Nothing here is fast; each line that *is* an equation carries its number. Kernels, laws and
//! walls are the ones the engine runs, since a formula has one copy; the node loops are not.
//!
//! ```text
//! particles ──P2G, (1) (2) (4)──▶ Grid<Momentum> ──+ gravity, walls──▶ Grid<Velocity>
//!     ▲                                                                    │
//!     └──────────────────────── G2P, (3) (5)–(8) ──────────────────────────┘
//! ```
//!
//! What stress does to a node, −Δt V⁰ D⁻¹ τ of (4), is kept apart from the momentum that particles
//! bring, because FLIP and the staggered energy ask for a node's velocity before forces.
//! Lever arms are r = x_i − x_p.

use crate::boundary::colliders::contact::{self, NearNode, Scratch, near};
use crate::boundary::colliders::placed::Moving;
use crate::boundary::colliders::projection::project_out;
use crate::boundary::impulse::Impulse;
use crate::boundary::pointer::{NodePointer, ParticlePointer};
use crate::boundary::walls::Walls;
use crate::boundary::walls::fold::{Triple, TripleNode};
use crate::error::SetupError;
use crate::force;
use crate::kernel::{BSpline, Cubic, Linear, Quadratic};
use crate::material::rheology::shear_rate;
use crate::material::{
    ConstitutiveModel, FluidModel, Model, Strain, Variables, VolumeCorrection, VolumeRule,
    for_model, start,
};
use crate::math::{Matrix, Vector};
use crate::setup::Collider;
use crate::setup::Pointer;
use crate::setup::check::CheckedSetup;
use crate::setup::{
    CORRECTION_INTERVAL, Deformation, ForceForm, Kernel, ParticleBatch, Setup, Transfer,
};
use crate::volume::filling::OUTSIDE;
use std::collections::BTreeMap;

/// A particle of the oracle.
#[derive(Clone, Debug)]
pub struct Particle<const D: usize> {
    /// Its place in the batches, counted through all of them from 0.
    pub id: u32,
    /// Index into [`Setup::materials`].
    pub material: usize,
    /// Body it belongs to.
    pub body: u32,
    /// Mass m \[kg\].
    pub mass: f64,
    /// Rest volume V⁰ \[m³; m² in 2D\].
    pub volume0: f64,
    /// Position x \[m\], in the scene's coordinates.
    pub position: Vector<f64, D>,
    /// Velocity v \[m/s\].
    pub velocity: Vector<f64, D>,
    /// Affine matrix C \[1/s\], `affine[(i, j)]` = ∂v_i/∂x_j. Gathered in every transfer scheme;
    /// only APIC tells it to the grid again.
    pub affine: Matrix<f64, D>,
    /// The columns of its model's [`Strain`].
    pub strain: Vec<f64>,
}

/// What particles bring to a node.
#[derive(Clone, Copy, Debug)]
pub struct Momentum<const D: usize> {
    /// Mass m_i \[kg\].
    pub mass: f64,
    /// Momentum m_i v_i that particles bring \[kg m/s\], without the impulse.
    pub momentum: Vector<f64, D>,
    /// Δt × the force of stress \[kg m/s\].
    pub impulse: Vector<f64, D>,
}

/// What particles read from a node.
#[derive(Clone, Copy, Debug)]
pub struct Velocity<const D: usize> {
    /// Mass m_i \[kg\].
    pub mass: f64,
    /// Velocity before forces and walls \[m/s\].
    pub before: Vector<f64, D>,
    /// Velocity after them \[m/s\].
    pub after: Vector<f64, D>,
}

/// Nodes by their index on each axis: node n sits at `origin` + n dx. Those on periodic axes are
/// indexed within one period.
pub type Grid<N, const D: usize> = BTreeMap<[i64; D], N>;

/// The particles of a scene and the plainest way to step them.
#[derive(Clone, Debug)]
pub struct Reference<const D: usize> {
    setup: Setup<D>,
    /// Where node 0 is \[m\].
    origin: Vector<f64, D>,
    walls: Walls<D>,
    /// Lengths in cells from node 0.
    colliders: Vec<Collider<D>>,
    particles: Vec<Particle<D>>,
    escaped: Vec<Particle<D>>,
    /// Where each particle started \[m\], by id.
    starts: Vec<[f64; D]>,
    /// Simulated time \[s\].
    time: f64,
    pointer: Option<Pointer>,
    /// Time since the fluids' volumes were last set right \[s\].
    uncorrected: f64,
}

impl<const D: usize> Reference<D> {
    /// Takes in the particles. [`Setup::time_step`] and [`Setup::isa`] mean nothing here.
    ///
    /// # Errors
    /// Names the key that cannot be simulated.
    pub fn new(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Result<Self, SetupError> {
        let scene = CheckedSetup::new(setup.clone())?;
        let mut particles = Vec::new();
        let mut measured = Vec::new();
        for batch in batches {
            take_in(setup, batch, &mut particles)?;
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
            reference.hold(particle);
            // Its velocity is what it was given.
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

    /// The particles that are in the scene, by ascending id.
    pub fn particles(&self) -> &[Particle<D>] {
        &self.particles
    }

    /// The particles that left through open sides, in the order they left.
    pub fn escaped(&self) -> &[Particle<D>] {
        &self.escaped
    }

    /// H = F − I of a particle; for models that keep J only, (J^(1/D) − 1) I.
    pub fn displacement_gradient(&self, particle: &Particle<D>) -> Matrix<f64, D> {
        self.law(particle).displacement_gradient(&particle.strain)
    }

    /// J_P of a particle, 1 for models without plastic flow.
    pub fn plastic_jacobian(&self, particle: &Particle<D>) -> f64 {
        self.law(particle).plastic_jacobian(&particle.strain)
    }

    /// J − 1 of a particle.
    pub fn jacobian_minus_one(&self, particle: &Particle<D>) -> f64 {
        self.law(particle).jacobian_minus_one(&particle.strain)
    }

    /// Sets or lifts the hand that stirs.
    pub fn set_pointer(&mut self, pointer: Option<Pointer>) {
        self.pointer = pointer;
    }

    /// One substep of `dt` \[s\]. There is no check on its length.
    ///
    /// # Panics
    /// If a particle is nowhere, or so far away that its nodes cannot be counted.
    pub fn substep(&mut self, dt: f64) {
        self.correct_volumes(dt);
        self.push_particles(dt);
        self.gather_volumes();
        let momentum = self.particles_to_grid(dt);
        let velocity = self.update_grid(&momentum, dt);
        self.grid_to_particles(&velocity, dt);
        self.time += dt;
    }

    /// Forces that depend on where particles started: v_p += Δt a, before P2G.
    fn push_particles(&mut self, dt: f64) {
        for p in &mut self.particles {
            let start = self.starts[p.id as usize];
            let mut a = [[0.0; D]];
            force::accelerations(
                &self.setup.forces,
                true,
                self.time,
                &[p.position.0],
                &[start],
                &mut [[0.0; D]],
                &mut a,
            );
            p.velocity += Vector(a[0]) * dt; // (11)
        }
    }

    /// J of the materials that take it from the grid.
    fn gather_volumes(&mut self) {
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

    /// J of the fluids that want it set right, every [`CORRECTION_INTERVAL`].
    fn correct_volumes(&mut self, dt: f64) {
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

    /// (7h) and (7i) for one fluid, after `time` \[s\].
    fn correct_volume_of(&mut self, material: usize, rates: VolumeCorrection, time: f64) {
        // V⁰, V⁰(J − 1); the same of this fluid.
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
        let mut answers: Grid<_, D> = nodes
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
                let excess = answers.get(&image).map_or(0.0, |answer| answer.1);
                answers.entry(node).and_modify(|answer| answer.1 = excess);
            }
        }
        let mut particles = core::mem::take(&mut self.particles);
        for p in particles.iter_mut().filter(|p| p.material == material) {
            let (mut mean, mut excess) = (0.0, 0.0);
            for Touch { node, w, .. } in self.touched_nodes(p) {
                let answer = answers[&node];
                mean += w * answer.0;
                excess += w * answer.1;
            }
            let strained = time * shear_rate(p.affine);
            let share = |rate: f64| rate * strained / (1.0 + rate * strained);
            let e = self.jacobian_minus_one(p);
            let smoothed = e + share(rates.smoothing) * (mean - e); // (7h)
            p.strain = vec![smoothed - share(rates.correction) * excess]; // (7i)
        }
        self.particles = particles;
    }

    /// Adds to the volumes of nodes at walls on their planes those of the mirror images.
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

    /// By particle, how much more room there is on the grid than its rest volumes need.
    fn gathered_jacobians(&self) -> Vec<f64> {
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

    /// P2G for a substep of `dt` \[s\].
    pub fn particles_to_grid(&self, dt: f64) -> Grid<Momentum<D>, D> {
        let (zero, d_inv) = (Vector([0.0; D]), self.inverse_inertia());
        let mut grid = Grid::new();
        for particle in &self.particles {
            let Particle {
                mass: m,
                volume0: v0,
                velocity: v,
                affine: c,
                ..
            } = *particle;
            let tau = self.law(particle).kirchhoff_stress(&particle.strain, c);
            let q = match self.setup.transfer {
                Transfer::Pic | Transfer::Flip { .. } => Matrix([zero; D]),
                Transfer::Apic => c * m, // (4) without stress
            };
            for Touch {
                node,
                w,
                r,
                gradient,
            } in self.touched_nodes(particle)
            {
                let n = grid.entry(node).or_insert(Momentum {
                    mass: 0.0,
                    momentum: zero,
                    impulse: zero,
                });
                n.mass += w * m; // (1)
                n.momentum += (v * m + q * r) * w; // (2) without stress
                n.impulse += match self.setup.force {
                    ForceForm::Mls => tau * r * (w * -dt * v0 * d_inv), // (2), stress in (4)
                    ForceForm::Classic => tau * gradient * (-dt * v0),
                };
            }
        }
        grid
    }

    /// Forces and walls, for a substep of `dt` \[s\]. Nodes without mass are skipped.
    pub fn update_grid(&self, grid: &Grid<Momentum<D>, D>, dt: f64) -> Grid<Velocity<D>, D> {
        let mut taken = vec![Impulse::ZERO; 2 * D + self.colliders.len()];
        let gravity = Vector(self.setup.gravity);
        let with_mass = grid.iter().filter(|(_, n)| n.mass > 0.0);
        let mut grid = with_mass
            .map(|(&node, n)| {
                let before = over(n.momentum, n.mass);
                let x = core::array::from_fn(|axis| {
                    self.origin[axis] + self.setup.dx * node[axis] as f64
                });
                let mut field = [[0.0; D]];
                let all = &self.setup.forces;
                force::accelerations(
                    all,
                    false,
                    self.time,
                    &[x],
                    &[],
                    &mut [field[0]],
                    &mut field,
                );
                let mut free = over(n.momentum + n.impulse, n.mass);
                free += (gravity + Vector(field[0])) * dt; // (9)
                if let Some((kept, medium)) = force::drag(all, dt) {
                    free = Vector(medium) + (free - Vector(medium)) * kept; // (10)
                }
                if let Some(pointer) = self.pointer {
                    let pointer = NodePointer::of(pointer, self.origin.0, self.setup.dx);
                    free = pointer.act(free, node, dt);
                }
                let velocity = Velocity {
                    mass: n.mass,
                    before,
                    after: self.walls.constrain(free, node, n.mass, &mut taken),
                };
                (node, velocity)
            })
            .collect();
        let colliders = self.moving(dt);
        let around: Vec<_> = colliders
            .iter()
            .map(|collider| self.around(collider, &grid))
            .collect();
        self.fold_walls(&mut grid);
        for ((collider, nodes), taken) in colliders.iter().zip(around).zip(&mut taken[2 * D..]) {
            self.hold_at(collider, nodes, &mut grid, taken);
        }
        grid
    }

    /// The colliders in a substep of `dt` \[s\].
    fn moving(&self, dt: f64) -> Vec<Moving<D>> {
        let period = self
            .walls
            .period
            .map(|cells| cells.map(|cells| cells as f64));
        let of = |collider: &Collider<D>| {
            let mut moving = Moving::of(collider, period);
            moving.move_to(collider, self.time, dt);
            moving
        };
        self.colliders.iter().map(of).collect()
    }

    /// The nodes around a collider, before walls have changed their masses.
    fn around(&self, collider: &Moving<D>, grid: &Grid<Velocity<D>, D>) -> Vec<NearNode<D>> {
        let with_mass = grid.iter().filter_map(|(&node, n)| {
            let mut near = near(collider, node, &self.walls)?;
            near.brought = n.mass;
            near.moving = near.moving * self.setup.dx;
            Some(near)
        });
        with_mass.collect()
    }

    /// Lets a collider act on the nodes around it.
    fn hold_at(
        &self,
        collider: &Moving<D>,
        mut nodes: Vec<NearNode<D>>,
        grid: &mut Grid<Velocity<D>, D>,
        taken: &mut Impulse<D>,
    ) {
        for near in &mut nodes {
            let n = &grid[&near.node];
            (near.mass, near.velocity, near.before) = (n.mass, n.after, n.before);
        }
        let places: BTreeMap<[i64; D], usize> = nodes
            .iter()
            .enumerate()
            .map(|(i, near)| (near.node, i))
            .collect();
        let find = |node| places.get(&self.walls.canonical(node)).copied();
        let blend = match self.setup.transfer {
            Transfer::Flip { blend } => blend,
            Transfer::Pic | Transfer::Apic => 0.0,
        };
        let scratch = &mut Scratch::default();
        contact::constrain(&mut nodes, find, collider.contact, blend, taken, scratch);
        for near in &nodes {
            let velocity = Velocity {
                mass: near.mass,
                before: near.before,
                after: near.velocity,
            };
            grid.insert(near.node, velocity);
        }
    }

    /// Lets the walls on their planes act on velocities.
    fn fold_walls(&self, grid: &mut Grid<Velocity<D>, D>) {
        for wall in &self.walls.planes {
            let on_plane = grid.keys().filter(|node| node[wall.axis] == wall.node);
            for node in on_plane.copied().collect::<Vec<_>>() {
                let inward = i64::from(wall.inward);
                let places = [-inward, 0, inward].map(|step| {
                    let mut place = node;
                    place[wall.axis] += step;
                    place
                });
                let nothing = Velocity {
                    mass: 0.0,
                    before: Vector([0.0; D]),
                    after: Vector([0.0; D]),
                };
                let [beyond, on_plane, inside] = places.map(|place| {
                    let node = grid.get(&place).unwrap_or(&nothing);
                    TripleNode {
                        mass: node.mass,
                        velocity: node.after,
                        before: node.before,
                    }
                });
                let mut triple = Triple {
                    beyond,
                    on_plane,
                    inside,
                };
                let inward = f64::from(wall.inward);
                if !wall.contact.fold(&mut triple, wall.axis, inward) {
                    continue;
                }
                let folded = [triple.beyond, triple.on_plane, triple.inside];
                for (place, node) in places.into_iter().zip(folded) {
                    let velocity = Velocity {
                        mass: node.mass,
                        before: node.before,
                        after: node.velocity,
                    };
                    grid.insert(place, velocity);
                }
            }
        }
    }

    /// G2P for a substep of `dt` \[s\].
    pub fn grid_to_particles(&mut self, grid: &Grid<Velocity<D>, D>, dt: f64) {
        let push = ParticlePointer::of(self.pointer, self.origin.0, self.setup.dx, dt);
        let colliders = self.moving(dt);
        let mut particles = core::mem::take(&mut self.particles);
        for particle in &mut particles {
            let (mut pic, mut change) = (Vector([0.0; D]), Vector([0.0; D]));
            let mut b = Matrix([Vector([0.0; D]); D]);
            let mut gradient_of_v = Matrix([Vector([0.0; D]); D]);
            for Touch {
                node,
                w,
                r,
                gradient,
            } in self.touched_nodes(particle)
            {
                let Some(n) = grid.get(&node) else { continue };
                pic += n.after * w; // (5)
                change += (n.after - n.before) * w;
                b += outer(n.after, r) * w; // (6)
                gradient_of_v += outer(n.after, gradient);
            }
            let c = match self.setup.kernel {
                Kernel::Linear => gradient_of_v,
                Kernel::Quadratic | Kernel::Cubic => b * self.inverse_inertia(), // (3)
            };
            let velocity_gradient = match self.setup.force {
                ForceForm::Mls => c,
                ForceForm::Classic => gradient_of_v,
            };
            let law = self.law(particle);
            particle.strain = law.advance(&particle.strain, velocity_gradient * dt); // (7)
            particle.position += pic * dt; // (8)
            particle.velocity = match self.setup.transfer {
                Transfer::Pic | Transfer::Apic => pic,
                Transfer::Flip { blend } => {
                    (particle.velocity + change) * blend + pic * (1.0 - blend)
                }
            };
            particle.affine = c;
            self.hold(particle);
            if let Some(push) = push {
                particle.velocity = push.act(particle.velocity, self.in_cells(particle)); // (12)
            }
            self.keep_in_domain(particle);
            self.project_out(particle, &colliders);
        }
        let (kept, gone) = particles.into_iter().partition(|p| !self.is_outside(p));
        self.particles = kept;
        self.escaped.extend::<Vec<_>>(gone);
    }

    /// Walls on their plane and clamps hold a particle.
    fn hold(&self, particle: &mut Particle<D>) {
        let dx = self.setup.dx;
        for axis in 0..D {
            let x = &mut particle.position[axis];
            let (low, high) = self.walls.bounds[axis];
            if let Some(low) = low {
                *x = x.max(self.origin[axis] + low * dx);
            }
            if let Some(high) = high {
                *x = x.min(self.origin[axis] + high * dx);
            }
        }
    }

    /// Colliders put a particle that is inside on their surface.
    fn project_out(&self, particle: &mut Particle<D>, colliders: &[Moving<D>]) {
        let mut x = self.in_cells(particle);
        let (hold, motion) = (&self.walls.bounds, (&mut x, &mut particle.velocity));
        let dx = self.setup.dx;
        if project_out(colliders, hold, [0.0; D], motion, dx, |_, _, _| {}) {
            particle.position = self.origin + x * self.setup.dx;
        }
    }

    /// Periodic sides bring the particle in at the other end, a cushion slows it.
    fn keep_in_domain(&self, particle: &mut Particle<D>) {
        let dx = self.setup.dx;
        for axis in 0..D {
            let x = &mut particle.position[axis];
            if let Some(cells) = self.walls.period[axis] {
                let length = cells as f64 * dx;
                *x -= ((*x - self.origin[axis]) / length).floor() * length;
            }
            if let Some(cushion) = &self.setup.cushion {
                let ahead = |side: f64| (side - *x) / cushion.time;
                let (low, high) = (cushion.inside.min[axis], cushion.inside.max[axis]);
                let v = &mut particle.velocity[axis];
                *v = v.max(ahead(low)).min(ahead(high));
            }
        }
    }

    /// Whether a particle is beyond an open side.
    fn is_outside(&self, particle: &Particle<D>) -> bool {
        let x = self.in_cells(particle);
        (0..D).any(|axis| {
            let (low, high) = self.walls.open[axis];
            low.is_some_and(|low| x[axis] < low) || high.is_some_and(|high| x[axis] > high)
        })
    }

    /// A particle's position in cells from the origin.
    fn in_cells(&self, particle: &Particle<D>) -> Vector<f64, D> {
        over(particle.position - self.origin, self.setup.dx)
    }

    /// D⁻¹ of (3) \[1/m²\]; infinite for the linear kernel.
    fn inverse_inertia(&self) -> f64 {
        let in_cells = match self.setup.kernel {
            Kernel::Linear => Linear::INVERSE_INERTIA,
            Kernel::Quadratic => Quadratic::INVERSE_INERTIA,
            Kernel::Cubic => Cubic::INVERSE_INERTIA,
        };
        in_cells / (self.setup.dx * self.setup.dx)
    }

    /// The nodes that a particle touches.
    fn touched_nodes(&self, particle: &Particle<D>) -> Vec<Touch<D>> {
        let (x, dx) = (self.in_cells(particle), self.setup.dx);
        let mut touched = match self.setup.kernel {
            Kernel::Linear => stencil::<Linear, D>(x, dx),
            Kernel::Quadratic => stencil::<Quadratic, D>(x, dx),
            Kernel::Cubic => stencil::<Cubic, D>(x, dx),
        };
        for touch in &mut touched {
            touch.node = self.walls.canonical(touch.node);
        }
        touched
    }

    fn law(&self, particle: &Particle<D>) -> &dyn Law<D> {
        law(&self.setup.materials[particle.material].model)
    }
}

/// Totals, particle after particle by ascending id.
impl<const D: usize> Reference<D> {
    /// Σ m \[kg\].
    pub fn mass(&self) -> f64 {
        self.particles.iter().map(|p| p.mass).sum()
    }

    /// Σ m v \[kg m/s\].
    pub fn momentum(&self) -> Vector<f64, D> {
        let mut sum = Vector([0.0; D]);
        for p in &self.particles {
            sum += p.velocity * p.mass;
        }
        sum
    }

    /// Angular momentum about the origin of coordinates \[kg m²/s\] as the grid will have it after
    /// P2G; in 2D its third component.
    ///
    /// A particle gives node i the momentum w m (v + C r). With Σ w = 1, Σ w r = 0 and
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

    /// Σ ½ m v² \[J\].
    pub fn kinetic_energy(&self) -> f64 {
        let of = |p: &Particle<D>| 0.5 * p.mass * p.velocity.dot(p.velocity);
        self.particles.iter().map(of).sum()
    }

    /// Σ ½ m C D : C \[J\]: what APIC's matrices hold besides [`Self::kinetic_energy`]; 0 in other
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

    /// Σ V⁰ Φ \[J\].
    pub fn elastic_energy(&self) -> f64 {
        let of = |p: &Particle<D>| p.volume0 * self.law(p).energy_density(&p.strain);
        self.particles.iter().map(of).sum()
    }

    /// Energy as the leapfrog of positions and velocities sees it \[J\], for a substep of `dt`
    /// \[s\] that is not taken: elastic energy now + ½ Σ m_i v_i·v_i⁺, with node velocities before
    /// and after forces. Without gravity and walls, APIC never lets it grow on an elastic body.
    pub fn staggered_energy(&self, dt: f64) -> f64 {
        let of = |n: &Velocity<D>| 0.5 * n.mass * n.before.dot(n.after);
        self.elastic_energy() + self.over_nodes(dt, of)
    }

    /// ½ Σ m_i v_i·(v_i⁺ − v_i) \[J\]: what [`Self::staggered_energy`] has beyond the energy of
    /// the nodes before forces. FLIP particles keep motion that the grid does not see: there, it is
    /// the sum of this and the *particles'* energies that does not grow.
    pub fn staggered_work(&self, dt: f64) -> f64 {
        self.over_nodes(dt, |n| 0.5 * n.mass * n.before.dot(n.after - n.before))
    }

    /// The sum of `term` over the nodes of a substep that is not taken.
    fn over_nodes(&self, dt: f64, term: impl Fn(&Velocity<D>) -> f64) -> f64 {
        let velocity = self.update_grid(&self.particles_to_grid(dt), dt);
        velocity.values().map(term).sum()
    }

    /// D_p = Σ_i w r rᵀ \[m²\] of (3), which is diagonal.
    fn inertia(&self, particle: &Particle<D>) -> Matrix<f64, D> {
        let mut d = Matrix([Vector([0.0; D]); D]);
        for Touch { w, r, .. } in self.touched_nodes(particle) {
            d += outer(r, r) * w;
        }
        d
    }
}

/// A particle and one of the nodes it touches.
struct Touch<const D: usize> {
    node: [i64; D],
    /// Weight w.
    w: f64,
    /// Lever arm r = x_i − x_p \[m\].
    r: Vector<f64, D>,
    /// ∇w, by the particle's position \[1/m\].
    gradient: Vector<f64, D>,
}

/// The nodes that a particle at `x` \[cells from the origin\] touches.
fn stencil<K: BSpline, const D: usize>(x: Vector<f64, D>, dx: f64) -> Vec<Touch<D>> {
    let base = Vector::<f64, D>::from_fn(|axis| (x[axis] - K::OFFSET).floor());
    let countable = 1.0 / f64::EPSILON;
    assert!(
        base.0.iter().all(|b| b.abs() < countable),
        "a particle is {x:?} cells from the origin"
    );
    let frac = Vector::<f64, D>::from_fn(|axis| x[axis] - K::OFFSET - base[axis]);
    let weights: [_; D] = core::array::from_fn(|axis| K::weights(frac[axis]));
    let gradients: [_; D] = core::array::from_fn(|axis| K::gradients(frac[axis]));
    let mut touched = Vec::with_capacity(K::NODES.pow(D as u32));
    for number in 0..K::NODES.pow(D as u32) {
        // `number` counts through K::NODES nodes an axis.
        let k: [usize; D] =
            core::array::from_fn(|axis| number / K::NODES.pow(axis as u32) % K::NODES);
        let w = (0..D).map(|axis| weights[axis][k[axis]]).product();
        let r = Vector::from_fn(|axis| (k[axis] as f64 - (K::OFFSET + frac[axis])) * dx);
        let gradient = Vector::from_fn(|axis| {
            let factor = |other: usize| {
                if other == axis {
                    gradients[other][k[other]] / dx
                } else {
                    weights[other][k[other]]
                }
            };
            (0..D).map(factor).product()
        });
        touched.push(Touch {
            node: core::array::from_fn(|axis| base[axis] as i64 + k[axis] as i64),
            w,
            r,
            gradient,
        });
    }
    touched
}

/// a / b. Not a times 1 / b, which overflows where b is the mass of a node that is barely touched.
fn over<const D: usize>(a: Vector<f64, D>, b: f64) -> Vector<f64, D> {
    Vector::from_fn(|axis| a[axis] / b)
}

/// a bᵀ.
fn outer<const D: usize>(a: Vector<f64, D>, b: Vector<f64, D>) -> Matrix<f64, D> {
    Matrix::from_fn(|i, j| a[i] * b[j])
}

/// A [`ConstitutiveModel`] in one `f64` a number, whatever it keeps as strain being columns.
trait Law<const D: usize> {
    fn start(&self, displacement_gradient: Matrix<f64, D>, given: &[(&str, &[f64])]) -> Vec<f64>;
    fn displacement_gradient(&self, strain: &[f64]) -> Matrix<f64, D>;
    fn jacobian_minus_one(&self, strain: &[f64]) -> f64;
    fn plastic_jacobian(&self, strain: &[f64]) -> f64;
    fn kirchhoff_stress(&self, strain: &[f64], gradient: Matrix<f64, D>) -> Matrix<f64, D>;
    fn advance(&self, strain: &[f64], increment: Matrix<f64, D>) -> Vec<f64>;
    fn energy_density(&self, strain: &[f64]) -> f64;
    fn volume_rule(&self) -> VolumeRule;
    fn rest_modulus(&self) -> f64;
}

fn law<const D: usize>(model: &Model) -> &dyn Law<D> {
    for_model!(model, law => law)
}

impl<M: ConstitutiveModel<D>, const D: usize> Law<D> for M {
    fn start(&self, displacement_gradient: Matrix<f64, D>, given: &[(&str, &[f64])]) -> Vec<f64> {
        start::<M, D>(displacement_gradient, given)
    }
    fn displacement_gradient(&self, strain: &[f64]) -> Matrix<f64, D> {
        M::Strain::read(|column| strain[column]).displacement_gradient()
    }
    fn jacobian_minus_one(&self, strain: &[f64]) -> f64 {
        M::Strain::read(|column| strain[column]).jacobian_minus_one()
    }
    fn plastic_jacobian(&self, strain: &[f64]) -> f64 {
        1.0 + M::Strain::read(|column| strain[column]).plastic_jacobian_minus_one()
    }
    fn kirchhoff_stress(&self, strain: &[f64], gradient: Matrix<f64, D>) -> Matrix<f64, D> {
        self.kirchhoff_stress(M::Strain::read(|column| strain[column]), gradient)
    }
    fn advance(&self, strain: &[f64], increment: Matrix<f64, D>) -> Vec<f64> {
        columns(self.advance(M::Strain::read(|column| strain[column]), increment))
    }
    fn energy_density(&self, strain: &[f64]) -> f64 {
        self.energy_density(M::Strain::<f64>::read(|column| strain[column]))
    }
    fn rest_modulus(&self) -> f64 {
        self.wave_modulus(M::Strain::rest(0.0_f64))
    }

    fn volume_rule(&self) -> VolumeRule {
        ConstitutiveModel::<D>::fluid(self).map_or(VolumeRule::Jacobian, FluidModel::volume_rule)
    }
}

fn columns<S: Strain<f64, D>, const D: usize>(strain: S) -> Vec<f64> {
    let mut columns = vec![0.0; S::COLUMNS];
    strain.write(|column, value| columns[column] = value);
    columns
}

/// Adds the particles of `batch`, numbered on from those that are there.
fn take_in<const D: usize>(
    setup: &Setup<D>,
    batch: &ParticleBatch<D>,
    particles: &mut Vec<Particle<D>>,
) -> Result<(), SetupError> {
    let variables = |material: usize| setup.materials[material].model.variables();
    batch.check(setup, particles.len() as u32, variables)?;
    let material = &setup.materials[batch.material];
    let law = law::<D>(&material.model);
    for (i, &position) in batch.position.iter().enumerate() {
        // One for all, or one a particle.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Corotated, Dust, Material};
    use crate::setup::{Contact, Domain, Sides, WallStyle};

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
        assert_eq!(key(&linear, &batch), "force");
        let other = ParticleBatch {
            material: 1,
            ..batch.clone()
        };
        assert_eq!(key(&setup, &other), "batch.material");
        let short = ParticleBatch {
            velocity: vec![[0.0; 2]; 3],
            ..batch.clone()
        };
        assert_eq!(key(&setup, &short), "batch.velocity");
        let empty = ParticleBatch {
            volume: vec![0.0],
            ..batch.clone()
        };
        assert_eq!(key(&setup, &empty), "batch.volume");
        let nowhere = ParticleBatch {
            position: vec![[f64::NAN; 2]; 20],
            ..batch
        };
        assert_eq!(key(&setup, &nowhere), "batch.position");
    }
}
