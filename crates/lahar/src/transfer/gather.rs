//! Grid to particles: (5)–(8).

use super::scatter::stencil;
use super::{Stage, TileCopy, rows, with_scheme};
use crate::boundary::collider::Moving;
use crate::boundary::impulse::Taken;
use crate::boundary::pointer::Push;
use crate::boundary::surface::put_out;
use crate::boundary::walls::Walls;
use crate::grid::{Grid, tile_edge};
use crate::kernel::BSpline;
use crate::material::{IsaToken, load_vector};
use crate::math::{Lanes, Mask, Matrix, Real, Register, Vector};
use crate::parallel;
use crate::particles::in_range;
use crate::particles::{AHEAD, CHUNK, Largest, Padded, close_chunk, open_chunk};
use crate::particles::{ColumnsMut, Group, Layout, PerParticle, Run, block_edge, split_runs};
use crate::prefetch::prefetch_chunk;
use crate::setup::Scheme;
use crate::setup::Transfer;
use fearless_simd::Simd;

/// What a gather found out, for the next time step and for the sort.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// Largest squared speed \[m²/s²\].
    pub(crate) speed_squared: f64,
    /// Largest move along an axis \[cells\].
    pub(crate) moved: f64,
    /// Largest wave modulus \[Pa\].
    pub(crate) wave_modulus: f64,
    /// The first row whose new velocity or position is not a number, or too far to be one; its old
    /// velocity and position are kept.
    pub(crate) failed: Option<usize>,
    /// How many there are.
    pub(crate) failures: u64,
}

impl Bounds {
    pub(crate) const NONE: Self = Self {
        speed_squared: 0.0,
        moved: 0.0,
        wave_modulus: 0.0,
        failed: None,
        failures: 0,
    };

    pub(crate) fn and(self, other: Self) -> Self {
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

/// A move of more cells than this in a substep is taken for a failure: nothing that is to be resolved moves
/// by more than one.
pub(crate) const MOST_CELLS: f64 = 100.0;

/// What acts on particles besides the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around<'a, const D: usize> {
    pub(crate) walls: &'a Walls<D>,
    pub(crate) push: Option<&'a Push<D>>,
    pub(crate) colliders: &'a [Moving<D>],
}

/// Moves the particles of `group` with the grid's velocities. What colliders take from each run of
/// particles that they put out comes to `taken`: run after run, collider after collider.
pub(crate) fn gather<T: Lanes, const D: usize>(
    group: &mut Group<T, D>,
    grid: &Grid<T, D>,
    around: Around<'_, D>,
    scheme: Scheme,
    isa: IsaToken,
    dt: f64,
    taken: &mut Vec<Taken<D>>,
) -> Bounds {
    let grain = parallel::grain(group.len(), 4096);
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
        mass,
        around,
        scheme,
        isa,
        dt,
        cells_per_velocity: dt / scheme.dx,
        per_dx: 1.0 / scheme.dx,
        affine: scheme.inverse_inertia() / scheme.dx,
    };
    taken.clear();
    taken.resize(runs.len() * around.colliders.len(), Taken::NOTHING);
    task.halve(runs, 0, ColumnsMut::new(columns), taken, grain)
}

struct Task<'a, T: Lanes, const D: usize> {
    law: &'a dyn crate::material::Law<T, D>,
    /// How many columns there are.
    columns: usize,
    grid: &'a Grid<T, D>,
    mass: &'a PerParticle<T>,
    around: Around<'a, D>,
    scheme: Scheme,
    isa: IsaToken,
    dt: f64,
    /// Δt / dx, 1 / dx, and D⁻¹ dx.
    cells_per_velocity: f64,
    per_dx: f64,
    affine: f64,
}

impl<T: Lanes, const D: usize> Task<'_, T, D> {
    /// `columns` begin with row `first_row`.
    fn halve(
        &self,
        runs: &[Run<D>],
        first_row: usize,
        columns: ColumnsMut<'_, T>,
        taken: &mut [Taken<D>],
        grain: usize,
    ) -> Bounds {
        let Some((middle, row)) = split_runs(runs, grain) else {
            let _flush = crate::float_mode::FlushToZero::enter();
            return with_scheme!(self.scheme, self.isa, simd, K, SPLIT, CLASSIC => {
                self.blocks::<_, K, SPLIT, CLASSIC>(simd, runs, first_row, columns, taken)
            });
        };
        let (low, high) = runs.split_at(middle);
        let (low_columns, high_columns) = columns.split_at(row - first_row);
        let (low_taken, high_taken) = taken.split_at_mut(middle * self.around.colliders.len());
        let (a, b) = parallel::join(
            || self.halve(low, first_row, low_columns, low_taken, grain),
            || self.halve(high, row, high_columns, high_taken, grain),
        );
        a.and(b)
    }

    /// Moves the particles of `runs`.
    #[inline(always)]
    fn blocks<S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        runs: &[Run<D>],
        first_row: usize,
        columns: ColumnsMut<'_, T>,
        taken: &mut [Taken<D>],
    ) -> Bounds {
        let (mut stage, mut padded) = (Stage::new(), Padded::new());
        let (mut columns, mut copies) = (columns, padded.columns());
        let mut tile = TileCopy::new();
        let mut bounds = Bounds::NONE;
        for (index, run) in runs.iter().enumerate() {
            tile.load(simd, self.grid, &runs[index..]);
            let mut found = self.block::<_, K, SPLIT, CLASSIC>(
                simd,
                run,
                first_row,
                &tile.0,
                &mut columns,
                &mut copies,
                &mut stage,
            );
            let colliders = self.around.colliders.len();
            let of_run = &mut taken[index * colliders..][..colliders];
            self.put_out(run, first_row, &mut columns, of_run, &mut found);
            bounds = bounds.and(found);
        }
        bounds
    }

    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "what does not change comes apart from what does"
    )]
    fn block<'c, S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        run: &Run<D>,
        first_row: usize,
        tile: &[T],
        columns: &mut ColumnsMut<'c, T>,
        copies: &mut ColumnsMut<'c, T>,
        stage: &mut Stage<T>,
    ) -> Bounds {
        let plane = self.grid.tile_plane();
        let keep = Keep {
            hold: self.hold(run),
            push: self.push(run),
            cushion: self.cushion(run),
        };
        let mut most = Most::none();
        let (mut failed, mut failures) = (None, 0);
        for row in run.rows().step_by(CHUNK) {
            let start = row - first_row;
            prefetch_chunk(&columns.slices[..self.columns], start + AHEAD);
            let count = CHUNK.min(run.end as usize - row);
            let (rows, at) = open_chunk(columns, copies, self.columns, start, count);
            let rows = &mut rows.slices[..self.columns];
            let found = chunk::<_, T, D, K, SPLIT, CLASSIC>(
                simd, self, at, count, plane, tile, &keep, rows, stage, &mut most,
            );
            let strain = &mut rows[Layout::strain(D)..];
            let modulus = &mut most.wave_modulus;
            self.law
                .advance(self.isa, strain, at, count, &stage.matrix, modulus);
            close_chunk(columns, copies, self.columns, start, count);
            failed = failed.or(found.0.map(|p| row + p));
            failures += found.1;
        }
        let mut wave_modulus = most.wave_modulus.get();
        if !wave_modulus.is_finite() {
            wave_modulus = 0.0;
            failed = failed.or(Some(run.start as usize));
            failures = failures.max(1);
        }
        if !in_range(run.block) {
            // One more move can still be told from where it is, two may not.
            failed = Some(run.start as usize);
            failures = run.rows().len() as u64;
        }
        Bounds {
            speed_squared: most.speed_squared.get(),
            moved: most.moved.get(),
            wave_modulus,
            failed,
            failures,
        }
    }

    /// The hand as this block's particles see it.
    fn push(&self, run: &Run<D>) -> Option<Push<D>> {
        let push = self.around.push?;
        let edge = block_edge(D) as f64;
        let middle = |block| edge * (f64::from(block) + 0.5) + self.scheme.offset();
        Some(push.seen_from(run.block.map(middle)))
    }

    /// Puts the particles of `run` that are inside a collider on its surface.
    fn put_out(
        &self,
        run: &Run<D>,
        first_row: usize,
        columns: &mut ColumnsMut<'_, T>,
        taken: &mut [Taken<D>],
        bounds: &mut Bounds,
    ) {
        let edge = block_edge(D) as f64;
        let middle = run
            .block
            .map(|b| edge * (f64::from(b) + 0.5) + self.scheme.offset());
        // Particles may be a cell out of their block, and have moved once more.
        let reach = (0.5 * edge + 1.0 + bounds.moved) * (D as f64).sqrt();
        let is_near = |collider: &Moving<D>| collider.end.distance(middle).0 <= reach;
        if !self.around.colliders.iter().any(is_near) {
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
            let was_inside = put_out(
                self.around.colliders,
                &self.around.walls.hold,
                middle,
                (&mut x, &mut v),
                self.scheme.dx,
                |number, at, change| taken[number].add(at.0, change * -mass), // (13)
            );
            if !was_inside {
                continue;
            }
            bounds.speed_squared = bounds.speed_squared.max(v.dot(v));
            for axis in 0..D {
                farthest = farthest.max((x[axis] - stored[axis]).abs());
                columns.slices[axis][at] = T::from_f64(x[axis]);
                columns.slices[Layout::velocity(D) + axis][at] = T::from_f64(v[axis]);
            }
        }
        bounds.moved += farthest;
    }

    /// The cushion as this block's particles see it.
    fn cushion(&self, run: &Run<D>) -> Option<([(T, T); D], T)> {
        let cushion = self.around.walls.cushion.as_ref()?;
        let edge = block_edge(D) as f64;
        let range = core::array::from_fn(|axis| {
            let middle = edge * (f64::from(run.block[axis]) + 0.5) + self.scheme.offset();
            (
                T::from_f64(cushion.low[axis] - middle),
                T::from_f64(cushion.high[axis] - middle),
            )
        });
        Some((range, T::from_f64(cushion.speed)))
    }

    /// Where this block's particles may be, as stored: `None` if no wall is near.
    fn hold(&self, run: &Run<D>) -> Option<[(T, T); D]> {
        let edge = block_edge(D) as f64;
        let offset = self.scheme.offset();
        let mut near = false;
        let range = core::array::from_fn(|axis| {
            let middle = edge * (f64::from(run.block[axis]) + 0.5) + offset;
            let (low, high) = self.around.walls.hold[axis];
            let (low, high) = (
                low.map_or(f64::NEG_INFINITY, |x| x - middle),
                high.map_or(f64::INFINITY, |x| x - middle),
            );
            // One block further than particles can drift and then move.
            near |= low > -2.0 * edge || high < 2.0 * edge;
            (T::from_f64(low.max(-1e30)), T::from_f64(high.min(1e30)))
        });
        near.then_some(range)
    }
}

/// The largest numbers among a block's particles, as in [`Bounds`].
struct Most<T> {
    speed_squared: Largest<T>,
    moved: Largest<T>,
    wave_modulus: Largest<T>,
}

impl<T: Lanes> Most<T> {
    fn none() -> Self {
        Self {
            speed_squared: Largest::none(),
            moved: Largest::none(),
            wave_modulus: Largest::none(),
        }
    }
}

/// What pushes a block's particles and keeps them in; positions as stored, (lowest, highest) on each axis.
struct Keep<T, const D: usize> {
    /// Where they may be: `None` if no wall is near.
    hold: Option<[(T, T); D]>,
    /// The hand.
    push: Option<Push<D>>,
    /// Where they are slowed down to stay, and the speed that crosses a cell in the time it looks ahead.
    cushion: Option<([(T, T); D], T)>,
}

/// A vector of a register of particles from their quads.
#[inline(always)]
fn load_quads<S: Simd, T: Lanes, const D: usize>(
    simd: S,
    quads: &[T; 4 * CHUNK],
    p: usize,
) -> Vector<T::Of<S>, D> {
    let quad = T::load_quads(simd, &quads[4 * p..]);
    let mut v = Vector([quad[0]; D]);
    for axis in 1..D {
        v[axis] = quad[axis];
    }
    v
}

/// (5), (6), (8) for particles `start .. start + count`; leaves Δt ∂v/∂x in the stage for the law. Returns the
/// first of them that failed, and how many did.
#[expect(
    clippy::too_many_arguments,
    reason = "the innermost function: what does not change comes apart from what does"
)]
#[inline(always)]
fn chunk<S: Simd, T: Lanes, const D: usize, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
    simd: S,
    task: &Task<'_, T, D>,
    start: usize,
    count: usize,
    plane: usize,
    tile: &[T],
    keep: &Keep<T, D>,
    columns: &mut [&mut [T]],
    stage: &mut Stage<T>,
    most: &mut Most<T>,
) -> (Option<usize>, u64) {
    let columns = &mut columns[..Layout::strain(D)];
    let mut p = 0;
    while p < count {
        stencil::<S, T, D, K, CLASSIC>(load_vector(simd, columns, start + p), p, stage);
        p += T::WIDTH;
    }
    // Lanes past the end repeat the last particle, so that maxima are those of particles.
    for p in (0..p).step_by(4) {
        rows::gather::<S, T, D, K, SPLIT, CLASSIC>(
            simd,
            stage,
            p,
            tile_edge::<D>(K::NODES),
            plane,
            tile,
        );
    }

    let zero = T::broadcast(simd, T::default());
    let (mut failed, mut failures) = (None, 0);
    let mut p = 0;
    while p < count {
        let u = load_vector::<S, T, D>(simd, columns, start + p);
        let old_v = load_vector::<S, T, D>(simd, &columns[Layout::velocity(D)..], start + p);
        let v = load_quads::<S, T, D>(simd, &stage.momentum[0], p); // (5)
        let mut gradient = Matrix([v; D]);
        let mut c = gradient;
        for axis in 0..D {
            gradient.0[axis] =
                load_quads::<S, T, D>(simd, &stage.impulse[1 + axis], p) * zero.lit(task.per_dx);
            // B = Σ w v rᵀ = dx (Σ w v n − v s), n and s from the centre; C = B D⁻¹
            let s = u[axis] - u[axis].floor() + zero.lit(K::OFFSET - K::CENTRE as f64);
            let moment = load_quads::<S, T, D>(simd, &stage.momentum[1 + axis], p);
            c.0[axis] = (moment - v * s) * zero.lit(task.affine); // (6), (3)
        }
        if !K::INVERSE_INERTIA.is_finite() {
            c = gradient;
        }
        let increment = if CLASSIC { gradient } else { c } * zero.lit(task.dt);
        let mut new_v = v;
        if let Transfer::Flip { blend } = task.scheme.transfer {
            let change = load_quads::<S, T, D>(simd, &stage.impulse[0], p);
            new_v = (old_v + change) * zero.lit(blend) + v * zero.lit(1.0 - blend);
        }
        let step = v * zero.lit(task.cells_per_velocity);
        let mut new_u = u + step; // (8)
        if let Some(hold) = &keep.hold {
            for axis in 0..D {
                new_u[axis] = new_u[axis]
                    .max(zero.splat(hold[axis].0))
                    .min(zero.splat(hold[axis].1));
            }
        }

        if let Some(push) = &keep.push {
            new_v = push.act(new_v, new_u); // (12)
        }
        if let Some((cushion, speed)) = &keep.cushion {
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
        let good = check.ge(zero) & largest.le(zero.lit(MOST_CELLS));
        if !good.all() {
            for lane in 0..T::WIDTH.min(count - p) {
                let whole = check.lane(lane) >= T::default();
                if !whole || largest.lane(lane) > T::from_f64(MOST_CELLS) {
                    failed = failed.or(Some(p + lane));
                    failures += 1;
                }
            }
        }
        most.moved.include(simd, Real::select(good, largest, zero));
        most.speed_squared
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
                T::store::<S>(increment[(i, j)], &mut stage.matrix[place][p..]);
            }
        }
        p += T::WIDTH;
    }

    (failed, failures)
}
