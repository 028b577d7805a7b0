//! Words of scene files and their meanings: each closed set is declared once, for the table of keys and for the
//! readers.

use super::info::Precision;
use super::plan::{StartPressure, Volume};
use lahar::geometry::sampling::Sampling;
use lahar::{Contact, ForceForm, Kernel, Transfer, WallStyle};

/// Contacts, without friction.
pub(super) const CONTACTS: [(&str, Contact); 4] = [
    ("sticky", Contact::Sticky),
    ("slip", Contact::Slip { friction: 0.0 }),
    ("separate", Contact::Separate { friction: 0.0 }),
    ("open", Contact::Open),
];

/// Contacts of the sides of a domain; `None` for sides that are joined.
pub(super) const SIDES: [(&str, Option<Contact>); 5] = [
    (CONTACTS[0].0, Some(CONTACTS[0].1)),
    (CONTACTS[1].0, Some(CONTACTS[1].1)),
    (CONTACTS[2].0, Some(CONTACTS[2].1)),
    (CONTACTS[3].0, Some(CONTACTS[3].1)),
    ("periodic", None),
];

/// Styles of walls; walls at nodes with the usual padding.
pub(super) const WALL_STYLES: [(&str, WallStyle); 2] = [
    ("plane", WallStyle::Plane),
    ("nodes", WallStyle::Nodes { padding: 3 }),
];

/// Precisions of the simulation.
pub(super) const PRECISIONS: [(&str, Precision); 2] =
    [("f32", Precision::F32), ("f64", Precision::F64)];

/// Kernels, the weight functions.
pub(super) const KERNELS: [(&str, Kernel); 3] = [
    ("quadratic", Kernel::Quadratic),
    ("cubic", Kernel::Cubic),
    ("linear", Kernel::Linear),
];

/// Transfer schemes; FLIP with the usual blend.
pub(super) const TRANSFERS: [(&str, Transfer); 3] = [
    ("apic", Transfer::Apic),
    ("pic", Transfer::Pic),
    ("flip", Transfer::Flip { blend: 0.99 }),
];

/// Forms of the force.
pub(super) const FORCE_FORMS: [(&str, ForceForm); 2] =
    [("mls", ForceForm::Mls), ("classic", ForceForm::Classic)];

/// Rules by which the particles of a shape are placed.
pub(super) const SAMPLINGS: [(&str, Sampling); 4] = [
    ("lattice", Sampling::Lattice),
    ("jittered", Sampling::Jittered),
    ("random", Sampling::Random),
    ("poisson", Sampling::Poisson),
];

/// Rules for the rest volumes of a body's particles.
pub(super) const VOLUMES: [(&str, Volume); 3] = [
    ("even", Volume::Even),
    ("alike", Volume::Source),
    ("measured", Volume::Measured),
];

/// Pressures of a fluid body at the start.
pub(super) const START_PRESSURES: [(&str, StartPressure); 3] = [
    ("auto", StartPressure::Automatic),
    ("none", StartPressure::None),
    ("hydrostatic", StartPressure::Hydrostatic),
];

/// Axes of a mesh file that may point up, with the turn that brings them to y \[degrees\].
pub(super) const UP_AXES: [(&str, [f64; 3]); 2] = [("y", [0.0; 3]), ("z", [-90.0, 0.0, 0.0])];

/// Ends of an axis that a front may run towards; true for the upper one.
pub(super) const ENDS: [(&str, bool); 2] = [("high", true), ("low", false)];
