//! From a checked scene to a simulation.

use super::checked::{AnyPlan, Scene};
use super::info::Precision;
use super::motion::InMotion;
use super::plan::Plan;
use crate::error::SceneError;
use lahar::{Isa, Setup, SetupError, Simulate, Simulation};

/// A simulation that is ready to run.
pub struct Built {
    /// The simulation, at time 0.
    pub simulation: Box<dyn Simulate>,
    /// Number of particles of each body.
    pub body_particles: Vec<usize>,
    /// Number of particles of each body that were left out because they would be inside colliders.
    pub left_out: Vec<usize>,
    /// All warnings, those of the scene included.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Samples the particles and makes the simulation.
    ///
    /// # Errors
    /// A setup that the simulator refuses, pointed at in the scene; an instruction set that this machine does
    /// not have.
    pub fn build(&self, isa: Isa) -> Result<Built, SceneError> {
        if !isa.is_available() {
            let have: Vec<&str> = Isa::ALL
                .into_iter()
                .filter(|isa| isa.is_available())
                .map(Isa::name)
                .collect();
            return Err(SceneError::of_file(
                &*self.name,
                format!("this machine has no {}", isa.name()),
            )
            .hint(format!("it has: {}", have.join(", "))));
        }
        match (&self.plan, self.precision) {
            (AnyPlan::D2(plan), Precision::F32) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f32, 2>::new(setup, batches)?))
            }),
            (AnyPlan::D2(plan), Precision::F64) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f64, 2>::new(setup, batches)?))
            }),
            (AnyPlan::D3(plan), Precision::F32) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f32, 3>::new(setup, batches)?))
            }),
            (AnyPlan::D3(plan), Precision::F64) => self.build_from(plan, isa, |setup, batches| {
                Ok(Box::new(Simulation::<f64, 3>::new(setup, batches)?))
            }),
        }
    }

    /// Builds the simulation of a plan, with `make` for its precision and dimension.
    fn build_from<const D: usize>(
        &self,
        plan: &Plan<D>,
        isa: Isa,
        make: impl Fn(Setup<D>, InMotion<'_, D>) -> Result<Box<dyn Simulate>, SetupError>,
    ) -> Result<Built, SceneError> {
        let mut warnings = self.warnings.clone();
        let (batches, left_out) = plan.batches(self.seed, &mut warnings);
        for (batch, body) in batches.iter().zip(&plan.bodies) {
            if batch.position.is_empty() {
                let error = self.error_at(
                    &format!("bodies.{}.shape", body.name),
                    format!("body \"{}\" comes to no particle", body.name),
                );
                return Err(error.hint(if plan.colliders.is_empty() {
                    "make the body larger, or dx or spacing smaller"
                } else {
                    "what is inside colliders is left out; make the body larger, or dx or spacing smaller"
                }));
            }
        }
        for (first, second, inside) in plan.overlaps(&batches) {
            warnings.push(format!("bodies \"{}\" and \"{}\" overlap: {inside} particles of the second start inside the first", plan.bodies[first].name, plan.bodies[second].name));
        }
        let body_particles = batches.iter().map(|batch| batch.position.len()).collect();
        let batches = InMotion::new(plan, batches, self.seed);
        let simulation = make(plan.setup(isa), batches).map_err(|error| {
            self.error_at(&error.key, format!("{}: {}", error.key, error.message))
        })?;
        Ok(Built {
            simulation,
            body_particles,
            left_out,
            warnings,
        })
    }
}
