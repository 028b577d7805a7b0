//! A checked scene in numbers of one dimension: the plan that a simulation is made from.

use super::forces::lattice;
use super::formula::Formulas;
use crate::particle_list::ParticleList;
use lahar::geometry::sampling::{Sampling, expected_count};
use lahar::geometry::{Bounds, Region};
use lahar::material::{Fluid, VolumeRule};
use lahar::{
    Collider, Contact, Cushion, Domain, Force, ForceForm, Kernel, Material, Probe, Sides, TimeStep,
    Transfer,
};

/// The part of a scene that depends on the dimension.
#[derive(Clone, Debug)]
pub(crate) struct Plan<const D: usize> {
    pub(crate) dx: f64,
    /// The constant part of gravity \[m/s²\].
    pub(crate) gravity: [f64; D],
    pub(crate) forces: Vec<Force<D>>,
    /// Simulated time of a run \[s\].
    pub(crate) duration: f64,
    pub(crate) domain: Option<Domain<D>>,
    pub(crate) clamp: Option<Bounds<D>>,
    pub(crate) cushion: Option<Cushion<D>>,
    pub(crate) colliders: Vec<Collider<D>>,
    pub(crate) kernel: Kernel,
    pub(crate) transfer: Transfer,
    pub(crate) force: ForceForm,
    pub(crate) time_step: TimeStep,
    pub(crate) materials: Vec<Material>,
    /// Indices of the fluids whose speed of sound the scene leaves open.
    pub(crate) automatic: Vec<usize>,
    pub(crate) bodies: Vec<Body<D>>,
    /// The probes of the scene.
    pub(crate) probes: Vec<Probe<D>>,
    pub(crate) warnings: Vec<String>,
}

/// A body of the scene.
#[derive(Clone, Debug)]
pub(crate) struct Body<const D: usize> {
    pub(crate) name: String,
    pub(crate) material: usize,
    pub(crate) source: Source<D>,
    pub(crate) velocity: Formulas<D>,
    /// Largest random deviation of a particle's velocity from `velocity` \[m/s\].
    pub(crate) velocity_spread: [f64; D],
    /// ∂v_i/∂x_j of spin and velocity gradient together \[1/s\].
    pub(crate) gradient: [[f64; D]; D],
    pub(crate) volume: Volume,
    pub(crate) pressure: StartPressure,
}

/// The source of a body's particles.
#[derive(Clone, Debug)]
pub(crate) enum Source<const D: usize> {
    Shape {
        region: Region<D>,
        spacing: f64,
        count: Option<usize>,
        sampling: Sampling,
    },
    List(ParticleList<D>),
}

/// The rule for the rest volumes of a body's particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Volume {
    /// The volume of the shape shared alike, or the volumes of the list.
    Source,
    /// The volume of the body that the scene gives \[m³\].
    Body(f64),
    /// The volume per particle that the scene gives \[m³\].
    Particle(f64),
    /// The volume of the shape, shared so that the grid is evenly filled. On a lattice this is an equal share.
    Even,
    /// The volume that each particle has on the grid at the start.
    Measured,
}

/// The pressure that a fluid body starts with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StartPressure {
    None,
    /// The pressure of a body at rest under gravity.
    Hydrostatic,
    /// Hydrostatic if the body is at rest on the floor.
    Automatic,
}

impl<const D: usize> Body<D> {
    /// Returns true if no part of the body moves at the start.
    fn is_still(&self) -> bool {
        let listed = match &self.source {
            Source::Shape { .. } => false,
            Source::List(list) => !list.velocity.is_empty() || !list.affine.is_empty(),
        };
        !listed
            && self.velocity.is_constant()
            && self.velocity.constants() == [0.0; D]
            && self.velocity_spread == [0.0; D]
            && self.gradient == [[0.0; D]; D]
    }

    /// Returns a box around the particles \[m\].
    pub(crate) fn bounds(&self) -> Bounds<D> {
        match &self.source {
            Source::Shape { region, .. } => *region.bounds(),
            Source::List(list) => Bounds::around_points(&list.position),
        }
    }

    /// Returns the number of particles: an estimate for shapes that are sampled on lattices.
    pub(crate) fn expected_particles(&self) -> f64 {
        match &self.source {
            Source::Shape {
                count: Some(count), ..
            } => *count as f64,
            Source::Shape {
                region,
                spacing,
                sampling,
                ..
            } => expected_count(region, *spacing, *sampling),
            Source::List(list) => list.position.len() as f64,
        }
    }

    /// Returns a bound on the speeds at the start \[m/s\].
    pub(crate) fn speed(&self) -> f64 {
        let length = |v: &[f64; D]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let bounds = self.bounds();
        let half: [f64; D] = core::array::from_fn(|i| 0.5 * bounds.side(i));
        let turning: [f64; D] =
            core::array::from_fn(|i| (0..D).map(|j| self.gradient[i][j].abs() * half[j]).sum());
        // Points along an axis at which a formula is evaluated.
        const PLACES: usize = 9;
        let own = if self.velocity.is_constant() {
            vec![self.velocity.constants()]
        } else {
            self.velocity.at(&lattice(&bounds, PLACES))
        };
        let own = own.iter().map(length).fold(0.0, f64::max);
        let listed = match &self.source {
            Source::List(list) => list.velocity.iter().map(length).fold(0.0, f64::max),
            Source::Shape { .. } => 0.0,
        };
        own + listed + length(&turning)
    }
}

impl<const D: usize> Plan<D> {
    /// Returns true if a body of fluid starts with the pressure of its own weight.
    pub(crate) fn starts_hydrostatic(&self, body: &Body<D>, fluid: &Fluid) -> bool {
        match body.pressure {
            StartPressure::None => false,
            StartPressure::Hydrostatic => true,
            StartPressure::Automatic => {
                let corrected = matches!(fluid.volume, VolumeRule::Corrected(_));
                corrected && body.is_still() && self.stands_on_floor(body)
            }
        }
    }

    /// Returns true if a body touches the wall towards which gravity pulls most.
    fn stands_on_floor(&self, body: &Body<D>) -> bool {
        let Some(domain) = &self.domain else {
            return false;
        };
        let g = self.gravity;
        let axis = (0..D).fold(0, |most, axis| {
            if g[axis].abs() > g[most].abs() {
                axis
            } else {
                most
            }
        });
        let Sides::Walls { low, high } = domain.sides[axis] else {
            return false;
        };
        let bounds = body.bounds();
        // Half a cell is near: the particles of a list are not on the wall themselves.
        let near = |gap: f64| gap.abs() <= 0.5 * self.dx;
        (g[axis] < 0.0 && low != Contact::Open && near(bounds.min[axis] - domain.min[axis]))
            || (g[axis] > 0.0 && high != Contact::Open && near(bounds.max[axis] - domain.max[axis]))
    }
}
