//! The sums over nodes, by rows: the only place where (2), (5) and (6) are restated.
//!
//! The lever arm r is linear in the node's index n = (i, j, k) from the base node. So a particle brings
//! w_i w_j w_k (P₀ + i A_x + j A_y + k A_z) to a node, where
//!
//! ```text
//! A = dx Q by columns,   P₀ = m v − A s,   s = the particle's place from the base node, in cells
//! ```
//!
//! and mass is the fourth number of P₀. The four nodes of a row, k = 0 .. 3, lie side by side in the tile: one register in
//! f32 with AVX-512. With w_k multiplied in first, a row is w_j times one register, and is added to its nodes one by one
//! or by pairs. Likewise G2P sums rows by j, then by i, and the row itself once at the end, for Σ, Σ·i, Σ·j and Σ·k, with
//! i, j, k counted from the stencil's middle node. In 2D a row is (i) and lies along j.
//!
//! The module `reference` does the same sums node by node; tests compare the two.

use super::stencil::{MomentumQuads, Quads, Stencils, VelocitySums};
use crate::kernel::BSpline;
use crate::math::{Lanes, Row};
use fearless_simd::Simd;

/// Returns the node's index along a row, for each of its numbers.
#[inline(always)]
fn along<S: Simd, T: Lanes>(simd: S) -> T::Row<S> {
    let index = [
        T::from_f64(0.0),
        T::from_f64(1.0),
        T::from_f64(2.0),
        T::from_f64(3.0),
    ];
    T::Row::spread(simd, &index)
}

/// (1), (2) for particle `p` of the chunk: adds its mass and momentum, and the impulse of stress, to the nodes of its
/// stencil.
#[inline(always)]
pub(super) fn scatter<
    S: Simd,
    T: Lanes,
    const D: usize,
    K: BSpline,
    const SPLIT: bool,
    const CLASSIC: bool,
>(
    simd: S,
    stencils: &Stencils<T>,
    quads: &MomentumQuads<T>,
    p: usize,
    (tile_edge, tile_layer): (usize, usize),
    tile: &mut [T],
) {
    let (momentum, impulse) = tile.split_at_mut(tile_layer);
    scatter_affine::<S, T, D, K>(simd, &quads.momentum, stencils, p, tile_edge, momentum);
    let target = if SPLIT { impulse } else { momentum };
    if CLASSIC {
        scatter_classic::<S, T, D, K>(simd, stencils, &quads.stress, p, tile_edge, target);
    } else if SPLIT {
        scatter_affine::<S, T, D, K>(simd, &quads.stress, stencils, p, tile_edge, target);
    }
}

/// Adds `weight value` to the stencil's row that begins with `row`: node by node in 2D, by pairs in 3D, where the other
/// costs of a row weigh more (measured).
#[inline(always)]
fn add_row<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    row: &mut [T],
    weight: T,
    value: T::Row<S>,
) {
    value.add_scaled(simd, weight, row, K::NODES, D == 3);
}

/// Adds w_i w_j w_k (P₀ + i A_x + j A_y + k A_z) of particle `p` to the nodes of its stencil; `affine` are P₀ and the
/// columns of A.
#[inline(always)]
fn scatter_affine<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    affine: &[Quads<T>; 4],
    stencils: &Stencils<T>,
    p: usize,
    tile_edge: usize,
    tile: &mut [T],
) {
    let q = 4 * p;
    let (base, weights) = (stencils.base[p], &stencils.weights);
    let quad = |c: usize| T::Row::<S>::repeat(simd, &affine[c][q..]);
    let w_row = T::Row::<S>::spread(simd, &weights[D - 1][q..]);
    let start = w_row * along::<S, T>(simd).mul_add(quad(D), quad(0));
    let a_x = w_row * quad(1);
    let mut plane = start;
    if D == 2 {
        for i in 0..K::NODES {
            let row = &mut tile[(base as usize + i * tile_edge) * 4..][..16];
            add_row::<S, T, D, K>(simd, row, weights[0][q + i], plane);
            plane = plane + a_x;
        }
    } else {
        let a_y = w_row * quad(2);
        for i in 0..K::NODES {
            let w_i = T::Row::splat(simd, weights[0][q + i]);
            let step = w_i * a_y;
            let mut value = w_i * plane;
            let at = (base as usize + i * tile_edge * tile_edge) * 4;
            let rows = &mut tile[at..at + (K::NODES - 1) * tile_edge * 4 + 16];
            for j in 0..K::NODES {
                let row = &mut rows[j * tile_edge * 4..][..16];
                add_row::<S, T, D, K>(simd, row, weights[1][q + j], value);
                value = value + step;
            }
            plane = plane + a_x;
        }
    }
}

/// Adds the quad of particle `p` to each node of its stencil, by weight: a payload without an affine part.
#[inline(always)]
pub(super) fn scatter_quad<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stencils: &Stencils<T>,
    quads: &Quads<T>,
    p: usize,
    tile_edge: usize,
    tile: &mut [T],
) {
    let q = 4 * p;
    let base = stencils.base[p] as usize;
    let value = T::Row::<S>::spread(simd, &stencils.weights[D - 1][q..])
        * T::Row::<S>::repeat(simd, &quads[q..]);
    for i in 0..K::NODES {
        let w_i = stencils.weights[0][q + i];
        if D == 2 {
            let row = &mut tile[(base + i * tile_edge) * 4..][..16];
            add_row::<S, T, D, K>(simd, row, w_i, value);
            continue;
        }
        let value = T::Row::splat(simd, w_i) * value;
        let at = (base + i * tile_edge * tile_edge) * 4;
        let rows = &mut tile[at..at + (K::NODES - 1) * tile_edge * 4 + 16];
        for j in 0..K::NODES {
            let row = &mut rows[j * tile_edge * 4..][..16];
            add_row::<S, T, D, K>(simd, row, stencils.weights[1][q + j], value);
        }
    }
}

/// The force of the original MPM: adds Σ over axes of G_a ∂_a w, where `stress[1..]` are the columns G of the impulse of
/// stress.
#[inline(always)]
fn scatter_classic<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stencils: &Stencils<T>,
    stress: &[Quads<T>; 4],
    p: usize,
    tile_edge: usize,
    tile: &mut [T],
) {
    let q = 4 * p;
    let base = stencils.base[p] as usize;
    let quad = |a: usize| T::Row::<S>::repeat(simd, &stress[1 + a][q..]);
    let (weights, gradients) = (&stencils.weights, &stencils.gradients);
    let w_row = T::Row::<S>::spread(simd, &weights[D - 1][q..]);
    let g_row = T::Row::<S>::spread(simd, &gradients[D - 1][q..]);
    let by_x = w_row * quad(0);
    let by_row = g_row * quad(D - 1);
    for i in 0..K::NODES {
        let (w_i, g_i) = (
            T::Row::splat(simd, weights[0][q + i]),
            T::Row::splat(simd, gradients[0][q + i]),
        );
        if D == 2 {
            let row = &mut tile[(base + i * tile_edge) * 4..][..16];
            (T::Row::load(simd, row) + (g_i * by_x + w_i * by_row)).store(row);
        } else {
            let by_y = w_row * quad(1);
            for j in 0..K::NODES {
                let (w_j, g_j) = (
                    T::Row::splat(simd, weights[1][q + j]),
                    T::Row::splat(simd, gradients[1][q + j]),
                );
                let row = &mut tile[(base + (i * tile_edge + j) * tile_edge) * 4..][..16];
                let value = (g_i * w_j) * by_x + ((w_i * g_j) * by_y + (w_i * w_j) * by_row);
                (T::Row::load(simd, row) + value).store(row);
            }
        }
    }
}

/// Returns `sum + (index − center) part`, for the small whole numbers of a stencil.
#[inline(always)]
fn add_moment<S: Simd, T: Lanes, K: BSpline>(
    simd: S,
    sum: T::Row<S>,
    index: usize,
    part: T::Row<S>,
) -> T::Row<S> {
    match index as isize - K::CENTER as isize {
        0 => sum,
        1 => sum + part,
        arm => T::Row::splat(simd, T::from_f64(arm as f64)).mul_add(part, sum),
    }
}

/// Returns Σ_j and Σ_j (j − center) of a plane's rows, weighted; in 2D a plane is a single row.
#[inline(always)]
fn plane_sums<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    plane: &[T],
    tile_edge: usize,
    weights: &[T],
) -> (T::Row<S>, T::Row<S>) {
    let zero = T::Row::splat(simd, T::default());
    if D == 2 {
        return (T::Row::load(simd, plane), zero);
    }
    let (mut sum, mut by_j) = (zero, zero);
    for j in 0..K::NODES {
        let part =
            T::Row::splat(simd, weights[j]) * T::Row::load(simd, &plane[j * tile_edge * 4..]);
        sum = if j == 0 { part } else { sum + part };
        by_j = add_moment::<S, T, K>(simd, by_j, j, part);
    }
    (sum, by_j)
}

/// Returns the rows of plane `i` of a stencil.
#[inline(always)]
fn plane<T, const D: usize, K: BSpline>(
    tile: &[T],
    base: usize,
    i: usize,
    tile_edge: usize,
) -> &[T] {
    let (at, rows) = if D == 2 {
        (base + i * tile_edge, 0)
    } else {
        (base + i * tile_edge * tile_edge, K::NODES - 1)
    };
    &tile[at * 4..][..rows * tile_edge * 4 + 16]
}

/// Writes Σ w of the nodes' quads, for particles `p .. p + 4`, to `out`.
#[inline(always)]
pub(crate) fn gather_quad<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stencils: &Stencils<T>,
    p: usize,
    tile_edge: usize,
    tile: &[T],
    out: &mut Quads<T>,
) {
    let sums = [
        sum_of_quads::<S, T, D, K>(simd, stencils, p, tile_edge, tile),
        sum_of_quads::<S, T, D, K>(simd, stencils, p + 1, tile_edge, tile),
        sum_of_quads::<S, T, D, K>(simd, stencils, p + 2, tile_edge, tile),
        sum_of_quads::<S, T, D, K>(simd, stencils, p + 3, tile_edge, tile),
    ];
    T::Row::fold_four(sums, &mut out[4 * p..]);
}

/// Returns the sum of [`gather_quad`] for particle `p`, not yet folded along the row.
#[inline(always)]
fn sum_of_quads<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stencils: &Stencils<T>,
    p: usize,
    tile_edge: usize,
    tile: &[T],
) -> T::Row<S> {
    let q = 4 * p;
    let base = stencils.base[p] as usize;
    let w_row = T::Row::<S>::spread(simd, &stencils.weights[D - 1][q..]);
    let mut sum = T::Row::splat(simd, T::default());
    for i in 0..K::NODES {
        let (row, _) = plane_sums::<S, T, D, K>(
            simd,
            plane::<T, D, K>(tile, base, i, tile_edge),
            tile_edge,
            &stencils.weights[1][q..],
        );
        sum = sum + T::Row::splat(simd, stencils.weights[0][q + i]) * row;
    }
    sum * w_row
}

/// The sums of [`VelocitySums`] for one particle, not yet folded along the row.
struct Sums<R> {
    moments: [R; 4],
    change: R,
    gradients: [R; 3],
}

/// (5), (6) for particles `p .. p + 4`: computes their [`VelocitySums`]; the change if `SPLIT`, the gradients if
/// `CLASSIC`.
#[inline(always)]
pub(super) fn gather<
    S: Simd,
    T: Lanes,
    const D: usize,
    K: BSpline,
    const SPLIT: bool,
    const CLASSIC: bool,
>(
    simd: S,
    stencils: &Stencils<T>,
    p: usize,
    (tile_edge, tile_layer): (usize, usize),
    tile: &[T],
    out: &mut VelocitySums<T>,
) {
    if !T::Row::<S>::ROOM_FOR_FOUR {
        for p in p..p + 4 {
            let one =
                sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stencils, p, tile_edge, tile_layer, tile);
            for m in 0..=D {
                one.moments[m].fold(&mut out.moments[m][4 * p..]);
            }
            if SPLIT {
                one.change.fold(&mut out.change[4 * p..]);
            }
            if CLASSIC {
                for axis in 0..D {
                    one.gradients[axis].fold(&mut out.gradients[axis][4 * p..]);
                }
            }
        }
        return;
    }
    let a = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stencils, p, tile_edge, tile_layer, tile);
    let b = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stencils, p + 1, tile_edge, tile_layer, tile);
    let c = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stencils, p + 2, tile_edge, tile_layer, tile);
    let d = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stencils, p + 3, tile_edge, tile_layer, tile);
    let q = 4 * p;
    for m in 0..=D {
        let rows = [&a, &b, &c, &d].map(|sums| sums.moments[m]);
        T::Row::fold_four(rows, &mut out.moments[m][q..]);
    }
    if SPLIT {
        let rows = [a.change, b.change, c.change, d.change];
        T::Row::fold_four(rows, &mut out.change[q..]);
    }
    if CLASSIC {
        for axis in 0..D {
            let rows = [&a, &b, &c, &d].map(|sums| sums.gradients[axis]);
            T::Row::fold_four(rows, &mut out.gradients[axis][q..]);
        }
    }
}

/// Returns the sums of [`gather`] for particle `p`.
#[inline(always)]
fn sums<S: Simd, T: Lanes, const D: usize, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
    simd: S,
    stencils: &Stencils<T>,
    p: usize,
    tile_edge: usize,
    tile_layer: usize,
    tile: &[T],
) -> Sums<T::Row<S>> {
    let q = 4 * p;
    let base = stencils.base[p] as usize;
    let k = along::<S, T>(simd);
    let w_row = T::Row::<S>::spread(simd, &stencils.weights[D - 1][q..]);
    let zero = T::Row::splat(simd, T::default());

    let velocity = &tile[..tile_layer];
    let (mut sum, mut by_i, mut by_j) = (zero, zero, zero);
    for i in 0..K::NODES {
        let w_i = T::Row::splat(simd, stencils.weights[0][q + i]);
        let (row, row_by_j) = plane_sums::<S, T, D, K>(
            simd,
            plane::<T, D, K>(velocity, base, i, tile_edge),
            tile_edge,
            &stencils.weights[1][q..],
        );
        let part = w_i * row;
        sum = sum + part;
        by_i = add_moment::<S, T, K>(simd, by_i, i, part);
        if D == 3 {
            by_j = w_i.mul_add(row_by_j, by_j);
        }
    }
    let sum = sum * w_row;
    let mut moments = [sum, by_i * w_row, zero, zero];
    if D == 3 {
        moments[2] = by_j * w_row;
    }
    moments[D] = sum * (k + T::Row::splat(simd, T::from_f64(-(K::CENTER as f64))));

    let (mut change, mut gradients) = (zero, [zero; 3]);
    if SPLIT {
        let changes = &tile[tile_layer..];
        let mut sum = zero;
        for i in 0..K::NODES {
            sum = T::Row::splat(simd, stencils.weights[0][q + i]).mul_add(
                plane_sums::<S, T, D, K>(
                    simd,
                    plane::<T, D, K>(changes, base, i, tile_edge),
                    tile_edge,
                    &stencils.weights[1][q..],
                )
                .0,
                sum,
            );
        }
        change = sum * w_row;
    }
    if CLASSIC {
        let g_row = T::Row::<S>::spread(simd, &stencils.gradients[D - 1][q..]);
        let (mut by_x, mut by_y, mut by_row) = (zero, zero, zero);
        for i in 0..K::NODES {
            let (w_i, g_i) = (
                T::Row::splat(simd, stencils.weights[0][q + i]),
                T::Row::splat(simd, stencils.gradients[0][q + i]),
            );
            let weighted = plane_sums::<S, T, D, K>(
                simd,
                plane::<T, D, K>(velocity, base, i, tile_edge),
                tile_edge,
                &stencils.weights[1][q..],
            )
            .0;
            by_x = g_i.mul_add(weighted, by_x);
            by_row = w_i.mul_add(weighted, by_row);
            if D == 3 {
                by_y = w_i.mul_add(
                    plane_sums::<S, T, D, K>(
                        simd,
                        plane::<T, D, K>(velocity, base, i, tile_edge),
                        tile_edge,
                        &stencils.gradients[1][q..],
                    )
                    .0,
                    by_y,
                );
            }
        }
        gradients[0] = by_x * w_row;
        if D == 3 {
            gradients[1] = by_y * w_row;
        }
        gradients[D - 1] = by_row * g_row;
    }
    Sums {
        moments,
        change,
        gradients,
    }
}
