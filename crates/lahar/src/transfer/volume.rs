//! How full the grid is where particles are: the gathered J, (7g).
//!
//! The grid knows how much rest volume lies around a particle. Where a body is as dense as at rest that
//! is dxᴰ a node; where there is less, what is there has expanded by as much.

use super::scatter::{load_vector, split_runs, stencil};
use super::{LARGEST_TILE, Scheme, Stage, rows};
use crate::dispatch::{on_level, on_portable};
use crate::grid::{Grid, tile_edge};
use crate::kernel::{BSpline, Cubic, Linear, Quadratic};
use crate::material::{CHUNK, IsaToken, store_part};
use crate::math::Lanes;
use crate::parallel;
use crate::setup::Kernel;
use crate::store::{Group, Run};
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
    let task = Task {
        group,
        grid,
        scheme,
        isa,
    };
    let grain = parallel::grain(group.len(), 4096);
    task.halve(&group.runs, 0, out, grain);
}

struct Task<'a, T: Lanes, const D: usize> {
    group: &'a Group<T, D>,
    grid: &'a Grid<T, D>,
    scheme: Scheme,
    isa: IsaToken,
}

impl<T: Lanes, const D: usize> Task<'_, T, D> {
    /// `out` begins with row `first_row`.
    fn halve(&self, runs: &[Run<D>], first_row: usize, out: &mut [T], grain: usize) {
        let Some((middle, row)) = split_runs(runs, grain) else {
            let _flush = crate::float_mode::FlushToZero::enter();
            let mut stage = Stage::new();
            let mut tile = [T::default(); LARGEST_TILE];
            for run in runs {
                self.grid.load_tile(run.tile as usize, &mut tile);
                for start in run.rows().step_by(CHUNK) {
                    let count = CHUNK.min(run.end as usize - start);
                    let out = &mut out[start - first_row..][..count];
                    self.chunk(start, &tile, &mut stage, out);
                }
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

    fn chunk(&self, start: usize, tile: &[T], stage: &mut Stage<T>, out: &mut [T]) {
        match self.scheme.kernel {
            Kernel::Quadratic => on_level!(self.isa.0, simd => {
                chunk::<_, T, D, Quadratic>(simd, self, start, tile, stage, out);
            }),
            Kernel::Cubic => on_portable!(simd => {
                chunk::<_, T, D, Cubic>(simd, self, start, tile, stage, out);
            }),
            Kernel::Linear => on_portable!(simd => {
                chunk::<_, T, D, Linear>(simd, self, start, tile, stage, out);
            }),
        }
    }
}

/// (7g) for the particles from row `start` on, as many as `out` has room for.
#[inline(always)]
fn chunk<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    task: &Task<'_, T, D>,
    start: usize,
    tile: &[T],
    stage: &mut Stage<T>,
    out: &mut [T],
) {
    let count = out.len();
    let mut p = 0;
    while p < count {
        let u = load_vector::<S, T, D>(simd, &task.group.columns, start + p, count - p);
        stencil::<S, T, D, K, false>(u, p, stage);
        p += T::WIDTH;
    }
    let (edge, plane) = (tile_edge::<D>(K::NODES), task.grid.tile_plane());
    for p in 0..count {
        rows::gather::<S, T, D, K, false, false>(simd, stage, p, edge, plane, tile);
    }
    let cell = T::broadcast(simd, T::from_f64(task.scheme.dx.powi(D as i32)));
    let mut p = 0;
    while p < count {
        let [volume, ..] = T::load_quads(simd, &stage.momentum[0][4 * p..]);
        // Lanes past the end hold what was there before, which is not stored.
        store_part::<S, T>((cell - volume) / volume, &mut out[p..], count - p); // (7g)
        p += T::WIDTH;
    }
}
