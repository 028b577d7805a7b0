//! All that decides how a simulation goes on, besides its setup: what is kept to go back to, in memory
//! (retry.rs) or as named arrays (checkpoint.rs).
//!
//! ```text
//! Simulation ──save──▶ State ──restore──▶ Simulation
//!   grid, tiles, buffers: not kept, since they follow from where the runs are
//! ```

pub mod checkpoint;
pub mod diagnostics;
pub(crate) mod probe;
pub(crate) mod retry;
pub(crate) mod snapshot;
pub(crate) mod time_step;

use crate::boundary::impulse::Taken;
use crate::instance::Instance;
use crate::math::Lanes;
use crate::parallel;
use crate::particles::Escaped;
use crate::particles::{Group, PerParticle, Run};
use crate::setup::Pointer;
use crate::simulation::Simulation;
use crate::state::probe::Readings;
use crate::state::time_step::StepControl;

/// The state between two substeps. Rows are kept in their order and sorted as long ago as they are:
/// what follows has the same bits.
pub(crate) struct State<T, const D: usize> {
    pub(crate) groups: Vec<Rows<T, D>>,
    pub(crate) drift: f64,
    pub(crate) uncorrected: f64,
    pub(crate) taken: Vec<Taken<D>>,
    pub(crate) readings: Vec<Readings>,
    pub(crate) escaped: Escaped,
    pub(crate) control: StepControl,
    pub(crate) next_id: u32,
    pub(crate) gravity: [f64; D],
    pub(crate) pointer: Option<Pointer>,
}

/// The particles of a group.
pub(crate) struct Rows<T, const D: usize> {
    /// Of the law, if it can be changed \[Pa\].
    pub(crate) bulk_modulus: Option<f64>,
    pub(crate) columns: Vec<Vec<T>>,
    pub(crate) mass: PerParticle<T>,
    pub(crate) volume0: PerParticle<T>,
    pub(crate) id: Vec<u32>,
    pub(crate) body: PerParticle<u32>,
    pub(crate) runs: Vec<Run<D>>,
}

impl<T: Lanes, const D: usize> State<T, D> {
    /// What the next copy takes, and what it has taken \[bytes\].
    pub(crate) fn bytes(&self) -> usize {
        let rows = |rows: &Rows<T, D>| {
            let columns = rows.columns.iter().map(Vec::capacity).sum::<usize>();
            size_of::<T>() * (columns + rows.mass.each() + rows.volume0.each())
                + size_of::<u32>() * (rows.id.capacity() + rows.body.each())
                + size_of::<Run<D>>() * rows.runs.capacity()
        };
        self.groups.iter().map(rows).sum()
    }
}

/// `to = from`, in the memory of `to`.
fn copy<T: Lanes>(to: &mut Vec<Vec<T>>, from: &[Vec<T>]) {
    to.resize_with(from.len(), Vec::new);
    parallel::for_chunks(to, 1, 0, 1, &|first, to| {
        for (to, from) in to.iter_mut().zip(&from[first..]) {
            to.clone_from(from);
        }
    });
}

impl<T: Instance<D>, const D: usize> Simulation<T, D> {
    /// A copy of the state, in the memory of `old` if there is one.
    pub(crate) fn save(&self, old: Option<State<T, D>>) -> State<T, D> {
        // By name, so that a new field asks whether it belongs to the state.
        let Self {
            groups: now,
            drift,
            uncorrected,
            taken,
            readings,
            escaped,
            control,
            next_id,
            pointer,
            setup,
            starts: _, // only grows: the ids say how far
            grid: _,   // follows from the runs
            walls: _,
            colliders: _,
            moving: _, // follow from the time
            taken_by_run: _,
            origin: _,
            scheme: _,
            isa: _,
            sorter: _,
            mark: _,
            clock: _,
            times: _,
        } = self;
        let mut groups = old.map_or_else(Vec::new, |old| old.groups);
        groups.resize_with(now.len(), || Rows {
            bulk_modulus: None,
            columns: Vec::new(),
            mass: PerParticle::Uniform(T::default()),
            volume0: PerParticle::Uniform(T::default()),
            id: Vec::new(),
            body: PerParticle::Uniform(0),
            runs: Vec::new(),
        });
        for (rows, group) in groups.iter_mut().zip(now) {
            rows.bulk_modulus = group.law.bulk_modulus();
            copy(&mut rows.columns, &group.columns);
            rows.mass.clone_from(&group.mass);
            rows.volume0.clone_from(&group.volume0);
            rows.id.clone_from(&group.id);
            rows.body.clone_from(&group.body);
            rows.runs.clone_from(&group.runs);
        }
        State {
            groups,
            drift: *drift,
            uncorrected: *uncorrected,
            taken: taken.clone(),
            readings: readings.clone(),
            escaped: *escaped,
            control: control.clone(),
            next_id: *next_id,
            gravity: setup.gravity,
            pointer: *pointer,
        }
    }

    /// Goes back to `state`, which this simulation has had.
    pub(crate) fn restore(&mut self, state: &State<T, D>) {
        for (group, rows) in self.groups.iter_mut().zip(&state.groups) {
            if let Some(bulk_modulus) = rows.bulk_modulus
                && group.law.bulk_modulus() != rows.bulk_modulus
            {
                group.set_law(group.law.with_bulk_modulus(bulk_modulus));
            }
            let Group {
                law: _,
                density: _,
                sound_speed: _,
                columns,
                mass,
                volume0,
                id,
                body,
                runs,
            } = group;
            copy(columns, &rows.columns);
            mass.clone_from(&rows.mass);
            volume0.clone_from(&rows.volume0);
            id.clone_from(&rows.id);
            body.clone_from(&rows.body);
            runs.clone_from(&rows.runs);
        }
        self.drift = state.drift;
        self.uncorrected = state.uncorrected;
        self.taken.clone_from(&state.taken);
        self.readings.clone_from(&state.readings);
        self.escaped = state.escaped;
        self.control = state.control.clone();
        self.next_id = state.next_id;
        self.setup.gravity = state.gravity;
        self.pointer = state.pointer;
        if let Some(starts) = &mut self.starts {
            starts.truncate(state.next_id as usize); // ids are given in order
        }
        self.grid.rebuild(&mut self.groups, &self.walls);
    }
}
