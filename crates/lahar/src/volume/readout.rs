//! Fluids read their volumes from the grid: the gathered J, (7g), and the correction of a J that drifts, (7h) and (7i).
//!
//! The grid knows the rest volume around a particle. Where a body is as dense as at rest that is dxᴰ per node. Where it is
//! less, the material there has expanded by as much.

use crate::dispatch::{on_level, on_portable};
use crate::grid::{Filling, Grid, NodeField, Volume, tile_edge};
use crate::kernel::{BSpline, Cubic, Linear, Quadratic};
use crate::material::rheology::shear_rate;
use crate::material::{IsaToken, VolumeCorrection, load_matrix, load_vector};
use crate::math::{Lanes, Real, Register};
use crate::particles::{AHEAD, CHUNK, Chunk, Group, Layout, Padded, Rows, pad, slices};
use crate::prefetch::prefetch_chunk;
use crate::setup::{Kernel, Scheme};
use crate::transfer::TileCopy;
use crate::transfer::rows::gather_quad;
use crate::transfer::stencil::{Quads, Stencils};
use crate::transfer::walk::{Cut, Piece, Walk};
use fearless_simd::Simd;

/// Writes J − 1 of each row of `group` to `out`, from the rest volumes at the nodes: (7g).
pub(crate) fn expansion<T: Lanes, const D: usize>(
    group: &Group<T, D>,
    (grid, volumes): (&Grid<T, D>, &NodeField<Volume, T>),
    scheme: Scheme,
    isa: IsaToken,
    out: &mut [T],
) {
    let task = Task {
        columns: &slices(&group.columns)[..Layout::strain(D)],
        grid,
        field: volumes,
        scheme,
        isa,
        readout: Expansion {
            cell: T::from_f64(scheme.dx.powi(D as i32)),
        },
    };
    task.walk(&group.runs, group.len(), out);
}

/// Corrects `jacobian_minus_one`, one number per row of `group`, by the `filling` of the grid and by these `shares` of the
/// difference: (7h) and (7i).
pub(crate) fn correct<T: Lanes, const D: usize>(
    group: &Group<T, D>,
    (grid, filling): (&Grid<T, D>, &NodeField<Filling, T>),
    scheme: Scheme,
    isa: IsaToken,
    shares: VolumeCorrection,
    jacobian_minus_one: &mut [T],
) {
    let task = Task {
        columns: &slices(&group.columns)[..Layout::strain(D)],
        grid,
        field: filling,
        scheme,
        isa,
        readout: Correction { shares },
    };
    task.walk(&group.runs, group.len(), jacobian_minus_one);
}

/// What particles make of the quads that they read of a field.
trait Readout<T: Lanes, const D: usize>: Sync {
    /// The quantity of the field.
    type Quantity: Sync;

    /// Prefetches the columns of the chunk that begins with row `start`.
    fn prefetch(&self, columns: &[&[T]], start: usize);

    /// Returns the new J − 1 of the register of particles that begins at row `at` of `columns`, from their present J − 1
    /// and their sums of quads.
    fn value<S: Simd>(
        &self,
        simd: S,
        columns: &[&[T]],
        at: usize,
        present: T::Of<S>,
        sums: [T::Of<S>; 4],
    ) -> T::Of<S>;
}

/// The gathered volume, (7g).
struct Expansion<T> {
    /// dxᴰ \[m³; m² in 2D\].
    cell: T,
}

impl<T: Lanes, const D: usize> Readout<T, D> for Expansion<T> {
    type Quantity = Volume;

    #[inline(always)]
    fn prefetch(&self, columns: &[&[T]], start: usize) {
        prefetch_chunk(&columns[..D], start);
    }

    #[inline(always)]
    fn value<S: Simd>(
        &self,
        _: S,
        _: &[&[T]],
        _: usize,
        _: T::Of<S>,
        [volume, ..]: [T::Of<S>; 4],
    ) -> T::Of<S> {
        (volume.splat(self.cell) - volume) / volume // (7g)
    }
}

/// The two corrections, (7h) and (7i).
struct Correction {
    shares: VolumeCorrection,
}

impl<T: Lanes, const D: usize> Readout<T, D> for Correction {
    type Quantity = Filling;

    #[inline(always)]
    fn prefetch(&self, columns: &[&[T]], start: usize) {
        prefetch_chunk(&columns[..D], start);
        prefetch_chunk(&columns[Layout::affine(D)..], start);
    }

    #[inline(always)]
    fn value<S: Simd>(
        &self,
        simd: S,
        columns: &[&[T]],
        at: usize,
        present: T::Of<S>,
        [mean, excess, ..]: [T::Of<S>; 4],
    ) -> T::Of<S> {
        let e = present;
        let c = load_matrix::<S, T, D>(simd, &columns[Layout::affine(D)..], at);
        let strained = shear_rate(c);
        let share = |rate: f64| {
            let amount = strained * e.lit(rate);
            amount / (amount + e.one())
        };
        let smoothed = e + (mean - e) * share(self.shares.smoothing); // (7h)
        smoothed - excess * share(self.shares.correction) // (7i)
    }
}

struct Task<'a, R: Readout<T, D>, T: Lanes, const D: usize> {
    /// Position, velocity, affine.
    columns: &'a [&'a [T]],
    grid: &'a Grid<T, D>,
    field: &'a NodeField<R::Quantity, T>,
    scheme: Scheme,
    isa: IsaToken,
    readout: R,
}

impl<'a, R: Readout<T, D>, T: Lanes, const D: usize> Walk<D> for Task<'a, R, T, D> {
    /// One number per row.
    type Data = &'a mut [T];
    type Found = ();

    fn cut(&self, values: Self::Data, cut: Cut) -> (Self::Data, Self::Data) {
        values.split_at_mut(cut.rows)
    }

    fn work(&self, piece: Piece<'_, Self::Data, D>) {
        match self.scheme.kernel {
            Kernel::Quadratic => on_level!(self.isa.0, simd => {
                self.runs::<_, Quadratic>(simd, piece);
            }),
            Kernel::Cubic => on_portable!(simd => {
                self.runs::<_, Cubic>(simd, piece);
            }),
            Kernel::Linear => on_portable!(simd => {
                self.runs::<_, Linear>(simd, piece);
            }),
        }
    }

    fn join(&self, (): (), (): ()) {}
}

impl<R: Readout<T, D>, T: Lanes, const D: usize> Task<'_, R, T, D> {
    #[inline(always)]
    fn runs<S: Simd, K: BSpline>(&self, simd: S, piece: Piece<'_, &mut [T], D>) {
        let Piece {
            runs,
            first_row,
            data: values,
        } = piece;
        let (mut stencils, mut padded) = (Stencils::new(), Padded::new());
        let mut tile = TileCopy::new();
        for (index, run) in runs.iter().enumerate() {
            tile.load(simd, self.grid, self.field, &runs[index..]);
            for start in run.rows().step_by(CHUNK) {
                self.readout.prefetch(self.columns, start + AHEAD);
                let count = CHUNK.min(run.end as usize - start);
                let values = &mut values[start - first_row..][..count];
                let mut rows = [T::default(); CHUNK];
                pad(&mut rows, values);
                let mut copies = None;
                let particles = padded.chunk(self.columns, start, count, &mut copies);
                self.chunk::<_, K>(simd, particles, &tile.0, &mut stencils, &mut rows);
                values.copy_from_slice(&rows[..count]);
            }
        }
    }

    /// Reads the nodes of one chunk of particles, whose numbers are `values`.
    #[inline(always)]
    fn chunk<S: Simd, K: BSpline>(
        &self,
        simd: S,
        particles: Chunk<'_, T>,
        tile: &[T],
        stencils: &mut Stencils<T>,
        values: &mut Rows<T>,
    ) {
        let Chunk {
            columns,
            start,
            count,
        } = particles;
        let mut sums: Quads<T> = [T::default(); 4 * CHUNK];
        let mut p = 0;
        while p < count {
            let u = load_vector::<S, T, D>(simd, columns, start + p);
            stencils.place::<S, D, K, false>(u, p);
            p += T::WIDTH;
        }
        for p in (0..p).step_by(4) {
            gather_quad::<S, T, D, K>(simd, stencils, p, tile_edge::<D>(K::NODES), tile, &mut sums);
        }
        let mut p = 0;
        while p < count {
            let quads = T::load_quads(simd, &sums[4 * p..]);
            let present = T::load(simd, &values[p..]);
            let value = self.readout.value(simd, columns, start + p, present, quads);
            T::store::<S>(value, &mut values[p..]);
            p += T::WIDTH;
        }
    }
}
