//! The face that a check of the method sees of an engine, so that one check runs on all of them.
//!
//! An engine only steps and shows its particles. Whatever is summed over them (energies, momenta)
//! is summed by the oracle, from what the engine shows.

use lahar::Instance;
use lahar::material::PLASTIC_JACOBIAN;
use lahar::math::{Matrix, Vector};
use lahar::particles::Field;
use lahar::reference::Reference;
use lahar::{
    Deformation, Isa, ParticleBatch, Setup, Simulate, Simulation, StartingValues, TimeStep,
};

/// A particle as an engine shows it.
#[derive(Clone, Debug)]
pub(crate) struct State<const D: usize> {
    pub(crate) id: u32,
    pub(crate) material: usize,
    pub(crate) body: u32,
    /// \[kg\]
    pub(crate) mass: f64,
    /// \[m³; m² in 2D\]
    pub(crate) volume0: f64,
    /// \[m\]
    pub(crate) position: [f64; D],
    /// \[m/s\]
    pub(crate) velocity: [f64; D],
    /// C \[1/s\], `[i][j]` = ∂v_i/∂x_j.
    pub(crate) affine: [[f64; D]; D],
    /// F.
    pub(crate) deformation_gradient: [[f64; D]; D],
    /// J − 1.
    pub(crate) jacobian_minus_one: f64,
    /// J_P.
    pub(crate) plastic_jacobian: f64,
}

/// What steps a scene.
pub(crate) trait Engine<const D: usize>: Sized {
    /// The distance from 1 to the next of its numbers.
    const EPSILON: f64;
    /// `setup.time_step` is fixed.
    fn new(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Self;
    /// One substep.
    fn substep(&mut self);
    /// All particles, by ascending id.
    fn particles(&self) -> Vec<State<D>>;

    /// `double` for an engine that computes in `f64`, else `single`.
    fn tolerance(double: f64, single: f64) -> f64 {
        if Self::EPSILON < 1e-10 {
            double
        } else {
            single
        }
    }
}

/// [`Reference`] as an engine.
pub(crate) struct Oracle<const D: usize> {
    reference: Reference<D>,
    dt: f64,
}

impl<const D: usize> Engine<D> for Oracle<D> {
    const EPSILON: f64 = f64::EPSILON;

    fn new(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Self {
        let reference = Reference::new(setup, batches).expect("the check's scene is sound");
        Self {
            reference,
            dt: fixed_dt(setup),
        }
    }

    fn substep(&mut self) {
        self.reference.substep(self.dt);
    }

    fn particles(&self) -> Vec<State<D>> {
        let rows = |m: Matrix<f64, D>| m.transpose().0.map(|row| row.0);
        let state = |p: &lahar::reference::Particle<D>| State {
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
}

/// The oracle in the state that an engine shows, for its totals. A model that keeps only J gets F
/// of that J.
pub(crate) fn oracle_of<const D: usize>(setup: &Setup<D>, particles: &[State<D>]) -> Reference<D> {
    let batch = |p: &State<D>| ParticleBatch {
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
    Reference::new(setup, &batches).expect("the engine's particles are sound")
}

/// The length of the substeps of a check \[s\].
pub(crate) fn fixed_dt<const D: usize>(setup: &Setup<D>) -> f64 {
    match setup.time_step {
        TimeStep::Fixed(dt) => dt,
        TimeStep::Automatic { .. } => panic!("the checks of the method fix dt"),
    }
}

/// `f` as the vector that formulas use.
pub(crate) fn times<const D: usize>(matrix: [[f64; D]; D], vector: [f64; D]) -> [f64; D] {
    matrix.map(|row| Vector(row).dot(Vector(vector)))
}

/// [`lahar::Simulation`] as an engine.
pub(crate) struct Fast<T: Instance<D>, const D: usize>(Simulation<T, D>);

impl<T: Instance<D>, const D: usize> Engine<D> for Fast<T, D> {
    const EPSILON: f64 = if size_of::<T>() == 8 {
        f64::EPSILON
    } else {
        f32::EPSILON as f64
    };

    fn new(setup: &Setup<D>, batches: &[ParticleBatch<D>]) -> Self {
        let mut setup = setup.clone();
        if size_of::<T>() == 4 {
            // The same figures on every machine, since some are held to known misses.
            setup.isa = Isa::Portable;
        }
        Self(Simulation::new(setup, batches).expect("the check's scene is sound"))
    }

    fn substep(&mut self) {
        Simulate::substep(&mut self.0).expect("the check's scene runs");
    }

    fn particles(&self) -> Vec<State<D>> {
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
        let snapshot = self.0.snapshot(&fields);
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
            .map(|p| State {
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
}
