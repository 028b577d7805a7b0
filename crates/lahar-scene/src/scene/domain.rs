//! Reads the domain: its walls, and the boxes that keep particles in.

use super::choices::{self, WALL_STYLES};
use super::contact::opt_contact;
use super::read::Reader;
use crate::error::SceneError;
use crate::text::{AXES, count_words, tidy};
use lahar::geometry::Bounds;
use lahar::{Contact, Cushion, Domain, Sides, WallStyle};

/// Cells along an axis at most: block coordinates are 32-bit numbers.
const LARGEST_CELL_COUNT: f64 = 1e9;

/// Names of the sides, by axis.
const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];

/// Reads the table `[domain]`.
pub(super) fn read_domain<const D: usize>(
    scene: &Reader<'_>,
    table: &Reader<'_>,
    dx: f64,
) -> Result<Domain<D>, SceneError> {
    let Bounds { min, max } = read_box(table, "the domain")?;
    let length: [f64; D] = core::array::from_fn(|i| max[i] - min[i]);
    if let Some(i) = (0..D).find(|&i| length[i] / dx > LARGEST_CELL_COUNT) {
        let cells = count_words(length[i] / dx);
        let message = format!("the domain would have {cells} cells along {}", AXES[i]);
        return Err(scene
            .error_at("dx", message)
            .hint("use a larger dx or a smaller domain"));
    }
    if let Some(i) = (0..D).find(|&i| !is_whole(length[i] / dx)) {
        return Err(no_whole_number_of_cells(scene, &min, &length, i, dx));
    }
    let (sides, style) = read_walls(table)?;
    Ok(Domain {
        min,
        max,
        sides,
        style,
    })
}

/// Returns the error of a domain that is no whole number of cells along `axis`.
fn no_whole_number_of_cells(
    scene: &Reader<'_>,
    min: &[f64],
    length: &[f64],
    axis: usize,
    dx: f64,
) -> SceneError {
    let cells = length[axis] / dx;
    let error = scene.error_at("dx", format!("the domain is {} m along {}, which is {cells:.4} cells of dx = {dx}; it must be a whole number", tidy(length[axis]), AXES[axis]));
    match fitting_dx(length, dx, |_| true) {
        Some(fit) => {
            let round = fitting_dx(length, dx, |fit| tidy(fit * 1e4).fract() == 0.0)
                .filter(|round| *round != fit)
                .map(|round| format!("; a round one is {round}"));
            error.hint(format!(
                "the nearest dx that fits is {fit}{}",
                round.unwrap_or_default()
            ))
        }
        None => {
            let whole = tidy(min[axis] + (cells.round().max(1.0)) * dx);
            error.hint(format!(
                "change dx, or the domain: max = {whole} along {} would fit",
                AXES[axis]
            ))
        }
    }
}

/// Reads a box from the keys `min` and `max`; messages call it `name`.
fn read_box<const D: usize>(table: &Reader<'_>, name: &str) -> Result<Bounds<D>, SceneError> {
    let (min, max): ([f64; D], [f64; D]) = (table.vector("min")?, table.vector("max")?);
    match (0..D).find(|&i| !(max[i] > min[i])) {
        None => Ok(Bounds { min, max }),
        Some(i) => {
            let message = format!(
                "{name} has no extent along {}: max {} is not above min {}",
                AXES[i], max[i], min[i]
            );
            Err(table.error_at("max", message))
        }
    }
}

/// Reads the box on whose sides particles are put back.
pub(super) fn read_clamp<const D: usize>(
    domain: &Reader<'_>,
) -> Result<Option<Bounds<D>>, SceneError> {
    let clamp = domain.opt_table("clamp");
    clamp.map(|table| read_box(&table, "this box")).transpose()
}

/// Reads the box that particles slow down to stay in.
pub(super) fn read_cushion<const D: usize>(
    domain: &Reader<'_>,
) -> Result<Option<Cushion<D>>, SceneError> {
    let cushion = domain.opt_table("cushion").map(|table| {
        Ok(Cushion {
            inside: read_box(&table, "this box")?,
            time: table.number("time")?,
        })
    });
    cushion.transpose()
}

/// Returns true if a side is a whole number of cells, but for the rounding of decimal fractions.
fn is_whole(cells: f64) -> bool {
    cells > 0.5 && (cells - cells.round()).abs() <= 1e-6 * cells.max(1.0)
}

/// Returns the `wanted` number nearest to `dx` of which every side is a whole multiple.
fn fitting_dx(sides: &[f64], dx: f64, wanted: impl Fn(f64) -> bool) -> Option<f64> {
    let cells = (sides[0] / dx).round().max(1.0);
    let fits = |n: f64| {
        let fit = tidy(sides[0]) / n;
        (n >= 1.0 && wanted(fit) && sides.iter().all(|side| is_whole(side / fit))).then_some(fit)
    };
    let nearer = |a: f64, b: f64| {
        if (a - dx).abs() <= (b - dx).abs() {
            a
        } else {
            b
        }
    };
    let reach = (cells as u32).clamp(8, 10_000);
    let below = (0..reach).find_map(|k| fits(cells + f64::from(k)));
    let above = (1..reach).find_map(|k| fits(cells - f64::from(k)));
    match (below, above) {
        (Some(a), Some(b)) => Some(nearer(a, b)),
        (a, b) => a.or(b),
    }
}

/// Reads the key `walls`: a word for all sides, or a table by side.
fn read_walls<const D: usize>(domain: &Reader<'_>) -> Result<([Sides; D], WallStyle), SceneError> {
    let Some(walls) = domain.opt_table("walls") else {
        let contact = domain.choice("walls", &choices::SIDES)?;
        let sides = contact.map_or(Sides::Periodic, |contact| Sides::Walls {
            low: contact,
            high: contact,
        });
        return Ok(([sides; D], WallStyle::Plane));
    };
    let other = opt_contact(&walls, "contact")?.unwrap_or(Contact::Separate { friction: 0.0 });
    let mut sides = [Sides::Periodic; D];
    for i in 0..D {
        let [low, high] = SIDES[i];
        if !walls.has(AXES[i]) {
            sides[i] = Sides::Walls {
                low: opt_contact(&walls, low)?.unwrap_or(other),
                high: opt_contact(&walls, high)?.unwrap_or(other),
            };
        } else if let Some(side) = [low, high].into_iter().find(|side| walls.has(side)) {
            return Err(walls.error_at_key(
                side,
                format!("there is no wall at the {side}: {} is periodic", AXES[i]),
            ));
        }
    }
    let given = walls.opt_integer("padding");
    let mut style = walls.choice("style", &WALL_STYLES)?;
    match (&mut style, given) {
        (WallStyle::Nodes { padding }, Some(given)) => *padding = given as u32,
        (WallStyle::Plane, Some(_)) => {
            return Err(walls.error_at_key("padding", "\"padding\" is for style = \"nodes\" only"));
        }
        (_, None) => {}
    }
    Ok((sides, style))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_dx_that_fits() {
        assert_eq!(fitting_dx(&[4.0, 2.0], 0.03, |_| true), Some(4.0 / 134.0));
        assert_eq!(fitting_dx(&[1.0, 0.75], 0.26, |_| true), Some(0.25));
        assert_eq!(
            fitting_dx(&[1.0, core::f64::consts::SQRT_2], 0.01, |_| true),
            None
        );
        assert!(
            is_whole(4.0 / 0.02) && is_whole(0.3 / 0.1) && !is_whole(4.0 / 0.03) && !is_whole(0.01)
        );
    }
}
