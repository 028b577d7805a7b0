//! Grid to particles: (5)–(8).

use super::stencil::{Quads, Stencils, VelocitySums};
use super::walk::{Cut, Piece, Walk};
use super::{TileCopy, rows, with_scheme};
use crate::boundary::colliders::placed::Moving;
use crate::boundary::colliders::projection::project_out;
use crate::boundary::impulse::Impulse;
use crate::boundary::pointer::ParticlePointer;
use crate::boundary::walls::Walls;
use crate::grid::{Grid, NodeField, Velocity, tile_edge};
use crate::kernel::BSpline;
use crate::material::{IsaToken, Law, load_vector};
use crate::math::{Lanes, Mask, Matrix, Real, Register, Vector};
use crate::particles::{
    AHEAD, CHUNK, ColumnsMut, Group, Largest, Lattice, Layout, Padded, PerParticle, Run,
    block_edge, close_chunk, in_range, open_chunk,
};
use crate::prefetch::prefetch_chunk;
use crate::setup::{Scheme, Transfer};
use fearless_simd::Simd;

/// Results of G2P, for the next time step and for the sort.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// Largest squared speed \[m²/s²\].
    pub(crate) speed_squared: f64,
    /// Largest displacement along an axis \[cells\].
    pub(crate) moved: f64,
    /// Largest wave modulus \[Pa\].
    pub(crate) wave_modulus: f64,
    /// The first row that failed: its new velocity or position is not finite, or out of range. Its old velocity and
    /// position are kept.
    pub(crate) failed: Option<usize>,
    /// Rows that failed.
    pub(crate) failures: u64,
}

impl Found {
    const NOTHING: Self = Self {
        speed_squared: 0.0,
        moved: 0.0,
        wave_modulus: 0.0,
        failed: None,
        failures: 0,
    };

    /// Joins the results of two lists of runs.
    fn and(self, other: Self) -> Self {
        Self {
            speed_squared: self.speed_squared.max(other.speed_squared),
            moved: self.moved.max(other.moved),
            wave_modulus: self.wave_modulus.max(other.wave_modulus),
            failed: match (self.failed, other.failed) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            },
            failures: self.failures + other.failures,
        }
    }
}

/// The largest displacement in a substep \[cells\]; a larger one is a failure. A motion that is resolved is below one cell.
pub(crate) const LARGEST_MOVE: f64 = 100.0;

/// What acts on particles besides the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surroundings<'a, const D: usize> {
    pub(crate) walls: &'a Walls<D>,
    pub(crate) pointer: Option<&'a ParticlePointer<D>>,
    pub(crate) colliders: &'a [Moving<D>],
}

/// Moves the particles of `group` with the grid's `velocities`, in a substep of `dt` \[s\]. Writes the impulses on colliders
/// by particles that are projected out to `impulses`: run after run, collider after collider.
pub(crate) fn gather<T: Lanes, const D: usize>(
    group: &mut Group<T, D>,
    (grid, velocities): (&Grid<T, D>, &NodeField<Velocity, T>),
    surroundings: Surroundings<'_, D>,
    (scheme, lattice): (Scheme, &Lattice<D>),
    isa: IsaToken,
    dt: f64,
    impulses: &mut Vec<Impulse<D>>,
) -> Found {
    let particles = group.len();
    let Group {
        law,
        columns,
        runs,
        mass,
        ..
    } = group;
    let task = Task {
        law: law.as_ref(),
        columns: columns.len(),
        grid,
        velocities,
        mass,
        surroundings,
        scheme,
        lattice,
        isa,
        dt,
        cells_per_velocity: dt / scheme.dx,
        per_dx: 1.0 / scheme.dx,
        affine: scheme.inverse_inertia() / scheme.dx,
    };
    impulses.clear();
    impulses.resize(runs.len() * surroundings.colliders.len(), Impulse::ZERO);
    let data = Data {
        columns: ColumnsMut::new(columns),
        impulses,
    };
    task.walk(runs, particles, data)
}

/// The columns of some runs, and the impulses on colliders by their particles.
struct Data<'a, T, const D: usize> {
    columns: ColumnsMut<'a, T>,
    impulses: &'a mut [Impulse<D>],
}

struct Task<'a, T: Lanes, const D: usize> {
    law: &'a dyn Law<T, D>,
    /// Number of columns.
    columns: usize,
    grid: &'a Grid<T, D>,
    velocities: &'a NodeField<Velocity, T>,
    mass: &'a PerParticle<T>,
    surroundings: Surroundings<'a, D>,
    scheme: Scheme,
    lattice: &'a Lattice<D>,
    isa: IsaToken,
    dt: f64,
    /// The factor Δt / dx.
    cells_per_velocity: f64,
    /// The factor 1 / dx.
    per_dx: f64,
    /// The factor D⁻¹ dx.
    affine: f64,
}

impl<'a, T: Lanes, const D: usize> Walk<D> for Task<'a, T, D> {
    type Data = Data<'a, T, D>;
    type Found = Found;

    fn cut(&self, data: Self::Data, cut: Cut) -> (Self::Data, Self::Data) {
        let (low_columns, high_columns) = data.columns.split_at(cut.rows);
        let colliders = self.surroundings.colliders.len();
        let (low, high) = data.impulses.split_at_mut(cut.runs * colliders);
        let low = Data {
            columns: low_columns,
            impulses: low,
        };
        let high = Data {
            columns: high_columns,
            impulses: high,
        };
        (low, high)
    }

    fn work(&self, piece: Piece<'_, Self::Data, D>) -> Found {
        with_scheme!(self.scheme, self.isa, simd, K, SPLIT, CLASSIC => {
            self.runs::<_, K, SPLIT, CLASSIC>(simd, piece)
        })
    }

    fn join(&self, low: Found, high: Found) -> Found {
        low.and(high)
    }
}

impl<T: Lanes, const D: usize> Task<'_, T, D> {
    /// Moves the particles of some runs.
    #[inline(always)]
    fn runs<S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        piece: Piece<'_, Data<'_, T, D>, D>,
    ) -> Found {
        let Piece {
            runs,
            first_row,
            data: Data {
                mut columns,
                impulses,
            },
        } = piece;
        let (mut buffers, mut padded) = (Buffers::new(), Padded::new());
        let mut copies = padded.columns();
        let mut tile = TileCopy::new();
        let mut found = Found::NOTHING;
        for (index, run) in runs.iter().enumerate() {
            tile.load(simd, self.grid, self.velocities, &runs[index..]);
            let mut of_run = self.run::<_, K, SPLIT, CLASSIC>(
                simd,
                run,
                first_row,
                &tile.0,
                (&mut columns, &mut copies),
                &mut buffers,
            );
            let colliders = self.surroundings.colliders.len();
            let impulses = &mut impulses[index * colliders..][..colliders];
            self.project_out(run, first_row, &mut columns, impulses, &mut of_run);
            found = found.and(of_run);
        }
        found
    }

    /// Moves the particles of one run, which read the nodes of `tile`.
    #[inline(always)]
    fn run<'c, S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        run: &Run<D>,
        first_row: usize,
        tile: &[T],
        (columns, copies): (&mut ColumnsMut<'c, T>, &mut ColumnsMut<'c, T>),
        buffers: &mut Buffers<T>,
    ) -> Found {
        let limits = Limits {
            bounds: self.bounds(run),
            pointer: (self.surroundings.pointer)
                .map(|pointer| pointer.relative_to(self.lattice.middle(run.block))),
            cushion: self.cushion(run),
        };
        let mut maxima = Maxima::none();
        let (mut failed, mut failures) = (None, 0);
        for row in run.rows().step_by(CHUNK) {
            let start = row - first_row;
            prefetch_chunk(&columns.slices[..self.columns], start + AHEAD);
            let count = CHUNK.min(run.end as usize - row);
            let (rows, at) = open_chunk(columns, copies, self.columns, start, count);
            let rows = &mut rows.slices[..self.columns];
            let of_chunk = self.chunk::<_, K, SPLIT, CLASSIC>(
                simd,
                at..at + count,
                tile,
                &limits,
                rows,
                buffers,
                &mut maxima,
            );
            let strain = &mut rows[Layout::strain(D)..];
            let (increment, modulus) = (&buffers.sums.increment, &mut maxima.wave_modulus);
            self.law
                .advance(self.isa, strain, at, count, increment, modulus);
            close_chunk(columns, copies, self.columns, start, count);
            failed = failed.or(of_chunk.0.map(|p| row + p));
            failures += of_chunk.1;
        }
        let mut wave_modulus = maxima.wave_modulus.get();
        if !wave_modulus.is_finite() {
            wave_modulus = 0.0;
            failed = failed.or(Some(run.start as usize));
            failures = failures.max(1);
        }
        if !in_range(run.block) {
            // One more move can still be told from the present position, two cannot.
            failed = Some(run.start as usize);
            failures = run.rows().len() as u64;
        }
        Found {
            speed_squared: maxima.speed_squared.get(),
            moved: maxima.moved.get(),
            wave_modulus,
            failed,
            failures,
        }
    }

    /// Projects the particles of `run` that are inside a collider onto its surface.
    fn project_out(
        &self,
        run: &Run<D>,
        first_row: usize,
        columns: &mut ColumnsMut<'_, T>,
        impulses: &mut [Impulse<D>],
        found: &mut Found,
    ) {
        let colliders = self.surroundings.colliders;
        let middle = self.lattice.middle(run.block);
        // Particles may be one cell outside of their block, and have moved since.
        let reach = (0.5 * block_edge(D) as f64 + 1.0 + found.moved) * (D as f64).sqrt();
        let is_near = |collider: &Moving<D>| collider.end.distance(middle).0 <= reach;
        if !colliders.iter().any(is_near) {
            return;
        }
        let mut farthest = 0.0_f64;
        for row in run.rows() {
            let at = row - first_row;
            let stored: [f64; D] = core::array::from_fn(|axis| columns.slices[axis][at].to_f64());
            let mut x = Vector(stored);
            let mut v =
                Vector::from_fn(|axis| columns.slices[Layout::velocity(D) + axis][at].to_f64());
            let mass = self.mass.get(row).to_f64();
            let was_inside = project_out(
                colliders,
                &self.surroundings.walls.bounds,
                middle,
                (&mut x, &mut v),
                self.scheme.dx,
                |number, at, change| impulses[number].add(at.0, change * -mass), // (13)
            );
            if !was_inside {
                continue;
            }
            found.speed_squared = found.speed_squared.max(v.dot(v));
            for axis in 0..D {
                farthest = farthest.max((x[axis] - stored[axis]).abs());
                columns.slices[axis][at] = T::from_f64(x[axis]);
                columns.slices[Layout::velocity(D) + axis][at] = T::from_f64(v[axis]);
            }
        }
        found.moved += farthest;
    }

    /// The cushion, relative to the block of `run`.
    fn cushion(&self, run: &Run<D>) -> Option<([(T, T); D], T)> {
        let cushion = self.surroundings.walls.cushion.as_ref()?;
        let middle = self.lattice.middle(run.block);
        let range = core::array::from_fn(|axis| {
            let (low, high) = (cushion.low[axis], cushion.high[axis]);
            (
                T::from_f64(low - middle[axis]),
                T::from_f64(high - middle[axis]),
            )
        });
        Some((range, T::from_f64(cushion.speed)))
    }

    /// The bounds of positions, relative to the block of `run`; `None` if no wall is near.
    fn bounds(&self, run: &Run<D>) -> Option<[(T, T); D]> {
        let edge = block_edge(D) as f64;
        let middle = self.lattice.middle(run.block);
        let mut near = false;
        let range = core::array::from_fn(|axis| {
            let (low, high) = self.surroundings.walls.bounds[axis];
            let (low, high) = (
                low.map_or(f64::NEG_INFINITY, |x| x - middle[axis]),
                high.map_or(f64::INFINITY, |x| x - middle[axis]),
            );
            // One block further than particles can drift and then move.
            near |= low > -2.0 * edge || high < 2.0 * edge;
            (T::from_f64(low.max(-1e30)), T::from_f64(high.min(1e30)))
        });
        near.then_some(range)
    }

    /// (5), (6), (8) for the particles at `rows` of `columns`; leaves Δt ∂v/∂x in the buffers for the law. Returns the first
    /// of them that failed, counted from the start of `rows`, and how many did.
    #[expect(
        clippy::too_many_arguments,
        reason = "the innermost function: constant and changing parts are separate arguments"
    )]
    #[inline(always)]
    fn chunk<S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        rows: core::ops::Range<usize>,
        tile: &[T],
        limits: &Limits<T, D>,
        columns: &mut [&mut [T]],
        buffers: &mut Buffers<T>,
        maxima: &mut Maxima<T>,
    ) -> (Option<usize>, u64) {
        let (start, count) = (rows.start, rows.len());
        let Buffers { stencils, sums } = buffers;
        let columns = &mut columns[..Layout::strain(D)];
        let mut p = 0;
        while p < count {
            stencils.place::<S, D, K, CLASSIC>(load_vector(simd, columns, start + p), p);
            p += T::WIDTH;
        }
        let sizes = (tile_edge::<D>(K::NODES), self.grid.tile_layer());
        // Lanes past the end repeat the last particle, so that maxima are those of particles.
        for p in (0..p).step_by(4) {
            rows::gather::<S, T, D, K, SPLIT, CLASSIC>(simd, stencils, p, sizes, tile, sums);
        }

        let zero = T::broadcast(simd, T::default());
        let (mut failed, mut failures) = (None, 0);
        let mut p = 0;
        while p < count {
            let u = load_vector::<S, T, D>(simd, columns, start + p);
            let old_v = load_vector::<S, T, D>(simd, &columns[Layout::velocity(D)..], start + p);
            let v = load_quads::<S, T, D>(simd, &sums.moments[0], p); // (5)
            let mut gradient = Matrix([v; D]);
            let mut c = gradient;
            for axis in 0..D {
                gradient.0[axis] =
                    load_quads::<S, T, D>(simd, &sums.gradients[axis], p) * zero.lit(self.per_dx);
                // B = Σ w v rᵀ = dx (Σ w v n − v s), n and s from the center; C = B D⁻¹
                let s = u[axis] - u[axis].floor() + zero.lit(K::OFFSET - K::CENTER as f64);
                let moment = load_quads::<S, T, D>(simd, &sums.moments[1 + axis], p);
                c.0[axis] = (moment - v * s) * zero.lit(self.affine); // (6), (3)
            }
            if !K::INVERSE_INERTIA.is_finite() {
                c = gradient;
            }
            let increment = if CLASSIC { gradient } else { c } * zero.lit(self.dt);
            let mut new_v = v;
            if let Transfer::Flip { blend } = self.scheme.transfer {
                let change = load_quads::<S, T, D>(simd, &sums.change, p);
                new_v = (old_v + change) * zero.lit(blend) + v * zero.lit(1.0 - blend);
            }
            let step = v * zero.lit(self.cells_per_velocity);
            let mut new_u = u + step; // (8)
            if let Some(bounds) = &limits.bounds {
                for axis in 0..D {
                    new_u[axis] = new_u[axis]
                        .max(zero.splat(bounds[axis].0))
                        .min(zero.splat(bounds[axis].1));
                }
            }

            if let Some(pointer) = &limits.pointer {
                new_v = pointer.act(new_v, new_u); // (12)
            }
            if let Some((cushion, speed)) = &limits.cushion {
                let speed = zero.splat(*speed);
                for axis in 0..D {
                    let lowest = (zero.splat(cushion[axis].0) - new_u[axis]) * speed;
                    let highest = (zero.splat(cushion[axis].1) - new_u[axis]) * speed;
                    new_v[axis] = new_v[axis].max(lowest).min(highest);
                }
            }

            // x times zero is zero, or not a number if x is not finite.
            let mut largest = zero;
            let mut check = zero;
            for axis in 0..D {
                largest = largest.max(step[axis].abs());
                check += (step[axis] + new_v[axis]) * zero;
                for i in 0..D {
                    check += increment[(i, axis)] * zero;
                }
            }
            let good = check.ge(zero) & largest.le(zero.lit(LARGEST_MOVE));
            if !good.all() {
                for lane in 0..T::WIDTH.min(count - p) {
                    let whole = check.lane(lane) >= T::default();
                    if !whole || largest.lane(lane) > T::from_f64(LARGEST_MOVE) {
                        failed = failed.or(Some(p + lane));
                        failures += 1;
                    }
                }
            }
            maxima
                .moved
                .include(simd, Real::select(good, largest, zero));
            maxima
                .speed_squared
                .include(simd, Real::select(good, new_v.dot(new_v), zero));

            for i in 0..D {
                let new_u = Real::select(good, new_u[i], u[i]);
                T::store::<S>(new_u, &mut columns[i][start + p..]);
                let new_v = Real::select(good, new_v[i], old_v[i]);
                T::store::<S>(new_v, &mut columns[Layout::velocity(D) + i][start + p..]);
            }
            for j in 0..D {
                for i in 0..D {
                    let place = j * D + i;
                    T::store::<S>(
                        c[(i, j)],
                        &mut columns[Layout::affine(D) + place][start + p..],
                    );
                    T::store::<S>(increment[(i, j)], &mut sums.increment[place][p..]);
                }
            }
            p += T::WIDTH;
        }

        (failed, failures)
    }
}

/// The largest numbers among a run's particles, as in [`Found`].
struct Maxima<T> {
    speed_squared: Largest<T>,
    moved: Largest<T>,
    wave_modulus: Largest<T>,
}

impl<T: Lanes> Maxima<T> {
    fn none() -> Self {
        Self {
            speed_squared: Largest::none(),
            moved: Largest::none(),
            wave_modulus: Largest::none(),
        }
    }
}

/// Limits on positions and velocities of a run's particles. Positions are relative to the block, (lowest, highest) on each
/// axis.
struct Limits<T, const D: usize> {
    /// The interval that positions are clamped to: `None` if no wall is near.
    bounds: Option<[(T, T); D]>,
    pointer: Option<ParticlePointer<D>>,
    /// The box of the cushion, and the speed that crosses a cell in its time.
    cushion: Option<([(T, T); D], T)>,
}

/// The buffers of one thread.
struct Buffers<T> {
    stencils: Stencils<T>,
    sums: VelocitySums<T>,
}

impl<T: Lanes> Buffers<T> {
    fn new() -> Self {
        Self {
            stencils: Stencils::new(),
            sums: VelocitySums::new(),
        }
    }
}

/// Loads a vector of a register of particles from their quads.
#[inline(always)]
fn load_quads<S: Simd, T: Lanes, const D: usize>(
    simd: S,
    quads: &Quads<T>,
    p: usize,
) -> Vector<T::Of<S>, D> {
    let quad = T::load_quads(simd, &quads[4 * p..]);
    let mut v = Vector([quad[0]; D]);
    for axis in 1..D {
        v[axis] = quad[axis];
    }
    v
}
