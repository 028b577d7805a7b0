//! How stiff fluids are: by the fastest flow that is expected, where the scene leaves it open.

use super::forces::expect;
use super::material::Stiffness;
use super::plan::{Body, Plan};
use super::read::Reader;
use super::space::{bounds_in_3d, vector_in_3d};
use crate::error::SceneError;
use lahar::geometry::Bounds;
use lahar::{Command, Model, TimeStep};

/// Sound travels so many times faster than the fastest water that is expected: density then varies
/// by about 1 % (Monaghan 1994).
const SOUND_OVER_SPEED: f64 = 10.0;

/// How far things may fall, and what else makes them fast.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Falls<const D: usize> {
    bodies: Vec<Bounds<D>>,
    /// Where things can be.
    room: Bounds<D>,
    /// The mean acceleration by forces besides gravity \[m/s²\].
    forces: [f64; D],
    /// Squared speeds of bodies and colliders, and of what swinging forces make \[m²/s²\].
    squared: f64,
}

impl<const D: usize> Falls<D> {
    /// What forces swing by counts over half of the longest side.
    pub(super) fn of(plan: &Plan<D>) -> Self {
        let bodies: Vec<Bounds<D>> = plan.bodies.iter().map(Body::bounds).collect();
        let forces = expect(&plan.forces, &bodies, plan.duration);
        let room = match &plan.domain {
            Some(domain) => Bounds {
                min: domain.min,
                max: domain.max,
            },
            None => Bounds::around(bodies.iter().copied()),
        };
        let longest = (0..D).map(|i| room.side(i)).fold(0.0, f64::max);
        let thrown = plan.bodies.iter().map(Body::speed).fold(0.0, f64::max);
        let pushed = plan
            .colliders
            .iter()
            .map(|collider| collider.largest_speed(0.0, plan.duration, (room.min, room.max)))
            .fold(thrown, f64::max);
        Self {
            bodies,
            room,
            forces: forces.mean,
            squared: pushed * pushed + forces.swing * longest,
        }
    }

    /// Largest speed that the bodies may reach from where they start \[m/s\]: √(v² + 2 g H), with g the
    /// mean of gravity and forces.
    pub(super) fn speed(&self, gravity: [f64; D]) -> f64 {
        self.speed_from(gravity, &self.bodies)
    }

    /// The same if they may start anywhere in the room.
    fn speed_from_anywhere(&self, gravity: [f64; D]) -> f64 {
        self.speed_from(gravity, core::slice::from_ref(&self.room))
    }

    fn speed_from(&self, gravity: [f64; D], starts: &[Bounds<D>]) -> f64 {
        let pull: [f64; D] = core::array::from_fn(|i| gravity[i] + self.forces[i]);
        let g = pull.iter().map(|g| g * g).sum::<f64>().sqrt();
        if g == 0.0 {
            return self.squared.sqrt();
        }
        // Lowest and highest height of a box against gravity.
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
        let fall = tops.fold(f64::NEG_INFINITY, f64::max) - heights(&self.room)[0];
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

    /// See [`SoundSpeeds`].
    pub(super) fn sound_speeds(&self) -> SoundSpeeds {
        let speed = |&material: &usize| (material, self.materials[material].sound_speed());
        let falls = Falls::of(self);
        let follows = !matches!(self.time_step, TimeStep::Fixed(_));
        SoundSpeeds {
            materials: (self.automatic.iter().filter(|_| follows).map(speed)).collect(),
            gravity: vector_in_3d(self.gravity),
            falls: Falls {
                bodies: falls.bodies.iter().map(bounds_in_3d).collect(),
                room: bounds_in_3d(&falls.room),
                forces: vector_in_3d(falls.forces),
                squared: falls.squared,
            },
        }
    }
}

/// How fast sound should be when gravity is changed while a scene runs, in the fluids whose scene leaves
/// that open: ten times the largest speed expected, and no less than at the start. A scene with a fixed
/// time step keeps its speeds, since its step is chosen for them.
#[derive(Clone, Debug, PartialEq)]
pub struct SoundSpeeds {
    /// Materials and their speeds of sound at the start.
    materials: Vec<(usize, f64)>,
    /// At the start.
    gravity: [f64; 3],
    falls: Falls<3>,
}

impl SoundSpeeds {
    /// What to tell the simulation along with a new `gravity` \[m/s²\].
    pub fn under(&self, gravity: [f64; 3]) -> Vec<Command> {
        let [a, b] = [self.gravity, gravity].map(|g| g.map(|x| x * x).iter().sum::<f64>().sqrt());
        let along: f64 = (0..3).map(|i| self.gravity[i] * gravity[i]).sum();
        // While down stays down, nothing falls from higher than it started.
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
