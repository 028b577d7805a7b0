//! Turns snapshots into sprites, and the domain and the floor into lines.

use std::sync::Arc;

use eframe::egui::Color32;
use lahar::{Field, Snapshot};
use lahar_scene::scene::ColorBy;

use crate::camera::{V3, add, corners, opposite_axis, scale, sub};
use crate::collider_lines::collider_lines;
use crate::color::Range;
use crate::palette::particle_colors;
use crate::renderer::{Line, Sprites};
use crate::scenes::SceneInfo;

/// Radius of a disc in parts of the spacing, large enough to leave no holes between jittered particles.
const RADIUS_2D: f32 = 1.05;
/// Radius of a ball in parts of the spacing. It is smaller because the balls behind fill the gaps.
const RADIUS_3D: f32 = 0.65;

/// The resting parts of a scene, and its extent.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scenery {
    /// Corners of the domain, or of a box around the particles with space to move in \[m\].
    pub(crate) extent: (V3, V3),
    /// The origin that everything is drawn relative to, so that f32 has enough digits \[m\].
    pub(crate) origin: V3,
    /// The domain's edges and the grid on its floor.
    pub(crate) lines: Arc<Vec<Line>>,
}

impl Scenery {
    pub(crate) fn new(info: &SceneInfo, snapshot: Option<&Snapshot>) -> Self {
        let extent = extent(info, snapshot);
        let origin = scale(add(extent.0, extent.1), 0.5);
        Self {
            extent,
            origin,
            lines: Arc::new(outline(info, extent, origin)),
        }
    }

    /// The lines of the scenery and of the colliders at `time` \[s\].
    pub(crate) fn lines_at(&self, info: &SceneInfo, time: f64) -> Arc<Vec<Line>> {
        if info.colliders.is_empty() {
            return Arc::clone(&self.lines);
        }
        let (extent, origin) = (self.extent, self.origin);
        let moving = collider_lines(&info.colliders, time, info.dimension, extent, origin);
        Arc::new([self.lines.as_slice(), &moving].concat())
    }

    /// The smallest side of the extent \[m\].
    pub(crate) fn smallest_side(&self, dimension: usize) -> f64 {
        let size = sub(self.extent.1, self.extent.0);
        (size[..dimension].iter()).fold(f64::INFINITY, |least, side| least.min(*side))
    }
}

/// The radius that particles are drawn with at first, in parts of the spacing of sprites.
pub(crate) fn usual_radius(info: &SceneInfo) -> f32 {
    match (info.camera.particle_radius, info.dimension) {
        (Some(_), _) => 1.0,
        (None, 2) => RADIUS_2D,
        (None, _) => RADIUS_3D,
    }
}

/// The sprites of the particles of one side.
pub(crate) fn sprites(
    snapshot: &Snapshot,
    info: &SceneInfo,
    scenery: &Scenery,
    (by, palette, range): (ColorBy, &[Color32], &Range),
) -> Sprites {
    let Some(positions) = snapshot.get(Field::Position).map(lahar::Data::to_f64) else {
        return Sprites::default();
    };
    let d = snapshot.dimension;
    let spacings: Vec<f32> = match (info.camera.particle_radius, snapshot.get(Field::Volume0)) {
        (Some(radius), _) => vec![radius as f32; snapshot.count],
        (None, Some(volumes)) => {
            let spacing = |&volume: &f32| if d == 2 { volume.sqrt() } else { volume.cbrt() };
            volumes.to_f32().iter().map(spacing).collect()
        }
        // A recording may lack volumes: two particles along a cell's side are assumed.
        (None, None) => vec![0.5 * info.dx as f32; snapshot.count],
    };
    let colors = particle_colors(by, snapshot, info, palette, range);
    let places = (positions.chunks_exact(d).zip(spacings))
        .map(|(x, spacing)| {
            let mut place = [0.0, 0.0, 0.0, spacing];
            for i in 0..d {
                place[i] = (x[i] - scenery.origin[i]) as f32;
            }
            place
        })
        .collect();
    Sprites { places, colors }
}

/// The corners of the domain, or of a box around the particles \[m\].
fn extent(info: &SceneInfo, snapshot: Option<&Snapshot>) -> (V3, V3) {
    if let Some((min, max)) = info.domain {
        return (min, max);
    }
    let d = info.dimension;
    let mut min = [f64::INFINITY; 3];
    let mut max = [f64::NEG_INFINITY; 3];
    let positions = snapshot
        .and_then(|s| s.get(Field::Position))
        .map(lahar::Data::to_f64)
        .unwrap_or_default();
    for x in positions.chunks_exact(d) {
        for i in 0..d {
            min[i] = min[i].min(x[i]);
            max[i] = max[i].max(x[i]);
        }
    }
    for i in 0..3 {
        if i >= d {
            (min[i], max[i]) = (0.0, 0.0);
        } else if min[i] > max[i] {
            (min[i], max[i]) = (0.0, 1.0);
        } else {
            // The particles need space to move in.
            let margin = (0.5 * (max[i] - min[i])).max(4.0 * info.dx);
            (min[i], max[i]) = (min[i] - margin, max[i] + margin);
        }
    }
    (min, max)
}

/// The domain's edges and, in 3D, a grid on its floor.
fn outline(info: &SceneInfo, (min, max): (V3, V3), origin: V3) -> Vec<Line> {
    let mut lines = vec![];
    let mut line = |a: V3, b: V3, half_width: f32, opacity: u8| {
        let local = |p: V3| sub(p, origin).map(|c| c as f32);
        lines.push(Line {
            start: local(a),
            half_width,
            end: local(b),
            color: [0xa9, 0xc7, 0xd6, opacity],
        });
    };
    if info.domain.is_some() {
        let corners = corners(min, max);
        for i in 0..8_usize {
            for axis in 0..info.dimension {
                let j = i | 1 << axis;
                if j != i && (info.dimension == 3 || j < 4) {
                    line(corners[i], corners[j], 0.7, 150);
                }
            }
        }
    }
    if info.dimension == 3 {
        let up = opposite_axis(info.gravity);
        let vertical = (0..3).find(|&i| up[i] != 0.0).unwrap_or(1);
        let floor = if up[vertical] > 0.0 {
            min[vertical]
        } else {
            max[vertical]
        };
        let (a, b) = ((vertical + 1) % 3, (vertical + 2) % 3);
        let step = round_step((max[a] - min[a]).max(max[b] - min[b]) / 12.0);
        for (along, across) in [(a, b), (b, a)] {
            let mut k = (min[across] / step).ceil();
            while k * step <= max[across] {
                let mut start = [floor; 3];
                start[across] = k * step;
                let mut end = start;
                (start[along], end[along]) = (min[along], max[along]);
                line(start, end, 0.4, 60);
                k += 1.0;
            }
        }
    }
    lines
}

/// The smallest of 1, 2 and 5 times a power of ten that is at least `least`.
pub(crate) fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|&step| step >= least * (1.0 - 1e-9))
        .unwrap_or(power)
}
