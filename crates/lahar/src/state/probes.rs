//! Probes: when they are read, and their readings until someone asks for them.
//!
//! ```text
//! substep ──▶ probes that are due ──gauges.rs──▶ State::readings ──▶ Simulate::take_probe_samples
//! ```
//! A probe is read at the end of the first substep at or after the moment it is due. No substep is shortened for it, so a
//! run has the same bits with and without probes.

use super::State;
use super::gauges;
use super::workspace::Workspace;
use crate::instance::Instance;
use crate::math::Lanes;
use crate::setup::check::CheckedSetup;
use crate::setup::{ProbeSample, ProbeSamples};

/// The state of one probe.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Readings {
    /// Readings that nobody has asked for yet.
    pub(crate) samples: Vec<ProbeSample>,
    /// Time of the last reading \[s\], and the impulse that its boundary had taken until then \[N s\].
    pub(crate) last: (f64, [f64; 3]),
    /// Impulse on the face of a gauge in a wall since the last reading, per area \[N s/m², in 2D too\].
    pub(crate) pressed: f64,
}

/// How far a moment may be missed by rounding, in intervals of the probe.
const MOMENT_TOLERANCE: f64 = 1e-9;

/// Returns the number of the last moment at which a probe was due up to `time`, from 0 at the start.
fn moments(rate: f64, time: f64) -> f64 {
    (time * rate + MOMENT_TOLERANCE).floor()
}

/// Reads the probes that became due since `before` \[s\]; at the start, with `None`, all of them.
pub(crate) fn read<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    before: Option<f64>,
) {
    let now = state.control.time();
    for (index, probe) in scene.setup.probes.iter().enumerate() {
        let is_due = |before| moments(probe.rate, now) > moments(probe.rate, before);
        if before.is_none_or(is_due) {
            let values = gauges::measure(scene, state, workspace, index);
            let sample = ProbeSample { time: now, values };
            state.readings[index].samples.push(sample);
        }
    }
}

impl<T: Lanes, const D: usize> State<T, D> {
    /// Takes out the readings since this was last called, probe by probe.
    pub(crate) fn take_samples(&mut self, scene: &CheckedSetup<D>) -> Vec<ProbeSamples> {
        let probes = scene.setup.probes.iter().zip(&mut self.readings);
        probes
            .map(|(probe, readings)| ProbeSamples {
                name: probe.name.clone(),
                columns: probe.gauge.columns(),
                samples: core::mem::take(&mut readings.samples),
            })
            .collect()
    }

    /// The mean force on the boundary `on` since the last reading of probe `index` \[N; N/m in 2D\]: ΔI/Δt.
    pub(super) fn mean_force(
        &mut self,
        scene: &CheckedSetup<D>,
        index: usize,
        on: &str,
    ) -> Vec<f64> {
        let boundaries = self.boundary_impulses(scene);
        let boundary = boundaries.iter().find(|boundary| boundary.name == on);
        let impulse = boundary.map_or([0.0; 3], |boundary| boundary.impulse);
        let now = self.control.time();
        let (then, before) = core::mem::replace(&mut self.readings[index].last, (now, impulse));
        let mean = |axis: usize| match now - then {
            0.0 => 0.0,
            between => (impulse[axis] - before[axis]) / between,
        };
        (0..D).map(mean).collect()
    }
}
