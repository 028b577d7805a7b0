//! The colors of a scene's materials and bodies, and the color of each particle.

use eframe::egui::Color32;
use lahar::{Data, Field, Snapshot};
use lahar_io::image::{Color, body_color};
use lahar_scene::scene::{ColorBy, Look};

use crate::color::{self, Range};
use crate::scenes::{SceneInfo, Swatch};

/// The usual background (Taichi's examples: 0x112F41).
pub const BACKGROUND: Color32 = Color32::from_rgb(0x11, 0x2f, 0x41);
/// The color of water (Taichi's examples: 0x068587).
pub const LIQUID: Color32 = Color32::from_rgb(0x06, 0x85, 0x87);
/// The color of elastic bodies (Taichi's examples: 0xED553B).
pub const JELLY: Color32 = Color32::from_rgb(0xed, 0x55, 0x3b);
/// The color of snow (Taichi's examples: 0xEEEEF0).
pub const SNOW: Color32 = Color32::from_rgb(0xee, 0xee, 0xf0);

/// The colors of a second material of the same look, and of looks without a color of their own.
const OTHERS: [Color32; 6] = [
    Color32::from_rgb(0xe9, 0xb4, 0x4c),
    Color32::from_rgb(0x8e, 0x7d, 0xbe),
    Color32::from_rgb(0x6f, 0xb2, 0x6b),
    Color32::from_rgb(0xd4, 0x7f, 0xa6),
    Color32::from_rgb(0x5b, 0xa4, 0xe6),
    Color32::from_rgb(0xb0, 0x8d, 0x6e),
];

/// The background that a scene starts with.
pub(crate) fn background(info: &SceneInfo) -> Color32 {
    (info.camera.background).map_or(BACKGROUND, opaque)
}

/// The colors that the entries of the legend start with. The person at the window may change them.
pub fn palette(swatches: &[Swatch]) -> Vec<Color32> {
    let mut used: Vec<Option<Look>> = vec![];
    let mut others = OTHERS.iter().cycle().copied();
    swatches
        .iter()
        .map(|swatch| {
            if let Some(color) = swatch.color {
                return opaque(color);
            }
            let first = !used.contains(&swatch.look);
            used.push(swatch.look);
            let own = match swatch.look {
                Some(Look::Liquid) => Some(LIQUID),
                Some(Look::Solid) => Some(JELLY),
                Some(Look::Snow) => Some(SNOW),
                Some(Look::Dust) | None => None,
            };
            own.filter(|_| first)
                .or_else(|| others.next())
                .unwrap_or(Color32::GRAY)
        })
        .collect()
}

/// The color of a body, where colors tell bodies apart.
pub(crate) fn color_of_body(info: &SceneInfo, number: usize) -> Color32 {
    let own = info.bodies.get(number).and_then(|body| body.color);
    opaque(own.unwrap_or_else(|| body_color(number)))
}

/// The color of each particle: red, green, blue, 255.
pub fn particle_colors(
    by: ColorBy,
    snapshot: &Snapshot,
    info: &SceneInfo,
    palette: &[Color32],
    range: &Range,
) -> Vec<[u8; 4]> {
    if let Some(values) = color::values(by, snapshot) {
        return colors_of_values(by, &values, range);
    }
    let first = palette.first().copied().unwrap_or(LIQUID);
    let of_body = |number: usize| match by {
        ColorBy::Body => color_of_body(info, number),
        _ => (info.body_swatches.get(number))
            .and_then(|&swatch| palette.get(swatch))
            .copied()
            .unwrap_or(first),
    };
    let Some(Data::U32(bodies)) = snapshot.get(Field::Body) else {
        let color = match by {
            ColorBy::Body => of_body(0),
            _ => first,
        };
        return vec![color.to_array(); snapshot.count];
    };
    let count = bodies.iter().max().map_or(0, |&last| last as usize + 1);
    let colors: Vec<[u8; 4]> = (0..count).map(|body| of_body(body).to_array()).collect();
    bodies.iter().map(|&body| colors[body as usize]).collect()
}

fn colors_of_values(by: ColorBy, values: &[f32], range: &Range) -> Vec<[u8; 4]> {
    let (low, high) = range.ends();
    // 256 steps are as fine as a screen shows, and cheaper than a blend per particle.
    let steps: Vec<_> = (0..256)
        .map(|i| color::along(by, i as f32 / 255.0).to_array())
        .collect();
    let not_a_number = color::along(by, f32::NAN).to_array();
    values
        .iter()
        .map(|value| {
            let at = (value - low) / (high - low);
            if at.is_finite() {
                steps[(at.clamp(0.0, 1.0) * 255.0) as usize]
            } else {
                not_a_number
            }
        })
        .collect()
}

fn opaque([r, g, b]: Color) -> Color32 {
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taichis_materials_have_taichis_colors_and_a_second_liquid_has_its_own() {
        let swatch = |look| Swatch {
            name: String::new(),
            look: Some(look),
            color: None,
        };
        let palette = palette(&[Look::Liquid, Look::Solid, Look::Snow, Look::Liquid].map(swatch));
        assert_eq!(palette[..3], [LIQUID, JELLY, SNOW]);
        assert!(!palette[..3].contains(&palette[3]));
    }
}
