//! Diagnostics: totals over all particles, in f64 and in a fixed order. They are one row of diagnostics.csv.

use super::State;
use super::workspace::Workspace;
use crate::instance::Instance;
use crate::parallel;
use crate::particles::{DRIFT_LIMIT, Group, Layout, PerParticle, Run};
use crate::setup::check::CheckedSetup;
use crate::setup::{Transfer, to_3d};

/// Totals over all particles at one moment; see [`Simulate::diagnostics`](crate::Simulate::diagnostics). Vectors have three
/// components. In 2D the third is zero, but for angular momentum, where it is the only one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Simulated time \[s\].
    pub time: f64,
    /// Number of substeps since the start.
    pub substeps: u64,
    /// Shortest substep since the frame began \[s\]; 0 if there was none.
    pub dt_min: f64,
    /// The limit of that substep, by [`DtLimit::name`](crate::DtLimit::name).
    pub dt_limit: &'static str,
    /// Number of particles.
    pub particles: u64,
    /// Σ over groups of equal particles of count × mass \[kg\].
    pub mass: f64,
    /// Σ m v \[kg m/s\].
    pub momentum: [f64; 3],
    /// Σ m x × v + what the affine matrices carry \[kg m²/s\], about the origin.
    pub angular_momentum: [f64; 3],
    /// Σ ½ m v² \[J\].
    pub kinetic_energy: f64,
    /// Σ V⁰ Φ \[J\].
    pub elastic_energy: f64,
    /// −Σ m g·x \[J\].
    pub potential_energy: f64,
    /// Largest particle speed \[m/s\].
    pub max_speed: f64,
    /// Volume of the space that is filled: Σ over cells of min(1, rest volume in it / dxᴰ) dxᴰ \[m³\].
    pub volume: f64,
    /// Σ J V⁰ \[m³\].
    pub particle_volume: f64,
    /// Number of particles that have left through open sides since the start.
    pub escaped: u64,
    /// Mass of the particles that have left \[kg\].
    pub escaped_mass: f64,
}

/// Measures the totals. If the next substep would sort, they are those of a sorted copy, so that sums have the
/// same order whoever asks and whenever.
pub(crate) fn measure<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    workspace: &Workspace<T, D>,
) -> Diagnostics {
    // A grid of its own, since P2G of volumes writes to the tiles.
    let mut workspace = workspace.for_measuring();
    if state.drift > DRIFT_LIMIT {
        let mut sorted = state.clone();
        workspace.sort_if_drifted(scene, &mut sorted);
        measure_sorted(scene, &sorted, &mut workspace)
    } else {
        measure_sorted(scene, state, &mut workspace)
    }
}

/// Measures the totals of particles that are inside of their blocks' tiles.
fn measure_sorted<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    workspace: &mut Workspace<T, D>,
) -> Diagnostics {
    let control = &state.control;
    let (dt_min, dt_limit) = control.shortest();
    let mut row = Diagnostics {
        time: control.time(),
        substeps: control.substeps,
        dt_min,
        dt_limit: dt_limit.name(),
        volume: workspace.filled_volume(state),
        escaped: state.escaped.count,
        escaped_mass: state.escaped.mass,
        ..Diagnostics::default()
    };
    let dx = scene.lattice.dx;
    let per_inertia = scene.setup.kernel.inverse_inertia();
    let spin = match scene.setup.transfer {
        Transfer::Apic if per_inertia.is_finite() => dx * dx / per_inertia,
        Transfer::Apic | Transfer::Pic | Transfer::Flip { .. } => 0.0,
    };
    let mut total = Totals::default();
    for group in &state.groups {
        row.particles += group.len() as u64;
        row.mass += match &group.mass {
            PerParticle::Uniform(mass) => mass.to_f64() * group.len() as f64,
            PerParticle::Each(_) => 0.0,
        };
        // Each block's own totals, then those in order: sums do not depend on the number of threads.
        let mut of_blocks = vec![Totals::default(); group.runs.len()];
        let grain = parallel::grain(of_blocks.len(), SMALLEST_PIECE);
        parallel::for_chunks(&mut of_blocks, 1, 0, grain, &|first, piece| {
            let mut strain = vec![0.0; group.law.strain_columns()];
            for (run, totals) in group.runs[first..].iter().zip(piece) {
                *totals = Totals::of(scene, state.gravity, group, run, spin, &mut strain);
            }
        });
        for block in &of_blocks {
            total.add(block);
        }
    }
    row.mass += total.each_mass;
    row.momentum = total.momentum;
    row.angular_momentum = total.angular_momentum;
    row.kinetic_energy = total.kinetic_energy;
    row.elastic_energy = total.elastic_energy;
    row.potential_energy = total.potential_energy;
    row.max_speed = total.max_speed_squared.sqrt();
    row.particle_volume = total.particle_volume;
    row
}

/// The smallest number of blocks that is worth a piece of work of its own.
const SMALLEST_PIECE: usize = 16;

/// Sums over particles, for the fields of [`Diagnostics`].
#[derive(Clone, Copy, Default)]
struct Totals {
    /// Mass of the particles of groups in which masses differ.
    each_mass: f64,
    momentum: [f64; 3],
    angular_momentum: [f64; 3],
    kinetic_energy: f64,
    elastic_energy: f64,
    potential_energy: f64,
    max_speed_squared: f64,
    particle_volume: f64,
}

impl Totals {
    /// Sums over the particles of one block; `strain` is a buffer for the strain of one particle.
    fn of<T: Instance<D>, const D: usize>(
        scene: &CheckedSetup<D>,
        gravity: [f64; D],
        group: &Group<T, D>,
        run: &Run<D>,
        spin: f64,
        strain: &mut [f64],
    ) -> Self {
        let gravity = to_3d(gravity);
        let at = |column: usize, p: usize| group.columns[column][p].to_f64();
        let mut totals = Self::default();
        for p in run.rows() {
            let x = to_3d(group.position(&scene.lattice, run.block, p));
            let v = to_3d(core::array::from_fn::<f64, D, _>(|axis| {
                at(Layout::velocity(D) + axis, p)
            }));
            let c = |i: usize, j: usize| {
                if i < D && j < D {
                    at(Layout::affine(D) + j * D + i, p)
                } else {
                    0.0
                }
            };
            let m = group.mass.get(p).to_f64();
            if matches!(group.mass, PerParticle::Each(_)) {
                totals.each_mass += m;
            }
            for axis in 0..3 {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                totals.momentum[axis] += m * v[axis];
                totals.angular_momentum[axis] +=
                    m * (x[i] * v[j] - x[j] * v[i] + spin * (c(j, i) - c(i, j)));
                totals.potential_energy -= m * gravity[axis] * x[axis];
            }
            let speed_squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            totals.kinetic_energy += 0.5 * m * speed_squared;
            totals.max_speed_squared = totals.max_speed_squared.max(speed_squared);
            for (column, value) in strain.iter_mut().enumerate() {
                *value = at(Layout::strain(D) + column, p);
            }
            let stored = group.law.energy(strain);
            let volume0 = group.volume0.get(p).to_f64();
            totals.elastic_energy += volume0 * stored.energy_density;
            totals.particle_volume += volume0 * stored.jacobian;
        }
        totals
    }

    fn add(&mut self, other: &Self) {
        self.each_mass += other.each_mass;
        for axis in 0..3 {
            self.momentum[axis] += other.momentum[axis];
            self.angular_momentum[axis] += other.angular_momentum[axis];
        }
        self.kinetic_energy += other.kinetic_energy;
        self.elastic_energy += other.elastic_energy;
        self.potential_energy += other.potential_energy;
        self.max_speed_squared = self.max_speed_squared.max(other.max_speed_squared);
        self.particle_volume += other.particle_volume;
    }
}
