//! The domain: its walls and what keeps particles inside, as plain data.

use crate::geometry::Bounds;

/// The box that holds a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain<const D: usize> {
    /// Lower corner \[m\]; the origin of the nodes.
    pub min: [f64; D],
    /// Upper corner \[m\].
    pub max: [f64; D],
    /// What is at the ends of each axis.
    pub sides: [Sides; D],
    /// How the walls act on the nodes.
    pub style: WallStyle,
}

/// A box that particles slow down to stay in: at the end of a substep, no velocity is left that
/// would carry its particle out within `time`. One that is out already is brought back in that time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cushion<const D: usize> {
    /// The box.
    pub inside: Bounds<D>,
    /// How far ahead it looks \[s\].
    pub time: f64,
}

/// The two ends of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sides {
    /// What leaves at one end comes in at the other. The length must be a whole number of cells.
    Periodic,
    /// A wall at each end.
    Walls {
        /// At `min`.
        low: Contact,
        /// At `max`.
        high: Contact,
    },
}

/// What a boundary does to velocity; v_n the component along its outward normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// No motion at all.
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

/// Where a wall takes hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WallStyle {
    /// On the plane of the domain's side: nodes beyond it hold the mirror image of the material
    /// inside, wherever the wall pushes.
    #[default]
    Plane,
    /// As in the Taichi examples: at all nodes with an index below `padding`, or above the last
    /// minus `padding`.
    Nodes {
        /// Layers of nodes.
        padding: u32,
    },
}
