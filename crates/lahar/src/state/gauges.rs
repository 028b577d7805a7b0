//! Readings of gauges. They are computed in f64 and in the order of rows, so that bits do not depend on threads, and from
//! the blocks in reach of the gauge only.

use super::sensor;
use crate::instance::Instance;
use crate::kernel::{BSpline, Quadratic};
use crate::math::Lanes;
use crate::particles::{Group, Lattice, Layout, Run, block_edge};
use crate::setup::check::CheckedSetup;
use crate::setup::{Gauge, Plate};
use crate::state::State;
use crate::state::workspace::Workspace;

/// Distance that a particle may be outside of its block between sorts \[cells\].
const DRIFT: f64 = 1.0;

/// Weight of a slope of zero in the fit (16), in radii squared. It is too small to matter with particles all around, and
/// keeps two particles from setting a slope.
const SLOPE_RIDGE: f64 = 1e-4;

/// How far a reading may be outside of the range of the particles around the gauge, as a part of that range. On a wall, a
/// linear pressure is a quarter of the range above that of the highest particle.
const MOST_BEYOND: f64 = 0.5;

/// The part of a cell that must be filled for the cell to be below the surface.
const SURFACE: f64 = 0.5;

/// Reads probe `index`. Returns the numbers that [`Gauge::columns`] names.
pub(super) fn measure<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    index: usize,
) -> Vec<f64> {
    vec![match &scene.setup.probes[index].gauge {
        &Gauge::Pressure { at, radius, plate } => {
            if let Some(felt) = sensor::felt(scene, state, index) {
                return vec![felt];
            }
            let points = points(at, plate.as_ref(), radius);
            let sum: f64 = points
                .iter()
                .map(|&x| pressure(scene, state, x, radius))
                .sum();
            sum / points.len() as f64
        }
        &Gauge::Velocity { at, radius } => return velocity(scene, state, at, radius).into(),
        &Gauge::Height {
            up,
            column: Some(at),
        } => column_height(scene, state, up, at),
        &Gauge::Height { up, column: None } => mean_height(scene, state, workspace, up),
        &Gauge::Front {
            along,
            rising,
            up,
            depth,
        } => front(scene, state, [along, up], rising, depth),
        Gauge::Force { on } => return state.mean_force(scene, index, on),
    }]
}

/// Lists the points at which the pressure on a plate is read: the middles of equal parts, at most half a radius apart.
fn points<const D: usize>(at: [f64; D], plate: Option<&Plate<D>>, radius: f64) -> Vec<[f64; D]> {
    let Some(plate) = plate else {
        return vec![at];
    };
    let count = (plate.width / (0.5 * radius)).ceil().max(1.0) as usize;
    let place = |i: usize| plate.width * ((i as f64 + 0.5) / count as f64 - 0.5);
    let across = tangents(plate.normal);
    let mut points = Vec::new();
    for i in 0..count {
        for j in 0..if D == 3 { count } else { 1 } {
            let along = [place(i), if D == 3 { place(j) } else { 0.0 }];
            if D == 2 || along[0].hypot(along[1]) <= 0.5 * plate.width {
                points.push(core::array::from_fn(|k| {
                    at[k] + along[0] * across[0][k] + along[1] * across[1][k]
                }));
            }
        }
    }
    points
}

/// Returns unit vectors across `normal`: one in 2D, where the second is zero, and two in 3D.
fn tangents<const D: usize>(normal: [f64; D]) -> [[f64; D]; 2] {
    let unit = |v: [f64; D]| {
        let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        v.map(|v| v / length)
    };
    let n = unit(normal);
    if D == 2 {
        let turned = core::array::from_fn(|k| if k == 0 { -n[1] } else { n[0] });
        return [turned, [0.0; D]];
    }
    // The axis that is farthest from the normal, less its part along it.
    let least = (0..D).fold(0, |least, k| {
        if n[k].abs() < n[least].abs() {
            k
        } else {
            least
        }
    });
    let first = unit(core::array::from_fn(|k| {
        f64::from(u8::from(k == least)) - n[least] * n[k]
    }));
    let second = core::array::from_fn(|k| {
        let (i, j) = ((k + 1) % D, (k + 2) % D);
        n[i] * first[j] - n[j] * first[i]
    });
    [first, second]
}

/// Calls `f` with every particle of blocks that may reach within `reach` cells of `x` on the axes in
/// `seen`: its group, row, and position in cells.
fn for_near<T: Lanes, const D: usize>(
    lattice: &Lattice<D>,
    state: &State<T, D>,
    (x, reach): ([f64; D], f64),
    seen: impl Fn(usize) -> bool,
    mut f: impl FnMut(&Group<T, D>, usize, [f64; D]),
) {
    let half = 0.5 * block_edge(D) as f64;
    for group in &state.groups {
        let may_see = |run: &&Run<D>| {
            let middle = lattice.middle(run.block);
            (0..D).filter(|&k| seen(k)).all(|k| {
                let distance = lattice.offset_on(k, x[k], middle[k]).abs();
                distance <= reach + DRIFT + half
            })
        };
        for run in group.runs.iter().filter(may_see) {
            for row in run.rows() {
                f(group, row, group.cells(lattice, run.block, row));
            }
        }
    }
}

/// Returns the weight of the particle at `b` for a node at `a`, with its mirror images in the walls across `axis`.
fn mirrored_weight<const D: usize>(scene: &CheckedSetup<D>, axis: usize, a: f64, b: f64) -> f64 {
    let planes = scene.walls.planes.iter().filter(|plane| plane.axis == axis);
    let images = planes.map(|plane| weight(2.0 * plane.node as f64 - b - a));
    weight(scene.lattice.offset_on(axis, a, b)) + images.sum::<f64>()
}

/// Returns the weight of a node for a particle `s` cells away, by the quadratic kernel whatever kernel the setup has.
fn weight(s: f64) -> f64 {
    let past = s - Quadratic::OFFSET;
    let base = past.floor();
    let weights = Quadratic::weights(past - base);
    // The node is at 0, which is −base above the base node.
    if (-2.0..=0.0).contains(&base) {
        weights[-base as usize]
    } else {
        0.0
    }
}

/// Returns the pressure at a point \[Pa\].
fn pressure<T: Lanes, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    at: [f64; D],
    radius: f64,
) -> f64 {
    let fit = fitted(scene, state, at, radius, |_, _, pressure| [pressure]);
    fit.map_or(0.0, |[fit]| {
        // Between particles that are all pressed there is no tension.
        let least = if fit.low < 0.0 {
            f64::NEG_INFINITY
        } else {
            0.0
        };
        fit.clamped().max(least)
    })
}

/// Returns the velocity at a point \[m/s\].
fn velocity<T: Lanes, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    at: [f64; D],
    radius: f64,
) -> [f64; D] {
    let velocity = |group: &Group<T, D>, row: usize, _| {
        core::array::from_fn(|axis| group.columns[Layout::velocity(D) + axis][row].to_f64())
    };
    let fit = fitted(scene, state, at, radius, velocity);
    fit.map_or([0.0; D], |axes| axes.map(Fitted::clamped))
}

/// A quantity at a point, from a plane fitted to that of the particles around it.
#[derive(Clone, Copy, Debug)]
struct Fitted {
    value: f64,
    /// The smallest and the largest value of a particle.
    low: f64,
    high: f64,
}

impl Fitted {
    /// Returns the value, clamped near the range of the particles: a plane does not fit an impact.
    fn clamped(self) -> f64 {
        let beyond = MOST_BEYOND * (self.high - self.low);
        self.value.clamp(self.low - beyond, self.high + beyond)
    }
}

/// Fits planes to `quantities` of the particles around a point, (16). Returns `None` if there are no particles. A mean would
/// be the value at the middle of the particles: for a point on a wall, half a radius inside. `quantities` is called with a
/// group, a row and its Cauchy pressure \[Pa\].
fn fitted<T: Lanes, const D: usize, const N: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    at: [f64; D],
    radius: f64,
    quantities: impl Fn(&Group<T, D>, usize, f64) -> [f64; N],
) -> Option<[Fitted; N]> {
    let x = scene.lattice.to_cells(at);
    let reach = radius / scene.lattice.dx;
    // Normal equations of q(d) = c₀ + c·d: the matrix and, for each quantity, the right side.
    let mut sums = [[0.0; 4]; 4];
    let mut right = [[0.0; 4]; N];
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); N];
    for_near(
        &scene.lattice,
        state,
        (x, reach),
        |_| true,
        |group, row, place| {
            let d: [f64; D] =
                core::array::from_fn(|k| scene.lattice.offset_on(k, x[k], place[k]) / reach);
            let squared = d.iter().map(|d| d * d).sum::<f64>();
            if squared >= 1.0 {
                return;
            }
            let (volume, pressure) = volume_and_pressure(group, row);
            let q = quantities(group, row, pressure);
            let w = volume * (1.0 - squared) * (1.0 - squared);
            let term = |i: usize| if i == 0 { 1.0 } else { d[i - 1] };
            for i in 0..=D {
                for j in 0..=D {
                    sums[i][j] += w * term(i) * term(j); // (16)
                }
                for (right, q) in right.iter_mut().zip(q) {
                    right[i] += w * term(i) * q; // (16)
                }
            }
            for ((low, high), q) in range.iter_mut().zip(q) {
                (*low, *high) = (low.min(q), high.max(q));
            }
        },
    );
    let total = sums[0][0];
    if total == 0.0 {
        return None;
    }
    for (i, row) in sums.iter_mut().enumerate().take(D + 1).skip(1) {
        row[i] += SLOPE_RIDGE * total;
    }
    Some(core::array::from_fn(|k| Fitted {
        value: first_unknown::<D>(sums, right[k]),
        low: range[k].0,
        high: range[k].1,
    }))
}

/// Returns J V⁰ \[m³\] and Cauchy pressure \[Pa\] of a particle.
fn volume_and_pressure<T: Lanes, const D: usize>(group: &Group<T, D>, row: usize) -> (f64, f64) {
    let at = |column: usize| group.columns[column][row].to_f64();
    let strain: Vec<f64> = (0..group.law.strain_columns())
        .map(|column| at(Layout::strain(D) + column))
        .collect();
    let gradient =
        core::array::from_fn(|i| core::array::from_fn(|j| at(Layout::affine(D) + j * D + i)));
    let found = group.law.describe(&strain, gradient);
    (
        group.volume0.get(row).to_f64() * found.jacobian,
        found.pressure,
    )
}

/// Returns the first of D + 1 unknowns of a symmetric positive system, by elimination from the last.
fn first_unknown<const D: usize>(mut a: [[f64; 4]; 4], mut b: [f64; 4]) -> f64 {
    for k in (1..=D).rev() {
        for i in 0..k {
            let factor = a[i][k] / a[k][k];
            for j in 0..k {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    b[0] / a[0][0]
}

/// Returns the coordinate of the surface in a column \[m\]: the highest place where half of the space is filled, by weights
/// of the quadratic kernel.
fn column_height<T: Lanes, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    up: usize,
    at: [f64; D],
) -> f64 {
    let x = scene.lattice.to_cells(at);
    let cell = scene.lattice.dx.powi(D as i32);
    let mut column: Vec<(f64, f64)> = Vec::new();
    for_near(
        &scene.lattice,
        state,
        (x, 1.5),
        |axis| axis != up,
        |group, row, place| {
            let across = (0..D).filter(|&k| k != up);
            let w: f64 = across
                .map(|k| mirrored_weight(scene, k, x[k], place[k]))
                .product();
            if w > 0.0 {
                column.push((place[up], w * group.volume0.get(row).to_f64() / cell));
            }
        },
    );
    let lowest = column.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let highest = column.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    let ground = if scene.setup.domain.is_some() {
        0.0
    } else {
        lowest
    };
    let world = |cells: f64| scene.lattice.to_world(up, cells);
    if column.is_empty() {
        return world(ground.min(0.0));
    }
    let first = lowest.floor() - 1.0;
    let nodes = (highest.ceil() + 1.0 - first) as usize + 1;
    let mut filled = vec![0.0; nodes];
    for &(place, part) in &column {
        let base = ((place - first).floor() as usize).saturating_sub(1);
        for (node, filled) in filled.iter_mut().enumerate().skip(base).take(4) {
            *filled += part * mirrored_weight(scene, up, first + node as f64, place);
        }
    }
    // A wall cuts the column off: what is beyond its plane is only an image.
    let inside = |node: usize| first + node as f64 >= ground;
    let surface = (0..nodes - 1)
        .rev()
        .find(|&node| filled[node] >= SURFACE && inside(node));
    match surface {
        Some(node) => {
            let past = (filled[node] - SURFACE) / (filled[node] - filled[node + 1]);
            world(first + node as f64 + past)
        }
        None => world(ground + column.iter().map(|p| p.1).sum::<f64>()),
    }
}

/// Returns the mean height of the surface \[m\]: the filled volume over the domain's area, from its lower side.
fn mean_height<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    up: usize,
) -> f64 {
    workspace.sort_if_drifted(scene, state);
    let volume = workspace.filled_volume(state);
    scene.lattice.origin[up] + volume / across(scene, |axis| axis != up)
}

/// Returns the product of the lengths of the domain on the axes in `seen` \[m^n\]; 1 for no axis.
fn across<const D: usize>(scene: &CheckedSetup<D>, seen: impl Fn(usize) -> bool) -> f64 {
    let side = |axis: usize| {
        let domain = scene.setup.domain.as_ref();
        domain.map_or(1.0, |domain| domain.max[axis] - domain.min[axis])
    };
    (0..D).filter(|&axis| seen(axis)).map(side).product()
}

/// Returns the end of the last column of one cell that is deeper than `depth` \[m\].
fn front<T: Lanes, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    [along, up]: [usize; 2],
    rising: bool,
    depth: f64,
) -> f64 {
    let dx = scene.lattice.dx;
    let mut columns = std::collections::BTreeMap::<i64, f64>::new();
    for group in &state.groups {
        for run in &group.runs {
            for row in run.rows() {
                let x = group.position(&scene.lattice, run.block, row)[along];
                let cell = ((x - scene.lattice.origin[along]) / dx).floor() as i64;
                *columns.entry(cell).or_default() += group.volume0.get(row).to_f64();
            }
        }
    }
    let area = dx * across(scene, |axis| axis != along && axis != up);
    let deep = |(cell, volume): (&i64, &f64)| (volume / area > depth).then_some(*cell);
    let last = if rising {
        columns.iter().rev().find_map(deep)
    } else {
        columns.iter().find_map(deep)
    };
    let world = |cells: f64| scene.lattice.to_world(along, cells);
    let Some(last) = last else {
        let domain = scene.setup.domain.as_ref();
        return match (rising, domain) {
            (false, Some(domain)) => domain.max[along],
            _ => world(0.0),
        };
    };
    let step = if rising { 1 } else { -1 };
    let depth_of = |cell: i64| columns.get(&cell).map_or(0.0, |volume| volume / area);
    let (here, beyond) = (depth_of(last), depth_of(last + step));
    let past = (here - depth) / (here - beyond);
    world(last as f64 + 0.5 + step as f64 * past)
}
