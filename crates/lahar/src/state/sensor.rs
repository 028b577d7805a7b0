//! Pressure gauges in walls: they measure the impulse that the wall takes, as a sensor does.

use crate::boundary::walls::faces::WallFaces;
use crate::math::Lanes;
use crate::setup::check::CheckedSetup;
use crate::setup::{Gauge, Plate};
use crate::state::State;

/// Distance from a wall's plane within which a gauge is in the wall \[cells\].
const IN_WALL: f64 = 1e-3;

/// Adds to each gauge in a wall the impulse on its face in the last grid update, over the face's area.
pub(crate) fn press<T: Lanes, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &mut State<T, D>,
    faces: &WallFaces<D>,
) {
    for index in 0..scene.setup.probes.len() {
        let Some(sensor) = Sensor::of(scene, index) else {
            continue;
        };
        let impulse: f64 = faces
            .normal_impulses(sensor.wall)
            .map(|(node, impulse)| {
                let distance = sensor.distance_along_wall(scene, node.map(f64::from));
                sensor.face.covers(distance) * impulse
            })
            .sum();
        let area = sensor.cells(scene) * scene.lattice.dx.powi(D as i32 - 1);
        state.readings[index].pressed += impulse / area;
    }
}

/// Returns the pressure that gauge `index` has felt since its last reading \[Pa\]; `None` at the start, and for
/// gauges that are not in a wall.
pub(super) fn felt<T: Lanes, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &mut State<T, D>,
    index: usize,
) -> Option<f64> {
    Sensor::of(scene, index)?;
    let now = state.control.time();
    let readings = &mut state.readings[index];
    let between = now - core::mem::replace(&mut readings.last.0, now);
    let pressed = core::mem::take(&mut readings.pressed);
    (between > 0.0).then(|| pressed / between)
}

/// A pressure gauge in a wall.
#[derive(Clone, Copy, Debug)]
struct Sensor<const D: usize> {
    /// The number of the wall, and the axis across it.
    wall: usize,
    axis: usize,
    /// The middle of the face \[cells\].
    at: [f64; D],
    face: Face,
}

impl<const D: usize> Sensor<D> {
    /// Returns gauge `index` as a sensor if it is in a wall.
    fn of(scene: &CheckedSetup<D>, index: usize) -> Option<Self> {
        let Gauge::Pressure { at, radius, plate } = &scene.setup.probes[index].gauge else {
            return None;
        };
        let at = scene.lattice.to_cells(*at);
        let faces = |axis: usize| match plate {
            Some(Plate { normal, .. }) => {
                let along = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
                normal[axis].abs() > (1.0 - IN_WALL) * along
            }
            None => true,
        };
        let wall = scene.walls.planes.iter().position(|plane| {
            faces(plane.axis) && (at[plane.axis] - plane.node as f64).abs() < IN_WALL
        })?;
        let dx = scene.lattice.dx;
        Some(Self {
            wall,
            axis: scene.walls.planes[wall].axis,
            at,
            face: match plate {
                Some(plate) => Face::plate(plate.width / dx),
                None => Face::point(radius / dx),
            },
        })
    }

    /// Returns the distance of `place` from the middle of the face, along the wall \[cells\].
    fn distance_along_wall(&self, scene: &CheckedSetup<D>, place: [f64; D]) -> f64 {
        let across = (0..D).filter(|&k| k != self.axis);
        let offset = |k: usize| scene.lattice.offset_on(k, self.at[k], place[k]);
        across.map(|k| offset(k).powi(2)).sum::<f64>().sqrt()
    }

    /// Returns the area of the face in cells. Nodes that walls cut in half count half.
    fn cells(&self, scene: &CheckedSetup<D>) -> f64 {
        let reach = self.face.outer.ceil() as i64;
        let width = 2 * reach + 1;
        let mut cells = 0.0;
        for number in 0..width.pow(D as u32 - 1) {
            let mut rest = number;
            let (mut node, mut share) = (self.at, 1.0);
            for k in (0..D).filter(|&k| k != self.axis) {
                node[k] = self.at[k].round() + (rest % width - reach) as f64;
                rest /= width;
                share *= share_of_cell(scene, k, node[k]);
            }
            cells += share * self.face.covers(self.distance_along_wall(scene, node));
        }
        cells
    }
}

/// Returns the share of a node's cell that is inside of the walls across `axis`: half of it for a node on a wall.
fn share_of_cell<const D: usize>(scene: &CheckedSetup<D>, axis: usize, node: f64) -> f64 {
    let walls = scene.walls.planes.iter().filter(|plane| plane.axis == axis);
    walls
        .map(|plane| {
            let inside = (node - plane.node as f64) * f64::from(plane.inward);
            (inside + 0.5).clamp(0.0, 1.0)
        })
        .product()
}

/// The face of a gauge: its weight is full up to `inner` from its middle, and none from `outer` on \[cells\].
#[derive(Clone, Copy, Debug)]
struct Face {
    inner: f64,
    outer: f64,
}

impl Face {
    /// The smallest width of a face: a node's impulse is that of a whole cell around it.
    const LEAST: f64 = 1.0;

    /// The face of a point that looks as far as `radius`.
    fn point(radius: f64) -> Self {
        Self {
            inner: 0.0,
            outer: radius.max(Self::LEAST),
        }
    }

    /// The face of a plate of this width, with an edge that is one cell wide.
    fn plate(width: f64) -> Self {
        let half = (0.5 * width).max(0.5 * Self::LEAST);
        Self {
            inner: half - 0.5,
            outer: half + 0.5,
        }
    }

    /// Returns the weight of the face at `distance` from its middle.
    fn covers(self, distance: f64) -> f64 {
        ((self.outer - distance) / (self.outer - self.inner)).clamp(0.0, 1.0)
    }
}
