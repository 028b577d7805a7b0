//! K4: energy of a free elastic body.

use std::fmt;

use lahar::Failure;
use lahar::material::{ConstitutiveModel, PlasticGradient, Snow, Strain};
use lahar::math::Matrix;
use lahar::{Setup, SetupError, TimeStep};

use super::engine::{Build, ParticleState, oracle_of};
use super::scenes::moving_disc;

/// Returns the largest of a series over its first, less 1.
pub fn excess(energy: &[f64]) -> f64 {
    energy
        .iter()
        .fold(f64::MIN, |most, e| most.max(e / energy[0] - 1.0))
}

/// Energies \[J/m\] of a disc before each substep.
#[derive(Clone, Debug, Default)]
pub struct Energies {
    /// U(Fⁿ) + ½ Σ m_i v_i·v_i⁺.
    pub staggered: Vec<f64>,
    /// U(Fⁿ) + the particles' kinetic energy + ½ Σ m_i v_i·(v_i⁺ − v_i).
    pub staggered_by_particles: Vec<f64>,
    /// U(Fⁿ) + the particles' kinetic energy, that of affine matrices included.
    pub of_particles: Vec<f64>,
}

/// A disc that moves freely from a velocity gradient.
#[derive(Clone, Debug)]
pub struct Disc {
    /// Scheme and material; its time step is ignored.
    pub scheme: Setup<2>,
    /// Velocity gradient at the start \[1/s\].
    pub velocity_gradient: [[f64; 2]; 2],
    /// Length of a substep \[s\].
    pub dt: f64,
    /// Length of the run \[s\].
    pub time: f64,
}

/// An error of a run: of its setup, or of a substep.
#[derive(Clone, Debug)]
pub enum RunError {
    /// The setup is wrong.
    Setup(SetupError),
    /// A substep has failed.
    Failure(Failure),
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setup(error) => error.fmt(f),
            Self::Failure(failure) => failure.fmt(f),
        }
    }
}

impl std::error::Error for RunError {}

impl From<SetupError> for RunError {
    fn from(error: SetupError) -> Self {
        Self::Setup(error)
    }
}

impl From<Failure> for RunError {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl Disc {
    /// Builds an engine and its setup.
    fn build<E: Build<2>>(&self) -> Result<(Setup<2>, E), SetupError> {
        let setup = Setup {
            time_step: TimeStep::Fixed(self.dt),
            ..self.scheme.clone()
        };
        let disc = moving_disc(self.velocity_gradient, setup.dx);
        let engine = E::build(&setup, &[disc])?;
        Ok((setup, engine))
    }

    /// Runs the disc and returns its energies.
    ///
    /// # Errors
    /// If the setup is wrong or a substep fails.
    pub fn energies<E: Build<2>>(&self) -> Result<Energies, RunError> {
        let (setup, mut engine) = self.build::<E>()?;
        let mut energies = Energies::default();
        for _ in 0..(self.time / self.dt) as usize {
            let now = oracle_of(&setup, &engine.particles());
            let of_particles =
                now.elastic_energy() + now.kinetic_energy() + now.affine_kinetic_energy();
            energies.of_particles.push(of_particles);
            energies.staggered.push(now.staggered_energy(self.dt));
            energies
                .staggered_by_particles
                .push(of_particles + now.staggered_work(self.dt));
            engine.substep()?;
        }
        Ok(energies)
    }

    /// Runs a disc of snow, which yields, and returns its energies with dissipation.
    ///
    /// # Errors
    /// If the setup is wrong or a substep fails.
    pub fn dissipation<E: Build<2>>(&self, law: &Snow) -> Result<Dissipation, RunError> {
        let (setup, mut engine) = self.build::<E>()?;
        let mut before = engine.particles();
        let mut found = Dissipation::default();
        for _ in 0..(self.time / self.dt) as usize {
            let staggered = oracle_of(&setup, &before).staggered_energy(self.dt);
            found.staggered.push(staggered + found.dissipated);
            engine.substep()?;
            let after = engine.particles();
            let pairs = before.iter().zip(&after);
            let of_substep: f64 = pairs.map(|(old, new)| self.loss(law, old, new)).sum();
            found.dissipated += of_substep;
            found.given_back = found.given_back.max(-of_substep);
            before = after;
        }
        Ok(found)
    }

    /// Returns the energy that a particle of snow dissipates in a substep \[J/m\]: the work of its stress, less the energy
    /// that it stores. The work is V⁰ ½(τⁿ + τⁿ⁺¹) : Δt C, as the leapfrog has it.
    fn loss(&self, law: &Snow, old: &ParticleState<2>, new: &ParticleState<2>) -> f64 {
        let c = Matrix::<f64, 2>::from_fn(|i, j| new.affine[i][j]);
        let (before, after) = (strain(old), strain(new));
        let stress = law.kirchhoff_stress(before, c) + law.kirchhoff_stress(after, c);
        let power = (stress.transpose() * c).trace() * 0.5;
        let stored = law.energy_density(after) - law.energy_density(before);
        new.volume0 * (power * self.dt - stored)
    }
}

/// Energies of a body that yields \[J/m\].
#[derive(Clone, Debug, Default)]
pub struct Dissipation {
    /// Staggered energy before each substep, plus the energy dissipated so far.
    pub staggered: Vec<f64>,
    /// Energy that was dissipated.
    pub dissipated: f64,
    /// The largest amount of dissipated energy that a substep has given back.
    pub given_back: f64,
}

/// Returns the strain of a particle of snow.
fn strain(p: &ParticleState<2>) -> PlasticGradient<f64, 2> {
    let h = Matrix::from_fn(|i, j| p.deformation_gradient[i][j] - f64::from(i == j));
    PlasticGradient {
        plastic_jacobian_minus_one: p.plastic_jacobian - 1.0,
        ..PlasticGradient::from_displacement_gradient(h)
    }
    .with_hidden_variables()
}
