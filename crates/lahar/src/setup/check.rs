//! The one check of setups and batches, for the engine and the oracle alike.

use super::force::check_forces;
use super::{
    Collider, Deformation, ForceForm, Gauge, Kernel, ParticleBatch, Setup, StartingValues,
    TimeStep, Transfer,
};
use crate::boundary::walls::Walls;
use crate::error::SetupError;
use crate::kernel::STENCIL;
use crate::material::{DEFORMATION_GRADIENT, JACOBIAN, Variable};
use crate::particles::Lattice;

/// Names of the axes, for messages.
const AXES: [&str; 3] = ["x", "y", "z"];

/// A setup that can be simulated, and what follows from it for a whole run.
#[derive(Clone, Debug)]
pub(crate) struct CheckedSetup<const D: usize> {
    pub(crate) setup: Setup<D>,
    pub(crate) walls: Walls<D>,
    /// The setup's colliders, with lengths in cells from node 0.
    pub(crate) colliders: Vec<Collider<D>>,
    pub(crate) lattice: Lattice<D>,
}

fn error<R>(key: &str, message: impl Into<String>) -> Result<R, SetupError> {
    Err(SetupError {
        key: key.into(),
        message: message.into(),
    })
}

fn is_positive(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}

fn is_finite(x: &[f64]) -> bool {
    x.iter().all(|x| x.is_finite())
}

impl<const D: usize> CheckedSetup<D> {
    /// Checks everything but the particles.
    ///
    /// # Errors
    /// Names the first key that cannot be simulated.
    pub(crate) fn new(setup: Setup<D>) -> Result<Self, SetupError> {
        check_numbers(&setup)?;
        check_method(&setup)?;
        check_forces(&setup.forces)?;
        for collider in &setup.colliders {
            collider.check()?;
        }
        let walls = Walls::of(&setup)?;
        let names = setup.colliders.iter().map(|collider| &*collider.name);
        let boundaries: Vec<&str> = walls.sides().map(|(name, _)| name).chain(names).collect();
        check_probes(&setup, &boundaries)?;
        let shortest = STENCIL as i64;
        let too_short = |axis: &usize| walls.period[*axis].is_some_and(|cells| cells < shortest);
        if let Some(axis) = (0..D).find(too_short) {
            return error(
                "dx",
                format!(
                    "a periodic axis needs at least {shortest} cells; {} has fewer",
                    AXES[axis]
                ),
            );
        }
        let lattice = Lattice {
            dx: setup.dx,
            origin: setup.domain.as_ref().map_or([0.0; D], |domain| domain.min),
            offset: setup.kernel.offset(),
            period: walls.period,
        };
        let in_cells = |collider: &Collider<D>| {
            collider
                .in_units(lattice.dx, lattice.origin)
                .extended(&walls)
        };
        Ok(Self {
            colliders: setup.colliders.iter().map(in_cells).collect(),
            walls,
            lattice,
            setup,
        })
    }
}

fn check_numbers<const D: usize>(setup: &Setup<D>) -> Result<(), SetupError> {
    let dx = setup.dx;
    if !is_positive(dx) {
        return error("dx", format!("must be a positive number, not {dx}"));
    }
    if setup.materials.is_empty() {
        return error("materials", "there must be at least one");
    }
    for material in &setup.materials {
        if !is_positive(material.density) {
            return error(
                &format!("materials.{}.density", material.name),
                format!("must be a positive number, not {}", material.density),
            );
        }
    }
    if !is_finite(&setup.gravity) {
        return error("gravity", "must be finite");
    }
    Ok(())
}

fn check_method<const D: usize>(setup: &Setup<D>) -> Result<(), SetupError> {
    if setup.kernel == Kernel::Linear && setup.force != ForceForm::Classic {
        return error(
            "kernel",
            "\"linear\" needs force = \"classic\": its inertia D is singular where a particle meets a node",
        );
    }
    if let Transfer::Flip { blend } = setup.transfer
        && !(0.0..=1.0).contains(&blend)
    {
        return error(
            "flip_blend",
            format!("must be from 0 (PIC) to 1 (FLIP), not {blend}"),
        );
    }
    match setup.time_step {
        TimeStep::Fixed(dt) if !is_positive(dt) => {
            error("dt", format!("must be a positive number, not {dt}"))
        }
        TimeStep::Automatic { cfl, .. } if !(cfl > 0.0 && cfl <= 1.0) => {
            error("cfl", format!("must be above 0 and at most 1, not {cfl}"))
        }
        TimeStep::Automatic { longest, .. } if longest.is_nan() || longest <= 0.0 => {
            error("dt_max", format!("must be positive, not {longest}"))
        }
        TimeStep::Fixed(_) | TimeStep::Automatic { .. } => Ok(()),
    }
}

/// Checks the probes; `boundaries` are the names of those that take forces.
fn check_probes<const D: usize>(setup: &Setup<D>, boundaries: &[&str]) -> Result<(), SetupError> {
    for probe in &setup.probes {
        let wrong =
            |key: &str, message: &str| error(&format!("probes.{}.{key}", probe.name), message);
        if !is_positive(probe.rate) {
            return wrong("rate", "must be a positive number");
        }
        match &probe.gauge {
            Gauge::Pressure { at, radius, plate } => {
                if !is_finite(at) || !is_positive(*radius) {
                    return wrong("pressure", "needs a place and a radius above 0");
                }
                if let Some(plate) = plate
                    && !(is_positive(plate.width)
                        && is_positive(plate.normal.iter().map(|n| n * n).sum()))
                {
                    return wrong("pressure", "needs a normal and a width above 0");
                }
            }
            Gauge::Velocity { at, radius } => {
                if !is_finite(at) || !is_positive(*radius) {
                    return wrong("velocity", "needs a place and a radius above 0");
                }
            }
            Gauge::Height { up, column } => {
                if *up >= D || column.is_some_and(|x| !is_finite(&x)) {
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
                if !is_positive(*depth) {
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

impl<const D: usize> ParticleBatch<D> {
    /// Checks the batch against the setup that it is for. The first particle gets the id `next_id`; `variables` are
    /// the internal variables of a material's model, by its index.
    ///
    /// # Errors
    /// Names the field that cannot be simulated.
    pub(crate) fn check(
        &self,
        setup: &Setup<D>,
        next_id: u32,
        variables: impl FnOnce(usize) -> &'static [Variable],
    ) -> Result<(), SetupError> {
        let count = self.position.len();
        if self.material >= setup.materials.len() {
            return error(
                "material",
                format!("there is no material {}", self.material),
            );
        }
        let last = u32::try_from(count)
            .ok()
            .and_then(|count| next_id.checked_add(count));
        if last.is_none_or(|last| last == u32::MAX) {
            return error(
                "position",
                format!("{count} more particles are more than ids can number"),
            );
        }
        self.check_lengths()?;
        self.check_values()?;
        self.check_variables(variables(self.material))
    }

    fn check_lengths(&self) -> Result<(), SetupError> {
        let count = self.position.len();
        let lengths = [
            ("velocity", self.velocity.len(), true, true),
            ("volume", self.volume.len(), false, true),
            ("mass", self.mass.len(), true, true),
            ("affine", self.affine.len(), true, false),
        ];
        for (key, len, may_be_empty, may_be_one) in lengths {
            let fits = len == count || (len == 0 && may_be_empty) || (len == 1 && may_be_one);
            if !fits && count > 0 {
                return error(key, format!("{len} values for {count} particles"));
            }
        }
        let deformed = match &self.deformation {
            Deformation::Rest => count,
            Deformation::Jacobian(j) => j.len(),
            Deformation::Gradient(f) => f.len(),
        };
        if deformed != count {
            return error(
                "deformation",
                format!("{deformed} values for {count} particles"),
            );
        }
        Ok(())
    }

    fn check_values(&self) -> Result<(), SetupError> {
        let positive = [("volume", &self.volume), ("mass", &self.mass)];
        for (key, values) in positive {
            if let Some(i) = values.iter().position(|&x| !is_positive(x)) {
                let value = values[i];
                return error(
                    key,
                    format!("of particle {i} must be a positive number, not {value}"),
                );
            }
        }
        for i in 0..self.position.len() {
            let is_sound = is_finite(&self.position[i])
                && self.velocity.get(i).is_none_or(|v| is_finite(v))
                && (self.affine.get(i)).is_none_or(|c| c.iter().all(|row| is_finite(row)))
                && match &self.deformation {
                    Deformation::Rest => true,
                    Deformation::Jacobian(j) => is_positive(j[i]),
                    Deformation::Gradient(f) => f[i].iter().all(|row| is_finite(row)),
                };
            if !is_sound {
                return error(
                    "position",
                    format!(
                        "particle {i}: position, velocity, affine and deformation must be finite numbers, and J positive"
                    ),
                );
            }
        }
        Ok(())
    }

    /// Checks the starting values of internal variables against the table of the model.
    fn check_variables(&self, table: &[Variable]) -> Result<(), SetupError> {
        for StartingValues { name, values } in &self.variables {
            let fail = |message: String| error(&format!("variables.{name}"), message);
            let known =
                (table.iter()).find(|variable| variable.name == *name && !variable.is_hidden);
            let Some(variable) = known else {
                return fail("the model of these particles has no such variable".to_owned());
            };
            if name == JACOBIAN.name || name == DEFORMATION_GRADIENT.name {
                return fail("is given as the deformation of the batch".to_owned());
            }
            let count = self.position.len() * variable.shape.len(D);
            if values.len() != count {
                return fail(format!("has {} values; {count} are needed", values.len()));
            }
            let positive = variable.is_positive();
            if let Some(bad) = (values.iter()).find(|x| !x.is_finite() || positive && **x <= 0.0) {
                let wanted = if positive { "a positive" } else { "a finite" };
                return fail(format!("must be {wanted} number, not {bad}"));
            }
        }
        Ok(())
    }
}
