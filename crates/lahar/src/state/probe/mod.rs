//! Gauges in the scene: pressure and velocity at a place, the height of a surface, how far a front has
//! come, the force on a boundary.
//!
//! ```text
//! substep ─► is one due? ─► gauges.rs measures ─► kept ─► Simulate::take_probe_samples
//! ```
//! A probe looks and changes nothing: it is read at the end of the first substep at or after the
//! moment it is due, and no substep is shortened for it. So a run has the same bits with and without.

mod gauges;
mod sensor;

use crate::error::SetupError;
use crate::instance::Instance;
use crate::setup::{Gauge, ProbeSample, ProbeSamples, Setup};
use crate::simulate::Simulate;
use crate::simulation::Simulation;

/// What a probe keeps between readings.
#[derive(Clone, Debug, Default)]
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

/// Whether the probes of a setup can be read; `boundaries` are the names of those that take forces.
///
/// # Errors
/// Names the key of a probe that cannot.
pub(crate) fn check<const D: usize>(
    setup: &Setup<D>,
    boundaries: &[&str],
) -> Result<(), SetupError> {
    for probe in &setup.probes {
        let wrong = |key: &str, message: &str| {
            Err(SetupError {
                key: format!("probes.{}.{key}", probe.name),
                message: message.into(),
            })
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let finite = |x: &[f64; D]| x.iter().all(|x| x.is_finite());
        if !positive(probe.rate) {
            return wrong("rate", "must be a positive number");
        }
        match &probe.gauge {
            Gauge::Pressure { at, radius, plate } => {
                if !finite(at) || !positive(*radius) {
                    return wrong("pressure", "needs a place and a radius above 0");
                }
                if let Some(plate) = plate
                    && !(positive(plate.width)
                        && positive(plate.normal.iter().map(|n| n * n).sum()))
                {
                    return wrong("pressure", "needs a normal and a width above 0");
                }
            }
            Gauge::Velocity { at, radius } => {
                if !finite(at) || !positive(*radius) {
                    return wrong("velocity", "needs a place and a radius above 0");
                }
            }
            Gauge::Height { up, column } => {
                if *up >= D || column.is_some_and(|x| !finite(&x)) {
                    return wrong("height", "needs an axis and a place");
                }
                if column.is_none() && setup.domain.is_none() {
                    return wrong(
                        "height",
                        "the mean height of a scene without a domain is unknown; give it a place",
                    );
                }
            }
            Gauge::Front {
                along, up, depth, ..
            } => {
                if *along >= D || *up >= D || along == up {
                    return wrong("front", "needs one axis along and another up");
                }
                if !positive(*depth) {
                    return wrong("front", "needs a depth above 0");
                }
                if D == 3 && setup.domain.is_none() {
                    return wrong("front", "depth across a scene without a domain is unknown");
                }
            }
            Gauge::Force { on } => {
                if !boundaries.contains(&on.as_str()) {
                    return wrong(
                        "force",
                        &format!(
                            "there is no boundary \"{on}\" that takes forces; there are: {}",
                            boundaries.join(", ")
                        ),
                    );
                }
            }
        }
    }
    Ok(())
}

impl<T: Instance<D>, const D: usize> Simulation<T, D> {
    /// Reads the probes that became due since `before` \[s\]; at the start, with `None`, all.
    pub(crate) fn read_probes(&mut self, before: Option<f64>) {
        let now = self.control.time();
        for index in 0..self.setup.probes.len() {
            let rate = self.setup.probes[index].rate;
            if before.is_some_and(|before| moments(rate, now) <= moments(rate, before)) {
                continue;
            }
            let values = gauges::measure(self, index);
            self.readings[index]
                .samples
                .push(ProbeSample { time: now, values });
        }
    }

    /// ΔI/Δt since the last reading of probe `index`.
    fn mean_force(&mut self, index: usize, on: &str) -> Vec<f64> {
        let boundaries = self.boundary_impulses();
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

    /// Hands over what has been read, probe by probe.
    pub(crate) fn take_samples(&mut self) -> Vec<ProbeSamples> {
        let taken = self.readings.iter_mut();
        let taken = taken.map(|readings| core::mem::take(&mut readings.samples));
        let taken = self.setup.probes.iter().zip(taken);
        taken
            .map(|(probe, samples)| ProbeSamples {
                name: probe.name.clone(),
                columns: probe.gauge.columns(),
                samples,
            })
            .collect()
    }
}
