//! What particles are colored by: the numbers, their range, and the colors.

use eframe::egui::Color32;
use lahar::{Field, Snapshot};
use lahar_io::image::{Color, PRESSURE_RAMP, REST_RAMP, SPEED_RAMP, along, body_color};

use crate::scenes::{MaterialKind, SceneInfo, Swatch};

/// Behind everything (Taichi's examples: 0x112F41).
pub const BACKGROUND: Color32 = Color32::from_rgb(0x11, 0x2f, 0x41);
/// Water (Taichi's examples: 0x068587).
pub const LIQUID: Color32 = Color32::from_rgb(0x06, 0x85, 0x87);
/// Elastic bodies (Taichi's examples: 0xED553B).
pub const JELLY: Color32 = Color32::from_rgb(0xed, 0x55, 0x3b);
/// Snow (Taichi's examples: 0xEEEEF0).
pub const SNOW: Color32 = Color32::from_rgb(0xee, 0xee, 0xf0);

/// What particles are colored by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// What they are made of.
    #[default]
    Material,
    /// Which body they belong to.
    Body,
    /// |v| \[m/s\].
    Speed,
    /// −tr σ/d \[Pa\].
    Pressure,
    /// m/(J V⁰) \[kg/m³\].
    Density,
    /// J = V/V⁰.
    Jacobian,
}

impl ColorBy {
    /// All, in the order of the key C.
    pub const ALL: [Self; 6] = [
        Self::Material,
        Self::Body,
        Self::Speed,
        Self::Pressure,
        Self::Density,
        Self::Jacobian,
    ];

    /// The next one.
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|&by| by == self).unwrap_or(0);
        Self::ALL[(at + 1) % Self::ALL.len()]
    }

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::Body => "body",
            Self::Speed => "speed",
            Self::Pressure => "pressure",
            Self::Density => "density",
            Self::Jacobian => "volume ratio J",
        }
    }

    /// Unit of its numbers, in `dimension` dimensions.
    pub fn unit(self, dimension: usize) -> &'static str {
        match (self, dimension) {
            (Self::Material | Self::Body | Self::Jacobian, _) => "",
            (Self::Speed, _) => "m/s",
            (Self::Pressure, _) => "Pa",
            (Self::Density, 2) => "kg/m²",
            (Self::Density, _) => "kg/m³",
        }
    }

    /// Fields that it needs of a snapshot.
    pub fn fields(self) -> Vec<Field> {
        match self {
            Self::Material | Self::Body => vec![],
            Self::Speed => vec![Field::Velocity],
            Self::Pressure => vec![Field::Pressure],
            Self::Density => vec![Field::Mass, Field::Jacobian],
            Self::Jacobian => vec![Field::Jacobian],
        }
    }

    /// One number a particle; `None` where colors are not of numbers, and while the snapshot has not
    /// got the fields.
    pub fn values(self, snapshot: &Snapshot) -> Option<Vec<f32>> {
        let get = |field| snapshot.get(field).map(lahar::Data::to_f32);
        match self {
            Self::Material | Self::Body => None,
            Self::Speed => Some(
                get(Field::Velocity)?
                    .chunks_exact(snapshot.dimension)
                    .map(|v| v.iter().map(|c| c * c).sum::<f32>().sqrt())
                    .collect(),
            ),
            Self::Pressure => get(Field::Pressure),
            Self::Density => {
                let (m, v, j) = (
                    get(Field::Mass)?,
                    get(Field::Volume0)?,
                    get(Field::Jacobian)?,
                );
                let density = |((m, v), j): ((&f32, &f32), &f32)| m / (v * j);
                Some(m.iter().zip(&v).zip(&j).map(density).collect())
            }
            Self::Jacobian => get(Field::Jacobian),
        }
    }

    /// The colors of its range, low to high, evenly spaced.
    pub fn ramp(self) -> &'static [Color] {
        match self {
            Self::Material | Self::Body => &[],
            Self::Speed => &SPEED_RAMP,
            Self::Pressure => &PRESSURE_RAMP,
            Self::Density | Self::Jacobian => &REST_RAMP,
        }
    }

    /// The color at `at` in 0..=1 of that range.
    pub fn along(self, at: f32) -> Color32 {
        let [r, g, b] = along(self.ramp(), at);
        Color32::from_rgb(r, g, b)
    }

    /// The range of a sample of values worth telling apart.
    fn range_of(self, mut sample: Vec<f32>) -> Option<(f32, f32)> {
        if sample.is_empty() {
            return None;
        }
        sample.sort_by(f32::total_cmp);
        let quantile = |q: f32| sample[((sample.len() - 1) as f32 * q).round() as usize];
        let (low, high) = (quantile(0.01), quantile(0.99));
        Some(match self {
            Self::Material | Self::Body => (0.0, 1.0),
            Self::Speed => (0.0, high),
            Self::Pressure => (if -low < 1e-3 * high { 0.0 } else { low }, high),
            // Symmetric about rest, which is what most particles are near.
            Self::Density => around(quantile(0.5), low, high),
            Self::Jacobian => around(1.0, low, high),
        })
    }
}

/// Particles looked at to find a range.
const SAMPLE: usize = 4096;

fn around(center: f32, low: f32, high: f32) -> (f32, f32) {
    let reach = (center - low).max(high - center).max(center.abs() * 1e-3);
    (center - reach, center + reach)
}

/// Low and high end of a legend; follows the numbers without flicker.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    /// What this is the range of.
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

    /// The ends; (0, 1) before there is anything.
    pub fn ends(&self) -> (f32, f32) {
        self.ends.unwrap_or((0.0, 1.0))
    }

    /// Takes in new numbers, those of all sides: widens at once, narrows slowly.
    pub fn follow(&mut self, by: ColorBy, sides: impl IntoIterator<Item = Vec<f32>>) {
        const NARROW: f32 = 0.03;
        if self.by != by {
            *self = Self { by, ends: None };
        }
        let mut sample = vec![];
        for values in sides {
            // A sample is enough, and outliers should not flatten the rest.
            let every = values.len().div_ceil(SAMPLE).max(1);
            let some = values.into_iter().step_by(every);
            sample.extend(some.filter(|value| value.is_finite()));
        }
        let Some((low, high)) = by.range_of(sample) else {
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

    /// Forgets all numbers.
    pub fn forget(&mut self) {
        self.ends = None;
    }
}

/// What is behind a scene at first.
pub(crate) fn background(info: &SceneInfo) -> Color32 {
    (info.angle.background).map_or(BACKGROUND, |[r, g, b]| Color32::from_rgb(r, g, b))
}

/// Colors of the swatches at first; the person at the window may change them.
pub fn palette(swatches: &[Swatch]) -> Vec<Color32> {
    /// For the second of a look, and for what has none.
    const OTHERS: [Color32; 6] = [
        Color32::from_rgb(0xe9, 0xb4, 0x4c),
        Color32::from_rgb(0x8e, 0x7d, 0xbe),
        Color32::from_rgb(0x6f, 0xb2, 0x6b),
        Color32::from_rgb(0xd4, 0x7f, 0xa6),
        Color32::from_rgb(0x5b, 0xa4, 0xe6),
        Color32::from_rgb(0xb0, 0x8d, 0x6e),
    ];
    let mut used: Vec<MaterialKind> = vec![];
    let mut others = OTHERS.iter().cycle().copied();
    swatches
        .iter()
        .map(|swatch| {
            if let Some([r, g, b]) = swatch.color {
                return Color32::from_rgb(r, g, b);
            }
            let first = !used.contains(&swatch.look);
            used.push(swatch.look);
            let own = match swatch.look {
                MaterialKind::Liquid => Some(LIQUID),
                MaterialKind::Jelly => Some(JELLY),
                MaterialKind::Snow => Some(SNOW),
                MaterialKind::Dust | MaterialKind::Other => None,
            };
            own.filter(|_| first)
                .or_else(|| others.next())
                .unwrap_or(Color32::GRAY)
        })
        .collect()
}

/// One color a particle.
pub fn colors(
    by: ColorBy,
    snapshot: &Snapshot,
    info: &SceneInfo,
    palette: &[Color32],
    range: &Range,
) -> Vec<[u8; 4]> {
    if let Some(values) = by.values(snapshot) {
        let (low, high) = range.ends();
        // 256 steps are as fine as the screen shows, and cheaper than a blend a particle.
        let steps: Vec<_> = (0..256)
            .map(|i| by.along(i as f32 / 255.0).to_array())
            .collect();
        let not_a_number = by.along(f32::NAN).to_array();
        return values
            .iter()
            .map(|v| {
                let at = (v - low) / (high - low);
                if at.is_finite() {
                    steps[(at.clamp(0.0, 1.0) * 255.0) as usize]
                } else {
                    not_a_number
                }
            })
            .collect();
    }
    let bodies = snapshot.get(Field::Body);
    if by == ColorBy::Body {
        let opaque = |[r, g, b]: Color| [r, g, b, 255];
        let of_body = |body: usize| match info.bodies.get(body) {
            Some((_, color)) => opaque(*color),
            None => opaque(body_color(body)),
        };
        return match bodies {
            Some(lahar::Data::U32(bodies)) => bodies.iter().map(|&b| of_body(b as usize)).collect(),
            _ => vec![of_body(0); snapshot.count],
        };
    }
    let first = palette.first().copied().unwrap_or(LIQUID).to_array();
    let of_body: Vec<[u8; 4]> = info
        .body_swatches
        .iter()
        .map(|&swatch| palette.get(swatch).map_or(first, Color32::to_array))
        .collect();
    match bodies {
        Some(lahar::Data::U32(bodies)) => bodies
            .iter()
            .map(|&body| of_body.get(body as usize).copied().unwrap_or(first))
            .collect(),
        _ => vec![first; snapshot.count],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn c_goes_round_all_of_them() {
        let mut by = ColorBy::Material;
        for _ in ColorBy::ALL {
            by = by.next();
        }
        assert_eq!(by, ColorBy::Material);
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

    #[test]
    fn the_lineage_colors_are_theirs_and_a_second_liquid_has_its_own() {
        let swatch = |look| Swatch {
            name: String::new(),
            look,
            color: None,
        };
        let palette = palette(
            &[
                MaterialKind::Liquid,
                MaterialKind::Jelly,
                MaterialKind::Snow,
                MaterialKind::Liquid,
            ]
            .map(swatch),
        );
        assert_eq!(palette[..3], [LIQUID, JELLY, SNOW]);
        assert!(!palette[..3].contains(&palette[3]));
    }
}
