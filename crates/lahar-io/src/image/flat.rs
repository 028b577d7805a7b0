//! Pictures in 2D: particles melt into one filled shape with a smooth edge.
//!
//! Every particle adds a bump w = (1 − r²/h²)² around it. Material is drawn where the bumps sum to more than a threshold,
//! in the mean of their colors. Neighbors close the gaps between them, while a lone particle is a disc.

use std::ops::Range;

use super::drawable::DrawableParticles;
use super::palette::{self, ToScreen};
use super::renderer::{Solid, Style};
use super::{Picture, Scenery};

/// Reach h of a bump, in sizes of a particle. Gaps between neighbors are filled up to two and a half sizes.
pub(super) const REACH: f32 = 2.0;

/// Sum of bumps above which material is drawn.
pub(super) const THRESHOLD: f32 = 0.75;

/// Half the width of the soft edge, in sums of bumps.
const SOFT: f32 = 0.1;

/// Margin around the domain, in parts of its larger side.
const MARGIN: f64 = 0.025;

/// Draws 2D scenes: the place of the scene in the picture.
#[derive(Clone, Debug)]
pub(super) struct FlatPainter {
    width: usize,
    height: usize,
    samples: usize,
    /// World position \[m\] of the picture's top left corner.
    corner: [f64; 2],
    /// Samples per meter.
    scale: f64,
    /// Positions of the left, right, bottom and top wall \[m\].
    walls: Option<[f64; 4]>,
    background: palette::Color,
}

impl FlatPainter {
    pub(super) fn new(scenery: &Scenery, style: &Style) -> Self {
        let (min, max) = scenery.bounds;
        let room = MARGIN * (max[0] - min[0]).max(max[1] - min[1]);
        let extent = [0, 1].map(|axis| (max[axis] - min[axis] + 2.0 * room).max(f64::MIN_POSITIVE));
        let pixels = (f64::from(style.width) / extent[0]).min(f64::from(style.height) / extent[1]);
        // Even sizes, which some video formats need.
        let even = |length: f64| ((length * pixels / 2.0).round() as usize * 2).max(16);
        Self {
            width: even(extent[0]),
            height: even(extent[1]),
            samples: style.samples as usize,
            corner: [min[0] - room, max[1] + room],
            scale: pixels * f64::from(style.samples),
            walls: scenery.walls.then_some([min[0], max[0], min[1], max[1]]),
            background: scenery.background,
        }
    }

    pub(super) fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// Shows `height` \[m\] around `center` \[m\] in a picture of the full size.
    pub(super) fn frame(&mut self, style: &Style, center: [f64; 2], height: f64) {
        let pixels = f64::from(style.height) / height;
        self.width = style.width as usize / 2 * 2;
        self.height = style.height as usize / 2 * 2;
        self.scale = pixels * f64::from(style.samples);
        self.corner = [
            center[0] - 0.5 * self.width as f64 / pixels,
            center[1] + 0.5 * self.height as f64 / pixels,
        ];
    }

    pub(super) fn render(&self, particles: &DrawableParticles, solids: &[Solid]) -> Picture {
        let (columns, rows) = (self.width * self.samples, self.height * self.samples);
        // Per sample: the sum of bumps, and of bump × color.
        let mut sums = vec![[0.0_f32; 4]; columns * rows];
        for ((x, &size), color) in particles
            .position
            .iter()
            .zip(&particles.size)
            .zip(&particles.color)
        {
            // At least 0.9 pixels, so that no particle falls between samples.
            let reach = (REACH * size * self.scale as f32).max(0.9 * self.samples as f32);
            let u = ((f64::from(x[0]) - self.corner[0]) * self.scale) as f32 - 0.5;
            let v = ((self.corner[1] - f64::from(x[1])) * self.scale) as f32 - 0.5;
            let Some((left, right)) = span(u, reach, columns) else {
                continue;
            };
            let Some((top, bottom)) = span(v, reach, rows) else {
                continue;
            };
            let inverse = 1.0 / (reach * reach);
            for row in top..=bottom {
                let dv = row as f32 - v;
                for (column, sum) in
                    (left..).zip(&mut sums[row * columns + left..=row * columns + right])
                {
                    let du = column as f32 - u;
                    let w = (1.0 - (du * du + dv * dv) * inverse).max(0.0);
                    let w = w * w;
                    sum[0] += w;
                    sum[1] += w * color[0];
                    sum[2] += w * color[1];
                    sum[3] += w * color[2];
                }
            }
        }

        let screen = ToScreen::new();
        let background = palette::linear(self.background);
        let share = 1.0 / (self.samples * self.samples) as f32;
        let inside = self.inside();
        let mut light = vec![background; self.width * self.height];
        for row in 0..self.height {
            for column in 0..self.width {
                let [columns_inside, rows_inside] = &inside;
                if !(columns_inside.contains(&column) && rows_inside.contains(&row)) {
                    continue;
                }
                let mut total = [0.0; 3];
                for sample in 0..self.samples {
                    let start = (row * self.samples + sample) * columns + column * self.samples;
                    for sum in &sums[start..start + self.samples] {
                        let solid = ((sum[0] - THRESHOLD) / SOFT * 0.5 + 0.5).clamp(0.0, 1.0);
                        let mean = 1.0 / sum[0].max(f32::MIN_POSITIVE);
                        let color = [sum[1] * mean, sum[2] * mean, sum[3] * mean];
                        let seen = palette::mix(background, color, solid);
                        total = core::array::from_fn(|i| total[i] + seen[i] * share);
                    }
                }
                light[row * self.width + column] = total;
            }
        }
        self.draw_solids(&mut light, solids);
        self.draw_walls(&mut light);
        Picture {
            width: self.width as u32,
            height: self.height as u32,
            rgb: light
                .into_iter()
                .flat_map(|light| screen.color(light))
                .collect(),
        }
    }

    /// Returns the columns and rows within the walls, all if there are none. A particle at a wall does not show beyond it.
    fn inside(&self) -> [Range<usize>; 2] {
        let Some([left, right, bottom, top]) = self.walls else {
            return [0..self.width, 0..self.height];
        };
        let pixels = self.scale / self.samples as f64;
        let at =
            |length: f64, limit: usize| ((length * pixels).round().max(0.0) as usize).min(limit);
        [
            at(left - self.corner[0], self.width)..at(right - self.corner[0], self.width),
            at(self.corner[1] - top, self.height)..at(self.corner[1] - bottom, self.height),
        ]
    }

    /// Draws colliders, with soft edges, over the particles that touch them.
    fn draw_solids(&self, light: &mut [[f32; 3]], solids: &[Solid]) {
        let pixels = self.scale / self.samples as f64;
        let [columns, rows] = self.inside();
        for solid in solids {
            for row in rows.clone() {
                for column in columns.clone() {
                    let x = self.corner[0] + (column as f64 + 0.5) / pixels;
                    let y = self.corner[1] - (row as f64 + 0.5) / pixels;
                    let (distance, _) = solid.placed.distance([x, y, 0.0]);
                    let part = (0.5 - distance * pixels).clamp(0.0, 1.0) as f32;
                    let seen = &mut light[row * self.width + column];
                    *seen = palette::mix(*seen, solid.color, part);
                }
            }
        }
    }

    /// Draws a thin line just outside the domain, where it hides nothing.
    fn draw_walls(&self, light: &mut [[f32; 3]]) {
        if self.walls.is_none() {
            return;
        }
        let [columns, rows] = self.inside();
        let line = palette::mix(palette::linear(self.background), [0.5; 3], WALL);
        let mut dot = |row: usize, column: usize| {
            if row < self.height && column < self.width {
                light[row * self.width + column] = line;
            }
        };
        // If the start is 0, the line before it wraps to a number beyond the picture.
        let (left, top) = (columns.start.wrapping_sub(1), rows.start.wrapping_sub(1));
        dot(top, left);
        dot(top, columns.end);
        for column in columns.clone() {
            dot(top, column);
            dot(rows.end, column);
        }
        for row in rows.start..=rows.end {
            dot(row, left);
            dot(row, columns.end);
        }
    }
}

/// Share of gray in the color of walls, the rest being background.
const WALL: f32 = 0.25;

/// Returns the first and the last of `count` samples within `reach` of `center`; none if all are outside, or a number is
/// not finite.
fn span(center: f32, reach: f32, count: usize) -> Option<(usize, usize)> {
    let low = (center - reach).ceil().max(0.0);
    let high = (center + reach).floor().min(count as f32 - 1.0);
    (low <= high).then_some((low as usize, high as usize))
}
