//! Engines as the checks of the method see them: an engine takes substeps and shows its particles.
//!
//! One check thus runs on the oracle, on the engine in either precision, and on the simulation of a scene. Momenta and
//! energies are summed by the oracle from the particles that an engine shows, so that no engine judges itself.

use lahar::Instance;
use lahar::material::PLASTIC_JACOBIAN;
use lahar::math::{Matrix, Vector};
use lahar::particles::Field;
use lahar::reference::Reference;
use lahar::{
    Deformation, Failure, Isa, ParticleBatch, Setup, SetupError, Simulate, Simulation,
    StartingValues, TimeStep,
};

/// A particle as an engine shows it.
#[derive(Clone, Debug)]
pub struct ParticleState<const D: usize> {
    /// Its number, which it keeps.
    pub id: u32,
    /// Index of its material.
    pub material: usize,
    /// Number of its body.
    pub body: u32,
    /// Mass \[kg; kg/m in 2D\].
    pub mass: f64,
    /// Rest volume \[m³; m² in 2D\].
    pub volume0: f64,
    /// Position of the particle \[m\].
    pub position: [f64; D],
    /// Velocity of the particle \[m/s\].
    pub velocity: [f64; D],
    /// Affine velocity matrix C \[1/s\], `[i][j]` = ∂v_i/∂x_j.
    pub affine: [[f64; D]; D],
    /// Deformation gradient F; for a model that stores J only, that of this J.
    pub deformation_gradient: [[f64; D]; D],
    /// The Jacobian less one, J − 1.
    pub jacobian_minus_one: f64,
    /// Plastic Jacobian J_P.
    pub plastic_jacobian: f64,
}

/// Total momenta, those of affine matrices included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momenta {
    /// Momentum \[kg m/s\].
    pub linear: [f64; 3],
    /// Angular momentum about the origin \[kg m²/s\].
    pub angular: [f64; 3],
}

/// A simulation that a check advances and reads.
pub trait Engine<const D: usize> {
    /// Takes one substep.
    ///
    /// # Errors
    /// If a particle gets a value that is not finite or leaves the representable range.
    fn substep(&mut self) -> Result<(), Failure>;

    /// Returns all particles by ascending id.
    fn particles(&self) -> Vec<ParticleState<D>>;

    /// Returns the total momenta.
    fn momenta(&mut self) -> Momenta;
}

/// An engine that can be built from a setup.
pub trait Build<const D: usize>: Engine<D> + Sized {
    /// The difference between 1 and the next larger number in the engine's precision.
    const EPSILON: f64;

    /// Builds the engine. The setup must fix dt.
    ///
    /// # Errors
    /// If the setup or a batch is wrong.
    fn build(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Result<Self, SetupError>;

    /// Returns `double` if the engine computes in `f64`, else `single`.
    fn tolerance(double: f64, single: f64) -> f64 {
        if Self::EPSILON < 1e-10 {
            double
        } else {
            single
        }
    }
}

/// The oracle, [`Reference`], as an engine.
#[derive(Debug)]
pub struct Oracle<const D: usize> {
    reference: Reference<D>,
    setup: Setup<D>,
}

impl<const D: usize> Engine<D> for Oracle<D> {
    fn substep(&mut self) -> Result<(), Failure> {
        if let TimeStep::Fixed(dt) = self.setup.time_step {
            self.reference.substep(dt);
        }
        Ok(())
    }

    fn particles(&self) -> Vec<ParticleState<D>> {
        let rows = |m: Matrix<f64, D>| m.transpose().0.map(|row| row.0);
        let state = |p: &lahar::reference::Particle<D>| ParticleState {
            id: p.id,
            material: p.material,
            body: p.body,
            mass: p.mass,
            volume0: p.volume0,
            position: p.position.0,
            velocity: p.velocity.0,
            affine: rows(p.affine),
            deformation_gradient: rows(
                self.reference.displacement_gradient(p) + Matrix::identity(1.0),
            ),
            jacobian_minus_one: self.reference.jacobian_minus_one(p),
            plastic_jacobian: self.reference.plastic_jacobian(p),
        };
        self.reference.particles().iter().map(state).collect()
    }

    fn momenta(&mut self) -> Momenta {
        momenta_of(&self.reference)
    }
}

impl<const D: usize> Build<D> for Oracle<D> {
    const EPSILON: f64 = f64::EPSILON;

    fn build(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Result<Self, SetupError> {
        Ok(Self {
            reference: Reference::new(setup, batches)?,
            setup: setup.clone(),
        })
    }
}

/// [`Simulation`] as an engine.
pub struct Fast<T: Instance<D>, const D: usize> {
    simulation: Simulation<T, D>,
    setup: Setup<D>,
}

impl<T: Instance<D>, const D: usize> Engine<D> for Fast<T, D> {
    fn substep(&mut self) -> Result<(), Failure> {
        Simulate::substep(&mut self.simulation)?;
        Ok(())
    }

    fn particles(&self) -> Vec<ParticleState<D>> {
        particles_of(&self.simulation)
    }

    fn momenta(&mut self) -> Momenta {
        momenta_of(&oracle_of(&self.setup, &self.particles()))
    }
}

impl<T: Instance<D>, const D: usize> Build<D> for Fast<T, D> {
    const EPSILON: f64 = if size_of::<T>() == 8 {
        f64::EPSILON
    } else {
        f32::EPSILON as f64
    };

    fn build(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Result<Self, SetupError> {
        let mut setup = setup.clone();
        if size_of::<T>() == 4 {
            // Some figures are compared with known misses, which must be the same on every machine.
            setup.isa = Isa::Portable;
        }
        Ok(Self {
            simulation: Simulation::new(setup.clone(), batches)?,
            setup,
        })
    }
}

/// The simulation of a scene as an engine. Its momenta are those of its diagnostics.
pub struct OfScene<'a>(pub &'a mut dyn Simulate);

impl<const D: usize> Engine<D> for OfScene<'_> {
    fn substep(&mut self) -> Result<(), Failure> {
        self.0.substep()?;
        Ok(())
    }

    fn particles(&self) -> Vec<ParticleState<D>> {
        particles_of(self.0)
    }

    fn momenta(&mut self) -> Momenta {
        let totals = self.0.diagnostics();
        Momenta {
            linear: totals.momentum,
            angular: totals.angular_momentum,
        }
    }
}

/// Returns all particles of a simulation by ascending id.
pub fn particles_of<const D: usize>(
    simulation: &(impl Simulate + ?Sized),
) -> Vec<ParticleState<D>> {
    let fields = [
        Field::Id,
        Field::Material,
        Field::Body,
        Field::Mass,
        Field::Volume0,
        Field::Position,
        Field::Velocity,
        Field::Affine,
        Field::DeformationGradient,
        Field::Jacobian,
        Field::Variable(&PLASTIC_JACOBIAN),
    ];
    let snapshot = simulation.snapshot(&fields);
    let columns: Vec<Vec<f64>> = snapshot
        .columns
        .iter()
        .map(|(_, data)| data.to_f64())
        .collect();
    let vector = |c: usize, p: usize| core::array::from_fn(|i| columns[c][p * D + i]);
    let matrix = |c: usize, p: usize| {
        core::array::from_fn(|i| core::array::from_fn(|j| columns[c][(p * D + i) * D + j]))
    };
    (0..snapshot.count)
        .map(|p| ParticleState {
            id: columns[0][p] as u32,
            material: columns[1][p] as usize,
            body: columns[2][p] as u32,
            mass: columns[3][p],
            volume0: columns[4][p],
            position: vector(5, p),
            velocity: vector(6, p),
            affine: matrix(7, p),
            deformation_gradient: matrix(8, p),
            jacobian_minus_one: columns[9][p] - 1.0,
            plastic_jacobian: columns[10][p],
        })
        .collect()
}

/// Builds the oracle in the state of these particles, to sum totals over them.
///
/// # Panics
/// If the oracle refuses the setup or a particle, which an engine that runs on this setup cannot show.
pub fn oracle_of<const D: usize>(setup: &Setup<D>, particles: &[ParticleState<D>]) -> Reference<D> {
    let batch = |p: &ParticleState<D>| ParticleBatch {
        material: p.material,
        body: p.body,
        measure_volume: false,
        position: vec![p.position],
        velocity: vec![p.velocity],
        volume: vec![p.volume0],
        mass: vec![p.mass],
        affine: vec![p.affine],
        deformation: Deformation::Gradient(vec![p.deformation_gradient]),
        variables: match setup.materials[p.material].model.variables() {
            table if table.contains(&PLASTIC_JACOBIAN) => vec![StartingValues {
                name: PLASTIC_JACOBIAN.name.to_owned(),
                values: vec![p.plastic_jacobian],
            }],
            _ => Vec::new(),
        },
    };
    let batches: Vec<_> = particles.iter().map(batch).collect();
    Reference::new(setup, &batches).expect("the particles of an engine are a sound start")
}

/// Returns the momenta that the oracle sums.
fn momenta_of<const D: usize>(oracle: &Reference<D>) -> Momenta {
    let Vector(momentum) = oracle.momentum();
    Momenta {
        linear: core::array::from_fn(|axis| momentum.get(axis).copied().unwrap_or(0.0)),
        angular: oracle.angular_momentum(),
    }
}
