//! The workspace: buffers of the substep, which can be dropped and made again from the state.

use super::State;
use crate::boundary::collider::Moving;
use crate::boundary::impulse::Taken;
use crate::error::SetupError;
use crate::grid::Grid;
use crate::instance::Instance;
use crate::material::IsaToken;
use crate::particles::{DRIFT_LIMIT, Sorter};
use crate::setup::Scheme;
use crate::setup::check::CheckedSetup;
use crate::transfer::scatter::What;

/// The buffers and constants of the substep. Nothing in it outlives a substep but the layout of the grid,
/// which follows from the blocks that the particles are in.
pub(crate) struct Workspace<T, const D: usize> {
    pub(crate) scheme: Scheme,
    pub(crate) isa: IsaToken,
    pub(crate) grid: Grid<T, D>,
    pub(crate) sorter: Sorter<T, D>,
    /// Sorts of all particles since the workspace was made.
    pub(crate) sorts: u64,
    /// The colliders in the present substep.
    pub(crate) colliders: Vec<Moving<D>>,
    /// Impulses that colliders take by projecting particles out, by run.
    pub(crate) impulses_by_run: Vec<Taken<D>>,
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
        self.grid.rebuild(&mut state.groups, &scene.walls);
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
            moving.put(collider, time, dt);
        }
    }

    /// Copies what it takes to measure the particles on a grid of their own.
    pub(crate) fn for_measuring(&self) -> Self {
        Self {
            scheme: self.scheme,
            isa: self.isa,
            grid: self.grid.clone(),
            sorter: Sorter::default(),
            sorts: 0,
            colliders: Vec::new(),
            impulses_by_run: Vec::new(),
        }
    }

    /// Sums the particles' rest volumes on the nodes.
    pub(crate) fn rest_volume_to_grid(&mut self, state: &State<T, D>) {
        let what = What::Volume { corrected: false };
        for group in &state.groups {
            T::scatter(
                group,
                self.scheme,
                self.isa,
                0.0,
                what,
                self.grid.tiles_mut(),
            );
        }
        T::sum_tiles(&mut self.grid, self.isa);
    }

    /// Measures the space that is filled \[m³; m² in 2D\]: Σ over nodes of min(1, rest volume at the node / dxᴰ)
    /// dxᴰ. Particles must be inside of their blocks' tiles.
    pub(crate) fn filled_volume(&mut self, state: &State<T, D>) -> f64 {
        self.rest_volume_to_grid(state);
        let cell = self.scheme.dx.powi(D as i32);
        self.grid.over_nodes(|volume| volume.min(cell))
    }
}
