//! Pressure gauges in walls: they feel what the wall takes, as a sensor does.

use crate::instance::Instance;
use crate::setup::{Gauge, Plate};
use crate::simulation::Simulation;

/// How far from a wall's plane a gauge may be to be in it \[cells\].
const IN_WALL: f64 = 1e-3;

impl<T: Instance<D>, const D: usize> Simulation<T, D> {
    /// Adds to each gauge in a wall the impulse on its face in the last update, over the face's area.
    pub(crate) fn press_probes(&mut self) {
        for index in 0..self.setup.probes.len() {
            let Some((wall, at, face)) = self.sensor(index) else {
                continue;
            };
            let axis = self.walls.planes[wall].axis;
            let cells = self.cells_of(axis, at, face);
            let impulse: f64 = self
                .grid
                .pressed(wall)
                .map(|(node, pressed)| {
                    let distance = self.distance_across(axis, at, node.map(f64::from));
                    face.covers(distance) * pressed
                })
                .sum();
            let area = cells * self.setup.dx.powi(D as i32 - 1);
            self.readings[index].pressed += impulse / area;
        }
    }

    /// How far apart two places are across `axis` \[cells\].
    fn distance_across(&self, axis: usize, a: [f64; D], b: [f64; D]) -> f64 {
        let across = (0..D).filter(|&k| k != axis);
        let squared: f64 = across.map(|k| self.offset_on(k, a[k], b[k]).powi(2)).sum();
        squared.sqrt()
    }

    /// The area of a face across `axis`, in cells, as nodes weigh it: those that walls cut in half count
    /// half.
    fn cells_of(&self, axis: usize, at: [f64; D], face: Face) -> f64 {
        let reach = face.outer.ceil() as i64;
        let width = 2 * reach + 1;
        let mut cells = 0.0;
        for number in 0..width.pow(D as u32 - 1) {
            let mut rest = number;
            let (mut node, mut share) = (at, 1.0);
            for k in (0..D).filter(|&k| k != axis) {
                node[k] = at[k].round() + (rest % width - reach) as f64;
                rest /= width;
                share *= self.share_of_cell(k, node[k]);
            }
            cells += share * face.covers(self.distance_across(axis, at, node));
        }
        cells
    }

    /// What gauge `index` has felt since its last reading \[Pa\]; `None` at the start, and for gauges
    /// that are not in a wall.
    pub(super) fn felt(&mut self, index: usize) -> Option<f64> {
        self.sensor(index)?;
        let now = self.control.time();
        let readings = &mut self.readings[index];
        let between = now - core::mem::replace(&mut readings.last.0, now);
        let pressed = core::mem::take(&mut readings.pressed);
        (between > 0.0).then(|| pressed / between)
    }

    /// The number of the wall that gauge `index` is in, its place in cells and its face.
    fn sensor(&self, index: usize) -> Option<(usize, [f64; D], Face)> {
        let Gauge::Pressure { at, radius, plate } = &self.setup.probes[index].gauge else {
            return None;
        };
        let at = self.to_cells(*at);
        let faces = |axis: usize| match plate {
            Some(Plate { normal, .. }) => {
                let along = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
                normal[axis].abs() > (1.0 - IN_WALL) * along
            }
            None => true,
        };
        let wall = self.walls.planes.iter().position(|plane| {
            faces(plane.axis) && (at[plane.axis] - plane.node as f64).abs() < IN_WALL
        })?;
        let dx = self.setup.dx;
        Some((
            wall,
            at,
            match plate {
                Some(plate) => Face::plate(plate.width / dx),
                None => Face::point(radius / dx),
            },
        ))
    }

    /// How much of a node's cell is inside the walls along `axis`: half of it where the node is on one.
    fn share_of_cell(&self, axis: usize, node: f64) -> f64 {
        let walls = self.walls.planes.iter().filter(|plane| plane.axis == axis);
        walls
            .map(|plane| {
                let inside = (node - plane.node as f64) * f64::from(plane.inward);
                (inside + 0.5).clamp(0.0, 1.0)
            })
            .product()
    }
}

/// The face of a gauge, in cells: full weight up to `inner` from its middle, none from `outer` on.
#[derive(Clone, Copy, Debug)]
struct Face {
    inner: f64,
    outer: f64,
}

impl Face {
    /// A node's impulse is that of a cell around it: no face is smaller.
    const LEAST: f64 = 1.0;

    fn point(radius: f64) -> Self {
        Self {
            inner: 0.0,
            outer: radius.max(Self::LEAST),
        }
    }

    /// A plate of this width, its edge blurred over a cell.
    fn plate(width: f64) -> Self {
        let half = (0.5 * width).max(0.5 * Self::LEAST);
        Self {
            inner: half - 0.5,
            outer: half + 0.5,
        }
    }

    fn covers(self, distance: f64) -> f64 {
        ((self.outer - distance) / (self.outer - self.inner)).clamp(0.0, 1.0)
    }
}
