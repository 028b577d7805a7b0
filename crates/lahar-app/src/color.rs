//! The quantities that particles are colored by: their values, their range in the legend, and their color ramps.

use eframe::egui::Color32;
use lahar::{Data, Field, Snapshot};
use lahar_io::image::{self, Color, PRESSURE_RAMP, REST_RAMP, SPEED_RAMP};
use lahar_scene::scene::ColorBy;

/// The quantities in the order in which the key C goes through them.
pub const ORDER: [ColorBy; 6] = [
    ColorBy::Material,
    ColorBy::Body,
    ColorBy::Speed,
    ColorBy::Pressure,
    ColorBy::Density,
    ColorBy::Jacobian,
];

/// The quantity after this one in [`ORDER`].
pub fn next(by: ColorBy) -> ColorBy {
    let at = ORDER.iter().position(|&other| other == by).unwrap_or(0);
    ORDER[(at + 1) % ORDER.len()]
}

/// The name of a quantity in panel and legend.
pub fn name(by: ColorBy) -> &'static str {
    match by {
        ColorBy::Material => "material",
        ColorBy::Body => "body",
        ColorBy::Speed => "speed",
        ColorBy::Pressure => "pressure",
        ColorBy::Density => "density",
        ColorBy::Jacobian => "volume ratio J",
    }
}

/// The unit of a quantity in `dimension` dimensions; empty if it has none.
pub fn unit(by: ColorBy, dimension: usize) -> &'static str {
    match (by, dimension) {
        (ColorBy::Material | ColorBy::Body | ColorBy::Jacobian, _) => "",
        (ColorBy::Speed, _) => "m/s",
        (ColorBy::Pressure, _) => "Pa",
        (ColorBy::Density, 2) => "kg/m²",
        (ColorBy::Density, _) => "kg/m³",
    }
}

/// The fields of a snapshot that a quantity is computed from.
pub fn fields(by: ColorBy) -> Vec<Field> {
    match by {
        ColorBy::Material | ColorBy::Body => vec![],
        ColorBy::Speed => vec![Field::Velocity],
        ColorBy::Pressure => vec![Field::Pressure],
        ColorBy::Density => vec![Field::Mass, Field::Jacobian],
        ColorBy::Jacobian => vec![Field::Jacobian],
    }
}

/// The value of each particle, in the quantity's unit. Returns `None` for materials and bodies, which have no values, and
/// while the snapshot lacks the [`fields`].
pub fn values(by: ColorBy, snapshot: &Snapshot) -> Option<Vec<f32>> {
    let get = |field| snapshot.get(field).map(Data::to_f32);
    match by {
        ColorBy::Material | ColorBy::Body => None,
        ColorBy::Speed => Some(
            get(Field::Velocity)?
                .chunks_exact(snapshot.dimension)
                .map(|v| v.iter().map(|c| c * c).sum::<f32>().sqrt())
                .collect(),
        ),
        ColorBy::Pressure => get(Field::Pressure),
        ColorBy::Density => {
            let mass = get(Field::Mass)?;
            let volume0 = get(Field::Volume0)?;
            let jacobian = get(Field::Jacobian)?;
            let density = |((m, v), j): ((&f32, &f32), &f32)| m / (v * j);
            Some(
                mass.iter()
                    .zip(&volume0)
                    .zip(&jacobian)
                    .map(density)
                    .collect(),
            )
        }
        ColorBy::Jacobian => get(Field::Jacobian),
    }
}

/// The colors of a quantity's range, from low to high, evenly spaced.
fn ramp(by: ColorBy) -> &'static [Color] {
    match by {
        ColorBy::Material | ColorBy::Body => &[],
        ColorBy::Speed => &SPEED_RAMP,
        ColorBy::Pressure => &PRESSURE_RAMP,
        ColorBy::Density | ColorBy::Jacobian => &REST_RAMP,
    }
}

/// The color at `at` (0..=1) of a quantity's range.
pub fn along(by: ColorBy, at: f32) -> Color32 {
    let [r, g, b] = image::along(ramp(by), at);
    Color32::from_rgb(r, g, b)
}

/// The largest number of particles per side that a range is found from.
const SAMPLE: usize = 4096;

/// The range of a sample of values that the legend shows.
fn range_of(by: ColorBy, mut sample: Vec<f32>) -> Option<(f32, f32)> {
    if sample.is_empty() {
        return None;
    }
    sample.sort_by(f32::total_cmp);
    let quantile = |q: f32| sample[((sample.len() - 1) as f32 * q).round() as usize];
    let (low, high) = (quantile(0.01), quantile(0.99));
    Some(match by {
        ColorBy::Material | ColorBy::Body => (0.0, 1.0),
        ColorBy::Speed => (0.0, high),
        ColorBy::Pressure => (if -low < 1e-3 * high { 0.0 } else { low }, high),
        // The range is symmetric about rest, where most particles are.
        ColorBy::Density => symmetric_about(quantile(0.5), low, high),
        ColorBy::Jacobian => symmetric_about(1.0, low, high),
    })
}

fn symmetric_about(center: f32, low: f32, high: f32) -> (f32, f32) {
    let reach = (center - low).max(high - center).max(center.abs() * 1e-3);
    (center - reach, center + reach)
}

/// The low and the high end of a legend. They follow the values without flicker.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    /// The quantity of this range.
    by: ColorBy,
    ends: Option<(f32, f32)>,
}

impl Range {
    /// The range of `by` from the first of `ends` to the second.
    pub fn of(by: ColorBy, ends: (f32, f32)) -> Self {
        Self {
            by,
            ends: Some(ends),
        }
    }

    /// The ends of the range; (0, 1) before there are values.
    pub fn ends(&self) -> (f32, f32) {
        self.ends.unwrap_or((0.0, 1.0))
    }

    /// Follows new values of all sides: widens at once, and narrows slowly.
    pub fn follow(&mut self, by: ColorBy, sides: impl IntoIterator<Item = Vec<f32>>) {
        const NARROW: f32 = 0.03;
        if self.by != by {
            *self = Self { by, ends: None };
        }
        let mut sample = vec![];
        for values in sides {
            let every = values.len().div_ceil(SAMPLE).max(1);
            let some = values.into_iter().step_by(every);
            sample.extend(some.filter(|value| value.is_finite()));
        }
        let Some((low, high)) = range_of(by, sample) else {
            return;
        };
        let (low, high) = match self.ends {
            None => (low, high),
            Some((old_low, old_high)) => (
                low.min(old_low + (low - old_low) * NARROW),
                high.max(old_high + (high - old_high) * NARROW),
            ),
        };
        self.ends = Some((low, high.max(low + f32::MIN_POSITIVE)));
    }

    /// Forgets all values.
    pub fn forget(&mut self) {
        self.ends = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_c_goes_through_all_quantities_and_back() {
        let mut by = ColorBy::Material;
        for _ in ORDER {
            by = next(by);
        }
        assert_eq!(by, ColorBy::Material);
        assert!(ColorBy::ALL.iter().all(|by| ORDER.contains(by)));
    }

    #[test]
    fn a_range_widens_at_once_and_narrows_slowly() {
        let mut range = Range::default();
        range.follow(ColorBy::Speed, [vec![0.0, 1.0]]);
        assert_eq!(range.ends(), (0.0, 1.0));
        range.follow(ColorBy::Speed, [vec![0.0, 1.0], vec![5.0]]);
        assert_eq!(range.ends(), (0.0, 5.0));
        range.follow(ColorBy::Speed, [vec![0.0, 1.0]]);
        assert!(range.ends().1 > 4.0 && range.ends().1 < 5.0);
        range.follow(ColorBy::Jacobian, [vec![0.9, 1.05]]);
        assert!((range.ends().0 - 0.9).abs() < 1e-6 && (range.ends().1 - 1.1).abs() < 1e-6);
    }
}
