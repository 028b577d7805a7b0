//! The grid: blocks of 64 nodes that exist only where particles are, and the tiles that the work is
//! done on.
//!
//! A *tile* is a block with its halo: all nodes that the block's particles touch, even after they
//! have drifted by one cell. P2G adds to the tiles, each by one thread; the grid update adds up what
//! the tiles say of each block's nodes; G2P reads a copy of a tile's worth of nodes.
//!
//! ```text
//!            tile of block b (quadratic, edge 4):   nodes −1 .. 7
//!   −1 | 0  1  2  3 | 4  5  6          what lies outside 0..4 belongs to its neighbours
//! ```
//!
//! Each node sums its contributions in ascending order of the contributing blocks' coordinates.
//! That order is the definition; it depends neither on threads nor on where the scene lies.
//!
//! A node is a *quad* of four numbers: `[p_x, p_y, p_z, m]` in 3D, `[p_x, p_y, 0, m]` in 2D; after
//! the update velocity stands where momentum was. Schemes that need the velocity before forces have
//! a second plane of quads.

mod columns;
mod filling;
mod links;
mod surfaces;
mod tile;

use crate::boundary::collider::Moving;
use crate::boundary::impulse::Taken;
use crate::boundary::walls::Walls;
use crate::dispatch::on_level;
use crate::forces::{self, Force};
use crate::material::IsaToken;
use crate::math::{Lanes, Real, Register, Vector};
use crate::parallel;
use crate::particles::{Group, block_edge};
use crate::prefetch::prefetch;
use crate::setup::Scheme;
use crate::setup::Transfer;
use columns::Columns;
use core::ops::Range;
use fearless_simd::Simd;
pub(crate) use filling::OUTSIDE;
use links::{Link, Links};
use surfaces::Near;
pub(crate) use tile::{Reach, Tiles, tile_edge, tile_plane};

/// Numbers a node and plane.
pub(crate) const QUAD: usize = 4;

/// Nodes that are read and written together.
const ROW: usize = 4;

/// Nodes a block, in 2D and 3D.
pub(crate) const BLOCK_NODES: usize = 64;

/// Forces on nodes that are not stress: gravity, drag and the hand. (Accelerations that differ from
/// node to node are in the grid.)
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeForces<T, const D: usize> {
    pub(crate) dt: T,
    /// \[m\]
    pub(crate) dx: f64,
    /// Δt g.
    pub(crate) gravity_impulse: Vector<T, D>,
    /// The medium's velocity, and what is left of the difference to it after Δt.
    pub(crate) drag: Option<(T, Vector<T, D>)>,
    pub(crate) pointer: Option<NodePointer<D>>,
}

/// [`crate::setup::Pointer`] in cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodePointer<const D: usize> {
    pub(crate) centre: [f64; D],
    pub(crate) radius: f64,
    pub(crate) softening: f64,
    pub(crate) action: crate::setup::PointerAction,
}

/// Blocks, tiles, and how they hang together.
#[derive(Clone)]
pub(crate) struct Grid<T, const D: usize> {
    /// Planes of quads: 1, or 2 if the scheme needs velocity before forces.
    planes: usize,
    /// Nodes along the edge of a tile.
    tile_edge: usize,
    /// Blocks that particles are in, ascending; each has a tile.
    tile_blocks: Vec<[i32; D]>,
    /// By tile, whether a group scatters to it; while tiles are given out.
    claimed: Vec<bool>,
    /// Blocks that have nodes, ascending.
    blocks: Vec<[i32; D]>,
    links: Links<D>,
    columns: Columns<D>,
    tiles: Vec<T>,
    /// By tile, what its last scatters reached.
    reach: Vec<Reach<D>>,
    nodes: Vec<T>,
    /// Δt a of forces that differ from node to node, D numbers a node; empty if there are none.
    impulses: Vec<T>,
    /// How much of its own velocity a particle keeps: FLIP's blend.
    blend: f64,
    /// By the number of the domain's side, and then by collider, what it took in the last update;
    /// lengths in cells from node 0.
    pub(crate) taken: Vec<Taken<D>>,
    /// By node of the tiles' blocks, what [`Grid::measure_filling`] found.
    excess: Vec<T>,
    /// By collider.
    near: Vec<Near<D>>,
}

impl<T: Lanes, const D: usize> Grid<T, D> {
    /// An empty grid for the kernel and transfer of `scheme`.
    pub(crate) fn new(scheme: Scheme) -> Self {
        Self {
            planes: scheme.planes(),
            tile_edge: tile_edge::<D>(scheme.kernel_nodes()),
            tile_blocks: Vec::new(),
            claimed: Vec::new(),
            blocks: Vec::new(),
            links: Links::new(),
            columns: Columns::default(),
            tiles: Vec::new(),
            reach: Vec::new(),
            nodes: Vec::new(),
            impulses: Vec::new(),
            blend: match scheme.transfer {
                Transfer::Flip { blend } => blend,
                Transfer::Pic | Transfer::Apic => 0.0,
            },
            taken: vec![Taken::NOTHING; 2 * D],
            excess: Vec::new(),
            near: Vec::new(),
        }
    }

    pub(crate) fn block_count(&self) -> usize {
        self.blocks.len()
    }

    pub(crate) fn bytes(&self) -> usize {
        let reals = [&self.tiles, &self.nodes, &self.impulses, &self.excess];
        size_of::<T>() * reals.map(Vec::capacity).into_iter().sum::<usize>()
            + self.links.bytes()
            + size_of::<Reach<D>>() * self.reach.capacity()
            + size_of::<[i32; D]>() * (self.blocks.capacity() + self.tile_blocks.capacity())
    }

    /// Numbers of one plane of a tile, padding included.
    pub(crate) fn tile_plane(&self) -> usize {
        tile_plane::<D>(self.tile_edge)
    }

    /// Numbers of a tile, all planes.
    pub(crate) fn tile_len(&self) -> usize {
        self.tile_plane() * self.planes
    }

    fn block_len(&self) -> usize {
        BLOCK_NODES * QUAD * self.planes
    }

    /// The tiles, to scatter to.
    pub(crate) fn tiles_mut(&mut self) -> Tiles<'_, T, D> {
        Tiles {
            len: self.tile_len(),
            numbers: &mut self.tiles,
            reach: &mut self.reach,
        }
    }

    /// Makes blocks and tiles for where the particles of `groups` are now, and tells their runs
    /// which tile is theirs.
    pub(crate) fn rebuild(&mut self, groups: &mut [Group<T, D>], walls: &Walls<D>) {
        self.tile_blocks.clear();
        for group in groups.iter() {
            self.tile_blocks
                .extend(group.runs.iter().map(|run| run.block));
        }
        self.tile_blocks.sort_unstable();
        self.tile_blocks.dedup();
        self.claimed.clear();
        self.claimed.resize(self.tile_blocks.len(), false);
        for group in groups {
            let mut tile = 0;
            for run in &mut group.runs {
                while self.tile_blocks[tile] != run.block {
                    tile += 1;
                }
                run.tile = tile as u32;
                run.first = !core::mem::replace(&mut self.claimed[tile], true);
            }
        }
        let period = &walls.period;
        self.links
            .find(&self.tile_blocks, self.tile_edge, period, &mut self.blocks);
        self.columns.find(&self.blocks, walls);
        // Stale numbers are never read: a tile's first scatter clears it, a block's update writes it.
        self.tiles
            .resize(self.tile_blocks.len() * self.tile_len(), T::default());
        self.reach.resize(self.tile_blocks.len(), Reach::NOTHING);
        self.nodes
            .resize(self.blocks.len() * self.block_len(), T::default());
    }

    /// Δt a of the forces that differ from node to node, at `time`; node 0 is at `origin`.
    pub(crate) fn evaluate(
        &mut self,
        forces: &[Force<D>],
        time: f64,
        dt: f64,
        origin: [f64; D],
        dx: f64,
    ) {
        let mut impulses = core::mem::take(&mut self.impulses);
        impulses.resize(self.blocks.len() * BLOCK_NODES * D, T::default());
        let grain = parallel::grain(self.blocks.len(), 4);
        let this = &*self;
        parallel::for_chunks(&mut impulses, BLOCK_NODES * D, 0, grain, &|first, piece| {
            let _flush = crate::float_mode::FlushToZero::enter();
            let (mut scratch, mut found) = ([[0.0; D]; BLOCK_NODES], [[0.0; D]; BLOCK_NODES]);
            for (index, impulse) in piece.chunks_exact_mut(BLOCK_NODES * D).enumerate() {
                let positions = this.node_positions(first + index, origin, dx);
                forces::accelerations(
                    forces,
                    false,
                    time,
                    &positions,
                    &[],
                    &mut scratch,
                    &mut found,
                );
                for (impulse, a) in impulse.iter_mut().zip(found.as_flattened()) {
                    *impulse = T::from_f64(dt * a);
                }
            }
        });
        self.impulses = impulses;
    }

    /// Where a block's nodes are \[m\].
    fn node_positions(&self, block: usize, origin: [f64; D], dx: f64) -> [[f64; D]; BLOCK_NODES] {
        let edge = block_edge(D) as i64;
        let first: [i64; D] = self.blocks[block].map(|b| i64::from(b) * edge);
        core::array::from_fn(|index| {
            core::array::from_fn(|axis| {
                let node = first[axis] + axis_index::<D>(index, axis) as i64;
                origin[axis] + dx * node as f64
            })
        })
    }

    /// The largest |Δt a| of [`Self::evaluate`] on a node with mass; after an update.
    pub(crate) fn largest_impulse(&self) -> f64 {
        let mut largest = 0.0_f64;
        let blocks = self.nodes.chunks_exact(self.block_len());
        for (nodes, impulses) in blocks.zip(self.impulses.chunks_exact(BLOCK_NODES * D)) {
            let quads = nodes[..BLOCK_NODES * QUAD].chunks_exact(QUAD);
            for (quad, impulse) in quads.zip(impulses.chunks_exact(D)) {
                if quad[3] > T::default() {
                    let squared = impulse.iter().map(|a| a.to_f64() * a.to_f64()).sum();
                    largest = largest.max(squared);
                }
            }
        }
        largest.sqrt()
    }

    /// Sums the tiles' contributions and makes velocity of momentum: v = p/m + Δt g, then the walls.
    pub(crate) fn update(
        &mut self,
        isa: IsaToken,
        forces: &NodeForces<T, D>,
        walls: &Walls<D>,
        colliders: &[Moving<D>],
    ) {
        self.sum(isa, Some(forces));
        self.taken.clear();
        self.taken.resize(2 * D + colliders.len(), Taken::NOTHING);
        self.constrain(walls);
        let mut near = core::mem::take(&mut self.near);
        near.resize_with(colliders.len(), Near::default);
        for (collider, near) in colliders.iter().zip(&mut near) {
            self.around(collider, walls, forces.dx, near);
        }
        self.columns.fold(
            isa,
            &mut self.nodes,
            self.planes,
            walls,
            self.blend,
            &mut self.taken,
        );
        for (number, (collider, near)) in colliders.iter().zip(&mut near).enumerate() {
            self.hold(collider, 2 * D + number, near, walls);
        }
        self.near = near;
    }

    /// Lets the walls of [`crate::WallStyle::Nodes`] act.
    fn constrain(&mut self, walls: &Walls<D>) {
        let _flush = crate::float_mode::FlushToZero::enter();
        let edge = block_edge(D);
        let block_len = self.block_len();
        let blocks = self
            .blocks
            .iter()
            .zip(self.nodes.chunks_exact_mut(block_len));
        for (block, nodes) in blocks {
            let first: [i64; D] = block.map(|b| i64::from(b) * edge as i64);
            if !walls.touch(first, edge) {
                continue;
            }
            let (quads, changes) = nodes.split_at_mut(BLOCK_NODES * QUAD);
            for index in 0..BLOCK_NODES {
                let at = index * QUAD;
                let mass = quads[at + 3];
                if mass <= T::default() {
                    continue;
                }
                let node =
                    core::array::from_fn(|axis| first[axis] + axis_index::<D>(index, axis) as i64);
                let free = Vector::<T, D>::from_fn(|axis| quads[at + axis]);
                let velocity = walls.constrain(free, node, mass, &mut self.taken);
                for axis in 0..D {
                    quads[at + axis] = velocity[axis];
                    if self.planes == 2 {
                        changes[at + axis] += velocity[axis] - free[axis];
                    }
                }
            }
        }
    }

    /// The nodes on wall number `wall` of [`Walls::planes`], by index, and the normal impulse that each
    /// took in the last update \[kg m/s\].
    pub(crate) fn pressed(&self, wall: usize) -> impl Iterator<Item = ([i32; D], f64)> {
        self.columns.pressed(wall)
    }

    /// Sums the tiles' contributions and leaves them as they are.
    pub(crate) fn sum_tiles(&mut self, isa: IsaToken) {
        self.sum(isa, None);
    }

    /// Sums the tiles' contributions, and lets `forces` act on them.
    fn sum(&mut self, isa: IsaToken, forces: Option<&NodeForces<T, D>>) {
        let mut nodes = core::mem::take(&mut self.nodes);
        let block_len = self.block_len();
        let grain = parallel::grain(self.blocks.len(), 16);
        let this = &*self;
        parallel::for_chunks(&mut nodes, block_len, 0, grain, &|first, piece| {
            let _flush = crate::float_mode::FlushToZero::enter();
            on_level!(isa.0, simd => {
                for (index, block) in piece.chunks_exact_mut(block_len).enumerate() {
                    this.ask_for_tiles(first + index + 1);
                    this.gather_tiles(simd, first + index, block);
                    if let Some(forces) = forces {
                        this.update_block(simd, first + index, block, forces);
                    }
                }
            });
        });
        self.nodes = nodes;
    }

    /// (1), (2): the sums over particles that the tiles have begun.
    #[inline(always)]
    fn gather_tiles<S: Simd>(&self, simd: S, block: usize, nodes: &mut [T]) {
        nodes.fill(T::default());
        for link in self.links.of_block(block) {
            let tile = &self.tiles[link.tile as usize * self.tile_len()..][..self.tile_len()];
            let reach = self.reach[link.tile as usize];
            for plane in 0..self.planes {
                let from = &tile[plane * self.tile_plane()..];
                let to = &mut nodes[plane * BLOCK_NODES * QUAD..];
                self.rows(link, reach, |block_at, tile_at, len| {
                    T::add_quads(simd, &mut to[block_at..][..len], &from[tile_at..][..len]);
                });
            }
        }
    }

    /// Calls `row(place in the block, place in the tile, numbers)` for each run of nodes of `link` within
    /// `reach`.
    #[inline(always)]
    fn rows(&self, link: &Link<D>, reach: Reach<D>, mut row: impl FnMut(usize, usize, usize)) {
        let Some((low, high)) = link.within(reach) else {
            return;
        };
        let len = (high[D - 1] - low[D - 1]) * QUAD;
        for i in low[0]..high[0] {
            if D == 2 {
                let (in_block, in_tile) = self.places(link, [i, low[1], 0]);
                row(in_block, in_tile, len);
            } else {
                for j in low[1]..high[1] {
                    let (in_block, in_tile) = self.places(link, [i, j, low[D - 1]]);
                    row(in_block, in_tile, len);
                }
            }
        }
    }

    /// Where the quad of a node of `link` is in its block and in its tile; in 2D the third index is not used.
    #[inline(always)]
    fn places(&self, link: &Link<D>, node: [usize; 3]) -> (usize, usize) {
        let (mut in_block, mut in_tile) = (0, 0);
        for axis in 0..D {
            let of_tile = (node[axis] as isize + link.shift[axis] as isize) as usize;
            in_block = in_block * block_edge(D) + node[axis];
            in_tile = in_tile * self.tile_edge + of_tile;
        }
        (in_block * QUAD, in_tile * QUAD)
    }

    /// Calls `span(places in the block, places in the tile)` for the nodes of `link` within `reach`, of each
    /// index on the first axis: from the first to the last, with others between.
    #[inline(always)]
    fn spans(
        &self,
        link: &Link<D>,
        reach: Reach<D>,
        mut span: impl FnMut(Range<usize>, Range<usize>),
    ) {
        let Some((low, high)) = link.within(reach) else {
            return;
        };
        for i in low[0]..high[0] {
            let first = self.places(link, [i, low[1], low[D - 1]]);
            let last = self.places(link, [i, high[1] - 1, high[D - 1] - 1]);
            span(first.0..last.0 + QUAD, first.1..last.1 + QUAD);
        }
    }

    /// Asks memory for what [`Self::gather_tiles`] will read for `block`, if there is that block.
    #[inline(always)]
    fn ask_for_tiles(&self, block: usize) {
        for link in self.links.of_block(block) {
            let tile = link.tile as usize * self.tile_len();
            self.spans(link, self.reach[link.tile as usize], |_, span| {
                prefetch(&self.tiles[tile + span.start..][..span.len()]);
            });
        }
    }

    /// Asks memory for what [`Self::load_tile`] will read for `tile`.
    pub(crate) fn ask_for_nodes(&self, tile: usize, reach: Reach<D>) {
        for link in self.links.of_tile(tile) {
            let block = link.block as usize * self.block_len();
            self.spans(link, reach, |span, _| {
                prefetch(&self.nodes[block + span.start..][..span.len()]);
            });
        }
    }

    /// Momentum to velocity for the nodes of a block, and what acts on them all.
    #[inline(always)]
    fn update_block<S: Simd>(
        &self,
        simd: S,
        block: usize,
        nodes: &mut [T],
        forces: &NodeForces<T, D>,
    ) {
        let (momentum, change) = nodes.split_at_mut(BLOCK_NODES * QUAD);
        for first in (0..BLOCK_NODES).step_by(T::WIDTH) {
            let quads = &mut momentum[first * QUAD..];
            let mut node = T::load_quads(simd, quads);
            let mass = node[3];
            let empty = mass.le(mass.zero());
            let per_mass = mass.one() / mass;
            for axis in 0..D {
                let sum = node[axis];
                // Forces act on momentum, and then comes one division: added to velocities, gravity's impulse
                // would round the same way on every node of a body that moves as one.
                let mut impulse = mass.splat(forces.gravity_impulse[axis]) * mass;
                if self.planes == 2 {
                    let quads = &mut change[first * QUAD..];
                    let mut stress = T::load_quads(simd, quads);
                    impulse += stress[axis];
                    let before = sum * per_mass;
                    stress[axis] = Real::select(empty, stress[axis], before);
                    T::store_quads::<S>(stress, quads);
                }
                if !self.impulses.is_empty() {
                    impulse += self.node_impulses(simd, block * BLOCK_NODES + first, axis) * mass; // (9)
                }
                let mut velocity = (sum + impulse) * per_mass;
                if let Some((kept, medium)) = forces.drag {
                    let medium = mass.splat(medium[axis]);
                    velocity = medium + (velocity - medium) * mass.splat(kept); // (10)
                }
                node[axis] = Real::select(empty, sum, velocity);
            }
            T::store_quads::<S>(node, quads);
        }
        if let Some(pointer) = &forces.pointer {
            self.point(block, momentum, pointer, forces.dt);
        }
        if self.planes == 2 {
            // From the velocity before forces to the change by them.
            let nodes = momentum
                .chunks_exact(QUAD)
                .zip(change.chunks_exact_mut(QUAD));
            for (quad, change) in nodes.filter(|(quad, _)| !(quad[3] <= T::default())) {
                for axis in 0..D {
                    change[axis] = quad[axis] - change[axis];
                }
            }
        }
    }

    /// One axis of Δt a on the register of nodes that begins with `node`.
    #[inline(always)]
    fn node_impulses<S: Simd>(&self, simd: S, node: usize, axis: usize) -> T::Of<S> {
        let mut lanes = [T::default(); 16];
        let impulses = self.impulses[node * D..].chunks_exact(D);
        for (lane, impulse) in lanes[..T::WIDTH].iter_mut().zip(impulses) {
            *lane = impulse[axis];
        }
        T::load(simd, &lanes)
    }

    /// Lets the hand act on the nodes of a block.
    fn point(&self, block: usize, quads: &mut [T], pointer: &NodePointer<D>, dt: T) {
        let first: [i64; D] = self.blocks[block].map(|b| i64::from(b) * block_edge(D) as i64);
        for (index, quad) in quads.chunks_exact_mut(QUAD).enumerate() {
            if quad[3] <= T::default() {
                continue;
            }
            let node =
                core::array::from_fn(|axis| first[axis] + axis_index::<D>(index, axis) as i64);
            let velocity = pointer.act(Vector::from_fn(|axis| quad[axis]), node, dt);
            quad[..D].copy_from_slice(&velocity.0);
        }
    }

    /// Copies the nodes that tile `tile` covers, as far as `reach`.
    pub(crate) fn load_tile(&self, isa: IsaToken, tile: usize, reach: Reach<D>, out: &mut [T]) {
        on_level!(isa.0, simd => self.copy_tile(simd, tile, reach, out));
    }

    /// What to load of tile `tile` for the particles that were scattered to it last: rows are read four nodes
    /// at a time.
    pub(crate) fn reach_of_rows(&self, tile: usize) -> Reach<D> {
        let kernel_nodes = self.tile_edge - block_edge(D) - 1;
        let mut reach = self.reach[tile];
        reach.high[D - 1] += (ROW - kernel_nodes) as u8;
        if usize::from(reach.high[D - 1]) > self.tile_edge {
            return Reach::WHOLE; // such a row ends in another
        }
        reach
    }

    /// [`Self::load_tile`] where the instruction set is known.
    #[inline(always)]
    pub(crate) fn copy_tile<S: Simd>(&self, simd: S, tile: usize, reach: Reach<D>, out: &mut [T]) {
        for link in self.links.of_tile(tile) {
            let block = &self.nodes[link.block as usize * self.block_len()..][..self.block_len()];
            for plane in 0..self.planes {
                let from = &block[plane * BLOCK_NODES * QUAD..];
                let to = &mut out[plane * self.tile_plane()..];
                self.rows(link, reach, |block_at, tile_at, len| {
                    T::copy_quads(simd, &mut to[tile_at..][..len], &from[block_at..][..len]);
                });
            }
        }
    }

    /// The box around all blocks that particles are in, in cells.
    pub(crate) fn occupied(&self) -> ([f64; D], [f64; D]) {
        let edge = block_edge(D) as f64;
        let mut bounds = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for block in &self.tile_blocks {
            for axis in 0..D {
                let low = edge * f64::from(block[axis]);
                bounds.0[axis] = bounds.0[axis].min(low);
                bounds.1[axis] = bounds.1[axis].max(low + edge);
            }
        }
        bounds
    }

    /// Σ `f` over the first numbers of the nodes, after [`Grid::sum_tiles`]: for gauges.
    pub(crate) fn over_nodes(&self, f: impl Fn(f64) -> f64) -> f64 {
        let mut total = 0.0;
        for nodes in self.nodes.chunks_exact(self.block_len()) {
            for quad in nodes[..BLOCK_NODES * QUAD].chunks_exact(QUAD) {
                total += f(quad[0].to_f64());
            }
        }
        total
    }
}

/// Index of a block's node on one axis.
#[inline(always)]
const fn axis_index<const D: usize>(index: usize, axis: usize) -> usize {
    let edge = block_edge(D);
    match D - 1 - axis {
        0 => index % edge,
        1 => index / edge % edge,
        _ => index / (edge * edge),
    }
}
