//! Positions of the particles of a body at the start. The same seed gives the same positions on every
//! machine.

use super::Region;

/// The rule by which positions are chosen.
///
/// ```
/// use lahar::geometry::sampling::{Random, Sampling, sample};
/// use lahar::geometry::{Bounds, Region, Shape};
///
/// let block = Shape::Box { min: [0.0, 0.0], max: [1.0, 0.5] };
/// let region = Region::new(block, Bounds::EVERYTHING);
/// let positions = sample(&region, 0.1, None, Sampling::Lattice, &mut Random::new(0, 0));
/// assert_eq!(positions.len(), 50);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// The centers of the cells of a lattice, which is fitted to the bounds of the shape.
    Lattice,
    /// One random point in each cell of that lattice.
    #[default]
    Jittered,
    /// Points drawn at random.
    Random,
    /// Random points that keep a distance from each other (dart throwing). The distance shrinks until the
    /// number of points is reached.
    Poisson,
}

impl Sampling {
    /// All of the rules.
    pub const ALL: [Self; 4] = [Self::Lattice, Self::Jittered, Self::Random, Self::Poisson];

    /// Returns the word for the rule in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lattice => "lattice",
            Self::Jittered => "jittered",
            Self::Random => "random",
            Self::Poisson => "poisson",
        }
    }
}

/// A stream of random numbers (SplitMix64).
///
/// ```
/// use lahar::geometry::sampling::Random;
///
/// let number = Random::new(7, 0).unit();
/// assert!((0.0..1.0).contains(&number));
/// assert_eq!(number, Random::new(7, 0).unit());
/// ```
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Starts stream number `stream` of `seed`. Different streams are independent of each other.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = Self(seed ^ 0x6c61_6861_7200_0000);
        let first = random.next();
        Self(first ^ stream.wrapping_mul(0xd134_2543_de82_ef95))
    }

    /// Returns the next 64 bits.
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number from 0, included, to 1, excluded.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }
}

/// Returns the number of positions that [`sample`] chooses for a mean distance of `spacing` \[m\]: exact
/// before rounding for random and Poisson sampling, an estimate for lattices.
pub fn expected_count<const D: usize>(region: &Region<D>, spacing: f64, sampling: Sampling) -> f64 {
    let cell: f64 = match sampling {
        Sampling::Random | Sampling::Poisson => spacing.powi(D as i32),
        // The lattice is fitted to the bounds.
        Sampling::Lattice | Sampling::Jittered => {
            let size = lattice_size(region, spacing);
            (0..D)
                .map(|i| region.bounds().side(i) / size[i] as f64)
                .product()
        }
    };
    region.volume() / cell
}

/// Chooses positions \[m\] in `region` that are `spacing` \[m\] apart on average. Random and Poisson
/// sampling choose `count` positions instead, if it is given.
pub fn sample<const D: usize>(
    region: &Region<D>,
    spacing: f64,
    count: Option<usize>,
    sampling: Sampling,
    random: &mut Random,
) -> Vec<[f64; D]> {
    if !(region.volume() > 0.0) {
        return Vec::new();
    }
    let count =
        count.unwrap_or_else(|| expected_count(region, spacing, Sampling::Random).round() as usize);
    match sampling {
        Sampling::Lattice => lattice(region, spacing, || 0.5),
        Sampling::Jittered => lattice(region, spacing, || random.unit()),
        Sampling::Random => (0..count).map_while(|_| anywhere(region, random)).collect(),
        Sampling::Poisson => poisson(region, count, random),
    }
}

/// Returns the number of lattice cells along each axis. A whole number of them fits the bounds.
pub fn lattice_size<const D: usize>(region: &Region<D>, spacing: f64) -> [usize; D] {
    core::array::from_fn(|i| ((region.bounds().side(i) / spacing).round() as usize).max(1))
}

/// Places one position per lattice cell, at `place()` of the cell's side along each axis.
fn lattice<const D: usize>(
    region: &Region<D>,
    spacing: f64,
    mut place: impl FnMut() -> f64,
) -> Vec<[f64; D]> {
    let bounds = region.bounds();
    let size = lattice_size(region, spacing);
    let mut positions = Vec::new();
    let mut cell = [0; D];
    loop {
        let p = core::array::from_fn(|i| {
            bounds.min[i] + bounds.side(i) * ((cell[i] as f64 + place()) / size[i] as f64)
        });
        if region.contains(&p) {
            positions.push(p);
        }
        // Count up to the next cell, the first axis fastest.
        let Some(axis) = (0..D).find(|&i| cell[i] + 1 < size[i]) else {
            return positions;
        };
        cell[axis] += 1;
        cell[..axis].fill(0);
    }
}

/// Draws after which [`anywhere`] gives up on a shape that fills almost nothing of its bounds.
const DRAWS: usize = 1_000_000;

/// Draws a random point of the region; `None` if it is not found.
fn anywhere<const D: usize>(region: &Region<D>, random: &mut Random) -> Option<[f64; D]> {
    let bounds = region.bounds();
    (0..DRAWS)
        .map(|_| core::array::from_fn(|i| bounds.min[i] + bounds.side(i) * random.unit()))
        .find(|p| region.contains(p))
}

/// Throws darts that must keep a distance from those before. The distance starts near the closest random
/// packing and shrinks after many misses in a row.
fn poisson<const D: usize>(region: &Region<D>, count: usize, random: &mut Random) -> Vec<[f64; D]> {
    /// The first distance, as a part of the mean spacing.
    const START: f64 = 0.85;
    /// Misses in a row after which the distance shrinks.
    const PATIENCE: usize = 60;
    /// The factor by which it shrinks.
    const SHRINK: f64 = 0.98;
    let bounds = region.bounds();
    let mut distance = START * (region.volume() / count.max(1) as f64).powf(1.0 / D as f64);
    let size: [usize; D] =
        core::array::from_fn(|i| ((bounds.side(i) / distance) as usize).clamp(1, 1 << 20));
    let cell_of = |p: &[f64; D]| -> [usize; D] {
        core::array::from_fn(|i| {
            (((p[i] - bounds.min[i]) / bounds.side(i) * size[i] as f64) as usize).min(size[i] - 1)
        })
    };
    let flat = |cell: [usize; D]| cell.iter().zip(size).rev().fold(0, |at, (c, n)| at * n + c);
    // The positions of each cell are a linked list. The cells are no smaller than the distance.
    const NONE: u32 = u32::MAX;
    let mut heads = vec![NONE; size.iter().product()];
    let mut next: Vec<u32> = Vec::with_capacity(count);
    let mut positions: Vec<[f64; D]> = Vec::with_capacity(count);
    let mut misses = 0;
    while positions.len() < count {
        let Some(p) = anywhere(region, random) else {
            return positions;
        };
        let cell = cell_of(&p);
        let close = (0..3_usize.pow(D as u32)).any(|neighbor| {
            let mut rest = neighbor;
            let mut other = [0; D];
            for i in 0..D {
                let at = cell[i] + rest % 3;
                rest /= 3;
                if at == 0 || at > size[i] {
                    return false;
                }
                other[i] = at - 1;
            }
            let mut at = heads[flat(other)];
            while at != NONE {
                let q = positions[at as usize];
                if (0..D).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>() < distance * distance {
                    return true;
                }
                at = next[at as usize];
            }
            false
        });
        if close {
            misses += 1;
            if misses == PATIENCE {
                misses = 0;
                distance *= SHRINK;
            }
        } else {
            misses = 0;
            let head = &mut heads[flat(cell)];
            next.push(*head);
            *head = positions.len() as u32;
            positions.push(p);
        }
    }
    positions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Bounds, Primitive, Shape};

    fn square() -> Region<2> {
        Region::new(
            Shape::Box {
                min: [0.1, 0.2],
                max: [1.1, 0.7],
            },
            Bounds::EVERYTHING,
        )
    }

    #[test]
    fn counts_are_as_expected_and_positions_inside() {
        for sampling in Sampling::ALL {
            let positions = sample(&square(), 0.01, None, sampling, &mut Random::new(1, 0));
            assert_eq!(positions.len(), 5000, "{sampling:?}");
            assert!(
                positions.iter().all(|p| square().contains(p)),
                "{sampling:?}"
            );
            let ball = Region::new(
                Shape::from(Primitive::Ball {
                    center: [0.0; 3],
                    radius: 0.5,
                }),
                Bounds::EVERYTHING,
            );
            let positions = sample(&ball, 0.05, None, sampling, &mut Random::new(1, 0));
            let expected = expected_count(&ball, 0.05, sampling);
            assert!(
                (positions.len() as f64 - expected).abs() < 0.02 * expected,
                "{sampling:?}: {} of {expected}",
                positions.len()
            );
            assert!(positions.iter().all(|p| ball.contains(p)), "{sampling:?}");
        }
    }

    #[test]
    fn same_seed_same_positions() {
        for sampling in Sampling::ALL {
            let draw = |seed, stream| {
                sample(
                    &square(),
                    0.03,
                    None,
                    sampling,
                    &mut Random::new(seed, stream),
                )
            };
            assert_eq!(draw(7, 0), draw(7, 0));
            if sampling != Sampling::Lattice {
                assert_ne!(draw(7, 0), draw(8, 0));
                assert_ne!(draw(7, 0), draw(7, 1));
            }
        }
    }

    #[test]
    fn poisson_keeps_its_distance() {
        let positions = sample(
            &square(),
            0.02,
            None,
            Sampling::Poisson,
            &mut Random::new(3, 0),
        );
        let mut least = f64::INFINITY;
        for (i, p) in positions.iter().enumerate() {
            for q in &positions[..i] {
                least = least.min((p[0] - q[0]).hypot(p[1] - q[1]));
            }
        }
        assert!(least > 0.6 * 0.02, "{least}");
    }

    #[test]
    fn count_is_kept_when_given() {
        for sampling in [Sampling::Random, Sampling::Poisson] {
            assert_eq!(
                sample(&square(), 1.0, Some(777), sampling, &mut Random::new(0, 0)).len(),
                777
            );
        }
    }
}
