//! The walls of the domain in node indices, and the intervals that particles are kept in.

pub(crate) mod faces;
pub(crate) mod fold;
mod nodes;

use crate::boundary::impulse::SIDES;
use crate::error::SetupError;
use crate::geometry::Bounds;
use crate::setup::{Contact, Cushion, Domain, Setup, Sides, WallStyle};

/// How far the length of a side may be from a whole number of cells \[cells\].
const WHOLE_CELLS_TOLERANCE: f64 = 1e-6;

/// One end of an axis with a wall of [`WallStyle::Nodes`].
#[derive(Clone, Copy, Debug)]
struct End {
    /// The contact acts on nodes with this index and beyond it.
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
    /// Returns the number of its side of the domain.
    pub(crate) fn side(&self) -> usize {
        side(self.axis, self.inward < 0)
    }
}

/// Returns the number of a side of the domain: axis after axis, low before high.
const fn side(axis: usize, high: bool) -> usize {
    2 * axis + high as usize
}

/// A side of the domain, in cells from node 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) axis: usize,
    /// Its place on `axis`.
    pub(super) at: f64,
    /// +1 at the high end of the axis, −1 at the low end.
    pub(super) out: f64,
}

/// The walls of a domain; there are none where it is unbounded.
#[derive(Clone, Debug)]
pub(crate) struct Walls<const D: usize> {
    /// Walls on their plane, axis after axis: the order in which they act.
    pub(crate) planes: Vec<Plane>,
    /// Walls of [`WallStyle::Nodes`].
    low: [Option<End>; D],
    high: [Option<End>; D],
    /// Cells along a periodic axis.
    pub(crate) period: [Option<i64>; D],
    /// The intervals that walls on their planes and clamps keep particles in: (lowest, highest), in cells from node 0.
    pub(crate) bounds: [(Option<f64>, Option<f64>); D],
    /// The box that particles are slowed down to stay in.
    pub(crate) cushion: Option<NodeCushion<D>>,
    /// The places of open sides, in cells from node 0. Particles beyond them are removed.
    pub(crate) open: [(Option<f64>, Option<f64>); D],
}

/// A [`Cushion`], with lengths in cells from node 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeCushion<const D: usize> {
    pub(crate) low: [f64; D],
    pub(crate) high: [f64; D],
    /// The speed that crosses a cell in the cushion's time: dx / time \[m/s\].
    pub(crate) speed: f64,
}

impl<const D: usize> Walls<D> {
    fn unbounded() -> Self {
        Self {
            planes: Vec::new(),
            low: [None; D],
            high: [None; D],
            period: [None; D],
            bounds: [(None, None); D],
            cushion: None,
            open: [(None, None); D],
        }
    }

    /// Returns true if particles can leave through a side.
    pub(crate) fn has_open(&self) -> bool {
        let is_open = |side: &(Option<f64>, Option<f64>)| side.0.is_some() || side.1.is_some();
        self.open.iter().any(is_open)
    }

    /// Makes the walls of a scene, its clamp and its cushion.
    ///
    /// # Errors
    /// Names the key of the domain that is wrong.
    pub(crate) fn of(setup: &Setup<D>) -> Result<Self, SetupError> {
        let (mut walls, origin) = match &setup.domain {
            Some(domain) => (Self::new(domain, setup.dx)?, domain.min),
            None => (Self::unbounded(), [0.0; D]),
        };
        walls.add_boxes(
            setup.clamp.as_ref(),
            setup.cushion.as_ref(),
            origin,
            setup.dx,
        )?;
        Ok(walls)
    }

    /// Makes the walls of `domain` on nodes `dx` apart.
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
                        walls.bounds[axis].0 = Some(0.0);
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
                        walls.bounds[axis].1 = Some(cells as f64);
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

    /// Adds the boxes of a clamp and of a cushion, which keep particles in.
    ///
    /// # Errors
    /// If a box is empty, or the cushion's time is not positive.
    fn add_boxes(
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
                let bounds = &mut self.bounds[axis];
                bounds.0 = Some(bounds.0.map_or(low[axis], |x| x.max(low[axis])));
                bounds.1 = Some(bounds.1.map_or(high[axis], |x| x.min(high[axis])));
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

    /// Returns the sides of the domain at which material ends.
    pub(super) fn ends(&self) -> impl Iterator<Item = Side> {
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

    /// Returns names and numbers of the sides with walls.
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

    /// Returns true if `node` is beyond a wall on its plane.
    pub(crate) fn is_beyond_plane(&self, node: [i64; D]) -> bool {
        (0..D).any(|axis| self.is_beyond_on(axis, node[axis]))
    }

    /// Returns true if nodes with index `node` on `axis` are beyond a wall across it.
    pub(crate) fn is_beyond_on(&self, axis: usize, node: i64) -> bool {
        let mut across = self.planes.iter().filter(|wall| wall.axis == axis);
        across.any(|wall| (node - wall.node) * i64::from(wall.inward) < 0)
    }

    /// Returns true if any of the nodes `first .. first + edge` is beyond a wall on its plane.
    pub(crate) fn have_nodes_beyond(&self, first: [i64; D], edge: i64) -> bool {
        self.planes.iter().any(|plane| {
            let first = first[plane.axis];
            if plane.inward > 0 {
                first < plane.node
            } else {
                first + edge - 1 > plane.node
            }
        })
    }

    /// Returns `node` with its indices on periodic axes brought into 0 .. period.
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
