//! [`Simulation`]: setup, state and workspace behind one face.

use crate::boundary::BoundaryImpulse;
use crate::error::{DtLimit, Failure, SetupError};
use crate::instance::Instance;
use crate::material::Law;
use crate::particles::{Field, Snapshot, block_edge};
use crate::setup::check::CheckedSetup;
use crate::setup::{Command, ParticleBatch, ProbeSamples, Setup, to_3d};
use crate::simulate::{Advance, Backend, Memory, Simulate};
use crate::state::checkpoint::{Checkpoint, CheckpointError};
use crate::state::diagnostics::{self, Diagnostics};
use crate::state::retry::{Retry, RetryPoint};
use crate::state::workspace::Workspace;
use crate::state::{State, add, probes, snapshot};
use crate::step::{PhaseTimes, StageTimes, Substep, substep};
use core::borrow::Borrow;

/// A simulation in `D` dimensions with numbers of type `T`.
///
/// ```
/// use lahar::{Material, ParticleBatch, Setup, Simulate, Simulation, material::Corotated, Model};
///
/// let jelly = Material { name: "jelly".into(), density: 1000.0, model: Model::Corotated(Corotated { lambda: 1e4, mu: 1e4 }) };
/// let mut setup = Setup::<2>::new(0.1, vec![jelly]);
/// setup.gravity = [0.0, -9.81];
/// let particles = ParticleBatch { position: vec![[0.2, 0.3], [0.25, 0.3]], volume: vec![0.0025], ..Default::default() };
/// let mut simulation = Simulation::<f32, 2>::new(setup, &[particles])?;
/// simulation.advance_to(0.1)?;
/// assert!(simulation.diagnostics().momentum[1] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Simulation<T: Instance<D>, const D: usize> {
    scene: CheckedSetup<D>,
    state: State<T, D>,
    workspace: Workspace<T, D>,
    /// The start of the frame, where one that fails begins again.
    retry_point: Option<RetryPoint<T, D>>,
    times: StageTimes,
    /// Sorts before the clock was given.
    sorts_before: u64,
}

impl<T: Instance<D>, const D: usize> Simulation<T, D> {
    /// Creates a simulation of `setup` with the particles of `batches`. Batches that are not borrowed are dropped
    /// one after the other.
    ///
    /// # Errors
    /// Names the key that cannot be simulated.
    pub fn new(
        setup: Setup<D>,
        batches: impl IntoIterator<Item: Borrow<ParticleBatch<D>>>,
    ) -> Result<Self, SetupError> {
        let materials = setup.materials.iter();
        let laws = materials
            .map(|material| T::built_in(&material.model))
            .collect();
        Self::with_laws(setup, laws, batches)
    }

    /// As [`Simulation::new`], with `laws[i]` in place of the model of material `i`: for models from outside of the
    /// crate, made into laws by [`crate::material::law`].
    ///
    /// # Errors
    /// Names the key that cannot be simulated.
    pub fn with_laws(
        setup: Setup<D>,
        laws: Vec<Box<dyn Law<T, D>>>,
        batches: impl IntoIterator<Item: Borrow<ParticleBatch<D>>>,
    ) -> Result<Self, SetupError> {
        const { assert!(D == 2 || D == 3, "two or three dimensions") };
        let scene = CheckedSetup::new(setup)?;
        if laws.len() != scene.setup.materials.len() {
            return Err(SetupError {
                key: "materials".into(),
                message: "each must have its law".into(),
            });
        }
        let mut workspace = Workspace::new(&scene)?;
        let mut state = State::new(&scene, laws);
        add::add(&scene, &mut state, &mut workspace, batches)?;
        probes::read(&scene, &mut state, &mut workspace, None);
        Ok(Self {
            scene,
            state,
            workspace,
            retry_point: None,
            times: StageTimes::default(),
            sorts_before: 0,
        })
    }

    /// Adds particles, also while the simulation is under way; ids go on from the last. Only the new particles are
    /// placed, sorted and measured.
    ///
    /// # Errors
    /// Names the field of the batch that cannot be simulated; nothing is added then.
    pub fn add(&mut self, batch: &ParticleBatch<D>) -> Result<(), SetupError> {
        let batches = core::slice::from_ref(batch);
        add::add(&self.scene, &mut self.state, &mut self.workspace, batches)
    }

    /// Takes one substep of the length and for the reason that are given.
    fn take_substep(&mut self, dt_and_limit: (f64, DtLimit)) -> Result<(), Failure> {
        let (state, workspace) = (&mut self.state, &mut self.workspace);
        substep(&self.scene, state, workspace, dt_and_limit, &mut self.times)
    }
}

impl<T: Instance<D>, const D: usize> Simulate for Simulation<T, D> {
    fn dimension(&self) -> usize {
        D
    }

    fn precision(&self) -> &'static str {
        T::NAME
    }

    fn backend(&self) -> Backend {
        Backend {
            name: "cpu".into(),
            instruction_set: self.scene.setup.isa.name().into(),
        }
    }

    fn dx(&self) -> f64 {
        self.scene.setup.dx
    }

    fn domain(&self) -> Option<([f64; 3], [f64; 3])> {
        let domain = self.scene.setup.domain.as_ref();
        domain.map(|domain| (to_3d(domain.min), to_3d(domain.max)))
    }

    fn gravity(&self) -> [f64; 3] {
        to_3d(self.state.gravity)
    }

    fn materials(&self) -> Vec<String> {
        let materials = self.scene.setup.materials.iter();
        materials.map(|material| material.name.clone()).collect()
    }

    fn time(&self) -> f64 {
        self.state.control.time()
    }

    fn substeps(&self) -> u64 {
        self.state.control.substeps
    }

    fn particle_count(&self) -> usize {
        self.state.particle_count()
    }

    fn next_dt(&self) -> (f64, DtLimit) {
        self.state.control.next()
    }

    fn substep(&mut self) -> Result<Advance, Failure> {
        let (dt, limit) = self.state.control.next();
        // Dust at rest without gravity has no time scale at all.
        let dt = if dt.is_finite() { dt } else { 1.0 };
        let substeps = self.state.control.per_fixed();
        for _ in 0..substeps {
            self.take_substep((dt, limit))?;
        }
        Ok(Advance {
            substeps,
            dt_min: dt,
            limit,
        })
    }

    fn advance_while(
        &mut self,
        time: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Advance, Failure> {
        let mut advance = Advance {
            substeps: 0,
            dt_min: f64::INFINITY,
            limit: DtLimit::Frame,
        };
        while let Some((dt, limit)) = self.state.control.towards(time) {
            if !go_on() {
                return Ok(advance);
            }
            self.take_substep((dt, limit))?;
            advance.substeps += 1;
            if dt < advance.dt_min {
                (advance.dt_min, advance.limit) = (dt, limit);
            }
        }
        self.state.control.arrived(time);
        Ok(advance)
    }

    fn command(&mut self, command: Command) {
        self.state.command(command);
    }

    fn add_particles(&mut self, batch: &ParticleBatch<3>) -> Result<(), SetupError> {
        self.add(&batch.in_dimension())
    }

    fn begin_frame(&mut self) {
        let old = self.retry_point.take();
        self.retry_point = Some(RetryPoint::save(&self.state, old));
        self.state.control.begin_frame();
    }

    fn retry_frame(&mut self, failure: &Failure) -> Option<Retry> {
        let retry = self.retry_point.as_mut()?.retry(&mut self.state, failure);
        self.workspace.rebuild(&self.scene, &mut self.state);
        retry
    }

    fn give_up_frame(&mut self) -> bool {
        let Some(start) = &self.retry_point else {
            return false;
        };
        start.restore(&mut self.state);
        self.workspace.rebuild(&self.scene, &mut self.state);
        true
    }

    fn checkpoint(&self) -> Checkpoint {
        self.state.to_checkpoint(&self.scene)
    }

    fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), CheckpointError> {
        self.state = self.state.read_checkpoint(&self.scene, checkpoint)?;
        self.workspace.rebuild(&self.scene, &mut self.state);
        self.retry_point = None;
        Ok(())
    }

    fn snapshot(&self, fields: &[Field]) -> Snapshot {
        snapshot::snapshot(&self.scene, &self.state, fields)
    }

    fn diagnostics(&self) -> Diagnostics {
        diagnostics::measure(&self.scene, &self.state, &self.workspace)
    }

    fn boundary_impulses(&self) -> Vec<BoundaryImpulse> {
        self.state.boundary_impulses(&self.scene)
    }

    fn take_probe_samples(&mut self) -> Vec<ProbeSamples> {
        self.state.take_samples(&self.scene)
    }

    fn set_clock(&mut self, clock: fn() -> f64) {
        self.times = StageTimes::new(clock);
        self.sorts_before = self.workspace.sorts;
    }

    fn phase_times(&self) -> PhaseTimes {
        let mut times = PhaseTimes {
            sorts: self.workspace.sorts - self.sorts_before,
            ..PhaseTimes::default()
        };
        for (stage, seconds) in Substep::<T, D>::STAGES.iter().zip(self.times.seconds) {
            times.add(stage.phase, seconds);
        }
        times
    }

    fn stage_times(&self) -> Vec<(&'static str, f64)> {
        let stages = Substep::<T, D>::STAGES.iter().zip(self.times.seconds);
        stages
            .map(|(stage, seconds)| (stage.name, seconds))
            .collect()
    }

    fn memory(&self) -> Memory {
        let blocks = self.workspace.grid.blocks().len();
        Memory {
            blocks,
            nodes: blocks * block_edge(D).pow(D as u32),
            grid_bytes: self.workspace.grid_bytes(),
            particle_bytes: self.state.bytes() + self.workspace.sorter.bytes(),
            retry_bytes: self.retry_point.as_ref().map_or(0, RetryPoint::bytes),
        }
    }
}
