//! The workspace: buffers of the substep, which can be dropped and made again from the state.

use super::State;
use crate::boundary::colliders::placed::Moving;
use crate::boundary::constraint::Boundaries;
use crate::boundary::impulse::Impulse;
use crate::error::SetupError;
use crate::force::nodes::NodeImpulses;
use crate::grid::operations::NodeVector;
use crate::grid::{BLOCK_NODES, Grid, Momentum, NodeField, QUAD, Velocity, Volume};
use crate::instance::Instance;
use crate::material::IsaToken;
use crate::particles::{DRIFT_LIMIT, Sorter};
use crate::setup::Scheme;
use crate::setup::check::CheckedSetup;

/// What a substep works with besides the state. Nothing in it outlives a substep but the layout of the grid,
/// which follows from the blocks that the particles are in.
pub(crate) struct Workspace<T, const D: usize> {
    pub(crate) scheme: Scheme,
    pub(crate) isa: IsaToken,
    pub(crate) grid: Grid<T, D>,
    /// From the sums over tiles to the forces.
    pub(crate) momentum: NodeField<Momentum, T>,
    /// From the forces to G2P.
    pub(crate) velocity: NodeField<Velocity, T>,
    /// The storage of node fields, while none of them is in use.
    spare: Vec<T>,
    /// Δt a of the forces that differ from node to node \[m/s\].
    pub(crate) node_impulses: NodeImpulses<T, D>,
    /// A buffer of the volume correction: the excess of volume at each node.
    pub(crate) excess: NodeVector<T, 1>,
    pub(crate) boundaries: Boundaries<D>,
    pub(crate) sorter: Sorter<T, D>,
    /// Sorts of all particles since the workspace was made.
    pub(crate) sorts: u64,
    /// The colliders in the present substep.
    pub(crate) colliders: Vec<Moving<D>>,
    /// By run and collider, the impulse on the collider by particles that are projected out.
    pub(crate) impulses_by_run: Vec<Impulse<D>>,
}

impl<T: Instance<D>, const D: usize> Workspace<T, D> {
    /// Creates the workspace of a simulation without particles.
    ///
    /// # Errors
    /// If this machine lacks the setup's instruction set.
    pub(crate) fn new(scene: &CheckedSetup<D>) -> Result<Self, SetupError> {
        let setup = &scene.setup;
        let Some(level) = setup.isa.level() else {
            return Err(SetupError {
                key: "isa".into(),
                message: format!("this machine has no {}", setup.isa.name()),
            });
        };
        let scheme = Scheme {
            kernel: setup.kernel,
            force: setup.force,
            transfer: setup.transfer,
            dx: setup.dx,
        };
        let period = scene
            .lattice
            .period
            .map(|cells| cells.map(|cells| cells as f64));
        let colliders = scene.colliders.iter();
        Ok(Self {
            scheme,
            isa: IsaToken(level),
            grid: Grid::new(scheme),
            momentum: NodeField::default(),
            velocity: NodeField::default(),
            spare: Vec::new(),
            node_impulses: NodeVector::default(),
            excess: NodeVector::default(),
            boundaries: Boundaries::new(scheme),
            sorter: Sorter::default(),
            sorts: 0,
            colliders: colliders
                .map(|collider| Moving::of(collider, period))
                .collect(),
            impulses_by_run: Vec::new(),
        })
    }

    /// Makes the grid's blocks and tiles where the particles of `state` are, and tells the runs their tiles.
    pub(crate) fn rebuild(&mut self, scene: &CheckedSetup<D>, state: &mut State<T, D>) {
        self.grid.rebuild(&mut state.groups, scene.walls.period);
        self.boundaries.rebuild(self.grid.blocks(), &scene.walls);
    }

    /// Sorts the particles by block if one of them may have left its block's tile.
    pub(crate) fn sort_if_drifted(&mut self, scene: &CheckedSetup<D>, state: &mut State<T, D>) {
        if state.drift <= DRIFT_LIMIT {
            return;
        }
        for group in &mut state.groups {
            state.escaped += self.sorter.sort(group, &scene.walls, &scene.lattice);
        }
        self.rebuild(scene, state);
        state.drift = 0.0;
        self.sorts += 1;
    }

    /// Places the colliders for a substep of `dt` \[s\].
    pub(crate) fn place_colliders(
        &mut self,
        scene: &CheckedSetup<D>,
        state: &State<T, D>,
        dt: f64,
    ) {
        let time = state.control.time();
        for (moving, collider) in self.colliders.iter_mut().zip(&scene.colliders) {
            moving.move_to(collider, time, dt);
        }
    }

    /// Copies what it takes to measure the particles on a grid of their own.
    pub(crate) fn for_measuring(&self) -> Self {
        Self {
            scheme: self.scheme,
            isa: self.isa,
            grid: self.grid.clone(),
            momentum: NodeField::default(),
            velocity: NodeField::default(),
            spare: Vec::new(),
            node_impulses: NodeVector::default(),
            excess: NodeVector::default(),
            boundaries: self.boundaries.clone(),
            sorter: Sorter::default(),
            sorts: 0,
            colliders: Vec::new(),
            impulses_by_run: Vec::new(),
        }
    }

    /// Takes the storage of node fields, to make one of. The fields of the last substep are gone afterwards.
    pub(crate) fn take_node_storage(&mut self) -> Vec<T> {
        let momentum = core::mem::take(&mut self.momentum).into_storage();
        let velocity = core::mem::take(&mut self.velocity).into_storage();
        let spare = core::mem::take(&mut self.spare);
        // At most one of them is in use.
        [momentum, velocity, spare]
            .into_iter()
            .max_by_key(Vec::capacity)
            .unwrap_or_default()
    }

    /// Gives the storage of a node field back.
    pub(crate) fn give_node_storage<Q>(&mut self, field: NodeField<Q, T>) {
        self.spare = field.into_storage();
    }

    /// Bytes of memory of the grid and of the fields on its nodes.
    pub(crate) fn grid_bytes(&self) -> usize {
        let node = size_of::<T>() * QUAD * self.scheme.layers();
        self.grid.bytes() + node * BLOCK_NODES * self.grid.blocks().len()
    }

    /// Sums the particles' rest volumes on the nodes.
    pub(crate) fn rest_volumes(&mut self, state: &State<T, D>) -> NodeField<Volume, T> {
        let (scheme, isa) = (self.scheme, self.isa);
        for group in &state.groups {
            T::add_volumes(group, scheme, isa, false, self.grid.tiles_mut());
        }
        let storage = self.take_node_storage();
        T::sum_volumes(&self.grid, isa, storage)
    }

    /// Measures the space that is filled \[m³; m² in 2D\]: Σ over nodes of min(1, rest volume at the node / dxᴰ)
    /// dxᴰ. Particles must be inside of their blocks' tiles.
    pub(crate) fn filled_volume(&mut self, state: &State<T, D>) -> f64 {
        let volumes = self.rest_volumes(state);
        let cell = self.scheme.dx.powi(D as i32);
        let filled = volumes.quads().map(|quad| quad[0].to_f64().min(cell));
        let total = filled.fold(0.0, |total, volume| total + volume);
        self.give_node_storage(volumes);
        total
    }
}
