//! Particles to grid: (1)–(4).

use super::{Stage, rows, with_scheme};
use crate::grid::{Reach, Tiles, tile_edge};
use crate::kernel::BSpline;
use crate::material::{IsaToken, load_matrix, load_vector};
use crate::math::{Lanes, Matrix, Real, Register, Vector};
use crate::parallel;
use crate::particles::{AHEAD, CHUNK, Chunk, Padded, Rows};
use crate::particles::{Group, Layout, Run, block_edge, slices, split_runs};
use crate::prefetch::prefetch_chunk;
use crate::setup::Scheme;
use crate::setup::{ForceForm, Transfer};
use fearless_simd::Simd;

/// What is scattered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    /// Momentum, mass and the impulse of stress.
    Momentum,
    /// For gauges and (7g) to (7i), a quad of V⁰, V⁰ (J − 1), and the same again from a group that is
    /// `corrected`, zeros from others.
    Volume {
        /// Whether this group is the one to be corrected.
        corrected: bool,
    },
}

/// Adds the particles of `group` to `tiles`. A tile that no group has been added to yet is
/// cleared first.
pub(crate) fn scatter<T: Lanes, const D: usize>(
    group: &Group<T, D>,
    scheme: Scheme,
    isa: IsaToken,
    dt: f64,
    what: What,
    tiles: Tiles<'_, T, D>,
) {
    let task = Task {
        group,
        columns: &slices(&group.columns)[..group.columns.len()],
        scheme,
        isa,
        impulse: match scheme.force {
            ForceForm::Mls => -dt * scheme.inverse_inertia() / scheme.dx,
            ForceForm::Classic => -dt / scheme.dx,
        },
        what,
    };
    let grain = parallel::grain(group.len(), 4096);
    task.halve(&group.runs, 0, tiles, grain);
}

struct Task<'a, T: Lanes, const D: usize> {
    group: &'a Group<T, D>,
    columns: &'a [&'a [T]],
    scheme: Scheme,
    isa: IsaToken,
    /// −Δt D⁻¹ dx, to be met by V⁰ τ r / dx; or −Δt / dx, to be met by V⁰ τ dx ∂w.
    impulse: f64,
    what: What,
}

impl<T: Lanes, const D: usize> Task<'_, T, D> {
    /// `tiles` begins with tile `first_tile`.
    fn halve(&self, runs: &[Run<D>], first_tile: u32, mut tiles: Tiles<'_, T, D>, grain: usize) {
        let Some((middle, _)) = split_runs(runs, grain) else {
            let _flush = crate::float_mode::FlushToZero::enter();
            let mut buffers = Buffers::new();
            with_scheme!(self.scheme, self.isa, simd, K, SPLIT, CLASSIC => {
                self.blocks::<_, K, SPLIT, CLASSIC>(simd, runs, first_tile, &mut tiles, &mut buffers);
            });
            return;
        };
        let (low, high) = runs.split_at(middle);
        let tile = high[0].tile;
        let (low_tiles, high_tiles) = tiles.split_at((tile - first_tile) as usize);
        parallel::join(
            || self.halve(low, first_tile, low_tiles, grain),
            || self.halve(high, tile, high_tiles, grain),
        );
    }

    /// Adds the particles of `runs` to their tiles.
    #[inline(always)]
    fn blocks<S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        runs: &[Run<D>],
        first_tile: u32,
        tiles: &mut Tiles<'_, T, D>,
        buffers: &mut Buffers<T>,
    ) {
        for run in runs {
            let index = (run.tile - first_tile) as usize;
            let tile = &mut tiles.numbers[index * tiles.len..][..tiles.len];
            let before = if run.first {
                tile.fill(T::default());
                Reach::NOTHING
            } else {
                tiles.reach[index]
            };
            self.block::<_, K, SPLIT, CLASSIC>(simd, run, tile, buffers);
            tiles.reach[index] = before.and(self.reach(&buffers.stage));
        }
    }

    /// Adds the particles of `run` to their tile; leaves how far they reach in the stage.
    #[inline(always)]
    fn block<S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        run: &Run<D>,
        tile: &mut [T],
        buffers: &mut Buffers<T>,
    ) {
        let Buffers {
            stage,
            padded,
            mass: mass_room,
            volume0: volume0_room,
        } = buffers;
        stage.lowest = [[T::from_f64(f64::INFINITY); 16]; 3];
        stage.highest = [[T::from_f64(f64::NEG_INFINITY); 16]; 3];
        for start in run.rows().step_by(CHUNK) {
            self.ask_for(start + AHEAD);
            let count = CHUNK.min(run.end as usize - start);
            let (mass, volume0) = (&self.group.mass, &self.group.volume0);
            let (mass, volume0) = (
                mass.rows(start, count, mass_room),
                volume0.rows(start, count, volume0_room),
            );
            let mut copies = None;
            let particles = Particles {
                chunk: padded.chunk(self.columns, start, count, &mut copies),
                mass,
                volume0,
            };
            self.chunk::<_, K, SPLIT, CLASSIC>(simd, &particles, tile, stage);
        }
    }

    #[inline(always)]
    fn chunk<S: Simd, K: BSpline, const SPLIT: bool, const CLASSIC: bool>(
        &self,
        simd: S,
        particles: &Particles<'_, T>,
        tile: &mut [T],
        stage: &mut Stage<T>,
    ) {
        let Chunk {
            columns,
            start,
            count,
        } = particles.chunk;
        let (law, strain) = (&self.group.law, &columns[Layout::strain(D)..]);
        if let What::Volume { corrected } = self.what {
            law.jacobian_minus_one(self.isa, strain, start, count, &mut stage.matrix[0]);
            prepare_volumes::<_, T, D, K>(simd, particles, corrected, stage);
            for p in 0..count {
                rows::scatter_quad::<_, T, D, K>(simd, stage, p, tile_edge::<D>(K::NODES), tile);
            }
            return;
        }
        let affine = &columns[Layout::affine(D)..];
        law.kirchhoff_stress(self.isa, strain, affine, start, count, &mut stage.matrix);
        prepare::<_, T, D, K, SPLIT, CLASSIC>(simd, self, particles, stage);
        let plane = crate::grid::tile_plane::<D>(tile_edge::<D>(K::NODES));
        for p in 0..count {
            rows::scatter::<_, T, D, K, SPLIT, CLASSIC>(
                simd,
                stage,
                p,
                tile_edge::<D>(K::NODES),
                plane,
                tile,
            );
        }
    }

    /// Asks memory for the chunk that begins with row `start`.
    fn ask_for(&self, start: usize) {
        match self.what {
            What::Momentum => {
                prefetch_chunk(self.columns, start);
                prefetch_chunk(&[self.group.mass.each_row()], start);
            }
            What::Volume { .. } => {
                prefetch_chunk(&self.columns[..D], start);
                prefetch_chunk(&self.columns[Layout::strain(D)..], start);
            }
        }
        prefetch_chunk(&[self.group.volume0.each_row()], start);
    }

    /// The nodes between the lowest and the highest places of a block's particles.
    fn reach(&self, stage: &Stage<T>) -> Reach<D> {
        let first = first_node(D);
        let node = |u: f64| (u.floor() + first) as u8;
        let mut reach = Reach::NOTHING;
        for axis in 0..D {
            let (mut lowest, mut highest) = (stage.lowest[axis][0], stage.highest[axis][0]);
            for (low, high) in stage.lowest[axis].iter().zip(&stage.highest[axis]) {
                lowest = lowest.min(*low);
                highest = highest.max(*high);
            }
            reach.low[axis] = node(lowest.to_f64());
            reach.high[axis] = node(highest.to_f64()) + self.scheme.kernel_nodes() as u8;
        }
        reach
    }
}

/// The node of a tile that a particle at u = 0 has for its base: tiles begin one node before their block.
fn first_node(dimension: usize) -> f64 {
    (block_edge(dimension) / 2) as f64 + 1.0
}

/// The stencil of a register of particles: weights to the stage; returns s, the place from the base
/// node in cells.
#[inline(always)]
pub(super) fn stencil<S: Simd, T: Lanes, const D: usize, K: BSpline, const CLASSIC: bool>(
    u: Vector<T::Of<S>, D>,
    p: usize,
    stage: &mut Stage<T>,
) -> Vector<T::Of<S>, D> {
    let first = u[0].lit(first_node(D));
    let edge = u[0].lit(tile_edge::<D>(K::NODES) as f64);
    let floor = Vector::<_, D>::from_fn(|axis| u[axis].floor());
    let frac = u - floor;
    let mut base = floor[0] + first;
    for axis in 1..D {
        base = base * edge + (floor[axis] + first);
    }
    T::store_whole::<S>(base, &mut stage.base[p..]);
    for axis in 0..D {
        T::store_quads::<S>(K::weights(frac[axis]), &mut stage.weights[axis][4 * p..]);
        if CLASSIC {
            T::store_quads::<S>(
                K::gradients(frac[axis]),
                &mut stage.gradients[axis][4 * p..],
            );
        }
    }
    frac + Vector::from_fn(|_| u[0].lit(K::OFFSET))
}

/// A vector's components and a fourth number, as a quad.
#[inline(always)]
fn quad<R: Real, const D: usize>(v: Vector<R, D>, fourth: R) -> [R; 4] {
    let zero = fourth.zero();
    [v[0], v[1], if D == 3 { v[D - 1] } else { zero }, fourth]
}

/// What a chunk's particles bring to the grid.
struct Particles<'a, T> {
    chunk: Chunk<'a, T>,
    mass: &'a Rows<T>,
    volume0: &'a Rows<T>,
}

/// What a thread needs room for.
struct Buffers<T> {
    stage: Stage<T>,
    padded: Padded<T>,
    mass: Rows<T>,
    volume0: Rows<T>,
}

impl<T: Lanes> Buffers<T> {
    fn new() -> Self {
        Self {
            stage: Stage::new(),
            padded: Padded::new(),
            mass: [T::default(); CHUNK],
            volume0: [T::default(); CHUNK],
        }
    }
}

/// Remembers how far the first `count` of a register of particles reach.
#[inline(always)]
fn note_places<S: Simd, T: Lanes, const D: usize>(
    simd: S,
    u: Vector<T::Of<S>, D>,
    count: usize,
    stage: &mut Stage<T>,
) {
    for axis in 0..D {
        let (lowest, highest) = (&mut stage.lowest[axis], &mut stage.highest[axis]);
        if count < T::WIDTH {
            for lane in 0..count {
                lowest[lane] = lowest[lane].min(u[axis].lane(lane));
                highest[lane] = highest[lane].max(u[axis].lane(lane));
            }
            continue;
        }
        T::store::<S>(T::load(simd, lowest).min(u[axis]), lowest);
        T::store::<S>(T::load(simd, highest).max(u[axis]), highest);
    }
}

/// Weights, and a quad of volumes each, for a chunk; J − 1 is in the stage.
#[inline(always)]
fn prepare_volumes<S: Simd, T: Lanes, const D: usize, K: BSpline>(
    simd: S,
    particles: &Particles<'_, T>,
    corrected: bool,
    stage: &mut Stage<T>,
) {
    let chunk = particles.chunk;
    let mut p = 0;
    while p < chunk.count {
        let u = load_vector::<S, T, D>(simd, chunk.columns, chunk.start + p);
        note_places::<S, T, D>(simd, u, chunk.count - p, stage);
        stencil::<S, T, D, K, false>(u, p, stage);
        let volume0 = T::load(simd, &particles.volume0[p..]);
        let dilated = volume0 * T::load(simd, &stage.matrix[0][p..]);
        let own = volume0.lit(if corrected { 1.0 } else { 0.0 });
        T::store_quads::<S>(
            [volume0, dilated, volume0 * own, dilated * own],
            &mut stage.momentum[0][4 * p..],
        );
        p += T::WIDTH;
    }
}

/// (3), (4) for a chunk: weights, and what each particle gives by rows.
#[inline(always)]
fn prepare<
    S: Simd,
    T: Lanes,
    const D: usize,
    K: BSpline,
    const SPLIT: bool,
    const CLASSIC: bool,
>(
    simd: S,
    task: &Task<'_, T, D>,
    particles: &Particles<'_, T>,
    stage: &mut Stage<T>,
) {
    let dx = task.scheme.dx;
    let apic = task.scheme.transfer == Transfer::Apic;
    let columns = &particles.chunk.columns[..Layout::strain(D)];
    let mut p = 0;
    while p < particles.chunk.count {
        let at = particles.chunk.start + p;
        let u = load_vector(simd, columns, at);
        note_places::<S, T, D>(simd, u, particles.chunk.count - p, stage);
        let s = stencil::<S, T, D, K, CLASSIC>(u, p, stage);
        let m = T::load(simd, &particles.mass[p..]);
        let zero = m.zero();
        let volume0 = T::load(simd, &particles.volume0[p..]);
        let v = load_vector(simd, &columns[Layout::velocity(D)..], at);
        // dx Q, column by column: its motion part and its stress part.
        let mut affine = Matrix([Vector([zero; D]); D]);
        if apic {
            affine = load_matrix(simd, &columns[Layout::affine(D)..], at) * (m * m.lit(dx));
        }
        let volume = volume0 * m.lit(task.impulse);
        let mut stress = affine;
        for j in 0..D {
            for i in 0..D {
                stress.0[j][i] = T::load(simd, &stage.matrix[j * D + i][p..]) * volume;
            }
        }
        if CLASSIC {
            for axis in 0..D {
                T::store_quads::<S>(
                    quad(stress.0[axis], zero),
                    &mut stage.impulse[1 + axis][4 * p..],
                );
            }
        } else if SPLIT {
            T::store_quads::<S>(quad(-(stress * s), zero), &mut stage.impulse[0][4 * p..]);
            for axis in 0..D {
                T::store_quads::<S>(
                    quad(stress.0[axis], zero),
                    &mut stage.impulse[1 + axis][4 * p..],
                );
            }
        } else {
            affine += stress; // (4)
        }
        T::store_quads::<S>(quad(v * m - affine * s, m), &mut stage.momentum[0][4 * p..]);
        for axis in 0..D {
            T::store_quads::<S>(
                quad(affine.0[axis], zero),
                &mut stage.momentum[1 + axis][4 * p..],
            );
        }
        p += T::WIDTH;
    }
}
