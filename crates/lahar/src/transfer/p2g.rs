//! Particles to grid: (1)–(4). What particles bring is a [`Payload`]: their momentum, or their volumes.

use super::stencil::{MomentumQuads, Stencils, VolumeQuads, first_node};
use super::walk::{Cut, Piece, Walk};
use super::{rows, with_scheme};
use crate::dispatch::{on_level, on_portable};
use crate::grid::{Reach, Tiles, tile_edge, tile_layer};
use crate::kernel::{BSpline, Cubic, Linear, Quadratic};
use crate::material::{IsaToken, load_matrix, load_vector};
use crate::math::{Lanes, Matrix, Real, Register, Vector};
use crate::particles::{AHEAD, CHUNK, Chunk, Group, Layout, Padded, Rows, Run, slices};
use crate::prefetch::prefetch_chunk;
use crate::setup::{ForceForm, Kernel, Scheme, Transfer};
use core::marker::PhantomData;
use fearless_simd::Simd;

/// Adds mass, momentum and the impulse of stress of the particles of `group` to `tiles`, for a substep of `dt` \[s\]. A tile
/// that no group has been added to yet is cleared first.
pub(crate) fn add_momentum<T: Lanes, const D: usize>(
    group: &Group<T, D>,
    scheme: Scheme,
    isa: IsaToken,
    dt: f64,
    tiles: Tiles<'_, T, D>,
) {
    let task = MomentumTask {
        source: Source {
            group,
            columns: &slices(&group.columns)[..group.columns.len()],
            isa,
        },
        scheme,
        impulse: match scheme.force {
            ForceForm::Mls => -dt * scheme.inverse_inertia() / scheme.dx,
            ForceForm::Classic => -dt / scheme.dx,
        },
    };
    task.walk(&group.runs, group.len(), tiles);
}

/// Adds the volumes of the particles of `group` to `tiles`: the quads of [`Volume`](crate::grid::Volume), with its second
/// half if this is the group to be `corrected`. A tile that no group has been added to yet is cleared first.
pub(crate) fn add_volumes<T: Lanes, const D: usize>(
    group: &Group<T, D>,
    scheme: Scheme,
    isa: IsaToken,
    corrected: bool,
    tiles: Tiles<'_, T, D>,
) {
    let task = VolumeTask {
        source: Source {
            group,
            columns: &slices(&group.columns)[..group.columns.len()],
            isa,
        },
        scheme,
        corrected,
    };
    task.walk(&group.runs, group.len(), tiles);
}

/// The particles of a group.
#[derive(Clone, Copy)]
struct Source<'a, T: Lanes, const D: usize> {
    group: &'a Group<T, D>,
    columns: &'a [&'a [T]],
    isa: IsaToken,
}

/// P2G of momentum.
struct MomentumTask<'a, T: Lanes, const D: usize> {
    source: Source<'a, T, D>,
    scheme: Scheme,
    /// −Δt D⁻¹ dx, for the product with V⁰ τ r / dx; or −Δt / dx, for that with V⁰ τ dx ∂w.
    impulse: f64,
}

impl<'a, T: Lanes, const D: usize> Walk<D> for MomentumTask<'a, T, D> {
    type Data = Tiles<'a, T, D>;
    type Found = ();

    fn cut(&self, tiles: Self::Data, cut: Cut) -> (Self::Data, Self::Data) {
        tiles.split_before(cut.tile)
    }

    fn work(&self, piece: Piece<'_, Self::Data, D>) {
        let (dx, apic) = (self.scheme.dx, self.scheme.transfer == Transfer::Apic);
        let mut buffers = Buffers::new(MomentumQuads::new());
        with_scheme!(self.scheme, self.source.isa, simd, K, SPLIT, CLASSIC => {
            let payload = MomentumPayload::<K, SPLIT, CLASSIC> {
                dx,
                apic,
                impulse: self.impulse,
                kernel: PhantomData,
            };
            add_runs(simd, &payload, &self.source, piece, &mut buffers);
        });
    }

    fn join(&self, (): (), (): ()) {}
}

/// P2G of volumes.
struct VolumeTask<'a, T: Lanes, const D: usize> {
    source: Source<'a, T, D>,
    scheme: Scheme,
    corrected: bool,
}

impl<'a, T: Lanes, const D: usize> Walk<D> for VolumeTask<'a, T, D> {
    type Data = Tiles<'a, T, D>;
    type Found = ();

    fn cut(&self, tiles: Self::Data, cut: Cut) -> (Self::Data, Self::Data) {
        tiles.split_before(cut.tile)
    }

    fn work(&self, piece: Piece<'_, Self::Data, D>) {
        let corrected = self.corrected;
        let mut buffers = Buffers::new(VolumeQuads::new());
        // On the same instruction set as the momentum.
        match (self.scheme.kernel, self.scheme.force) {
            (Kernel::Quadratic, ForceForm::Mls) => on_level!(self.source.isa.0, simd => {
                let payload = VolumePayload::<Quadratic>::new(corrected);
                add_runs(simd, &payload, &self.source, piece, &mut buffers);
            }),
            (Kernel::Quadratic, ForceForm::Classic) => on_portable!(simd => {
                let payload = VolumePayload::<Quadratic>::new(corrected);
                add_runs(simd, &payload, &self.source, piece, &mut buffers);
            }),
            (Kernel::Cubic, _) => on_portable!(simd => {
                let payload = VolumePayload::<Cubic>::new(corrected);
                add_runs(simd, &payload, &self.source, piece, &mut buffers);
            }),
            (Kernel::Linear, _) => on_portable!(simd => {
                let payload = VolumePayload::<Linear>::new(corrected);
                add_runs(simd, &payload, &self.source, piece, &mut buffers);
            }),
        }
    }

    fn join(&self, (): (), (): ()) {}
}

/// A quantity that particles bring to the nodes of their stencils.
trait Payload<T: Lanes, const D: usize> {
    type Kernel: BSpline;
    /// What the particles of a chunk bring.
    type Quads;

    /// Prefetches the columns of the chunk that begins with row `start`.
    fn prefetch(&self, source: &Source<'_, T, D>, start: usize);

    /// Computes what the particles of a chunk bring, and their stencils.
    fn prepare<S: Simd>(
        &self,
        simd: S,
        source: &Source<'_, T, D>,
        particles: &Particles<'_, T>,
        stencils: &mut Stencils<T>,
        extent: &mut Extent<T>,
        quads: &mut Self::Quads,
    );

    /// Adds what particle `p` of the chunk brings to its nodes.
    fn add<S: Simd>(
        &self,
        simd: S,
        stencils: &Stencils<T>,
        quads: &Self::Quads,
        p: usize,
        tile: &mut [T],
    );
}

/// Adds the particles of the runs of `piece` to their tiles.
#[inline(always)]
fn add_runs<S: Simd, T: Lanes, P: Payload<T, D>, const D: usize>(
    simd: S,
    payload: &P,
    source: &Source<'_, T, D>,
    piece: Piece<'_, Tiles<'_, T, D>, D>,
    buffers: &mut Buffers<T, P::Quads>,
) {
    let mut tiles = piece.data;
    for run in piece.runs {
        let (tile, reach) = tiles.get_mut(run.tile as usize);
        let before = if run.first {
            tile.fill(T::default());
            Reach::NOTHING
        } else {
            *reach
        };
        add_run(simd, payload, source, run, tile, buffers);
        *reach = before.and(buffers.extent.reach::<D>(P::Kernel::NODES));
    }
}

/// Adds the particles of `run` to their tile; leaves their extent in the buffers.
#[inline(always)]
fn add_run<S: Simd, T: Lanes, P: Payload<T, D>, const D: usize>(
    simd: S,
    payload: &P,
    source: &Source<'_, T, D>,
    run: &Run<D>,
    tile: &mut [T],
    buffers: &mut Buffers<T, P::Quads>,
) {
    let Buffers {
        stencils,
        extent,
        quads,
        padded,
        mass: mass_buffer,
        volume0: volume0_buffer,
    } = buffers;
    *extent = Extent::empty();
    for start in run.rows().step_by(CHUNK) {
        payload.prefetch(source, start + AHEAD);
        let count = CHUNK.min(run.end as usize - start);
        let (mass, volume0) = (&source.group.mass, &source.group.volume0);
        let (mass, volume0) = (
            mass.rows(start, count, mass_buffer),
            volume0.rows(start, count, volume0_buffer),
        );
        let mut copies = None;
        let particles = Particles {
            chunk: padded.chunk(source.columns, start, count, &mut copies),
            mass,
            volume0,
        };
        payload.prepare(simd, source, &particles, stencils, extent, quads);
        for p in 0..count {
            payload.add(simd, stencils, quads, p, tile);
        }
    }
}

/// The particles of a chunk.
struct Particles<'a, T> {
    chunk: Chunk<'a, T>,
    mass: &'a Rows<T>,
    volume0: &'a Rows<T>,
}

/// The buffers of one thread.
struct Buffers<T, Q> {
    stencils: Stencils<T>,
    extent: Extent<T>,
    quads: Q,
    padded: Padded<T>,
    mass: Rows<T>,
    volume0: Rows<T>,
}

impl<T: Lanes, Q> Buffers<T, Q> {
    fn new(quads: Q) -> Self {
        Self {
            stencils: Stencils::new(),
            extent: Extent::empty(),
            quads,
            padded: Padded::new(),
            mass: [T::default(); CHUNK],
            volume0: [T::default(); CHUNK],
        }
    }
}

/// The lowest and the highest positions of a run's particles, lane by lane, on each axis.
#[repr(align(64))]
struct Extent<T> {
    lowest: [[T; 16]; 3],
    highest: [[T; 16]; 3],
}

impl<T: Lanes> Extent<T> {
    fn empty() -> Self {
        Self {
            lowest: [[T::from_f64(f64::INFINITY); 16]; 3],
            highest: [[T::from_f64(f64::NEG_INFINITY); 16]; 3],
        }
    }

    /// Includes the first `count` of a register of particles at `u`.
    #[inline(always)]
    fn include<S: Simd, const D: usize>(&mut self, simd: S, u: Vector<T::Of<S>, D>, count: usize) {
        for axis in 0..D {
            let (lowest, highest) = (&mut self.lowest[axis], &mut self.highest[axis]);
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

    /// Returns the nodes of the tile that the particles touch.
    fn reach<const D: usize>(&self, kernel_nodes: usize) -> Reach<D> {
        let first = first_node(D);
        let node = |u: f64| (u.floor() + first) as u8;
        let mut reach = Reach::NOTHING;
        for axis in 0..D {
            let (mut lowest, mut highest) = (self.lowest[axis][0], self.highest[axis][0]);
            for (low, high) in self.lowest[axis].iter().zip(&self.highest[axis]) {
                lowest = lowest.min(*low);
                highest = highest.max(*high);
            }
            reach.low[axis] = node(lowest.to_f64());
            reach.high[axis] = node(highest.to_f64()) + kernel_nodes as u8;
        }
        reach
    }
}

/// Returns the components of a vector and a fourth number, as a quad.
#[inline(always)]
fn quad<R: Real, const D: usize>(v: Vector<R, D>, fourth: R) -> [R; 4] {
    let zero = fourth.zero();
    [v[0], v[1], if D == 3 { v[D - 1] } else { zero }, fourth]
}

/// Volumes: the quads of [`Volume`](crate::grid::Volume).
struct VolumePayload<K> {
    corrected: bool,
    kernel: PhantomData<K>,
}

impl<K> VolumePayload<K> {
    fn new(corrected: bool) -> Self {
        Self {
            corrected,
            kernel: PhantomData,
        }
    }
}

impl<T: Lanes, K: BSpline, const D: usize> Payload<T, D> for VolumePayload<K> {
    type Kernel = K;
    type Quads = VolumeQuads<T>;

    #[inline(always)]
    fn prefetch(&self, source: &Source<'_, T, D>, start: usize) {
        prefetch_chunk(&source.columns[..D], start);
        prefetch_chunk(&source.columns[Layout::strain(D)..], start);
        prefetch_chunk(&[source.group.volume0.each_row()], start);
    }

    #[inline(always)]
    fn prepare<S: Simd>(
        &self,
        simd: S,
        source: &Source<'_, T, D>,
        particles: &Particles<'_, T>,
        stencils: &mut Stencils<T>,
        extent: &mut Extent<T>,
        quads: &mut VolumeQuads<T>,
    ) {
        let Chunk {
            columns,
            start,
            count,
        } = particles.chunk;
        let (law, strain) = (&source.group.law, &columns[Layout::strain(D)..]);
        law.jacobian_minus_one(source.isa, strain, start, count, &mut quads.expansion);
        let mut p = 0;
        while p < count {
            let u = load_vector::<S, T, D>(simd, columns, start + p);
            extent.include(simd, u, count - p);
            stencils.place::<S, D, K, false>(u, p);
            let volume0 = T::load(simd, &particles.volume0[p..]);
            let dilated = volume0 * T::load(simd, &quads.expansion[p..]);
            let own = volume0.lit(if self.corrected { 1.0 } else { 0.0 });
            T::store_quads::<S>(
                [volume0, dilated, volume0 * own, dilated * own],
                &mut quads.volumes[4 * p..],
            );
            p += T::WIDTH;
        }
    }

    #[inline(always)]
    fn add<S: Simd>(
        &self,
        simd: S,
        stencils: &Stencils<T>,
        quads: &VolumeQuads<T>,
        p: usize,
        tile: &mut [T],
    ) {
        let edge = tile_edge::<D>(K::NODES);
        rows::scatter_quad::<_, T, D, K>(simd, stencils, &quads.volumes, p, edge, tile);
    }
}

/// Mass, momentum and the impulse of stress, in a layer of its own if `SPLIT`; by the gradients of the weights if
/// `CLASSIC`.
struct MomentumPayload<K, const SPLIT: bool, const CLASSIC: bool> {
    /// Distance of the nodes \[m\].
    dx: f64,
    /// Whether particles bring affine momentum.
    apic: bool,
    /// As in [`MomentumTask`].
    impulse: f64,
    kernel: PhantomData<K>,
}

impl<T: Lanes, K: BSpline, const SPLIT: bool, const CLASSIC: bool, const D: usize> Payload<T, D>
    for MomentumPayload<K, SPLIT, CLASSIC>
{
    type Kernel = K;
    type Quads = MomentumQuads<T>;

    #[inline(always)]
    fn prefetch(&self, source: &Source<'_, T, D>, start: usize) {
        prefetch_chunk(source.columns, start);
        prefetch_chunk(&[source.group.mass.each_row()], start);
        prefetch_chunk(&[source.group.volume0.each_row()], start);
    }

    /// (3), (4): P₀ and dx Q of each particle.
    #[inline(always)]
    fn prepare<S: Simd>(
        &self,
        simd: S,
        source: &Source<'_, T, D>,
        particles: &Particles<'_, T>,
        stencils: &mut Stencils<T>,
        extent: &mut Extent<T>,
        quads: &mut MomentumQuads<T>,
    ) {
        let Chunk {
            columns,
            start,
            count,
        } = particles.chunk;
        let (law, strain) = (&source.group.law, &columns[Layout::strain(D)..]);
        let affine = &columns[Layout::affine(D)..];
        let kirchhoff_stress = &mut quads.kirchhoff_stress;
        law.kirchhoff_stress(source.isa, strain, affine, start, count, kirchhoff_stress);

        let columns = &columns[..Layout::strain(D)];
        let mut p = 0;
        while p < count {
            let at = start + p;
            let u = load_vector(simd, columns, at);
            extent.include(simd, u, count - p);
            let s = stencils.place::<S, D, K, CLASSIC>(u, p);
            let m = T::load(simd, &particles.mass[p..]);
            let zero = m.zero();
            let volume0 = T::load(simd, &particles.volume0[p..]);
            let v = load_vector(simd, &columns[Layout::velocity(D)..], at);
            // dx Q, column by column: its motion part and its stress part.
            let mut affine = Matrix([Vector([zero; D]); D]);
            if self.apic {
                let c = load_matrix(simd, &columns[Layout::affine(D)..], at);
                affine = c * (m * m.lit(self.dx));
            }
            let volume = volume0 * m.lit(self.impulse);
            let mut stress = affine;
            for j in 0..D {
                for i in 0..D {
                    let tau = T::load(simd, &quads.kirchhoff_stress[j * D + i][p..]);
                    stress.0[j][i] = tau * volume;
                }
            }
            if SPLIT && !CLASSIC {
                T::store_quads::<S>(quad(-(stress * s), zero), &mut quads.stress[0][4 * p..]);
            }
            if SPLIT || CLASSIC {
                for axis in 0..D {
                    let column = quad(stress.0[axis], zero);
                    T::store_quads::<S>(column, &mut quads.stress[1 + axis][4 * p..]);
                }
            } else {
                affine += stress; // (4)
            }
            let first = quad(v * m - affine * s, m);
            T::store_quads::<S>(first, &mut quads.momentum[0][4 * p..]);
            for axis in 0..D {
                let column = quad(affine.0[axis], zero);
                T::store_quads::<S>(column, &mut quads.momentum[1 + axis][4 * p..]);
            }
            p += T::WIDTH;
        }
    }

    #[inline(always)]
    fn add<S: Simd>(
        &self,
        simd: S,
        stencils: &Stencils<T>,
        quads: &MomentumQuads<T>,
        p: usize,
        tile: &mut [T],
    ) {
        let edge = tile_edge::<D>(K::NODES);
        let sizes = (edge, tile_layer::<D>(edge));
        rows::scatter::<_, T, D, K, SPLIT, CLASSIC>(simd, stencils, quads, p, sizes, tile);
    }
}
