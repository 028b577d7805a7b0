//! The substep: one declared list of stages, each a file.
//!
//! ```text
//! particles ──sort, volumes, particle forces──▶ P2G ──▶ nodes: sums, forces, boundaries ──▶ G2P ──▶ particles
//!                                                                            totals, time step, probes
//! ```

mod boundaries;
mod boundary_totals;
mod colliders;
mod g2p;
mod node_forces;
mod node_sums;
mod p2g;
mod particle_forces;
mod probes;
mod sort;
mod time_step;
mod times;
mod volume_correction;
mod volume_gathering;

use crate::error::{DtLimit, Failure};
use crate::instance::Instance;
use crate::setup::check::CheckedSetup;
use crate::state::State;
use crate::state::workspace::Workspace;
use times::{Phase, STAGE_COUNT};

pub use times::PhaseTimes;
pub(crate) use times::StageTimes;

/// The data that the stages of one substep work on.
pub(crate) struct Substep<'a, T: Instance<D>, const D: usize> {
    pub(crate) scene: &'a CheckedSetup<D>,
    pub(crate) state: &'a mut State<T, D>,
    pub(crate) workspace: &'a mut Workspace<T, D>,
    /// Length of the substep \[s\].
    pub(crate) dt: f64,
    pub(crate) limit: DtLimit,
    /// Time at its start \[s\].
    pub(crate) start: f64,
}

/// One stage of the substep.
pub(crate) struct Stage<T: Instance<D>, const D: usize> {
    pub(crate) name: &'static str,
    /// The phase that its time counts for.
    pub(crate) phase: Phase,
    run: fn(&mut Substep<'_, T, D>) -> Result<(), Failure>,
}

impl<T: Instance<D>, const D: usize> Stage<T, D> {
    const fn new(
        name: &'static str,
        phase: Phase,
        run: fn(&mut Substep<'_, T, D>) -> Result<(), Failure>,
    ) -> Self {
        Self { name, phase, run }
    }
}

impl<T: Instance<D>, const D: usize> Substep<'_, T, D> {
    /// The substep. A stage that has nothing to do returns at once.
    pub(crate) const STAGES: [Stage<T, D>; STAGE_COUNT] = [
        Stage::new("sort", Phase::Sort, sort::run),
        Stage::new("volume correction", Phase::Volume, volume_correction::run), // (7h), (7i)
        Stage::new("volume gathering", Phase::Volume, volume_gathering::run),   // (7g)
        Stage::new("particle forces", Phase::Other, particle_forces::run),      // (11)
        Stage::new("colliders", Phase::Other, colliders::run),
        Stage::new("particles to grid", Phase::Scatter, p2g::run), // (1)–(4)
        Stage::new("node sums", Phase::Grid, node_sums::run),      // (1), (2)
        Stage::new("node forces", Phase::Grid, node_forces::run),  // (9), (10)
        Stage::new("boundaries", Phase::Grid, boundaries::run),    // (13)–(15)
        Stage::new("grid to particles", Phase::Gather, g2p::run),  // (5)–(8)
        Stage::new("boundary totals", Phase::Other, boundary_totals::run),
        Stage::new("time step", Phase::Other, time_step::run),
        Stage::new("probes", Phase::Other, probes::run),
    ];
}

/// Takes one substep of `dt` \[s\], which `limit` has decided. Adds the seconds of each stage to
/// `times`.
///
/// # Errors
/// If a particle is lost; the state is that of the middle of the substep then.
pub(crate) fn substep<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    (dt, limit): (f64, DtLimit),
    times: &mut StageTimes,
) -> Result<(), Failure> {
    let mut substep = Substep {
        start: state.control.time(),
        scene,
        state,
        workspace,
        dt,
        limit,
    };
    let mut before = times.now();
    for (number, stage) in Substep::<T, D>::STAGES.iter().enumerate() {
        let result = (stage.run)(&mut substep);
        let after = times.now();
        times.seconds[number] += after - before;
        before = after;
        result?;
    }
    Ok(())
}
