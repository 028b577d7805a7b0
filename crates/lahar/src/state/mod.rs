//! The state: all that decides how a simulation goes on, besides its setup.
//!
//! ```text
//! Setup ──check──▶ CheckedSetup ─┐
//!                     State ─────┼──substep──▶ State
//!                 Workspace ─────┘
//! ```
//! A state can be cloned, which is what a retry of a frame goes back to ([`retry`]); turned into named arrays
//! and back ([`checkpoint`]); and compared. The [`workspace`] holds the rest: buffers that can be dropped and
//! made again from the state.

pub(crate) mod accelerations;
pub(crate) mod add;
pub mod checkpoint;
pub mod diagnostics;
mod gauges;
pub(crate) mod limits;
pub(crate) mod probes;
pub(crate) mod retry;
pub(crate) mod sensor;
pub(crate) mod snapshot;
pub(crate) mod time_step;
pub(crate) mod workspace;

use crate::boundary::BoundaryImpulse;
use crate::boundary::impulse::Impulse;
use crate::material::Law;
use crate::math::{Lanes, Vector};
use crate::particles::{Escaped, Group, Layout};
use crate::setup::check::CheckedSetup;
use crate::setup::{Command, Pointer, to_3d};
use probes::Readings;
use std::sync::Arc;
use time_step::StepControl;

/// The state between two substeps. Rows keep their order and the age of their last sort, so that a copy goes on
/// with the same bits.
#[derive(PartialEq)]
pub(crate) struct State<T: Lanes, const D: usize> {
    /// The particles, by material.
    pub(crate) groups: Vec<Group<T, D>>,
    /// A bound on the distance that any particle has moved since the last sort \[cells\].
    pub(crate) drift: f64,
    /// Time since the fluids' volumes were last corrected \[s\].
    pub(crate) time_since_correction: f64,
    /// Impulses that each boundary has taken since the start, by the number of the domain's side and then by collider;
    /// lengths in meters.
    pub(crate) boundary_totals: Vec<Impulse<D>>,
    /// Readings of each probe that nobody has asked for yet.
    pub(crate) readings: Vec<Readings>,
    /// Particles that have left since the start.
    pub(crate) escaped: Escaped,
    /// Clock and time step.
    pub(crate) control: StepControl,
    /// The id of the next new particle.
    pub(crate) next_id: u32,
    /// Gravity at present \[m/s²\].
    pub(crate) gravity: [f64; D],
    pub(crate) pointer: Option<Pointer>,
    /// Start of each particle \[m\], by id, if a force asks for it. Grows only when particles are added, so that
    /// copies share it.
    pub(crate) starts: Option<Arc<Vec<[f64; D]>>>,
}

impl<T: Lanes, const D: usize> Clone for State<T, D> {
    fn clone(&self) -> Self {
        let mut copy = Self {
            groups: Vec::new(),
            boundary_totals: Vec::new(),
            readings: Vec::new(),
            control: self.control.clone(),
            starts: None,
            ..*self
        };
        copy.clone_from(self);
        copy
    }

    /// Copies `from` into the memory of this state, on all threads.
    fn clone_from(&mut self, from: &Self) {
        // Each field by name, so that a new one is not forgotten.
        let Self {
            groups,
            drift,
            time_since_correction,
            boundary_totals,
            readings,
            escaped,
            control,
            next_id,
            gravity,
            pointer,
            starts,
        } = self;
        groups.clone_from(&from.groups);
        *drift = from.drift;
        *time_since_correction = from.time_since_correction;
        boundary_totals.clone_from(&from.boundary_totals);
        readings.clone_from(&from.readings);
        *escaped = from.escaped;
        control.clone_from(&from.control);
        *next_id = from.next_id;
        *gravity = from.gravity;
        *pointer = from.pointer;
        starts.clone_from(&from.starts);
    }
}

impl<T: Lanes, const D: usize> State<T, D> {
    /// The state at time 0, without particles; `laws` are those of the setup's materials.
    pub(crate) fn new(scene: &CheckedSetup<D>, laws: Vec<Box<dyn Law<T, D>>>) -> Self {
        let setup = &scene.setup;
        let groups = laws.into_iter().zip(&setup.materials);
        let starts = setup.forces.iter().any(|force| force.acts_on_particles());
        Self {
            groups: groups
                .map(|(law, material)| Group::new(law.into(), material.density))
                .collect(),
            drift: 0.0,
            time_since_correction: 0.0,
            boundary_totals: vec![Impulse::ZERO; 2 * D + setup.colliders.len()],
            readings: vec![Readings::default(); setup.probes.len()],
            escaped: Escaped::default(),
            control: StepControl::new(setup.time_step, setup.dx, Vector(setup.gravity).norm()),
            next_id: 0,
            gravity: setup.gravity,
            pointer: None,
            starts: starts.then(Arc::default),
        }
    }

    /// Memory of the particles \[bytes\], spare capacity included.
    pub(crate) fn bytes(&self) -> usize {
        self.groups.iter().map(Group::bytes).sum()
    }

    pub(crate) fn particle_count(&self) -> usize {
        self.groups.iter().map(Group::len).sum()
    }

    /// Carries out a command; it takes effect at the next substep.
    pub(crate) fn command(&mut self, command: Command) {
        match command {
            Command::Gravity(gravity) => {
                self.set_gravity(core::array::from_fn(|axis| gravity[axis]));
            }
            Command::Pointer(pointer) => self.pointer = pointer,
            Command::SoundSpeed { material, speed } => {
                let density = self.groups.get(material).map(|group| group.density);
                let bulk_modulus = density.map(|density| density * speed * speed);
                self.stiffen(material, bulk_modulus.filter(|&k| k > 0.0 && k.is_finite()));
            }
        }
    }

    pub(crate) fn set_gravity(&mut self, gravity: [f64; D]) {
        self.gravity = gravity;
        self.control.gravity = Vector(gravity).norm();
    }

    /// Gives a material that has a bulk modulus this one \[Pa\]. Its particles keep their pressures.
    pub(crate) fn stiffen(&mut self, material: usize, bulk_modulus: Option<f64>) {
        let Some(group) = self.groups.get_mut(material) else {
            return;
        };
        if let (Some(before), Some(now)) = (group.law.bulk_modulus(), bulk_modulus)
            && before != now
        {
            group.set_law(group.law.with_bulk_modulus(now).into());
            let (_, strain) = group.columns.split_at_mut(Layout::strain(D));
            group.law.keep_pressure(before, strain);
            self.measure_waves();
        }
    }

    /// Lists what each wall and each collider has taken since the start.
    pub(crate) fn boundary_impulses(&self, scene: &CheckedSetup<D>) -> Vec<BoundaryImpulse> {
        let of = |name: &str, number: usize| BoundaryImpulse {
            name: name.into(),
            impulse: to_3d(self.boundary_totals[number].impulse.0),
            angular_impulse: self.boundary_totals[number].angular,
        };
        let sides = scene.walls.sides().map(|(name, side)| of(name, side));
        let colliders = scene.setup.colliders.iter().zip(2 * D..);
        sides
            .chain(colliders.map(|(collider, number)| of(&collider.name, number)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::workspace::Workspace;
    use super::{State, add};
    use crate::instance::Kernels;
    use crate::material::preset;
    use crate::setup::check::CheckedSetup;
    use crate::setup::{Contact, Domain, Sides, WallStyle};
    use crate::setup::{ParticleBatch, Setup};
    use crate::step::{StageTimes, substep};

    /// A column of water that has just begun to collapse.
    fn scene() -> CheckedSetup<2> {
        let mut setup = Setup::new(0.1, vec![preset("water", 10.0).expect("a preset")]);
        let wall = Contact::Separate { friction: 0.0 };
        setup.gravity = [0.0, -9.81];
        setup.domain = Some(Domain {
            min: [0.0; 2],
            max: [3.0, 2.0],
            sides: [Sides::Walls {
                low: wall,
                high: wall,
            }; 2],
            style: WallStyle::Plane,
        });
        CheckedSetup::new(setup).expect("a good setup")
    }

    fn take_substeps(
        scene: &CheckedSetup<2>,
        state: &mut State<f32, 2>,
        workspace: &mut Workspace<f32, 2>,
    ) {
        for _ in 0..60 {
            let next = state.control.next();
            let times = &mut StageTimes::default();
            substep(scene, state, workspace, next, times).expect("water runs");
        }
    }

    #[test]
    fn a_copy_goes_on_with_another_workspace() {
        let scene = scene();
        let law = <f32 as Kernels<2>>::built_in(&scene.setup.materials[0].model);
        let mut state = State::new(&scene, vec![law]);
        let mut workspace = Workspace::new(&scene).expect("any instruction set");
        let place = |i: usize| 0.05 * (i as f64 + 0.5);
        let column = ParticleBatch {
            position: (0..400).map(|i| [place(i / 20), place(i % 20)]).collect(),
            volume: vec![0.05 * 0.05],
            ..ParticleBatch::default()
        };
        add::add(&scene, &mut state, &mut workspace, [column]).expect("a good batch");
        take_substeps(&scene, &mut state, &mut workspace);

        let copy = state.clone();
        assert!(copy == state);
        take_substeps(&scene, &mut state, &mut workspace);
        assert!(copy != state);

        let mut other = copy.clone();
        let mut fresh = Workspace::new(&scene).expect("any instruction set");
        fresh.rebuild(&scene, &mut other);
        take_substeps(&scene, &mut other, &mut fresh);
        assert!(other == state, "the state decides all that follows");

        state.clone_from(&copy);
        assert!(state == copy);
    }
}
