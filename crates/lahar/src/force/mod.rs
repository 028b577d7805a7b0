//! Forces other than stress: the sum of the setup's accelerations, one drag of all drags, and their effect on nodes.

pub(crate) mod nodes;

use crate::setup::Force;

/// Writes the sum of the accelerations at `positions` \[m/s²\] to `out`: those of the forces that act on particles, or of
/// the others. `scratch` is as long.
pub(crate) fn accelerations<const D: usize>(
    forces: &[Force<D>],
    on_particles: bool,
    time: f64,
    positions: &[[f64; D]],
    starts: &[[f64; D]],
    scratch: &mut [[f64; D]],
    out: &mut [[f64; D]],
) {
    out.fill([0.0; D]);
    for force in forces {
        if force.acts_on_particles() == on_particles {
            let starts = if on_particles { starts } else { &[] };
            force.add(time, positions, starts, scratch, out);
        }
    }
}

/// Returns true if any force is an acceleration of nodes.
pub(crate) fn any_on_nodes<const D: usize>(forces: &[Force<D>]) -> bool {
    let acts =
        |force: &Force<D>| !force.acts_on_particles() && !matches!(force, Force::Drag { .. });
    forces.iter().any(acts)
}

/// Returns all drags as one: with K = Σ k and u = Σ k u / K, the share of v − u that is left after `dt`, and u. Returns
/// `None` if there is no drag.
pub(crate) fn drag<const D: usize>(forces: &[Force<D>], dt: f64) -> Option<(f64, [f64; D])> {
    let (mut rates, mut weighted) = (0.0, [0.0; D]);
    for force in forces {
        if let Force::Drag { rate, velocity } = force {
            rates += rate;
            for i in 0..D {
                weighted[i] += rate * velocity[i];
            }
        }
    }
    (rates > 0.0).then(|| (libm::exp(-rates * dt), weighted.map(|w| w / rates)))
}
