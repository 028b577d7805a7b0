//! The stiffness of fluids. Where the scene leaves it open, it follows from the fastest flow that is expected.

use super::forces::expect;
use super::material::Stiffness;
use super::plan::{Body, Plan};
use super::read::Reader;
use super::space::{bounds_in_3d, vector_in_3d};
use crate::error::SceneError;
use lahar::geometry::Bounds;
use lahar::{Command, Model, TimeStep};

/// The speed of sound over the largest speed expected. With 10, the density varies by about 1 % (Monaghan 1994).
const SOUND_OVER_SPEED: f64 = 10.0;

/// Bounds on speeds: how far bodies may fall, and the other causes of speed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Falls<const D: usize> {
    bodies: Vec<Bounds<D>>,
    /// The space that the material can reach.
    space: Bounds<D>,
    /// The mean acceleration by forces other than gravity \[m/s²\].
    forces: [f64; D],
    /// The largest squared speed of bodies, colliders and oscillating forces together \[m²/s²\].
    squared: f64,
}

impl<const D: usize> Falls<D> {
    /// Finds the bounds of a plan. Oscillating forces count over half of the longest side.
    pub(super) fn of(plan: &Plan<D>) -> Self {
        let bodies: Vec<Bounds<D>> = plan.bodies.iter().map(Body::bounds).collect();
        let forces = expect(&plan.forces, &bodies, plan.duration);
        let space = match &plan.domain {
            Some(domain) => Bounds {
                min: domain.min,
                max: domain.max,
            },
            None => Bounds::around(bodies.iter().copied()),
        };
        let longest = (0..D).map(|i| space.side(i)).fold(0.0, f64::max);
        let thrown = plan.bodies.iter().map(Body::speed).fold(0.0, f64::max);
        let pushed = plan
            .colliders
            .iter()
            .map(|collider| collider.largest_speed(0.0, plan.duration, (space.min, space.max)))
            .fold(thrown, f64::max);
        Self {
            bodies,
            space,
            forces: forces.mean,
            squared: pushed * pushed + forces.swing * longest,
        }
    }

    /// Returns the largest speed that the bodies may reach from where they start \[m/s\]: √(v² + 2 g H), with g the
    /// mean of gravity and forces.
    pub(super) fn speed(&self, gravity: [f64; D]) -> f64 {
        self.speed_from(gravity, &self.bodies)
    }

    /// Returns the same speed for bodies that may start anywhere in `space`.
    fn speed_from_anywhere(&self, gravity: [f64; D]) -> f64 {
        self.speed_from(gravity, core::slice::from_ref(&self.space))
    }

    fn speed_from(&self, gravity: [f64; D], starts: &[Bounds<D>]) -> f64 {
        let pull: [f64; D] = core::array::from_fn(|i| gravity[i] + self.forces[i]);
        let g = pull.iter().map(|g| g * g).sum::<f64>().sqrt();
        if g == 0.0 {
            return self.squared.sqrt();
        }
        // The lowest and the highest coordinate of a box, measured against gravity.
        let heights = |bounds: &Bounds<D>| {
            let mut range = [0.0, 0.0];
            for i in 0..D {
                let up = -pull[i] / g;
                if up != 0.0 {
                    let (a, b) = (bounds.min[i] * up, bounds.max[i] * up);
                    range = [range[0] + a.min(b), range[1] + a.max(b)];
                }
            }
            range
        };
        let tops = starts.iter().map(|bounds| heights(bounds)[1]);
        let fall = tops.fold(f64::NEG_INFINITY, f64::max) - heights(&self.space)[0];
        (self.squared + 2.0 * g * fall.max(0.0)).sqrt()
    }
}

impl<const D: usize> Plan<D> {
    /// Gives every fluid its bulk modulus.
    pub(super) fn settle_stiffness(
        &mut self,
        given: &[(Option<Stiffness>, Reader<'_>)],
    ) -> Result<(), SceneError> {
        let speed = Falls::of(self).speed(self.gravity);
        for (index, (material, (stiffness, table))) in
            self.materials.iter_mut().zip(given).enumerate()
        {
            let (Model::Fluid(fluid), Some(stiffness)) = (&mut material.model, stiffness) else {
                continue;
            };
            fluid.bulk_modulus = match stiffness {
                Stiffness::Bulk(bulk) => *bulk,
                Stiffness::SoundSpeed(c) => material.density * c * c,
                Stiffness::Auto if speed > 0.0 => {
                    self.automatic.push(index);
                    material.density * (SOUND_OVER_SPEED * speed).powi(2)
                }
                Stiffness::Auto => {
                    let error = table.error_at("sound_speed", format!("the speed of sound of \"{}\" cannot be found: nothing moves or can fall", material.name));
                    return Err(error.hint(
                        "give sound_speed a number, about ten times the largest speed you expect",
                    ));
                }
            };
        }
        Ok(())
    }

    /// Returns the rule for the speeds of sound under changed gravity.
    pub(super) fn sound_speeds(&self) -> SoundSpeeds {
        let speed = |&material: &usize| (material, self.materials[material].sound_speed());
        let falls = Falls::of(self);
        let follows = !matches!(self.time_step, TimeStep::Fixed(_));
        SoundSpeeds {
            materials: (self.automatic.iter().filter(|_| follows).map(speed)).collect(),
            gravity: vector_in_3d(self.gravity),
            falls: Falls {
                bodies: falls.bodies.iter().map(bounds_in_3d).collect(),
                space: bounds_in_3d(&falls.space),
                forces: vector_in_3d(falls.forces),
                squared: falls.squared,
            },
        }
    }
}

/// The rule for the speeds of sound when gravity is changed during a run, for fluids whose scene leaves them open:
/// ten times the largest speed expected, and no less than at the start. A scene with a fixed time step keeps its
/// speeds of sound, because its step is chosen for them.
///
/// ```
/// use lahar_scene::scene::Scene;
///
/// let scene = Scene::load("dam-break", &[])?;
/// let commands = scene.sound_speeds().under([0.0, -40.0, 0.0]);
/// assert_eq!(commands.len(), 1);
/// # Ok::<(), lahar_scene::error::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SoundSpeeds {
    /// Indices of materials, and their speeds of sound at the start \[m/s\].
    materials: Vec<(usize, f64)>,
    /// Gravity at the start \[m/s²\].
    gravity: [f64; 3],
    falls: Falls<3>,
}

impl SoundSpeeds {
    /// Returns the commands that go with a new `gravity` \[m/s²\].
    pub fn under(&self, gravity: [f64; 3]) -> Vec<Command> {
        let [a, b] = [self.gravity, gravity].map(|g| g.map(|x| x * x).iter().sum::<f64>().sqrt());
        let along: f64 = (0..3).map(|i| self.gravity[i] * gravity[i]).sum();
        // As long as the direction stays, no material falls from higher than it started.
        let speed = if along >= (1.0 - 1e-9) * a * b {
            self.falls.speed(gravity)
        } else {
            self.falls.speed_from_anywhere(gravity)
        };
        (self.materials.iter())
            .map(|&(material, least)| Command::SoundSpeed {
                material,
                speed: least.max(SOUND_OVER_SPEED * speed),
            })
            .collect()
    }
}
