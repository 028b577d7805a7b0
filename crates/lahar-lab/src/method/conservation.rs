//! K2, K3, K6 and K8: affine motions, momenta, masses and free fall.

use lahar::Failure;

use super::engine::{Engine, ParticleState};

/// Takes one substep of an affine motion. Returns the largest changes of a velocity \[m/s\] and of an entry of C \[1/s\],
/// which the way to the grid and back must preserve.
///
/// # Errors
/// If the substep fails.
pub fn affine_change<E: Engine<D>, const D: usize>(engine: &mut E) -> Result<[f64; 2], Failure> {
    let before = engine.particles();
    engine.substep()?;
    let mut worst = [0.0_f64; 2];
    for (old, new) in before.iter().zip(engine.particles()) {
        let velocities = difference(&new.velocity, &old.velocity);
        let affine = difference(new.affine.as_flattened(), old.affine.as_flattened());
        worst = [worst[0].max(velocities), worst[1].max(affine)];
    }
    Ok(worst)
}

/// The largest relative change of the momenta in a substep.
#[derive(Clone, Copy, Debug)]
pub struct MomentumChange {
    /// Change of the momentum over Σ m |v| at the start.
    pub linear: f64,
    /// Change of the angular momentum over Σ m |x| |v| at the start.
    pub angular: f64,
}

/// Takes substeps of free bodies and returns the largest changes of their momenta.
///
/// # Errors
/// If a substep fails.
pub fn momentum_change<E: Engine<D>, const D: usize>(
    engine: &mut E,
    substeps: usize,
) -> Result<MomentumChange, Failure> {
    let (mut linear_scale, mut angular_scale) = (0.0, 0.0);
    for p in engine.particles() {
        linear_scale += p.mass * norm(&p.velocity);
        angular_scale += p.mass * norm(&p.position) * norm(&p.velocity);
    }
    let mut worst = MomentumChange {
        linear: 0.0,
        angular: 0.0,
    };
    let mut old = engine.momenta();
    for _ in 0..substeps {
        engine.substep()?;
        let new = engine.momenta();
        let change = |a: [f64; 3], b: [f64; 3]| norm(&[0, 1, 2].map(|k| b[k] - a[k]));
        let linear = change(old.linear, new.linear) / linear_scale;
        let angular = change(old.angular, new.angular) / angular_scale;
        worst = MomentumChange {
            linear: worst.linear.max(linear),
            angular: worst.angular.max(angular),
        };
        old = new;
    }
    Ok(worst)
}

/// Returns number and mass of each particle, which must stay the same to the bit.
pub fn masses<const D: usize>(particles: &[ParticleState<D>]) -> Vec<(u32, f64)> {
    particles.iter().map(|p| (p.id, p.mass)).collect()
}

/// Returns how far a free body falls in `substeps` substeps of `dt` \[s\] from the velocity `velocity` \[m/s\] under
/// `gravity` \[m/s²\], as symplectic Euler has it: v n dt + g dt² n (n + 1)/2 \[m\].
pub fn free_fall(velocity: f64, gravity: f64, dt: f64, substeps: f64) -> f64 {
    velocity * substeps * dt + gravity * dt * dt * substeps * (substeps + 1.0) / 2.0
}

/// Returns the Euclidean length of a vector.
pub fn norm(a: &[f64]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns the largest difference of two entries.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()))
}
