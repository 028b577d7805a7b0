//! The two transfers between particles and nodes.
//!
//! Each walks over the blocks of a group. The particles of a block are worked on in chunks, step by step through buffers
//! that stay in the first-level cache, so that laws and transfers are compiled apart:
//!
//! ```text
//! P2G   law: strain → stress     │ weights, Q_p: lanes of particles │ rows of nodes += particle
//! G2P   rows of nodes → particle │ v, C, x: lanes of particles      │ law: strain advances
//! ```
//!
//! In "lanes" a register holds the same number of 16 (f64: 8) particles; in "rows" it holds four nodes of one particle.
//! Rows restate the sums (2), (5) and (6), as [`rows`] explains.

pub(crate) mod g2p;
pub(crate) mod p2g;
pub(crate) mod rows;
pub(crate) mod stencil;
pub(crate) mod walk;

use crate::grid::{Grid, NodeField, tile_edge, tile_layer};
use crate::math::Lanes;
use crate::particles::Run;
use fearless_simd::Simd;

/// Numbers of the largest tile: cubic in 3D, two layers.
const LARGEST_TILE: usize = 2 * tile_layer::<3>(tile_edge::<3>(4));

/// A copy of the nodes that a tile's particles read, aligned to a line of the cache.
#[repr(align(64))]
pub(crate) struct TileCopy<T>(pub(crate) [T; LARGEST_TILE]);

impl<T: Lanes> TileCopy<T> {
    pub(crate) fn new() -> Self {
        Self([T::default(); LARGEST_TILE])
    }

    /// Copies the nodes of `field` that the particles of the first of `runs` read, and prefetches those of the second.
    #[inline(always)]
    pub(crate) fn load<Q, S: Simd, const D: usize>(
        &mut self,
        simd: S,
        grid: &Grid<T, D>,
        field: &NodeField<Q, T>,
        runs: &[Run<D>],
    ) {
        let tile = runs[0].tile as usize;
        let reach = grid.reach_of_rows(tile);
        grid.copy_tile(simd, field, tile, reach, &mut self.0);
        if let Some(next) = runs.get(1) {
            let tile = next.tile as usize;
            grid.prefetch_nodes_of(field, tile, grid.reach_of_rows(tile));
        }
    }
}

/// Runs an expression with `$K` bound to the type of the scheme's kernel, and with constants for its choices: `$SPLIT` if
/// the impulse of stress has a layer of its own, `$CLASSIC` for the force of the original MPM. `$simd` is the token of the
/// instruction set. The combinations that most scenes use are compiled for every instruction set; the others, which serve
/// comparisons, for the portable one.
macro_rules! with_scheme {
    ($scheme:expr, $isa:expr, $simd:ident, $K:ident, $SPLIT:ident, $CLASSIC:ident => $body:expr) => {{
        use $crate::setup::{ForceForm, Kernel};
        let split = $scheme.layers() == 2;
        macro_rules! instance {
            ($kernel:ty, $s:literal, $c:literal, $on:ident $level:tt) => {{
                type $K = $kernel;
                const $SPLIT: bool = $s;
                const $CLASSIC: bool = $c;
                $crate::transfer::with_scheme!(@run $on $level, $simd => $body)
            }};
        }
        match ($scheme.kernel, split, $scheme.force) {
            (Kernel::Quadratic, false, ForceForm::Mls) => instance!($crate::kernel::Quadratic, false, false, wide ($isa.0)),
            (Kernel::Quadratic, true, ForceForm::Mls) => instance!($crate::kernel::Quadratic, true, false, wide ($isa.0)),
            (Kernel::Quadratic, false, ForceForm::Classic) => instance!($crate::kernel::Quadratic, false, true, portable ()),
            (Kernel::Quadratic, true, ForceForm::Classic) => instance!($crate::kernel::Quadratic, true, true, portable ()),
            (Kernel::Cubic, false, ForceForm::Mls) => instance!($crate::kernel::Cubic, false, false, portable ()),
            (Kernel::Cubic, true, ForceForm::Mls) => instance!($crate::kernel::Cubic, true, false, portable ()),
            (Kernel::Cubic, false, ForceForm::Classic) => instance!($crate::kernel::Cubic, false, true, portable ()),
            (Kernel::Cubic, true, ForceForm::Classic) => instance!($crate::kernel::Cubic, true, true, portable ()),
            (Kernel::Linear, false, _) => instance!($crate::kernel::Linear, false, true, portable ()),
            (Kernel::Linear, true, _) => instance!($crate::kernel::Linear, true, true, portable ()),
        }
    }};
    (@run wide ($level:expr), $simd:ident => $body:expr) => { $crate::dispatch::on_level!($level, $simd => $body) };
    (@run portable (), $simd:ident => $body:expr) => { $crate::dispatch::on_portable!($simd => $body) };
}

pub(crate) use with_scheme;
