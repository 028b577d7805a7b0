//! The filling of nodes by the shape itself: the shape is cut into small pieces, and each is spread over nodes.
//!
//! The pieces form a lattice, and weights are products over axes. So lines of pieces are spread along the
//! first axis, the results along the second, and those along the third: a piece costs a few additions.

use super::nodes::{Lattice, Nodes};
use crate::parallel::*;
use lahar::geometry::Region;
use lahar::geometry::sampling::lattice_size;
use lahar::kernel::{BSpline, STENCIL};

/// Pieces per cell along an axis.
const PIECES_PER_CELL: f64 = 4.0;

/// A coordinate of pieces along one axis.
struct Place {
    /// The coordinate \[m\].
    x: f64,
    /// For each lattice, the first node that the pieces touch, and the weights of the stencil.
    touched: [(usize, [f64; STENCIL]); 2],
}

/// Sums at the nodes of both lattices, over all of their axes or the first ones.
type Sums = [Vec<f64>; 2];

/// Returns sums of 0.
fn zeros(len: usize) -> Sums {
    [vec![0.0; len], vec![0.0; len]]
}

impl Place {
    /// Spreads `line`, which is at this coordinate, over the nodes along the axis.
    fn spread(&self, line: &Sums, sums: &mut Sums) {
        for ((line, sums), (base, weights)) in line.iter().zip(sums).zip(&self.touched) {
            let n = line.len();
            let nodes = sums[base * n..].chunks_exact_mut(n);
            for (node, weight) in nodes.zip(weights) {
                for (sum, value) in node.iter_mut().zip(line) {
                    *sum += weight * value;
                }
            }
        }
    }
}

/// Returns Σ w over the pieces in `region`, at each node of both lattices.
pub(super) fn filled<K: BSpline, const D: usize>(nodes: &Nodes<D>, region: &Region<D>) -> Sums {
    let bounds = region.bounds();
    let size = lattice_size(region, nodes.dx() / PIECES_PER_CELL);
    let places: [Vec<Place>; D] = core::array::from_fn(|axis| {
        let place = |number: usize| {
            let part = (number as f64 + 0.5) / size[axis] as f64;
            let x = bounds.min[axis] + bounds.side(axis) * part;
            let (base, frac) = nodes.base::<K>(axis, x);
            let touched = Lattice::BOTH.map(|lattice| {
                let (base, frac) = lattice.base(base, frac);
                (base, K::weights(frac))
            });
            Place { x, touched }
        };
        (0..size[axis]).map(place).collect()
    });
    let mut whole_line = zeros(nodes.stride(1));
    for place in &places[0] {
        place.spread(&[vec![1.0], vec![1.0]], &mut whole_line);
    }
    let pieces = Pieces {
        nodes,
        region,
        places,
        whole_line,
    };
    let last = &pieces.places[D - 1];
    let planes: Vec<Sums> = last.par_iter().map(|place| pieces.plane(place)).collect();
    let mut filled = zeros(nodes.len());
    for (place, plane) in last.iter().zip(&planes) {
        place.spread(plane, &mut filled);
    }
    filled
}

/// The pieces of a region.
struct Pieces<'a, const D: usize> {
    nodes: &'a Nodes<D>,
    region: &'a Region<D>,
    places: [Vec<Place>; D],
    /// The sums of a line along the first axis of which all pieces are inside.
    whole_line: Sums,
}

impl<const D: usize> Pieces<'_, D> {
    /// Returns the sums over the pieces at one coordinate of the last axis, at the nodes along the other axes.
    fn plane(&self, place: &Place) -> Sums {
        let mut x = [0.0; D];
        x[D - 1] = place.x;
        let mut sums = zeros(self.nodes.stride(D - 1));
        let mut line = zeros(self.nodes.stride(1));
        if D == 2 {
            self.line(&mut x, &mut sums);
            return sums;
        }
        for place in &self.places[1] {
            x[1] = place.x;
            line.iter_mut().for_each(|line| line.fill(0.0));
            if self.line(&mut x, &mut line) {
                place.spread(&line, &mut sums);
            }
        }
        sums
    }

    /// Adds the pieces of a line along the first axis. Returns true if there are any.
    fn line(&self, x: &mut [f64; D], line: &mut Sums) -> bool {
        let mut is_inside = |place: &Place| {
            x[0] = place.x;
            self.region.contains(x)
        };
        let places = &self.places[0];
        // A convex region contains all pieces between its ends.
        let ends = [places.first(), places.last()];
        if self.region.is_convex() && ends.into_iter().flatten().all(&mut is_inside) {
            line.clone_from(&self.whole_line);
            return true;
        }
        let one = [vec![1.0], vec![1.0]];
        let mut any = false;
        for place in places.iter().filter(|place| is_inside(place)) {
            place.spread(&one, line);
            any = true;
        }
        any
    }
}
