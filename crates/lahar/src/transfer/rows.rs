//! The sums over nodes, by rows: the only place where (2), (5) and (6) are restated.
//!
//! The lever arm r is linear in the node's index n = (i, j, k) from the base node, so what a
//! particle gives to a node is w_i w_j w_k (P₀ + i A_x + j A_y + k A_z), where
//!
//! ```text
//! A = dx Q by columns,   P₀ = m v − A s,   s = the particle's place from the base node, in cells
//! ```
//!
//! and mass rides along as the fourth number of P₀. The four nodes of a row, k = 0 .. 3, lie side by
//! side in the tile: one register in f32 with AVX-512. With w_k multiplied in first, a row is w_j times
//! one register, and is added to its nodes one by one or by pairs. Likewise G2P sums rows by j, then by
//! i, and the row itself once at the end, keeping Σ, Σ·i, Σ·j and Σ·k, with i, j, k counted from the stencil's middle node. In 2D a row is (i) and lies along j.
//!
//! `reference` does the same sums node by node; tests hold the two together.

use super::Stage;
use crate::kernel::BSpline;
use crate::math::{Lanes, Row};
use fearless_simd::Simd;

/// The node's index along a row, for each of its numbers.
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

/// (1), (2) for particle `p` of the chunk: adds what it gives to each node of its stencil.
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
    stage: &Stage<T>,
    p: usize,
    tile_edge: usize,
    tile_plane: usize,
    tile: &mut [T],
) {
    let (momentum, impulse) = tile.split_at_mut(tile_plane);
    scatter_affine::<S, T, D, K>(
        simd,
        &stage.momentum,
        &stage.weights,
        stage.base[p],
        p,
        tile_edge,
        momentum,
    );
    let target = if SPLIT { impulse } else { momentum };
    if CLASSIC {
        scatter_classic::<S, T, D, K>(simd, stage, p, tile_edge, target);
    } else if SPLIT {
        scatter_affine::<S, T, D, K>(
            simd,
            &stage.impulse,
            &stage.weights,
            stage.base[p],
            p,
            tile_edge,
            target,
        );
    }
}

/// Adds `weight value` to the stencil's row that begins with `row`. Node by node in 2D, by pairs in 3D, where
/// what a row costs besides weighs more: measured.
#[inline(always)]
fn add_row<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    row: &mut [T],
    weight: T,
    value: T::Row<S>,
) {
    value.add_scaled(simd, weight, row, K::NODES, D == 3);
}

#[inline(always)]
fn scatter_affine<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    affine: &[[T; 4 * super::CHUNK]; 4],
    weights: &[[T; 4 * super::CHUNK]; 3],
    base: i32,
    p: usize,
    tile_edge: usize,
    tile: &mut [T],
) {
    let q = 4 * p;
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

/// Adds the first quad of `stage.momentum` for particle `p` to each node of its stencil, by weight: what has
/// no affine part.
#[inline(always)]
pub(super) fn scatter_quad<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stage: &Stage<T>,
    p: usize,
    tile_edge: usize,
    tile: &mut [T],
) {
    let q = 4 * p;
    let base = stage.base[p] as usize;
    let value = T::Row::<S>::spread(simd, &stage.weights[D - 1][q..])
        * T::Row::<S>::repeat(simd, &stage.momentum[0][q..]);
    for i in 0..K::NODES {
        let w_i = stage.weights[0][q + i];
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
            add_row::<S, T, D, K>(simd, row, stage.weights[1][q + j], value);
        }
    }
}

/// The original force: what the gradients of the weights make of the impulse's columns G, which
/// `impulse[1..]` holds: Σ over axes of G_a ∂_a w.
#[inline(always)]
fn scatter_classic<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stage: &Stage<T>,
    p: usize,
    tile_edge: usize,
    tile: &mut [T],
) {
    let q = 4 * p;
    let base = stage.base[p] as usize;
    let quad = |a: usize| T::Row::<S>::repeat(simd, &stage.impulse[1 + a][q..]);
    let (weights, gradients) = (&stage.weights, &stage.gradients);
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

/// `sum + (index − centre) part`, for the small whole numbers that a stencil has.
#[inline(always)]
fn add_moment<S: Simd, T: Lanes, K: BSpline>(
    simd: S,
    sum: T::Row<S>,
    index: usize,
    part: T::Row<S>,
) -> T::Row<S> {
    match index as isize - K::CENTRE as isize {
        0 => sum,
        1 => sum + part,
        arm => T::Row::splat(simd, T::from_f64(arm as f64)).mul_add(part, sum),
    }
}

/// Σ_j and Σ_j (j − centre) of a plane's rows, weighted; in 2D a plane is a single row.
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

/// The rows of plane `i` of a stencil.
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

/// Σ w of the nodes' quads, to `momentum[0]`: what [`gather`] finds there. For particles `p .. p + 4`.
#[inline(always)]
pub(super) fn gather_quad<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stage: &mut Stage<T>,
    p: usize,
    tile_edge: usize,
    tile: &[T],
) {
    let sums = [
        sum_of_quads::<S, T, D, K>(simd, stage, p, tile_edge, tile),
        sum_of_quads::<S, T, D, K>(simd, stage, p + 1, tile_edge, tile),
        sum_of_quads::<S, T, D, K>(simd, stage, p + 2, tile_edge, tile),
        sum_of_quads::<S, T, D, K>(simd, stage, p + 3, tile_edge, tile),
    ];
    T::Row::fold_four(sums, &mut stage.momentum[0][4 * p..]);
}

/// The sum of [`gather_quad`] for particle `p`, still node by node along the row.
#[inline(always)]
fn sum_of_quads<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    stage: &Stage<T>,
    p: usize,
    tile_edge: usize,
    tile: &[T],
) -> T::Row<S> {
    let q = 4 * p;
    let base = stage.base[p] as usize;
    let w_row = T::Row::<S>::spread(simd, &stage.weights[D - 1][q..]);
    let mut sum = T::Row::splat(simd, T::default());
    for i in 0..K::NODES {
        let (row, _) = plane_sums::<S, T, D, K>(
            simd,
            plane::<T, D, K>(tile, base, i, tile_edge),
            tile_edge,
            &stage.weights[1][q..],
        );
        sum = sum + T::Row::splat(simd, stage.weights[0][q + i]) * row;
    }
    sum * w_row
}

/// What the rows of one particle's stencil add up to, still node by node along the row; as quads in the stage.
struct Sums<R> {
    /// Σ w v and Σ w v (n_a − centre).
    momentum: [R; 4],
    /// Σ w Δv and dx Σ v ∂_a w.
    impulse: [R; 4],
}

/// (5), (6) for particles `p .. p + 4`: Σ w v to `momentum[0]`, Σ w v (n_a − centre) to `momentum[1 + a]`; if
/// `SPLIT`, Σ w Δv to `impulse[0]`; if `CLASSIC`, dx Σ v ∂_a w to `impulse[1 + a]`.
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
    stage: &mut Stage<T>,
    p: usize,
    tile_edge: usize,
    tile_plane: usize,
    tile: &[T],
) {
    let used = usize::from(!SPLIT)..if CLASSIC { 1 + D } else { 1 };
    if !T::Row::<S>::ROOM_FOR_FOUR {
        for p in p..p + 4 {
            let one =
                sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stage, p, tile_edge, tile_plane, tile);
            for m in 0..=D {
                one.momentum[m].fold(&mut stage.momentum[m][4 * p..]);
            }
            for m in used.clone() {
                one.impulse[m].fold(&mut stage.impulse[m][4 * p..]);
            }
        }
        return;
    }
    let a = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stage, p, tile_edge, tile_plane, tile);
    let b = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stage, p + 1, tile_edge, tile_plane, tile);
    let c = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stage, p + 2, tile_edge, tile_plane, tile);
    let d = sums::<S, T, D, K, SPLIT, CLASSIC>(simd, stage, p + 3, tile_edge, tile_plane, tile);
    let q = 4 * p;
    for m in 0..=D {
        let rows = [a.momentum[m], b.momentum[m], c.momentum[m], d.momentum[m]];
        T::Row::fold_four(rows, &mut stage.momentum[m][q..]);
    }
    for m in used {
        let rows = [a.impulse[m], b.impulse[m], c.impulse[m], d.impulse[m]];
        T::Row::fold_four(rows, &mut stage.impulse[m][q..]);
    }
}

/// The sums of [`gather`] for particle `p`.
#[inline(always)]
fn sums<S: Simd, T: Lanes, const D: usize, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
    simd: S,
    stage: &Stage<T>,
    p: usize,
    tile_edge: usize,
    tile_plane: usize,
    tile: &[T],
) -> Sums<T::Row<S>> {
    let q = 4 * p;
    let base = stage.base[p] as usize;
    let k = along::<S, T>(simd);
    let w_row = T::Row::<S>::spread(simd, &stage.weights[D - 1][q..]);
    let zero = T::Row::splat(simd, T::default());

    let velocity = &tile[..tile_plane];
    let (mut sum, mut by_i, mut by_j) = (zero, zero, zero);
    for i in 0..K::NODES {
        let w_i = T::Row::splat(simd, stage.weights[0][q + i]);
        let (row, row_by_j) = plane_sums::<S, T, D, K>(
            simd,
            plane::<T, D, K>(velocity, base, i, tile_edge),
            tile_edge,
            &stage.weights[1][q..],
        );
        let part = w_i * row;
        sum = sum + part;
        by_i = add_moment::<S, T, K>(simd, by_i, i, part);
        if D == 3 {
            by_j = w_i.mul_add(row_by_j, by_j);
        }
    }
    let sum = sum * w_row;
    let mut momentum = [sum, by_i * w_row, zero, zero];
    if D == 3 {
        momentum[2] = by_j * w_row;
    }
    momentum[D] = sum * (k + T::Row::splat(simd, T::from_f64(-(K::CENTRE as f64))));

    let mut impulse = [zero; 4];
    if SPLIT {
        let change = &tile[tile_plane..];
        let mut sum = zero;
        for i in 0..K::NODES {
            sum = T::Row::splat(simd, stage.weights[0][q + i]).mul_add(
                plane_sums::<S, T, D, K>(
                    simd,
                    plane::<T, D, K>(change, base, i, tile_edge),
                    tile_edge,
                    &stage.weights[1][q..],
                )
                .0,
                sum,
            );
        }
        impulse[0] = sum * w_row;
    }
    if CLASSIC {
        let g_row = T::Row::<S>::spread(simd, &stage.gradients[D - 1][q..]);
        let (mut by_x, mut by_y, mut by_row) = (zero, zero, zero);
        for i in 0..K::NODES {
            let (w_i, g_i) = (
                T::Row::splat(simd, stage.weights[0][q + i]),
                T::Row::splat(simd, stage.gradients[0][q + i]),
            );
            let weighted = plane_sums::<S, T, D, K>(
                simd,
                plane::<T, D, K>(velocity, base, i, tile_edge),
                tile_edge,
                &stage.weights[1][q..],
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
                        &stage.gradients[1][q..],
                    )
                    .0,
                    by_y,
                );
            }
        }
        impulse[1] = by_x * w_row;
        if D == 3 {
            impulse[2] = by_y * w_row;
        }
        impulse[D] = by_row * g_row;
    }
    Sums { momentum, impulse }
}
