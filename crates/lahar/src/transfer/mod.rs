//! The two loops between particles and nodes.
//!
//! Each runs over the blocks of a group; a block's particles are worked on in chunks, in stages
//! through a buffer that stays in the first-level cache, so that laws and transfers are compiled
//! apart:
//!
//! ```text
//! scatter   law: strain → stress   │ weights, Q_p: lanes of particles │ rows of nodes += particle
//! gather    rows of nodes → particle │ v, C, x: lanes of particles │ law: strain advances
//! ```
//!
//! "Lanes" means that a register holds the same number of 16 (f64: 8) particles; "rows" that it holds
//! four nodes of one particle. Rows restate the sums (2), (5) and (6): [`rows`] says how.

pub(crate) mod gather;
pub(crate) mod rows;
pub(crate) mod scatter;
pub(crate) mod volume;

use crate::grid::{Grid, tile_edge, tile_plane};
use crate::math::Lanes;
use crate::particles::Run;
use crate::particles::{CHUNK, Rows};
use fearless_simd::Simd;

/// Numbers of the largest tile: cubic in 3D, two planes.
const LARGEST_TILE: usize = 2 * tile_plane::<3>(tile_edge::<3>(4));

/// A copy of a tile's nodes, as far as they are read; it begins with a line of the cache.
#[repr(align(64))]
pub(crate) struct TileCopy<T>(pub(crate) [T; LARGEST_TILE]);

impl<T: Lanes> TileCopy<T> {
    pub(crate) fn new() -> Self {
        Self([T::default(); LARGEST_TILE])
    }

    /// Loads what the particles of the first of `runs` read, and asks memory for what those of the second will.
    #[inline(always)]
    pub(crate) fn load<S: Simd, const D: usize>(
        &mut self,
        simd: S,
        grid: &Grid<T, D>,
        runs: &[Run<D>],
    ) {
        let tile = runs[0].tile as usize;
        grid.copy_tile(simd, tile, grid.reach_of_rows(tile), &mut self.0);
        if let Some(next) = runs.get(1) {
            let tile = next.tile as usize;
            grid.ask_for_nodes(tile, grid.reach_of_rows(tile));
        }
    }
}

/// Buffers for one chunk of particles. A quad is four numbers of one particle; quads of a chunk
/// follow one another.
#[repr(align(64))]
pub(crate) struct Stage<T> {
    /// τ, or Δt ∂v/∂x: `[j·D + i][p]`. Of volumes, J − 1 in the first.
    pub(crate) matrix: [Rows<T>; 9],
    /// For each axis, the four weights of each particle.
    pub(crate) weights: [[T; 4 * CHUNK]; 3],
    /// For each axis, the four weight gradients of each particle (classic only).
    pub(crate) gradients: [[T; 4 * CHUNK]; 3],
    /// Scatter: P₀ and dx Q by column, of momentum. Gather: Σ w v and Σ w v n by column.
    pub(crate) momentum: [[T; 4 * CHUNK]; 4],
    /// Scatter: the same of the impulse of stress, where that is apart. Gather: Σ w Δv, and
    /// Σ v ∇w by column.
    pub(crate) impulse: [[T; 4 * CHUNK]; 4],
    /// Where each particle's first row begins in the tile, in nodes.
    pub(crate) base: [i32; CHUNK],
    /// The lowest places of a block's particles so far, lane by lane, on each axis.
    pub(crate) lowest: [[T; 16]; 3],
    /// The highest.
    pub(crate) highest: [[T; 16]; 3],
}

impl<T: Lanes> Stage<T> {
    pub(crate) fn new() -> Self {
        let zero = T::default();
        Self {
            matrix: [[zero; CHUNK]; 9],
            weights: [[zero; 4 * CHUNK]; 3],
            gradients: [[zero; 4 * CHUNK]; 3],
            momentum: [[zero; 4 * CHUNK]; 4],
            impulse: [[zero; 4 * CHUNK]; 4],
            base: [0; CHUNK],
            lowest: [[zero; 16]; 3],
            highest: [[zero; 16]; 3],
        }
    }
}

/// Runs an expression with `$K` bound to the kernel's type and `$SPLIT`, `$CLASSIC` to constants, on
/// `$simd`. The combination that most scenes use is compiled for every instruction set; the others,
/// kept for comparison, for the portable one.
macro_rules! with_scheme {
    ($scheme:expr, $isa:expr, $simd:ident, $K:ident, $SPLIT:ident, $CLASSIC:ident => $body:expr) => {{
        use $crate::setup::{ForceForm, Kernel};
        let split = $scheme.planes() == 2;
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
