//! The domain's walls as the nodes see them.

use super::impulse::{SIDES, Taken};
use super::rooted::Side;
use super::{Contact, Cushion, Domain, Sides, WallStyle};
use crate::error::SetupError;
use crate::geometry::Bounds;
use crate::math::{Scalar, Vector};
use crate::setup::Setup;

/// How far, in cells, a side may be from a whole number of them.
const WHOLE_CELLS_TOLERANCE: f64 = 1e-6;

/// One end of an axis in node indices.
#[derive(Clone, Copy, Debug)]
struct End {
    /// The outermost node that is not inside: at and beyond it the contact acts.
    node: i64,
    contact: Contact,
}

/// A wall on its plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) axis: usize,
    /// The index on `axis` of the nodes on the plane.
    pub(crate) node: i64,
    /// +1: the domain is on the side of higher indices; −1: of lower ones.
    pub(crate) inward: i8,
    pub(crate) contact: Contact,
}

impl Plane {
    /// The number of the domain's side that it is.
    pub(crate) fn side(&self) -> usize {
        side(self.axis, self.inward < 0)
    }
}

/// The number of a side of the domain: axis after axis, low before high.
const fn side(axis: usize, high: bool) -> usize {
    2 * axis + high as usize
}

/// The walls of a domain in node indices; nothing at all when unbounded.
#[derive(Clone, Debug)]
pub(crate) struct Walls<const D: usize> {
    /// Walls on their plane, axis after axis. They act in this order.
    pub(crate) planes: Vec<Plane>,
    /// Walls of [`WallStyle::Nodes`].
    low: [Option<End>; D],
    high: [Option<End>; D],
    /// Cells on a periodic axis.
    pub(crate) period: [Option<i64>; D],
    /// Where particles may be, in cells from the origin: (lowest, highest) if a wall on its plane or
    /// a clamp holds them there.
    pub(crate) hold: [(Option<f64>, Option<f64>); D],
    /// Where particles are slowed down to stay, in cells from the origin.
    pub(crate) cushion: Option<NodeCushion<D>>,
    /// Beyond which particles are removed, in cells from the origin.
    pub(crate) open: [(Option<f64>, Option<f64>); D],
}

/// [`Cushion`] in cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeCushion<const D: usize> {
    pub(crate) low: [f64; D],
    pub(crate) high: [f64; D],
    /// dx / time: the speed that crosses a cell in it \[m/s\].
    pub(crate) speed: f64,
}

impl<const D: usize> Walls<D> {
    fn unbounded() -> Self {
        Self {
            planes: Vec::new(),
            low: [None; D],
            high: [None; D],
            period: [None; D],
            hold: [(None, None); D],
            cushion: None,
            open: [(None, None); D],
        }
    }

    /// Whether particles can leave through a side.
    pub(crate) fn has_open(&self) -> bool {
        let is_open = |side: &(Option<f64>, Option<f64>)| side.0.is_some() || side.1.is_some();
        self.open.iter().any(is_open)
    }

    /// The walls of a scene, and what keeps particles in.
    ///
    /// # Errors
    /// Names the key that makes no walls.
    pub(crate) fn of(setup: &Setup<D>) -> Result<Self, SetupError> {
        let (mut walls, origin) = match &setup.domain {
            Some(domain) => (Self::new(domain, setup.dx)?, domain.min),
            None => (Self::unbounded(), [0.0; D]),
        };
        walls.keep(
            setup.clamp.as_ref(),
            setup.cushion.as_ref(),
            origin,
            setup.dx,
        )?;
        Ok(walls)
    }

    /// The walls of `domain` on nodes `dx` apart.
    ///
    /// # Errors
    /// If a side is empty, or is not a whole number of cells.
    fn new(domain: &Domain<D>, dx: f64) -> Result<Self, SetupError> {
        let mut walls = Self::unbounded();
        for axis in 0..D {
            let length = domain.max[axis] - domain.min[axis];
            if !(length > 0.0 && length.is_finite()) {
                return Err(SetupError {
                    key: "domain.max".into(),
                    message: format!("must be above domain.min on axis {}", ["x", "y", "z"][axis]),
                });
            }
            let cells = (length / dx).round();
            if (length / dx - cells).abs() > WHOLE_CELLS_TOLERANCE * cells.max(1.0) || cells < 1.0 {
                return Err(SetupError {
                    key: "dx".into(),
                    message: format!(
                        "the domain's side along {} is {length} m, {:.4} cells of {dx} m: a side must be a whole number of \
                         cells; the nearest dx is {}",
                        ["x", "y", "z"][axis],
                        length / dx,
                        length / cells.max(1.0)
                    ),
                });
            }
            let cells = cells as i64;
            match domain.sides[axis] {
                Sides::Periodic => walls.period[axis] = Some(cells),
                Sides::Walls { low, high } => {
                    let (low_node, high_node) = match domain.style {
                        WallStyle::Plane => (0, cells),
                        // Taichi's examples: i < padding, i > n − padding.
                        WallStyle::Nodes { padding } => {
                            (i64::from(padding) - 1, cells - i64::from(padding) + 1)
                        }
                    };
                    let on_plane = domain.style == WallStyle::Plane;
                    if low == Contact::Open {
                        walls.open[axis].0 = Some(0.0);
                    } else if on_plane {
                        walls.planes.push(Plane {
                            axis,
                            node: low_node,
                            inward: 1,
                            contact: low,
                        });
                        walls.hold[axis].0 = Some(0.0);
                    } else {
                        walls.low[axis] = Some(End {
                            node: low_node,
                            contact: low,
                        });
                    }
                    if high == Contact::Open {
                        walls.open[axis].1 = Some(cells as f64);
                    } else if on_plane {
                        walls.planes.push(Plane {
                            axis,
                            node: high_node,
                            inward: -1,
                            contact: high,
                        });
                        walls.hold[axis].1 = Some(cells as f64);
                    } else {
                        walls.high[axis] = Some(End {
                            node: high_node,
                            contact: high,
                        });
                    }
                }
            }
        }
        Ok(walls)
    }

    /// Adds what keeps particles in boxes of their own.
    ///
    /// # Errors
    /// If a box is empty, or the cushion's time is not positive.
    fn keep(
        &mut self,
        clamp: Option<&Bounds<D>>,
        cushion: Option<&Cushion<D>>,
        origin: [f64; D],
        dx: f64,
    ) -> Result<(), SetupError> {
        let cells = |x: [f64; D]| -> [f64; D] {
            core::array::from_fn(|axis| (x[axis] - origin[axis]) / dx)
        };
        if let Some(corners) = clamp {
            check_corners("domain.clamp", corners)?;
            let (low, high) = (cells(corners.min), cells(corners.max));
            for axis in 0..D {
                let hold = &mut self.hold[axis];
                hold.0 = Some(hold.0.map_or(low[axis], |x| x.max(low[axis])));
                hold.1 = Some(hold.1.map_or(high[axis], |x| x.min(high[axis])));
            }
        }
        if let Some(cushion) = cushion {
            check_corners("domain.cushion", &cushion.inside)?;
            if !(cushion.time > 0.0 && cushion.time.is_finite()) {
                return Err(SetupError {
                    key: "domain.cushion.time".into(),
                    message: format!("must be a positive number, not {}", cushion.time),
                });
            }
            self.cushion = Some(NodeCushion {
                low: cells(cushion.inside.min),
                high: cells(cushion.inside.max),
                speed: dx / cushion.time,
            });
        }
        Ok(())
    }

    /// The sides of the domain where material ends.
    pub(crate) fn ends(&self) -> impl Iterator<Item = Side> {
        let planes = self.planes.iter().map(|plane| Side {
            axis: plane.axis,
            at: plane.node as f64,
            out: -f64::from(plane.inward),
        });
        let of_axis = |axis: usize| {
            let (low, high) = (self.low[axis], self.high[axis]);
            let at = |end: End| end.node as f64;
            let low = low.map(at).or(self.open[axis].0).map(|at| (at, -1.0));
            let high = high.map(at).or(self.open[axis].1).map(|at| (at, 1.0));
            let ends = low.into_iter().chain(high);
            ends.map(move |(at, out)| Side { axis, at, out })
        };
        planes.chain((0..D).flat_map(of_axis))
    }

    /// Names of the domain's sides with walls, and their numbers.
    pub(crate) fn sides(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let is_wall = |side: usize| {
            let (axis, high) = (side / 2, side % 2 == 1);
            let end = if high {
                self.high[axis]
            } else {
                self.low[axis]
            };
            end.is_some() || self.planes.iter().any(|plane| plane.side() == side)
        };
        (0..2 * D)
            .filter(move |&side| is_wall(side))
            .map(|side| (SIDES[side / 2][side % 2], side))
    }

    /// Whether any node of `first .. first + edge` on each axis is in a wall of
    /// [`WallStyle::Nodes`].
    pub(crate) fn touch(&self, first: [i64; D], edge: usize) -> bool {
        (0..D).any(|axis| {
            self.low[axis].is_some_and(|end| first[axis] <= end.node)
                || self.high[axis].is_some_and(|end| first[axis] + edge as i64 > end.node)
        })
    }

    /// The velocity of node `node` of `mass` after the walls of [`WallStyle::Nodes`] have acted on
    /// it, axis after axis; adds what they take to `taken`, by the number of the side.
    #[inline(always)]
    pub(crate) fn constrain<T: Scalar>(
        &self,
        mut velocity: Vector<T, D>,
        node: [i64; D],
        mass: T,
        taken: &mut [Taken<D>],
    ) -> Vector<T, D> {
        for axis in 0..D {
            let low = self.low[axis].filter(|end| node[axis] <= end.node);
            let high = self.high[axis].filter(|end| node[axis] >= end.node);
            for (end, inward) in [(low, 1.0), (high, -1.0)] {
                let Some(end) = end else { continue };
                let free = velocity;
                velocity = end.contact.constrain(free, axis, inward);
                let change = Vector::from_fn(|i| (velocity[i] - free[i]).to_f64());
                let at = node.map(|node| node as f64);
                taken[side(axis, inward < 0.0)].add(at, change * -mass.to_f64()); // (13)
            }
        }
        velocity
    }

    /// Whether `node` is beyond a wall on its plane.
    pub(crate) fn is_behind_plane(&self, node: [i64; D]) -> bool {
        (0..D).any(|axis| self.is_behind_on(axis, node[axis]))
    }

    /// Whether nodes with that number on `axis` are beyond a wall across it.
    pub(crate) fn is_behind_on(&self, axis: usize, node: i64) -> bool {
        let mut across = self.planes.iter().filter(|wall| wall.axis == axis);
        across.any(|wall| (node - wall.node) * i64::from(wall.inward) < 0)
    }

    /// Whether a wall on its plane has any of the nodes `first .. first + edge` beyond it.
    pub(crate) fn passes(&self, first: [i64; D], edge: i64) -> bool {
        self.planes.iter().any(|plane| {
            let first = first[plane.axis];
            if plane.inward > 0 {
                first < plane.node
            } else {
                first + edge - 1 > plane.node
            }
        })
    }

    /// `node` on its periodic axes brought into 0 .. period.
    pub(crate) fn canonical(&self, mut node: [i64; D]) -> [i64; D] {
        for axis in 0..D {
            if let Some(period) = self.period[axis] {
                node[axis] = node[axis].rem_euclid(period);
            }
        }
        node
    }
}

fn check_corners<const D: usize>(key: &str, corners: &Bounds<D>) -> Result<(), SetupError> {
    let empty = |axis: usize| {
        let side = corners.max[axis] - corners.min[axis];
        !(side > 0.0 && side.is_finite())
    };
    match (0..D).find(|&axis| empty(axis)) {
        None => Ok(()),
        Some(axis) => Err(SetupError {
            key: format!("{key}.max"),
            message: format!("must be above {key}.min along {}", ["x", "y", "z"][axis]),
        }),
    }
}
