//! The public face: commands in, snapshots out.
//!
//! [`Simulation`] is the typed one; [`Simulate`] is the same without the types of numbers and
//! dimension, for outlets that open whatever scene they are given.

use crate::boundary::collider::Moving;
use crate::boundary::impulse::Taken;
use crate::boundary::pointer::Push;
use crate::boundary::surface::put_out;
use crate::boundary::walls::Walls;
use crate::boundary::{BoundaryImpulse, Collider};
use crate::error::{DtLimit, Failure, SetupError};
use crate::forces::{self, Force};
use crate::grid::{Grid, NodeForces, NodePointer};
use crate::instance::Instance;
use crate::material::{IsaToken, Law, VolumeCorrection};
use crate::math::Vector;
use crate::particles::{DRIFT_LIMIT, Escaped, Sorter, in_range};
use crate::particles::{Field, Snapshot};
use crate::particles::{Group, Layout, PerParticle, Run, block_edge, locate};
use crate::setup::{
    Command, Deformation, ForceForm, Isa, Kernel, ParticleBatch, Pointer, ProbeSamples, Setup,
    TimeStep, Transfer,
};
use crate::simulate::{Advance, Memory, PhaseTimes, Simulate};
use crate::state::checkpoint::{Checkpoint, CheckpointError};
use crate::state::diagnostics::Diagnostics;
use crate::state::probe::{self, Readings};
use crate::state::retry::{Mark, Retry};
use crate::state::time_step::StepControl;
use crate::transfer::Scheme;
use crate::transfer::gather::{Around, MOST_CELLS};
use crate::transfer::scatter::What;
use core::borrow::Borrow;

/// How far sound goes, in cells, between two corrections of the fluids' volumes.
pub(crate) const CORRECTION_INTERVAL: f64 = 5.0;

/// A simulation in `D` dimensions with numbers of type `T`.
///
/// ```
/// use lahar::{Material, ParticleBatch, Setup, Simulate, Simulation, material::Corotated, Model};
///
/// let jelly = Material { name: "jelly".into(), density: 1000.0, model: Model::Corotated(Corotated { lambda: 1e4, mu: 1e4 }) };
/// let mut setup = Setup::<2>::new(0.1, vec![jelly]);
/// setup.gravity = [0.0, -9.81];
/// let particles = ParticleBatch { position: vec![[0.2, 0.3], [0.25, 0.3]], volume: vec![0.0025], ..Default::default() };
/// let mut simulation = Simulation::<f32, 2>::new(setup, &[particles])?;
/// simulation.advance_to(0.1)?;
/// assert!(simulation.diagnostics().momentum[1] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Simulation<T: Instance<D>, const D: usize> {
    pub(crate) setup: Setup<D>,
    pub(crate) walls: Walls<D>,
    /// Lengths in cells from node 0.
    pub(crate) colliders: Vec<Collider<D>>,
    /// The same in the present substep.
    pub(crate) moving: Vec<Moving<D>>,
    /// Room for what colliders take by putting particles out.
    pub(crate) taken_by_run: Vec<Taken<D>>,
    /// Where node 0 is \[m\].
    pub(crate) origin: [f64; D],
    pub(crate) scheme: Scheme,
    pub(crate) isa: IsaToken,
    pub(crate) grid: Grid<T, D>,
    pub(crate) groups: Vec<Group<T, D>>,
    pub(crate) sorter: Sorter<T, D>,
    /// Cells that particles may have moved since they were sorted.
    pub(crate) drift: f64,
    /// Time since the fluids' volumes were last set right \[s\].
    pub(crate) uncorrected: f64,
    pub(crate) pointer: Option<Pointer>,
    /// By the number of the domain's side, and then by collider, what it has taken since the start;
    /// lengths in metres.
    pub(crate) taken: Vec<Taken<D>>,
    pub(crate) escaped: Escaped,
    pub(crate) control: StepControl,
    /// Where each particle started \[m\], by id, if a force asks for it.
    pub(crate) starts: Option<Vec<[f64; D]>>,
    pub(crate) next_id: u32,
    /// What each probe has read.
    pub(crate) readings: Vec<Readings>,
    /// Where a frame that fails begins again.
    pub(crate) mark: Option<Mark<T, D>>,
    pub(crate) clock: Option<fn() -> f64>,
    pub(crate) times: PhaseTimes,
}

pub(crate) fn three<const D: usize>(a: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|i| if i < D { a[i] } else { 0.0 })
}

fn setup_error<R>(key: &str, message: String) -> Result<R, SetupError> {
    Err(SetupError {
        key: key.into(),
        message,
    })
}

impl<T: Instance<D>, const D: usize> Simulation<T, D> {
    /// Checks the setup and takes in the particles. Batches that are not borrowed are dropped one after the other.
    ///
    /// # Errors
    /// Names the key that cannot be simulated.
    pub fn new(
        setup: Setup<D>,
        batches: impl IntoIterator<Item: Borrow<ParticleBatch<D>>>,
    ) -> Result<Self, SetupError> {
        let laws = setup
            .materials
            .iter()
            .map(|material| T::built_in(&material.model))
            .collect();
        Self::with_laws(setup, laws, batches)
    }

    /// As [`Simulation::new`], with `laws[i]` in place of the model of material `i`: for models
    /// from outside the crate, made into laws by [`crate::material::law`].
    ///
    /// # Errors
    /// Names the key that cannot be simulated.
    pub fn with_laws(
        setup: Setup<D>,
        laws: Vec<Box<dyn Law<T, D>>>,
        batches: impl IntoIterator<Item: Borrow<ParticleBatch<D>>>,
    ) -> Result<Self, SetupError> {
        const { assert!(D == 2 || D == 3, "two or three dimensions") };
        let walls = check(&setup, laws.len())?;
        let Some(level) = setup.isa.level() else {
            return setup_error("isa", format!("this machine has no {}", setup.isa.name()));
        };
        let scheme = Scheme {
            kernel: setup.kernel,
            force: setup.force,
            transfer: setup.transfer,
            dx: setup.dx,
        };
        let groups = laws
            .into_iter()
            .zip(&setup.materials)
            .map(|(law, m)| Group::new(law, m.density))
            .collect::<Vec<_>>();
        let origin = setup.domain.as_ref().map_or([0.0; D], |domain| domain.min);
        let in_cells = |collider: &Collider<D>| collider.in_units(setup.dx, origin).rooted(&walls);
        let colliders: Vec<_> = setup.colliders.iter().map(in_cells).collect();
        let period = walls.period.map(|cells| cells.map(|cells| cells as f64));
        let moving = |collider: &Collider<D>| Moving::of(collider, period);
        let mut simulation = Self {
            moving: colliders.iter().map(moving).collect(),
            taken_by_run: Vec::new(),
            colliders,
            walls,
            origin,
            grid: Grid::new(scheme),
            scheme,
            isa: IsaToken(level),
            groups,
            sorter: Sorter::default(),
            drift: 0.0,
            uncorrected: 0.0,
            pointer: None,
            taken: vec![Taken::NOTHING; 2 * D + setup.colliders.len()],
            escaped: Escaped::default(),
            control: StepControl::new(setup.time_step, setup.dx),
            starts: setup
                .forces
                .iter()
                .any(Force::acts_on_particles)
                .then(Vec::new),
            next_id: 0,
            readings: vec![Readings::default(); setup.probes.len()],
            mark: None,
            clock: None,
            times: PhaseTimes::default(),
            setup,
        };
        simulation.take_in(batches)?;
        simulation.read_probes(None);
        Ok(simulation)
    }

    /// Adds particles to a simulation that may be under way; ids go on from the last.
    ///
    /// # Errors
    /// Names what of the batch cannot be simulated; nothing is added then.
    pub fn add(&mut self, batch: &ParticleBatch<D>) -> Result<(), SetupError> {
        self.take_in(core::slice::from_ref(batch))
    }

    fn take_in(
        &mut self,
        batches: impl IntoIterator<Item: Borrow<ParticleBatch<D>>>,
    ) -> Result<(), SetupError> {
        let mut measured = Vec::new();
        for batch in batches {
            let batch = batch.borrow();
            let first = self.next_id;
            self.append(batch)?;
            if batch.measure_volume {
                measured.push(first..self.next_id);
            }
        }
        self.groups.iter_mut().for_each(Group::shrink);
        self.sort();
        self.measure_volumes(&measured);
        self.measure();
        Ok(())
    }

    /// Puts rows behind those of their group, in runs of their own.
    fn append(&mut self, batch: &ParticleBatch<D>) -> Result<(), SetupError> {
        let count = batch.position.len();
        check_batch(batch, &self.setup, self.next_id)?;
        batch.check_variables(self.groups[batch.material].law.variables())?;
        let offset = self.scheme.offset();
        self.move_colliders(0.0);
        let (hold, origin, dx) = (self.walls.hold, self.origin, self.setup.dx);
        let place_of = |position: &[f64; D]| -> [(i32, f64); D] {
            core::array::from_fn(|axis| {
                // Whoever starts outside is put where the first substep would put it.
                let (low, high) = hold[axis];
                let cells = (position[axis] - origin[axis]) / dx;
                let cells = cells.max(low.unwrap_or(cells)).min(high.unwrap_or(cells));
                locate(cells, offset, D)
            })
        };
        let far = |position| !in_range(place_of(position).map(|(block, _)| block));
        if let Some(i) = batch.position.iter().position(far) {
            let position = batch.position[i];
            return setup_error(
                "position",
                format!("particle {i} at {position:?} m is too far from the origin"),
            );
        }
        let density = self.setup.materials[batch.material].density;
        let pick = |values: &[f64], i: usize| {
            if values.len() == 1 {
                values[0]
            } else {
                values[i]
            }
        };
        let group = &mut self.groups[batch.material];
        let before = group.len();
        for column in &mut group.columns {
            column.reserve(count);
        }
        for (i, position) in batch.position.iter().enumerate() {
            let place = place_of(position);
            let block = place.map(|(block, _)| block);
            let edge = block_edge(D) as f64;
            let middle = block.map(|block| edge * (f64::from(block) + 0.5) + offset);
            let (mut x, mut v) = (Vector(place.map(|(_, x)| x)), Vector([0.0; D]));
            put_out(
                &self.moving,
                &hold,
                middle,
                (&mut x, &mut v),
                dx,
                |_, _, _| {},
            );
            let row = (before + i) as u32;
            match group.runs.last_mut() {
                Some(run) if run.start >= before as u32 && run.block == block => run.end = row + 1,
                _ => group.runs.push(Run {
                    block,
                    start: row,
                    end: row + 1,
                    tile: 0,
                    first: false,
                }),
            }
            let velocity = match batch.velocity.len() {
                0 => [0.0; D],
                1 => batch.velocity[0],
                _ => batch.velocity[i],
            };
            let gradient = match &batch.deformation {
                Deformation::Rest => None,
                Deformation::Jacobian(j) => {
                    let stretch = libm::pow(j[i], 1.0 / D as f64);
                    Some(core::array::from_fn(|a| {
                        core::array::from_fn(|b| if a == b { stretch } else { 0.0 })
                    }))
                }
                Deformation::Gradient(f) => Some(f[i]),
            };
            let (head, strain) = group.columns.split_at_mut(Layout::strain(D));
            for axis in 0..D {
                head[axis].push(T::from_f64(x[axis]));
                head[Layout::velocity(D) + axis].push(T::from_f64(velocity[axis]));
                for row in 0..D {
                    let c = batch.affine.get(i).map_or(0.0, |c| c[row][axis]);
                    head[Layout::affine(D) + axis * D + row].push(T::from_f64(c));
                }
            }
            let variables = batch.variables_of(i);
            let identity = || core::array::from_fn(|a| core::array::from_fn(|b| f64::from(a == b)));
            match gradient.or_else(|| (!variables.is_empty()).then(identity)) {
                None => strain
                    .iter_mut()
                    .for_each(|column| column.push(T::default())),
                Some(f) => {
                    let start = group.law.start(f, &variables);
                    strain
                        .iter_mut()
                        .zip(start)
                        .for_each(|(column, value)| column.push(T::from_f64(value)));
                }
            }
        }
        let volume = |i| T::from_f64(pick(&batch.volume, i));
        let mass = |i| {
            T::from_f64(if batch.mass.is_empty() {
                density * pick(&batch.volume, i)
            } else {
                pick(&batch.mass, i)
            })
        };
        group.volume0.extend(before, (0..count).map(volume));
        group.mass.extend(before, (0..count).map(mass));
        group
            .body
            .extend(before, core::iter::repeat_n(batch.body, count));
        group.id.extend((0..count as u32).map(|i| self.next_id + i));
        self.next_id += count as u32;
        if let Some(starts) = &mut self.starts {
            starts.extend_from_slice(&batch.position);
        }
        Ok(())
    }

    /// Particles to their blocks, and a grid where they are.
    fn sort(&mut self) {
        let start = self.now();
        for group in &mut self.groups {
            let escaped = self.sorter.sort(group, &self.walls, self.scheme.offset());
            self.escaped.count += escaped.count;
            self.escaped.mass += escaped.mass;
        }
        self.grid.rebuild(&mut self.groups, &self.walls);
        self.drift = 0.0;
        self.times.sort += self.now() - start;
        self.times.sorts += 1;
    }

    /// Sorts if a particle may be outside its block's tile.
    pub(crate) fn sort_if_drifted(&mut self) {
        if self.drift > DRIFT_LIMIT {
            self.sort();
        }
    }

    /// Speeds of what is there, for the first time step.
    fn measure(&mut self) {
        let mut speed_squared = 0.0_f64;
        for group in &self.groups {
            for row in 0..group.len() {
                let v = Vector::<f64, D>::from_fn(|axis| {
                    group.columns[Layout::velocity(D) + axis][row].to_f64()
                });
                speed_squared = speed_squared.max(v.dot(v));
            }
        }
        self.measure_waves();
        self.control.viscosity = self
            .groups
            .iter()
            .filter(|group| group.len() > 0)
            .map(|group| group.law.viscosity() / group.density)
            .fold(0.0, f64::max);
        self.control.speed = speed_squared.sqrt();
        self.control.gravity = Vector(self.setup.gravity).norm();
        self.control.field = self.largest_acceleration();
        self.watch_colliders();
    }

    /// Gives a material that has a bulk modulus this one \[Pa\], and its particles the pressures that they
    /// had.
    pub(crate) fn stiffen(&mut self, material: usize, bulk_modulus: Option<f64>) {
        let Some(group) = self.groups.get_mut(material) else {
            return;
        };
        if let (Some(before), Some(now)) = (group.law.bulk_modulus(), bulk_modulus)
            && before != now
        {
            group.set_law(group.law.with_bulk_modulus(now));
            let (_, strain) = group.columns.split_at_mut(Layout::strain(D));
            group.law.keep_pressure(before, strain);
            self.measure_waves();
        }
    }

    /// The fastest wave in what is there, for the next time step.
    fn measure_waves(&mut self) {
        let of = |group: &Group<T, D>| {
            let strain = &group.columns[Layout::strain(D)..];
            group.law.wave_modulus(strain, group.len()) / group.density
        };
        let squared = self.groups.iter().map(of).fold(0.0, f64::max);
        self.control.wave_speed = squared.sqrt();
    }

    /// One substep of length `dt` \[s\].
    fn substep_of(&mut self, dt: f64, limit: DtLimit) -> Result<(), Failure> {
        self.sort_if_drifted();
        self.set_volumes_right(dt);
        self.push_particles(dt);
        self.move_colliders(dt);
        self.scatter(dt); // (1)–(4)
        let colliders = core::mem::take(&mut self.moving);
        self.update(dt, &colliders);
        let gathered = self.gather(dt, limit, &colliders); // (5)–(8)
        if gathered.is_ok() {
            self.account(&colliders);
        }
        self.moving = colliders;
        gathered?;
        let before = self.control.time();
        self.press_probes();
        self.control.taken(dt, limit);
        self.watch_colliders();
        self.read_probes(Some(before));
        Ok(())
    }

    /// Puts the colliders where they are in a substep of `dt` \[s\].
    fn move_colliders(&mut self, dt: f64) {
        let time = self.control.time();
        for (moving, collider) in self.moving.iter_mut().zip(&self.colliders) {
            moving.put(collider, time, dt);
        }
    }

    /// What boundaries took in this substep, to what they have taken since the start.
    fn account(&mut self, colliders: &[Moving<D>]) {
        let dx = self.setup.dx;
        let (sides, of_colliders) = self.taken.split_at_mut(2 * D);
        for (total, taken) in sides.iter_mut().zip(&self.grid.taken) {
            total.add_scaled(taken, dx, self.origin);
        }
        let each = of_colliders.iter_mut().zip(&self.grid.taken[2 * D..]);
        for ((total, taken), collider) in each.zip(colliders) {
            // About where its centre is now.
            let from_center = (-collider.start.center() * dx).0;
            total.add_scaled(taken, dx, from_center);
        }
    }

    /// How fast colliders may move, for the next time step.
    fn watch_colliders(&mut self) {
        self.control.boundary_speed = 0.0;
        if self.colliders.is_empty() {
            return;
        }
        let (dt, _) = self.control.next();
        let (time, occupied) = (self.control.time(), self.grid.occupied());
        self.control.boundary_speed = self
            .colliders
            .iter()
            .map(|collider| self.setup.dx * collider.largest_speed(time, dt, occupied))
            .fold(0.0, f64::max);
    }

    /// P2G.
    fn scatter(&mut self, dt: f64) {
        let start = self.now();
        self.scatter_what(What::Momentum, dt);
        self.times.scatter += self.now() - start;
    }

    fn scatter_what(&mut self, what: What, dt: f64) {
        for group in &self.groups {
            let tiles = self.grid.tiles_mut();
            T::scatter(group, self.scheme, self.isa, dt, what, tiles);
        }
    }

    /// Rest volumes to the nodes, before an update has run.
    pub(crate) fn rest_volume_to_grid(&mut self) {
        self.scatter_what(What::Volume { corrected: false }, 0.0);
        T::sum_tiles(&mut self.grid, self.isa);
    }

    /// Volumes by how full the grid is, for the materials that want it.
    fn set_volumes_right(&mut self, dt: f64) {
        let start = self.now();
        self.correct_volumes(dt);
        self.gather_volumes();
        self.times.volume += self.now() - start;
    }

    /// (7g) for the materials that want it.
    fn gather_volumes(&mut self) {
        let gathers = |group: &Group<T, D>| group.law.gathered_column().is_some();
        if !self.groups.iter().any(gathers) {
            return;
        }
        self.rest_volume_to_grid();
        for group in &mut self.groups {
            if let Some(column) = group.law.gathered_column() {
                let column = Layout::strain(D) + column;
                let mut out = core::mem::take(&mut group.columns[column]);
                T::expansion(group, &self.grid, self.scheme, self.isa, &mut out);
                group.columns[column] = out;
            }
        }
    }

    /// (7h) and (7i) for the fluids that want them, every [`CORRECTION_INTERVAL`].
    fn correct_volumes(&mut self, dt: f64) {
        let corrected = |group: &Group<T, D>| {
            let (column, rates) = group.law.corrected_column()?;
            (group.len() > 0).then_some((column, rates))
        };
        let cells_of = |group: &Group<T, D>, time: f64| time * group.sound_speed / self.setup.dx;
        let time = self.uncorrected + dt;
        self.uncorrected = time;
        let fluids = self
            .groups
            .iter()
            .filter(|group| corrected(group).is_some());
        let cells = fluids
            .map(|group| cells_of(group, time))
            .fold(0.0, f64::max);
        if cells < CORRECTION_INTERVAL {
            return;
        }
        self.uncorrected = 0.0;
        for index in 0..self.groups.len() {
            let Some((column, rates)) = corrected(&self.groups[index]) else {
                continue;
            };
            for (other, group) in self.groups.iter().enumerate() {
                let what = What::Volume {
                    corrected: other == index,
                };
                T::scatter(
                    group,
                    self.scheme,
                    self.isa,
                    0.0,
                    what,
                    self.grid.tiles_mut(),
                );
            }
            T::measure_filling(&mut self.grid, self.isa, &self.walls, self.setup.dx);
            let shares = VolumeCorrection {
                smoothing: rates.smoothing * time,
                correction: rates.correction * time,
            };
            let group = &mut self.groups[index];
            let column = Layout::strain(D) + column;
            let mut e = core::mem::take(&mut group.columns[column]);
            T::correct_volume(group, &self.grid, self.scheme, self.isa, shares, &mut e);
            group.columns[column] = e;
        }
    }

    /// Particles with these ids get the rest volume that the grid says they fill.
    fn measure_volumes(&mut self, ids: &[core::ops::Range<u32>]) {
        if ids.is_empty() {
            return;
        }
        self.rest_volume_to_grid();
        for group in &mut self.groups {
            let mut expansion = vec![T::default(); group.len()];
            T::expansion(group, &self.grid, self.scheme, self.isa, &mut expansion);
            let volume = |row: usize| {
                let given = group.volume0.get(row);
                if ids.iter().any(|ids| ids.contains(&group.id[row])) {
                    given + given * expansion[row]
                } else {
                    given
                }
            };
            let volumes: Vec<T> = (0..group.len()).map(volume).collect();
            group.volume0 = PerParticle::Uniform(T::default());
            group.volume0.extend(0, volumes.into_iter());
        }
    }

    /// Momentum to velocity, forces, walls.
    fn update(&mut self, dt: f64, colliders: &[Moving<D>]) {
        let start = self.now();
        let fields = forces::any_on_nodes(&self.setup.forces);
        if fields {
            let time = self.control.time();
            self.grid
                .evaluate(&self.setup.forces, time, dt, self.origin, self.setup.dx);
        }
        let node_forces = NodeForces {
            dt: T::from_f64(dt),
            dx: self.setup.dx,
            gravity_impulse: Vector(self.setup.gravity.map(|g| T::from_f64(g * dt))),
            drag: forces::drag(&self.setup.forces, dt)
                .map(|(kept, medium)| (T::from_f64(kept), Vector(medium.map(T::from_f64)))),
            pointer: (self.pointer)
                .map(|pointer| NodePointer::of(pointer, self.origin, self.setup.dx)),
        };
        T::update(
            &mut self.grid,
            self.isa,
            &node_forces,
            &self.walls,
            colliders,
        );
        if fields {
            self.control.field = self.grid.largest_impulse() / dt;
        }
        self.times.grid += self.now() - start;
    }

    /// G2P.
    fn gather(&mut self, dt: f64, limit: DtLimit, colliders: &[Moving<D>]) -> Result<(), Failure> {
        let start = self.now();
        let (mut speed_squared, mut moved, mut wave_speed_squared) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut failure = None;
        let push = Push::of(self.pointer, self.origin, self.setup.dx, dt);
        for (material, group) in self.groups.iter_mut().enumerate() {
            let around = Around {
                walls: &self.walls,
                push: push.as_ref(),
                colliders,
            };
            let taken = &mut self.taken_by_run;
            let found = T::gather(group, &self.grid, around, self.scheme, self.isa, dt, taken);
            // Run after run: the order of sums does not depend on threads.
            for (number, total) in self.grid.taken[2 * D..].iter_mut().enumerate() {
                let mut of_group = Taken::NOTHING;
                for taken in taken.iter().skip(number).step_by(colliders.len()) {
                    of_group.add_scaled(taken, 1.0, [0.0; D]);
                }
                total.add_scaled(&of_group, 1.0, [0.0; D]);
            }
            speed_squared = speed_squared.max(found.speed_squared);
            moved = moved.max(found.moved);
            wave_speed_squared = wave_speed_squared.max(found.wave_modulus / group.density);
            if let Some(row) = found.failed {
                failure = failure.or(Some((material, row, found.failures)));
            }
        }
        self.times.gather += self.now() - start;
        if let Some(found) = failure {
            return Err(self.failure(found, dt, limit));
        }
        self.drift += moved;
        self.control.speed = speed_squared.sqrt();
        self.control.wave_speed = wave_speed_squared.sqrt();
        Ok(())
    }

    /// World position of a row of a block \[m\]; inside the domain on periodic axes.
    pub(crate) fn position(&self, group: &Group<T, D>, block: [i32; D], row: usize) -> [f64; D] {
        let cells = group.cells(block, row, self.scheme.offset());
        core::array::from_fn(|axis| {
            let inside = match self.walls.period[axis] {
                Some(period) => cells[axis].rem_euclid(period as f64),
                None => cells[axis],
            };
            self.origin[axis] + self.setup.dx * inside
        })
    }

    /// What there is to say of the particles that failed: material, first row, count.
    fn failure(
        &self,
        (material, row, count): (usize, usize, u64),
        dt: f64,
        dt_limit: DtLimit,
    ) -> Failure {
        let group = &self.groups[material];
        // A law says of a chunk only that something in it is wrong.
        let is_bad = |&row: &usize| {
            let mut numbers = group.columns.iter().map(|column| column[row].to_f64());
            !numbers.all(f64::is_finite)
        };
        let bad = (row..group.len()).find(is_bad);
        let row = bad.unwrap_or(row);
        let run = group
            .runs
            .iter()
            .find(|run| run.rows().contains(&row))
            .expect("every row is in a run");
        let position = self.position(group, run.block, row);
        let what = if bad.is_some() {
            "a particle's motion or strain is no longer a finite number".to_owned()
        } else if in_range(run.block) {
            format!("a particle has jumped by more than {MOST_CELLS} cells")
        } else {
            "a particle is too far from the origin to be placed".to_owned()
        };
        Failure {
            what,
            particle: group.id[row],
            material: self.setup.materials[material].name.clone(),
            body: group.body.get(row),
            position: three(position),
            count,
            substep: self.control.substeps + 1,
            time: self.control.time(),
            dt,
            dt_limit,
        }
    }

    fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}

/// Checks everything but the particles.
fn check<const D: usize>(setup: &Setup<D>, laws: usize) -> Result<Walls<D>, SetupError> {
    let dx = setup.dx;
    if !(dx > 0.0 && dx.is_finite()) {
        return setup_error("dx", format!("must be a positive number, not {dx}"));
    }
    if setup.materials.is_empty() || laws != setup.materials.len() {
        return setup_error(
            "materials",
            "there must be at least one, each with its law".into(),
        );
    }
    for material in &setup.materials {
        if !(material.density > 0.0 && material.density.is_finite()) {
            return setup_error(
                &format!("materials.{}.density", material.name),
                format!("must be a positive number, not {}", material.density),
            );
        }
    }
    if setup.gravity.iter().any(|g| !g.is_finite()) {
        return setup_error("gravity", "must be finite".into());
    }
    if setup.kernel == Kernel::Linear && setup.force != ForceForm::Classic {
        return setup_error(
            "kernel",
            "\"linear\" needs force = \"classic\": its inertia D is singular where a particle meets a node".into(),
        );
    }
    if let Transfer::Flip { blend } = setup.transfer
        && !(0.0..=1.0).contains(&blend)
    {
        return setup_error(
            "flip_blend",
            format!("must be from 0 (PIC) to 1 (FLIP), not {blend}"),
        );
    }
    match setup.time_step {
        TimeStep::Fixed(dt) if !(dt > 0.0 && dt.is_finite()) => {
            return setup_error("dt", format!("must be a positive number, not {dt}"));
        }
        TimeStep::Automatic { cfl, .. } if !(cfl > 0.0 && cfl <= 1.0) => {
            return setup_error("cfl", format!("must be above 0 and at most 1, not {cfl}"));
        }
        TimeStep::Automatic { longest, .. } if longest.is_nan() || longest <= 0.0 => {
            return setup_error("dt_max", format!("must be positive, not {longest}"));
        }
        _ => {}
    }
    forces::check(&setup.forces)?;
    for collider in &setup.colliders {
        collider.check()?;
    }
    let walls = Walls::of(setup)?;
    let names = setup.colliders.iter().map(|collider| &*collider.name);
    let boundaries: Vec<&str> = walls.sides().map(|(name, _)| name).chain(names).collect();
    probe::check(setup, &boundaries)?;
    let shortest = crate::kernel::STENCIL as i64;
    for axis in 0..D {
        if walls.period[axis].is_some_and(|period| period < shortest) {
            return setup_error(
                "dx",
                format!(
                    "a periodic axis needs at least {shortest} cells; {} has fewer",
                    ["x", "y", "z"][axis]
                ),
            );
        }
    }
    Ok(walls)
}

/// Checks a batch; `next_id` ids are taken.
fn check_batch<const D: usize>(
    batch: &ParticleBatch<D>,
    setup: &Setup<D>,
    next_id: u32,
) -> Result<(), SetupError> {
    let count = batch.position.len();
    if batch.material >= setup.materials.len() {
        return setup_error(
            "material",
            format!("there is no material {}", batch.material),
        );
    }
    if u32::try_from(count)
        .ok()
        .and_then(|count| next_id.checked_add(count))
        .is_none_or(|last| last == u32::MAX)
    {
        return setup_error(
            "position",
            format!("{count} more particles are more than ids can number"),
        );
    }
    let lengths = [
        ("velocity", batch.velocity.len(), true, true),
        ("volume", batch.volume.len(), false, true),
        ("mass", batch.mass.len(), true, true),
        ("affine", batch.affine.len(), true, false),
    ];
    for (key, len, may_be_empty, may_be_one) in lengths {
        if len != count && !(len == 0 && may_be_empty) && !(len == 1 && may_be_one) && count > 0 {
            return setup_error(key, format!("{len} values for {count} particles"));
        }
    }
    let deformed = match &batch.deformation {
        Deformation::Rest => count,
        Deformation::Jacobian(j) => j.len(),
        Deformation::Gradient(f) => f.len(),
    };
    if deformed != count {
        return setup_error(
            "deformation",
            format!("{deformed} values for {count} particles"),
        );
    }
    let positive = [("volume", &batch.volume), ("mass", &batch.mass)];
    for (key, values) in positive {
        if let Some(i) = values.iter().position(|&x| !(x > 0.0 && x.is_finite())) {
            return setup_error(
                key,
                format!(
                    "of particle {i} must be a positive number, not {}",
                    values[i]
                ),
            );
        }
    }
    let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
    for i in 0..count {
        let ok = finite(&batch.position[i])
            && batch.velocity.get(i).is_none_or(|v| finite(v))
            && batch
                .affine
                .get(i)
                .is_none_or(|c| c.iter().all(|row| finite(row)))
            && match &batch.deformation {
                Deformation::Rest => true,
                Deformation::Jacobian(j) => j[i] > 0.0 && j[i].is_finite(),
                Deformation::Gradient(f) => f[i].iter().all(|row| finite(row)),
            };
        if !ok {
            return setup_error(
                "position",
                format!(
                    "particle {i}: position, velocity, affine and deformation must be finite numbers, and J positive"
                ),
            );
        }
    }
    Ok(())
}

impl<T: Instance<D>, const D: usize> Simulate for Simulation<T, D> {
    fn dimension(&self) -> usize {
        D
    }
    fn precision(&self) -> &'static str {
        T::NAME
    }
    fn isa(&self) -> Isa {
        self.setup.isa
    }
    fn dx(&self) -> f64 {
        self.setup.dx
    }
    fn domain(&self) -> Option<([f64; 3], [f64; 3])> {
        self.setup
            .domain
            .as_ref()
            .map(|domain| (three(domain.min), three(domain.max)))
    }
    fn gravity(&self) -> [f64; 3] {
        three(self.setup.gravity)
    }
    fn materials(&self) -> Vec<String> {
        self.setup
            .materials
            .iter()
            .map(|material| material.name.clone())
            .collect()
    }
    fn time(&self) -> f64 {
        self.control.time()
    }
    fn substeps(&self) -> u64 {
        self.control.substeps
    }
    fn particle_count(&self) -> usize {
        self.groups.iter().map(Group::len).sum()
    }
    fn next_dt(&self) -> (f64, DtLimit) {
        self.control.next()
    }

    fn substep(&mut self) -> Result<Advance, Failure> {
        let (dt, limit) = self.control.next();
        // Dust at rest without gravity has no time scale at all.
        let dt = if dt.is_finite() { dt } else { 1.0 };
        let substeps = self.control.per_fixed();
        for _ in 0..substeps {
            self.substep_of(dt, limit)?;
        }
        Ok(Advance {
            substeps,
            dt_min: dt,
            limit,
        })
    }

    fn advance_while(
        &mut self,
        time: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Advance, Failure> {
        let mut advance = Advance {
            substeps: 0,
            dt_min: f64::INFINITY,
            limit: DtLimit::Frame,
        };
        while let Some((dt, limit)) = self.control.towards(time) {
            if !go_on() {
                return Ok(advance);
            }
            self.substep_of(dt, limit)?;
            advance.substeps += 1;
            if dt < advance.dt_min {
                (advance.dt_min, advance.limit) = (dt, limit);
            }
        }
        self.control.arrived(time);
        Ok(advance)
    }

    fn command(&mut self, command: Command) {
        match command {
            Command::Gravity(gravity) => {
                self.setup.gravity = core::array::from_fn(|axis| gravity[axis]);
                self.control.gravity = Vector(self.setup.gravity).norm();
            }
            Command::Pointer(pointer) => self.pointer = pointer,
            Command::SoundSpeed { material, speed } => {
                let density = self.groups.get(material).map(|group| group.density);
                let bulk_modulus = density.map(|density| density * speed * speed);
                self.stiffen(material, bulk_modulus.filter(|&k| k > 0.0 && k.is_finite()));
            }
        }
    }

    fn begin_frame(&mut self) {
        self.begin();
    }

    fn retry_frame(&mut self, failure: &Failure) -> Option<Retry> {
        self.begin_again(failure)
    }

    fn give_up_frame(&mut self) -> bool {
        Self::give_up_frame(self)
    }

    fn checkpoint(&self) -> Checkpoint {
        self.write()
    }

    fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), CheckpointError> {
        let (state, starts) = self.read(checkpoint)?;
        self.restore(&state);
        self.starts = starts;
        self.mark = None;
        Ok(())
    }

    fn snapshot(&self, fields: &[Field]) -> Snapshot {
        crate::state::snapshot::snapshot(self, fields)
    }

    fn diagnostics(&mut self) -> Diagnostics {
        self.sort_if_drifted();
        crate::state::diagnostics::measure(self)
    }

    fn boundary_impulses(&self) -> Vec<BoundaryImpulse> {
        let of = |name: &str, number: usize| BoundaryImpulse {
            name: name.into(),
            impulse: three(self.taken[number].impulse.0),
            angular_impulse: self.taken[number].angular,
        };
        let sides = self.walls.sides().map(|(name, side)| of(name, side));
        let colliders = self.setup.colliders.iter().zip(2 * D..);
        sides
            .chain(colliders.map(|(collider, number)| of(&collider.name, number)))
            .collect()
    }

    fn take_probe_samples(&mut self) -> Vec<ProbeSamples> {
        self.take_samples()
    }

    fn set_clock(&mut self, clock: fn() -> f64) {
        self.clock = Some(clock);
        self.times = PhaseTimes::default();
    }

    fn phase_times(&self) -> PhaseTimes {
        self.times
    }

    fn memory(&self) -> Memory {
        let blocks = self.grid.block_count();
        Memory {
            blocks,
            nodes: blocks * block_edge(D).pow(D as u32),
            grid_bytes: self.grid.bytes(),
            particle_bytes: self.groups.iter().map(Group::bytes).sum::<usize>()
                + self.sorter.bytes(),
            retry_bytes: self.mark.as_ref().map_or(0, |mark| mark.state.bytes()),
        }
    }
}
