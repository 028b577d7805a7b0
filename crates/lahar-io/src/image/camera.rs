//! A perspective camera, and the one that shows a whole box.

type V = [f32; 3];

pub(super) fn sub(a: V, b: V) -> V {
    core::array::from_fn(|i| a[i] - b[i])
}
pub(super) fn add_scaled(a: V, b: V, s: f32) -> V {
    core::array::from_fn(|i| a[i] + b[i] * s)
}
pub(super) fn dot(a: V, b: V) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
pub(super) fn cross(a: V, b: V) -> V {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
pub(super) fn unit(a: V) -> V {
    let length = dot(a, a).sqrt().max(f32::MIN_POSITIVE);
    a.map(|c| c / length)
}

/// A perspective camera.
///
/// ```
/// use lahar_io::image::Camera;
///
/// let unit_box = ([0.0; 3], [1.0; 3]);
/// let camera = Camera::showing(unit_box, 1, 4.0 / 3.0);
/// assert!(camera.eye[1] > camera.target[1], "it looks down");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the camera \[m\].
    pub eye: [f32; 3],
    /// Point in the middle of the picture \[m\].
    pub target: [f32; 3],
    /// Direction that points up in the picture.
    pub up: [f32; 3],
    /// Angle between the lower and the upper edge of the picture \[rad\].
    pub angle: f32,
}

/// Angle of the usual view from the front to the right \[rad\].
const SIDE: f32 = 0.52;

/// Angle of the usual view above the horizon \[rad\].
const ABOVE: f32 = 0.42;

/// Angle between the lower and the upper edge of the usual view \[rad\].
const WIDE: f32 = 0.55;

/// Largest part of the picture's width and height that a box fills.
const FILL: f32 = 0.94;

impl Camera {
    /// Shows a whole box (lower and upper corner \[m\]) from the front, somewhat from the right and above. `up` is the axis
    /// that points up, `aspect` the picture's width divided by its height.
    pub fn showing(bounds: ([f64; 3], [f64; 3]), up: usize, aspect: f32) -> Self {
        let (right, front) = ground(up);
        let mut direction = [0.0; 3];
        direction = add_scaled(direction, front, ABOVE.cos() * SIDE.cos());
        direction = add_scaled(direction, right, ABOVE.cos() * SIDE.sin());
        direction[up] = ABOVE.sin();
        Self::showing_from(bounds, up, aspect, direction, WIDE)
    }

    /// Looks at `center` \[m\] from `direction`, so far away that `height` \[m\] fill the angle of view `angle` \[rad\].
    pub fn framing(
        center: [f64; 3],
        height: f64,
        up: usize,
        direction: [f32; 3],
        angle: f32,
    ) -> Self {
        let target = center.map(|x| x as f32);
        let distance = 0.5 * height as f32 / (0.5 * angle).tan();
        let mut up_vector = [0.0; 3];
        up_vector[up] = 1.0;
        Self {
            eye: add_scaled(target, unit(direction), distance),
            target,
            up: up_vector,
            angle,
        }
    }

    /// Shows a whole box as [`Camera::showing`] does, from another `direction` (towards the camera), with `angle` \[rad\]
    /// between the lower and the upper edge of the picture.
    pub fn showing_from(
        (min, max): ([f64; 3], [f64; 3]),
        up: usize,
        aspect: f32,
        direction: [f32; 3],
        angle: f32,
    ) -> Self {
        let direction = unit(direction);
        let (min, max) = (min.map(|x| x as f32), max.map(|x| x as f32));
        let center: V = core::array::from_fn(|i| 0.5 * (min[i] + max[i]));
        let extent = dot(sub(max, min), sub(max, min)).sqrt();
        let mut up_vector = [0.0; 3];
        up_vector[up] = 1.0;
        let mut camera = Self {
            eye: center,
            target: center,
            up: up_vector,
            angle,
        };
        let corners = corners(min, max);
        // Each pass finds the distance, then shifts the middle of the visible box to the middle of the picture.
        for _ in 0..3 {
            let fits = |distance: f32, camera: &Self| {
                let placed = Self {
                    eye: add_scaled(camera.target, direction, distance),
                    ..*camera
                };
                let [low, high] = placed.seen(&corners, aspect);
                [0, 1].iter().all(|&i| low[i] >= -FILL && high[i] <= FILL)
            };
            let (mut near, mut far) = (0.3 * extent, 40.0 * extent);
            for _ in 0..40 {
                let middle = 0.5 * (near + far);
                if fits(middle, &camera) {
                    far = middle
                } else {
                    near = middle
                }
            }
            camera.eye = add_scaled(camera.target, direction, far);
            let [low, high] = camera.seen(&corners, aspect);
            let frame = camera.frame();
            let shift = far * (0.5 * camera.angle).tan();
            let to_right = 0.5 * (low[0] + high[0]) * shift * aspect;
            let to_up = 0.5 * (low[1] + high[1]) * shift;
            for point in [&mut camera.eye, &mut camera.target] {
                *point = add_scaled(add_scaled(*point, frame[0], to_right), frame[1], to_up);
            }
        }
        camera
    }

    /// Returns the unit vectors to the right, up and forward.
    pub(super) fn frame(&self) -> [V; 3] {
        let forward = unit(sub(self.target, self.eye));
        let right = unit(cross(forward, self.up));
        [right, cross(right, forward), forward]
    }

    /// Returns the smallest and largest picture coordinates (−1 to 1) of `points`.
    fn seen(&self, points: &[V], aspect: f32) -> [[f32; 2]; 2] {
        let [right, up, forward] = self.frame();
        let scale = 1.0 / (0.5 * self.angle).tan();
        let mut low = [f32::INFINITY; 2];
        let mut high = [f32::NEG_INFINITY; 2];
        for &point in points {
            let r = sub(point, self.eye);
            let depth = dot(r, forward);
            if depth <= 0.0 {
                return [[f32::NEG_INFINITY; 2], [f32::INFINITY; 2]];
            }
            let at = [
                dot(r, right) * scale / (depth * aspect),
                dot(r, up) * scale / depth,
            ];
            for i in 0..2 {
                low[i] = low[i].min(at[i]);
                high[i] = high[i].max(at[i]);
            }
        }
        [low, high]
    }
}

/// Returns the directions to the right and to the front on the ground; `up` is the axis that points up.
fn ground(up: usize) -> (V, V) {
    match up {
        0 => ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        1 => ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        _ => ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
    }
}

/// Returns the eight corners of a box. Two that differ in one bit of their index share an edge.
pub(super) fn corners(min: V, max: V) -> [V; 8] {
    core::array::from_fn(|corner| {
        core::array::from_fn(|axis| {
            if corner >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_box_is_seen_and_fills_the_picture() {
        for up in [1, 2] {
            for max in [[1.0, 1.0, 1.0], [4.0, 1.0, 0.5], [0.2, 3.0, 0.2]] {
                let camera = Camera::showing(([0.0; 3], max), up, 1.6);
                let [low, high] = camera.seen(&corners([0.0; 3], max.map(|x| x as f32)), 1.6);
                let fill = low.iter().chain(&high).fold(0.0_f32, |a, b| a.max(b.abs()));
                assert!(
                    (0.88..=0.97).contains(&fill),
                    "{max:?}, up {up}: {low:?} {high:?}"
                );
                assert!(camera.eye[up] > camera.target[up]);
            }
        }
    }
}
