//! The domain as plain data: its walls, and the boxes that keep particles inside.

use crate::geometry::Bounds;

/// The box of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain<const D: usize> {
    /// Lower corner \[m\]; the origin of the nodes.
    pub min: [f64; D],
    /// Upper corner \[m\].
    pub max: [f64; D],
    /// The two sides of each axis.
    pub sides: [Sides; D],
    /// How the walls act on the nodes.
    pub style: WallStyle,
}

/// A box that particles slow down to stay in. At the end of a substep no particle has a velocity that would carry it out
/// within `time`. A particle outside comes back in that time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cushion<const D: usize> {
    /// The box that particles stay in.
    pub inside: Bounds<D>,
    /// The time that it looks ahead \[s\].
    pub time: f64,
}

/// The two sides of the domain on one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sides {
    /// Material that leaves at one end comes in at the other. The length must be a whole number of cells.
    Periodic,
    /// A wall at each end.
    Walls {
        /// The wall at `min`.
        low: Contact,
        /// The wall at `max`.
        high: Contact,
    },
}

/// The contact law of a boundary: how it constrains velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// Material at the boundary moves with it.
    Sticky,
    /// No motion through it or away from it; Coulomb friction along it.
    Slip {
        /// Coefficient of friction; 0: none.
        friction: f64,
    },
    /// No motion into it, free to leave; Coulomb friction along it while pressed.
    Separate {
        /// Coefficient of friction; 0: none.
        friction: f64,
    },
    /// No wall: particles that pass are removed, and counted.
    Open,
}

/// The nodes on which the walls of a domain act.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WallStyle {
    /// The nodes at the plane of the domain's side. Nodes beyond it are the mirror image of the material inside, wherever
    /// the wall pushes.
    #[default]
    Plane,
    /// As in the Taichi examples, all nodes with an index below `padding`, or above the last minus `padding`.
    Nodes {
        /// The number of layers of nodes.
        padding: u32,
    },
}
