//! Contact laws and readings that tests of walls and of colliders share.

use lahar::particles::Field;
use lahar::{Contact, Sides, Simulate};

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
