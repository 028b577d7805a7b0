//! Gauges in the scene: pressure and velocity at a place, the height of a surface, how far a front has
//! come, the force on a boundary.
//!
//! ```text
//! substep ─► is one due? ─► gauges.rs measures ─► kept ─► Simulate::take_probe_samples
//! ```
//! A probe looks and changes nothing: it is read at the end of the first substep at or after the
//! moment it is due, and no substep is shortened for it. So a run has the same bits with and without.

use super::State;
use super::gauges;
use super::workspace::Workspace;
use crate::instance::Instance;
use crate::math::Lanes;
use crate::setup::check::CheckedSetup;
use crate::setup::{ProbeSample, ProbeSamples};

/// What a probe keeps between readings.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Readings {
    /// Those that were not taken yet.
    pub(crate) samples: Vec<ProbeSample>,
    /// Time \[s\] of the last one, and the impulse \[N s\] that its boundary had taken till then.
    pub(crate) last: (f64, [f64; 3]),
    /// The impulse on the face of a gauge in a wall since then, per area \[N s/m²; N s/m² in 2D too\].
    pub(crate) pressed: f64,
}

/// How far, in its own intervals, a moment may be missed by rounding.
const MOMENT_TOLERANCE: f64 = 1e-9;

/// Number of the last moment at which a probe was due at `time`, from 0 at the start.
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
