//! Materials, contact laws and readings that tests of walls and of colliders share.

use lahar::material::{Corotated, Fluid, lame};
use lahar::particles::Field;
use lahar::{Contact, Material, Model, Sides, Simulate};

/// Density of the materials \[kg/m³\].
pub(crate) const DENSITY: f64 = 1000.0;

/// Returns a fluid with p = ρ₀c² (1/J − 1) and a tension cut-off \[Pa\].
pub(crate) fn fluid(sound_speed: f64, tension: f64) -> Material {
    Material {
        name: "fluid".into(),
        density: DENSITY,
        model: Model::Fluid(Fluid {
            tension,
            ..Fluid::inviscid(DENSITY * sound_speed * sound_speed)
        }),
    }
}

/// Returns a corotated solid with a Young's modulus \[Pa\] and a Poisson's ratio of 0.3.
pub(crate) fn jelly(youngs_modulus: f64) -> Material {
    let (lambda, mu) = lame(youngs_modulus, 0.3);
    Material {
        name: "jelly".into(),
        density: DENSITY,
        model: Model::Corotated(Corotated { lambda, mu }),
    }
}

/// A contact that neither lets material through nor lets it go, without friction.
pub(crate) const SLIP: Contact = Contact::Slip { friction: 0.0 };

/// A contact that lets material go freely, without friction.
pub(crate) const SEPARATE: Contact = Contact::Separate { friction: 0.0 };

/// Returns sides with the same wall at both ends of an axis.
pub(crate) fn both(contact: Contact) -> Sides {
    Sides::Walls {
        low: contact,
        high: contact,
    }
}

/// Returns a vector field of all particles, by ascending id.
pub(crate) fn field<const D: usize>(simulation: &impl Simulate, field: Field) -> Vec<[f64; D]> {
    let snapshot = simulation.snapshot(&[field]);
    let numbers = snapshot.columns[0].1.to_f64();
    numbers.as_chunks().0.to_vec()
}
