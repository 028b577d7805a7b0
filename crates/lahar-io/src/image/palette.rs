//! Colors of materials, bodies and scales, and the conversion between sRGB and linear light. Fluids, jelly and snow have
//! the colors of the Taichi examples; the others match them.

use lahar_scene::scene::Look;

/// A color: red, green and blue in sRGB.
pub type Color = [u8; 3];

const fn hex(rgb: u32) -> Color {
    [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8]
}

/// Color of the background.
pub const BACKGROUND: Color = hex(0x11_2F41);

/// Colors of fluids. The second fluid has the second color, and so on.
const FLUIDS: [Color; 4] = [
    hex(0x06_8587),
    hex(0x3F_7FD6),
    hex(0xD9_9A2B),
    hex(0x8A_5A44),
];
/// Colors of elastic solids.
const SOLIDS: [Color; 4] = [
    hex(0xED_553B),
    hex(0xF2_B134),
    hex(0x9B_5DE5),
    hex(0x5B_C26A),
];
/// Colors of snow, grains and dust.
const GRAINS: [Color; 3] = [hex(0xEE_EEF0), hex(0xD8_B982), hex(0xA9_8467)];

/// Color of colliders that have none of their own.
pub const COLLIDER: Color = hex(0x8A_98_A3);

/// Colors of bodies by number.
const BODIES: [Color; 8] = [
    hex(0x06_8587),
    hex(0xED_553B),
    hex(0xEE_EEF0),
    hex(0xF2_B134),
    hex(0x3F_7FD6),
    hex(0x9B_5DE5),
    hex(0x5B_C26A),
    hex(0xD9_7AA6),
];

/// Returns the color of the body with this number, for bodies that have none of their own.
pub fn body_color(number: usize) -> Color {
    BODIES[number % BODIES.len()]
}

/// Returns one color per material, given the names of their models: water is teal, jelly red, snow white.
///
/// ```
/// use lahar_io::image::model_colors;
///
/// let colors = model_colors(&["fluid", "snow", "fluid"]);
/// assert_ne!(colors[0], colors[2], "two fluids can be told apart");
/// ```
pub fn model_colors(models: &[&str]) -> Vec<Color> {
    let mut seen = [0_usize; 3];
    models
        .iter()
        .map(|model| {
            let (kind, colors): (usize, &[Color]) = match Look::of_model(model) {
                Some(Look::Liquid) => (0, &FLUIDS),
                // A run of a later version may name a model that is not known here.
                Some(Look::Solid) | None => (1, &SOLIDS),
                Some(Look::Dust | Look::Snow) => (2, &GRAINS),
            };
            let nth = seen[kind];
            seen[kind] += 1;
            colors[nth % colors.len()]
        })
        .collect()
}

/// Returns the color of fast material: lighter, towards white.
pub(super) fn bright(color: Color) -> Color {
    // White turns towards a cold blue, so that fast and slow white can be told apart.
    let towards: Color = if color.iter().all(|&c| c > 0xD0) {
        [0xA8, 0xD4, 0xF0]
    } else {
        [0xD8, 0xFF, 0xFA]
    };
    core::array::from_fn(|i| ((f32::from(color[i]) * 0.35) + f32::from(towards[i]) * 0.65) as u8)
}

/// Mixes a color with white; `part` is the share of white.
pub(super) fn lighter(color: Color, part: f32) -> Color {
    color.map(|c| (f32::from(c) + (255.0 - f32::from(c)) * part) as u8)
}

/// Colors from slow to fast.
pub const SPEED_RAMP: [Color; 5] = [
    hex(0x0D_5C86),
    hex(0x0D_979B),
    hex(0x7F_D09C),
    hex(0xF5_E38B),
    hex(0xFF_FFFF),
];

/// Colors from low pressure to high.
pub const PRESSURE_RAMP: [Color; 5] = [
    hex(0x3B_3A8C),
    hex(0x8A_44A6),
    hex(0xDB_4D6D),
    hex(0xF9_964D),
    hex(0xFC_F3A8),
];

/// Colors of J and of density: below the value at rest, at rest, above it.
pub const REST_RAMP: [Color; 3] = [hex(0x3D_86E0), hex(0xE4_E8EA), hex(0xED_553B)];

/// A color that cannot be overlooked, for values that are not numbers.
const NOT_A_NUMBER: Color = hex(0xFF_00FF);

/// Returns the color at `at` (0 to 1) along evenly spaced ones.
pub fn along(ramp: &[Color], at: f32) -> Color {
    let Some(last) = ramp.len().checked_sub(1) else {
        return NOT_A_NUMBER;
    };
    if !at.is_finite() {
        return NOT_A_NUMBER;
    }
    let place = at.clamp(0.0, 1.0) * last as f32;
    let low = (place as usize).min(last.saturating_sub(1));
    let (a, b) = (ramp[low], ramp[(low + 1).min(last)]);
    let part = place - low as f32;
    core::array::from_fn(|i| {
        let (a, b) = (f32::from(a[i]), f32::from(b[i]));
        (a + (b - a) * part).round() as u8
    })
}

/// Converts an sRGB color to linear light (0 to 1).
pub(super) fn linear(color: Color) -> [f32; 3] {
    color.map(|c| {
        let c = f32::from(c) / 255.0;
        if c <= 0.040_45 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// Converts linear light to sRGB by a table, which is fine enough to give each of the 256 levels.
pub(super) struct ToScreen(Vec<u8>);

impl ToScreen {
    const STEPS: usize = 1 << 13;

    pub(super) fn new() -> Self {
        Self(
            (0..=Self::STEPS)
                .map(|i| {
                    let c = i as f32 / Self::STEPS as f32;
                    let s = if c <= 0.003_130_8 {
                        12.92 * c
                    } else {
                        1.055 * c.powf(1.0 / 2.4) - 0.055
                    };
                    (s * 255.0).round() as u8
                })
                .collect(),
        )
    }

    pub(super) fn color(&self, light: [f32; 3]) -> Color {
        light.map(|c| self.0[(c.clamp(0.0, 1.0) * Self::STEPS as f32 + 0.5) as usize])
    }
}

/// Mixes two colors in linear light: `a` for part 0, `b` for part 1.
pub(super) fn mix(a: [f32; 3], b: [f32; 3], part: f32) -> [f32; 3] {
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_color_survives_the_way_through_light() {
        let screen = ToScreen::new();
        for c in 0..=255 {
            assert_eq!(screen.color(linear([c; 3])), [c; 3]);
        }
    }

    #[test]
    fn materials_of_a_kind_differ() {
        let colors = model_colors(&["fluid", "corotated", "fluid", "snow"]);
        assert_eq!(colors[0], hex(0x06_8587));
        assert_eq!(colors[1], hex(0xED_553B));
        assert_ne!(colors[0], colors[2]);
        assert_eq!(colors[3], hex(0xEE_EEF0));
    }

    #[test]
    fn a_ramp_begins_and_ends_with_its_ends() {
        assert_eq!(along(&SPEED_RAMP, 0.0), SPEED_RAMP[0]);
        assert_eq!(along(&SPEED_RAMP, 7.0), SPEED_RAMP[4]);
        assert_eq!(along(&REST_RAMP, 0.5), REST_RAMP[1]);
        assert_eq!(along(&REST_RAMP[..1], 0.5), REST_RAMP[0]);
        assert_eq!(along(&PRESSURE_RAMP, f32::NAN), NOT_A_NUMBER);
    }
}
