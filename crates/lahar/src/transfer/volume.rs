//! How full the grid is where particles are: the gathered J, (7g), and what is set right by it, (7h), (7i).
//!
//! The grid knows how much rest volume lies around a particle. Where a body is as dense as at rest that
//! is dxᴰ a node; where there is less, what is there has expanded by as much.

use super::rows::gather_quad;
use super::scatter::stencil;
use super::{Stage, TileCopy};
use crate::dispatch::{on_level, on_portable};
use crate::grid::{Grid, tile_edge};
use crate::kernel::{BSpline, Cubic, Linear, Quadratic};
use crate::material::rheology::shear_rate;
use crate::material::{IsaToken, VolumeCorrection, load_matrix, load_vector};
use crate::math::{Lanes, Real};
use crate::parallel;
use crate::particles::{AHEAD, CHUNK, Chunk, Padded, Rows, pad};
use crate::particles::{Group, Layout, Run, slices, split_runs};
use crate::prefetch::prefetch_chunk;
use crate::setup::Kernel;
use crate::setup::Scheme;
use fearless_simd::Simd;

/// Writes J − 1 of every row of `group` to `out`, by what the grid's nodes hold of rest volume (first
/// number of a quad).
pub(crate) fn expansion<T: Lanes, const D: usize>(
    group: &Group<T, D>,
    grid: &Grid<T, D>,
    scheme: Scheme,
    isa: IsaToken,
    out: &mut [T],
) {
    Task {
        group,
        columns: &slices(&group.columns)[..Layout::strain(D)],
        grid,
        scheme,
        isa,
        what: Read::Expansion,
    }
    .run(out);
}

/// Sets J − 1 in `jacobian_minus_one`, a row each of `group`, right by what the nodes answered to
/// [`Grid::measure_filling`].
pub(crate) fn correct<T: Lanes, const D: usize>(
    group: &Group<T, D>,
    grid: &Grid<T, D>,
    scheme: Scheme,
    isa: IsaToken,
    shares: VolumeCorrection,
    jacobian_minus_one: &mut [T],
) {
    Task {
        group,
        columns: &slices(&group.columns)[..Layout::strain(D)],
        grid,
        scheme,
        isa,
        what: Read::Correction(shares),
    }
    .run(jacobian_minus_one);
}

/// What is made of what particles read.
#[derive(Clone, Copy, Debug)]
enum Read {
    /// (7g)
    Expansion,
    /// (7h), (7i), by these shares of what is missing.
    Correction(VolumeCorrection),
}

struct Task<'a, T: Lanes, const D: usize> {
    group: &'a Group<T, D>,
    /// Position, velocity, affine.
    columns: &'a [&'a [T]],
    grid: &'a Grid<T, D>,
    scheme: Scheme,
    isa: IsaToken,
    what: Read,
}

impl<T: Lanes, const D: usize> Task<'_, T, D> {
    fn run(&self, out: &mut [T]) {
        let grain = parallel::grain(self.group.len(), 4096);
        self.halve(&self.group.runs, 0, out, grain);
    }

    /// `out` begins with row `first_row`.
    fn halve(&self, runs: &[Run<D>], first_row: usize, out: &mut [T], grain: usize) {
        let Some((middle, row)) = split_runs(runs, grain) else {
            let _flush = crate::float_mode::FlushToZero::enter();
            match self.scheme.kernel {
                Kernel::Quadratic => on_level!(self.isa.0, simd => {
                    self.blocks::<_, Quadratic>(simd, runs, first_row, out);
                }),
                Kernel::Cubic => on_portable!(simd => {
                    self.blocks::<_, Cubic>(simd, runs, first_row, out);
                }),
                Kernel::Linear => on_portable!(simd => {
                    self.blocks::<_, Linear>(simd, runs, first_row, out);
                }),
            }
            return;
        };
        let (low, high) = runs.split_at(middle);
        let (low_out, high_out) = out.split_at_mut(row - first_row);
        parallel::join(
            || self.halve(low, first_row, low_out, grain),
            || self.halve(high, row, high_out, grain),
        );
    }

    #[inline(always)]
    fn blocks<S: Simd, K: BSpline>(
        &self,
        simd: S,
        runs: &[Run<D>],
        first_row: usize,
        out: &mut [T],
    ) {
        let (mut stage, mut padded) = (Stage::new(), Padded::new());
        let mut tile = TileCopy::new();
        for (index, run) in runs.iter().enumerate() {
            tile.load(simd, self.grid, &runs[index..]);
            for start in run.rows().step_by(CHUNK) {
                self.ask_for(start + AHEAD);
                let count = CHUNK.min(run.end as usize - start);
                let out = &mut out[start - first_row..][..count];
                let mut values = [T::default(); CHUNK];
                pad(&mut values, out);
                let mut copies = None;
                let particles = padded.chunk(self.columns, start, count, &mut copies);
                chunk::<_, T, D, K>(simd, self, particles, &tile.0, &mut stage, &mut values);
                out.copy_from_slice(&values[..count]);
            }
        }
    }

    /// Asks memory for the chunk that begins with row `start`.
    fn ask_for(&self, start: usize) {
        prefetch_chunk(&self.columns[..D], start);
        if let Read::Correction(_) = self.what {
            prefetch_chunk(&self.columns[Layout::affine(D)..], start);
        }
    }
}

/// (7g), or (7h) and (7i), for a chunk.
#[inline(always)]
fn chunk<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    task: &Task<'_, T, D>,
    particles: Chunk<'_, T>,
    tile: &[T],
    stage: &mut Stage<T>,
    values: &mut Rows<T>,
) {
    let Chunk {
        columns,
        start,
        count,
    } = particles;
    let mut p = 0;
    while p < count {
        let u = load_vector::<S, T, D>(simd, columns, start + p);
        stencil::<S, T, D, K, false>(u, p, stage);
        p += T::WIDTH;
    }
    for p in (0..p).step_by(4) {
        gather_quad::<S, T, D, K>(simd, stage, p, tile_edge::<D>(K::NODES), tile);
    }
    let cell = T::broadcast(simd, T::from_f64(task.scheme.dx.powi(D as i32)));
    let mut p = 0;
    while p < count {
        // Lanes past the end hold what was there before, which is not stored.
        let [first, second, ..] = T::load_quads(simd, &stage.momentum[0][4 * p..]);
        let value = match task.what {
            Read::Expansion => (cell - first) / first, // (7g)
            Read::Correction(shares) => {
                let e = T::load(simd, &values[p..]);
                let c = load_matrix::<S, T, D>(simd, &columns[Layout::affine(D)..], start + p);
                let strained = shear_rate(c);
                let share = |rate: f64| {
                    let amount = strained * e.lit(rate);
                    amount / (amount + e.one())
                };
                let smoothed = e + (first - e) * share(shares.smoothing); // (7h)
                smoothed - second * share(shares.correction) // (7i)
            }
        };
        T::store::<S>(value, &mut values[p..]);
        p += T::WIDTH;
    }
}
