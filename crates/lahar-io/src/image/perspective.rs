//! Pictures in 3D: particles as lit balls over a floor, in the box of the domain.
//!
//! ```text
//! balls ─► depth and nearest particle per sample ─► smoothed depth ─► normals ─► light, shadow, dark corners ─► mean of samples
//! ```
//! Smoothing turns a dense crowd of balls into one surface. It stops at jumps of depth, so that lone balls stay balls.

use core::f32::consts::TAU;

use super::camera::{self, Camera, add_scaled, cross, dot, sub, unit};
use super::drawable::DrawableParticles;
use super::palette::{self, ToScreen};
use super::renderer::{Solid, Style};
use super::{Picture, Scenery};

/// Radius of a ball, in sizes of its particle.
const RADIUS: f32 = 0.9;

/// Distance over which depth is smoothed, in radii.
const SMOOTHING: f32 = 1.9;
/// Smallest difference of depth that is a jump, in radii.
const JUMP: f32 = 2.0;

/// Samples per side of the shadow map.
const SHADOW: usize = 512;

/// Most steps of a march along a ray.
const MARCHES: usize = 96;

/// Index that stands for a sample without a particle.
const NOTHING: u32 = u32::MAX;

/// Strength of the light that comes from everywhere.
const AMBIENT: f32 = 0.42;
/// Strength of the lamp.
const LAMP: f32 = 0.78;

#[derive(Clone, Debug)]
pub(super) struct PerspectivePainter {
    pub(super) camera: Camera,
    width: usize,
    height: usize,
    samples: usize,
    min: [f32; 3],
    max: [f32; 3],
    up: usize,
    walls: bool,
    /// Direction towards the lamp.
    lamp: [f32; 3],
    background: palette::Color,
}

/// Depth and particle of each sample.
struct DepthBuffer {
    /// Distance along the view \[m\]; infinite if the sample shows nothing.
    depth: Vec<f32>,
    particle: Vec<u32>,
}

impl PerspectivePainter {
    pub(super) fn new(scenery: &Scenery, style: &Style) -> Self {
        let (min, max) = scenery.bounds;
        let (width, height) = (style.width as usize / 2 * 2, style.height as usize / 2 * 2);
        let camera = Camera::showing(scenery.bounds, scenery.up, width as f32 / height as f32);
        // The lamp is over the left shoulder of the viewer.
        let [right, _, forward] = camera.frame();
        let mut lamp = add_scaled(add_scaled([0.0; 3], right, -0.45), forward, -0.35);
        lamp[scenery.up] += 1.0;
        Self {
            camera,
            width,
            height,
            samples: (style.samples as usize).min(2),
            min: min.map(|x| x as f32),
            max: max.map(|x| x as f32),
            up: scenery.up,
            walls: scenery.walls,
            lamp: unit(lamp),
            background: scenery.background,
        }
    }

    pub(super) fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    pub(super) fn render(&self, particles: &DrawableParticles, solids: &[Solid]) -> Picture {
        let eye = Viewport::new(
            &self.camera,
            self.width * self.samples,
            self.height * self.samples,
        );
        let shadow = Shadow::cast(self, particles);
        let mut seen = eye.balls(particles);
        let mut raw = seen.depth.clone();
        eye.smooth(&mut seen, particles);
        eye.trace(self, solids, &mut seen, &mut raw);
        let mut light = eye.paint(self, &seen, (particles, solids), &shadow);
        self.draw_edges(&eye, &raw, &mut light);

        let screen = ToScreen::new();
        let share = 1.0 / (self.samples * self.samples) as f32;
        let mut rgb = Vec::with_capacity(3 * self.width * self.height);
        for row in 0..self.height {
            for column in 0..self.width {
                let mut total = [0.0; 3];
                for sample in 0..self.samples {
                    let start = (row * self.samples + sample) * eye.width + column * self.samples;
                    for seen in &light[start..start + self.samples] {
                        total = add_scaled(total, *seen, share);
                    }
                }
                rgb.extend(screen.color(total));
            }
        }
        Picture {
            width: self.width as u32,
            height: self.height as u32,
            rgb,
        }
    }

    /// Returns where a ray enters the box and where it leaves it, in lengths of `along`.
    fn crossing(&self, from: [f32; 3], along: [f32; 3]) -> Option<(f32, f32)> {
        let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
        for i in 0..3 {
            let sides = [self.min[i], self.max[i]].map(|side| (side - from[i]) / along[i]);
            enter = enter.max(sides[0].min(sides[1]));
            leave = leave.min(sides[0].max(sides[1]));
        }
        (enter < leave).then_some((enter, leave))
    }

    /// Returns the point where a ray meets the floor inside the box \[m\].
    fn floor(&self, from: [f32; 3], along: [f32; 3]) -> Option<[f32; 3]> {
        let distance = (self.min[self.up] - from[self.up]) / along[self.up];
        let at = add_scaled(from, along, distance);
        let inside = (0..3).all(|i| i == self.up || (self.min[i]..=self.max[i]).contains(&at[i]));
        (distance > 0.0 && inside).then_some(at)
    }

    /// Returns the color of the floor: a grid of lines, about eight along its longer side.
    fn floor_color(&self, at: [f32; 3], width: f32) -> [f32; 3] {
        let longest = (0..3)
            .filter(|&i| i != self.up)
            .map(|i| self.max[i] - self.min[i])
            .fold(0.0, f32::max);
        let step = nice(longest / 8.0);
        let mut line = 0.0_f32;
        for axis in (0..3).filter(|&i| i != self.up) {
            let place = (at[axis] - self.min[axis]) / step;
            let away = (place - place.round()).abs() * step;
            line = line.max((1.0 - away / width).clamp(0.0, 1.0));
        }
        palette::mix(
            palette::linear(palette::lighter(self.background, 0.09)),
            palette::linear(palette::lighter(self.background, 0.2)),
            line,
        )
    }

    /// Draws the twelve edges of the box, faint, and hidden behind nearer things.
    fn draw_edges(&self, eye: &Viewport, depth: &[f32], light: &mut [[f32; 3]]) {
        if !self.walls {
            return;
        }
        let corners = camera::corners(self.min, self.max);
        let color = palette::linear(EDGE);
        let thick = 0.5 * self.samples as f32;
        for a in 0..8_usize {
            for bit in 0..3 {
                let b = a | 1 << bit;
                if a == b {
                    continue;
                }
                let (Some(p), Some(q)) = (eye.project(corners[a]), eye.project(corners[b])) else {
                    continue;
                };
                let steps = (2.0 * (p[0] - q[0]).abs().max((p[1] - q[1]).abs()))
                    .ceil()
                    .clamp(1.0, 1e5);
                let upright = (p[1] - q[1]).abs() > (p[0] - q[0]).abs();
                let mut before = None;
                for step in 0..=steps as usize {
                    let part = step as f32 / steps;
                    let x = p[0] + (q[0] - p[0]) * part;
                    let y = p[1] + (q[1] - p[1]) * part;
                    // 1/depth is linear in the picture.
                    let z = 1.0 / (1.0 / p[2] + (1.0 / q[2] - 1.0 / p[2]) * part);
                    let (along, across) = if upright { (y, x) } else { (x, y) };
                    if before == Some(along.round() as isize) {
                        continue;
                    }
                    before = Some(along.round() as isize);
                    for offset in
                        (across - thick).ceil() as isize..=(across + thick).floor() as isize
                    {
                        let (column, row) = if upright {
                            (offset, along.round() as isize)
                        } else {
                            (along.round() as isize, offset)
                        };
                        if (0..eye.width as isize).contains(&column)
                            && (0..eye.height as isize).contains(&row)
                        {
                            let at = row as usize * eye.width + column as usize;
                            if z <= depth[at] * 1.001 {
                                light[at] = palette::mix(light[at], color, 0.75);
                            }
                        }
                    }
                }
            }
        }
    }
}

const EDGE: palette::Color = [0x6E, 0x93, 0xA6];

/// Returns 1, 2 or 5 times a power of ten, near `length`.
fn nice(length: f32) -> f32 {
    let power = 10.0_f32.powf(length.max(f32::MIN_POSITIVE).log10().floor());
    let lead = length / power;
    power
        * if lead < 1.5 {
            1.0
        } else if lead < 3.5 {
            2.0
        } else if lead < 7.5 {
            5.0
        } else {
            10.0
        }
}

/// A camera and its grid of samples.
struct Viewport {
    from: [f32; 3],
    right: [f32; 3],
    up: [f32; 3],
    forward: [f32; 3],
    width: usize,
    height: usize,
    /// Focal length \[samples\].
    focal: f32,
    /// Offsets at which to look for things that hide the sky, within a unit circle, for each place of a 4 × 4 pattern.
    looks: Box<[[[f32; 2]; DIRECTIONS]; 16]>,
}

impl Viewport {
    fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let [right, up, forward] = camera.frame();
        Self {
            from: camera.eye,
            right,
            up,
            forward,
            width,
            height,
            focal: 0.5 * height as f32 / (0.5 * camera.angle).tan(),
            looks: Box::new(core::array::from_fn(|turn| {
                core::array::from_fn(|i| {
                    const GOLDEN_ANGLE: f32 = 2.399_963;
                    let angle = turn as f32 * (TAU / 16.0) + i as f32 * GOLDEN_ANGLE;
                    let away = (i as f32 + 0.7) / DIRECTIONS as f32;
                    [away * angle.cos(), away * angle.sin()]
                })
            })),
        }
    }

    /// Returns column, row (in samples) and depth \[m\] of a point in front of the camera.
    fn project(&self, point: [f32; 3]) -> Option<[f32; 3]> {
        let r = sub(point, self.from);
        let depth = dot(r, self.forward);
        (depth > 1e-6).then(|| {
            [
                0.5 * self.width as f32 - 0.5 + dot(r, self.right) * self.focal / depth,
                0.5 * self.height as f32 - 0.5 - dot(r, self.up) * self.focal / depth,
                depth,
            ]
        })
    }

    /// Returns the direction of a sample's ray, scaled to 1 along the view.
    fn ray(&self, column: f32, row: f32) -> [f32; 3] {
        let u = (column + 0.5 - 0.5 * self.width as f32) / self.focal;
        let v = (0.5 * self.height as f32 - row - 0.5) / self.focal;
        core::array::from_fn(|i| self.forward[i] + u * self.right[i] + v * self.up[i])
    }

    fn balls(&self, particles: &DrawableParticles) -> DepthBuffer {
        let mut depth = vec![f32::INFINITY; self.width * self.height];
        let mut particle = vec![NOTHING; self.width * self.height];
        for (index, (&x, &size)) in particles.position.iter().zip(&particles.size).enumerate() {
            let Some([u, v, z]) = self.project(x) else {
                continue;
            };
            let radius = RADIUS * size;
            let reach = (radius * self.focal / z).max(0.75);
            let (left, right) = (
                (u - reach).ceil().max(0.0),
                (u + reach).floor().min(self.width as f32 - 1.0),
            );
            let (top, bottom) = (
                (v - reach).ceil().max(0.0),
                (v + reach).floor().min(self.height as f32 - 1.0),
            );
            // Also false if a number is not finite.
            if !(left <= right && top <= bottom) {
                continue;
            }
            let inverse = 1.0 / (reach * reach);
            for row in top as usize..=bottom as usize {
                let dv = row as f32 - v;
                for column in left as usize..=right as usize {
                    let du = column as f32 - u;
                    let rest = 1.0 - (du * du + dv * dv) * inverse;
                    if rest > 0.0 {
                        let near = z - radius * rest.sqrt();
                        let at = row * self.width + column;
                        if near < depth[at] {
                            depth[at] = near;
                            particle[at] = index as u32;
                        }
                    }
                }
            }
        }
        DepthBuffer { depth, particle }
    }

    /// Adds the colliders within the scene's box: marches along each ray in steps of the distance to the nearest solid.
    /// Solid k appears as particle `NOTHING − 1 − k`.
    fn trace(
        &self,
        space: &PerspectivePainter,
        solids: &[Solid],
        seen: &mut DepthBuffer,
        raw: &mut [f32],
    ) {
        if solids.is_empty() {
            return;
        }
        let diagonal = dot(sub(space.max, space.min), sub(space.max, space.min)).sqrt();
        let near = 1e-3 * f64::from(diagonal);
        for row in 0..self.height {
            for column in 0..self.width {
                let at = row * self.width + column;
                let ray = self.ray(column as f32, row as f32);
                let Some((enter, leave)) = space.crossing(self.from, ray) else {
                    continue;
                };
                let leave = leave.min(raw[at]).min(seen.depth[at]);
                let length = f64::from(dot(ray, ray).sqrt());
                for (number, solid) in solids.iter().enumerate() {
                    let mut depth = f64::from(enter);
                    for _ in 0..MARCHES {
                        if depth >= f64::from(leave) || depth >= f64::from(seen.depth[at]) {
                            break;
                        }
                        let point = core::array::from_fn(|i| {
                            f64::from(self.from[i]) + depth * f64::from(ray[i])
                        });
                        let (free, _) = solid.placed.distance(point);
                        if free < near {
                            seen.depth[at] = depth as f32;
                            raw[at] = depth as f32;
                            seen.particle[at] = NOTHING - 1 - number as u32;
                            break;
                        }
                        depth += free / length;
                    }
                }
            }
        }
    }

    /// Smooths the depth over about two balls, along rows and columns in turn. A much nearer sample has no effect, and a
    /// much farther one only that of a little farther one, so that edges stay in place.
    fn smooth(&self, seen: &mut DepthBuffer, particles: &DrawableParticles) {
        let (w, h) = (self.width, self.height);
        let radius: Vec<f32> = seen
            .particle
            .iter()
            .map(|&particle| match particle {
                NOTHING => 0.0,
                particle => RADIUS * particles.size[particle as usize],
            })
            .collect();
        let mut other = seen.depth.clone();
        for pass in 0..4 {
            let across = pass % 2 == 0;
            for row in 0..h {
                for column in 0..w {
                    let at = row * w + column;
                    let center = seen.depth[at];
                    if seen.particle[at] == NOTHING {
                        continue;
                    }
                    let jump = JUMP * radius[at];
                    let reach = (SMOOTHING * radius[at] * self.focal / center)
                        .round()
                        .clamp(1.0, 16.0) as usize;
                    let (place, length, stride) = if across { (column, w, 1) } else { (row, h, w) };
                    let side = reach.min(place).min(length - 1 - place);
                    let falloff = 1.0 / ((reach * reach) as f32 * 1.3);
                    let (mut total, mut weight) = (0.0, 1.0);
                    for step in 1..=side {
                        let a = seen.depth[at - step * stride] - center;
                        let b = seen.depth[at + step * stride] - center;
                        // In pairs, so that slopes stay. An empty sample has infinite depth.
                        if a.min(b) > -jump && a.max(b) < f32::INFINITY {
                            let share = 1.0 - (step * step) as f32 * falloff;
                            total += share * (a.min(jump) + b.min(jump));
                            weight += 2.0 * share;
                        }
                    }
                    other[at] = center + total / weight;
                }
            }
            core::mem::swap(&mut seen.depth, &mut other);
        }
    }

    fn point(&self, depth: &[f32], at: usize) -> [f32; 3] {
        add_scaled(
            self.from,
            self.ray((at % self.width) as f32, (at / self.width) as f32),
            depth[at],
        )
    }

    /// Returns the normal of the smoothed depth, from the smaller of the differences on either side.
    fn normal(&self, depth: &[f32], at: usize, center: [f32; 3]) -> [f32; 3] {
        let (column, row) = (at % self.width, at / self.width);
        let difference = |back: Option<usize>, front: Option<usize>| {
            let slope = |to: usize| depth[to] - depth[at];
            let (back, front) = (
                back.filter(|&to| depth[to].is_finite()),
                front.filter(|&to| depth[to].is_finite()),
            );
            match (back, front) {
                (Some(b), Some(f)) if slope(b).abs() < slope(f).abs() => Some((b, -1.0)),
                (_, Some(f)) => Some((f, 1.0)),
                (Some(b), None) => Some((b, -1.0)),
                (None, None) => None,
            }
        };
        let across = difference(
            (column > 0).then(|| at - 1),
            (column + 1 < self.width).then(|| at + 1),
        );
        let down = difference(
            (row > 0).then(|| at - self.width),
            (row + 1 < self.height).then(|| at + self.width),
        );
        match (across, down) {
            (Some((a, s)), Some((d, t))) => {
                let across = sub(self.point(depth, a), center).map(|c| c * s);
                let down = sub(self.point(depth, d), center).map(|c| c * t);
                unit(cross(down, across))
            }
            _ => unit(sub(self.from, center)),
        }
    }

    /// Returns the part of the sky that near things hide: 0 open, 1 closed.
    fn hidden(
        &self,
        depth: &[f32],
        at: usize,
        center: [f32; 3],
        normal: [f32; 3],
        reach: f32,
    ) -> f32 {
        let (column, row) = ((at % self.width) as f32, (at / self.width) as f32);
        let samples = (reach * self.focal / depth[at]).clamp(3.0, 60.0);
        // The offsets turn in a fixed pattern over 4 × 4 samples, which the mean of samples hides.
        let looks = &self.looks[(at % self.width % 4) * 4 + at / self.width % 4];
        let mut sum = 0.0;
        for look in looks {
            let (c, r) = (column + samples * look[0], row + samples * look[1]);
            if c < 0.0 || r < 0.0 || c >= self.width as f32 || r >= self.height as f32 {
                continue;
            }
            let other = r as usize * self.width + c as usize;
            if !depth[other].is_finite() {
                continue;
            }
            let to = sub(self.point(depth, other), center);
            let distance = dot(to, to).sqrt().max(1e-9);
            let rise = (dot(to, normal) / distance - 0.12).max(0.0);
            sum += rise * (1.0 - distance / (2.5 * reach)).max(0.0);
        }
        (sum * 2.2 / DIRECTIONS as f32).min(1.0)
    }

    fn paint(
        &self,
        space: &PerspectivePainter,
        seen: &DepthBuffer,
        (particles, solids): (&DrawableParticles, &[Solid]),
        shadow: &Shadow,
    ) -> Vec<[f32; 3]> {
        let far = palette::linear(space.background);
        let sky = palette::linear(palette::lighter(space.background, 0.07));
        let diagonal = dot(sub(space.max, space.min), sub(space.max, space.min)).sqrt();
        let nearest = dot(sub(space.camera.target, self.from), self.forward) - 0.5 * diagonal;
        let mut light = Vec::with_capacity(seen.depth.len());
        for at in 0..seen.depth.len() {
            let (column, row) = ((at % self.width) as f32, (at / self.width) as f32);
            let ray = self.ray(column, row);
            let particle = seen.particle[at];
            if particle == NOTHING {
                let backdrop = palette::mix(sky, far, (row / self.height as f32).min(1.0));
                light.push(space.floor(self.from, ray).map_or(backdrop, |floor| {
                    let away = dot(sub(floor, self.from), self.forward);
                    let color =
                        space.floor_color(floor, 1.1 * away / self.focal * space.samples as f32);
                    let lit = 1.0 - 0.62 * shadow.at(floor, 0.0);
                    color.map(|c| c * lit)
                }));
                continue;
            }
            let center = self.point(&seen.depth, at);
            let solid = solids.get((NOTHING - 1 - particle) as usize);
            let (radius, normal, color) = match solid {
                Some(solid) => {
                    let (_, normal) = solid.placed.distance(center.map(f64::from));
                    (0.01 * diagonal, normal.map(|n| n as f32), solid.color)
                }
                None => (
                    RADIUS * particles.size[particle as usize],
                    self.normal(&seen.depth, at, center),
                    particles.color[particle as usize],
                ),
            };
            let view = unit(ray.map(|c| -c));
            let open = 1.0 - 0.75 * self.hidden(&seen.depth, at, center, normal, 5.0 * radius);
            let lamp = dot(normal, space.lamp);
            let lit = LAMP * lamp.max(0.0) * (1.0 - 0.75 * shadow.at(center, 2.2 * radius));
            // More light comes from above than from below.
            let around = AMBIENT * (0.75 + 0.25 * normal[space.up]) * open;
            let half = unit(add_scaled(space.lamp, view, 1.0));
            let shine = if lit > 0.0 {
                dot(normal, half).max(0.0).powi(40) * 0.22 * (lit / LAMP)
            } else {
                0.0
            };
            let rim = (1.0 - dot(normal, view).max(0.0)).powi(4) * 0.10 * open;
            let surface: [f32; 3] =
                core::array::from_fn(|i| color[i] * (around + lit) * 1.15 + shine + rim * sky[i]);
            let haze = ((seen.depth[at] - nearest) / diagonal).clamp(0.0, 1.0) * 0.28;
            light.push(palette::mix(surface, sky, haze));
        }
        light
    }
}

/// Number of offsets at which a sample looks for things that hide the sky.
const DIRECTIONS: usize = 9;

/// The shadow map: for each ray of the lamp, the height of the first thing it meets, along the lamp's direction.
struct Shadow {
    side: [f32; 3],
    other: [f32; 3],
    lamp: [f32; 3],
    corner: [f32; 2],
    /// Samples per meter.
    scale: f32,
    height: Vec<f32>,
}

impl Shadow {
    fn cast(space: &PerspectivePainter, particles: &DrawableParticles) -> Self {
        let lamp = space.lamp;
        let helper = if lamp[0].abs() < 0.7 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let side = unit(cross(lamp, helper));
        let other = cross(lamp, side);
        let corners = camera::corners(space.min, space.max);
        let range = |axis: [f32; 3]| {
            corners
                .iter()
                .map(|&c| dot(c, axis))
                .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| {
                    (low.min(x), high.max(x))
                })
        };
        let (a, b) = (range(side), range(other));
        let extent = (a.1 - a.0).max(b.1 - b.0).max(f32::MIN_POSITIVE);
        let mut map = Self {
            side,
            other,
            lamp,
            corner: [a.0, b.0],
            scale: (SHADOW - 1) as f32 / extent,
            height: vec![f32::NEG_INFINITY; SHADOW * SHADOW],
        };
        for (&x, &size) in particles.position.iter().zip(&particles.size) {
            let [u, v, height] = map.place(x);
            let reach = (RADIUS * size * map.scale).max(0.71);
            let (left, right) = (
                (u - reach).ceil().max(0.0),
                (u + reach).floor().min(SHADOW as f32 - 1.0),
            );
            let (top, bottom) = (
                (v - reach).ceil().max(0.0),
                (v + reach).floor().min(SHADOW as f32 - 1.0),
            );
            if !(left <= right && top <= bottom) {
                continue;
            }
            for row in top as usize..=bottom as usize {
                for column in left as usize..=right as usize {
                    let (du, dv) = (column as f32 - u, row as f32 - v);
                    let at = &mut map.height[row * SHADOW + column];
                    if du * du + dv * dv <= reach * reach && height > *at {
                        *at = height;
                    }
                }
            }
        }
        map
    }

    fn place(&self, x: [f32; 3]) -> [f32; 3] {
        [
            (dot(x, self.side) - self.corner[0]) * self.scale,
            (dot(x, self.other) - self.corner[1]) * self.scale,
            dot(x, self.lamp),
        ]
    }

    /// Returns the part of the lamp (0 to 1) that is hidden from `x` by things more than `slack` \[m\] nearer to it.
    fn at(&self, x: [f32; 3], slack: f32) -> f32 {
        let [u, v, height] = self.place(x);
        let mut hidden = 0.0;
        for row in -1..=1_i32 {
            for column in -1..=1_i32 {
                let (c, r) = (u + 1.6 * column as f32, v + 1.6 * row as f32);
                if c >= 0.0 && r >= 0.0 && c < SHADOW as f32 && r < SHADOW as f32 {
                    let above = self.height[r as usize * SHADOW + c as usize] - height;
                    if above > slack {
                        hidden += 1.0 / 9.0;
                    }
                }
            }
        }
        hidden
    }
}
