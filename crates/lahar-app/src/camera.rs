//! The camera: maps the scene to the window and back. It is flat in 2D and orbits in 3D.
//!
//! ```text
//!   world [m] ──view──▶ camera's axes (right, up, back) ──projection──▶ −1..1 ──▶ points of the window
//! ```

use lahar_scene::scene;

/// A vector in three dimensions.
pub type V3 = [f64; 3];

/// A 4 × 4 matrix by columns, as shaders want it.
pub type M4 = [[f32; 4]; 4];

pub(crate) fn add(a: V3, b: V3) -> V3 {
    core::array::from_fn(|i| a[i] + b[i])
}
pub(crate) fn sub(a: V3, b: V3) -> V3 {
    core::array::from_fn(|i| a[i] - b[i])
}
pub(crate) fn scale(a: V3, s: f64) -> V3 {
    a.map(|c| c * s)
}
pub(crate) fn dot(a: V3, b: V3) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
pub(crate) fn length(a: V3) -> f64 {
    dot(a, a).sqrt()
}
pub(crate) fn cross(a: V3, b: V3) -> V3 {
    core::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}
pub(crate) fn normalize(a: V3) -> V3 {
    scale(a, 1.0 / length(a).max(f64::MIN_POSITIVE))
}

/// The view of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// 2 or 3.
    pub dimension: usize,
    /// The point that the middle of the window shows \[m\].
    pub target: V3,
    /// Half of the height that the window shows at the target \[m\].
    pub half_height: f64,
    /// Angle about the vertical \[rad\]; 3D only.
    pub yaw: f64,
    /// Angle above the horizon \[rad\]; 3D only.
    pub pitch: f64,
    /// The direction up: a unit vector along an axis.
    pub up: V3,
    /// Half the angle that the window's height spans \[rad\]; 3D only.
    half_angle: f64,
    /// Half the diagonal of the scene \[m\].
    reach: f64,
}

/// [`Camera::half_angle`] where the scene does not give it \[rad\].
const HALF_ANGLE: f64 = 0.35;
/// The largest [`Camera::half_angle`]: a wider view would be nothing but edges \[rad\].
const WIDEST: f64 = 1.4;
/// The view is larger than the scene by this factor.
const MARGIN: f64 = 1.06;
/// The largest pitch, short of the pole where the orbit would flip \[rad\].
const STEEPEST: f64 = 1.5;

impl Camera {
    /// A camera that sees what the scene's camera `wanted` asks for, or else the whole box, in a window of `aspect` = width/height. Gravity
    /// points down.
    pub fn fit(
        dimension: usize,
        (min, max): (V3, V3),
        gravity: V3,
        wanted: scene::Camera,
        aspect: f64,
    ) -> Self {
        let size = sub(max, min);
        let target = scale(add(min, max), 0.5);
        let reach = 0.5 * length(size).max(1e-9);
        let mut camera = Self {
            dimension,
            target,
            half_height: reach,
            yaw: 0.55,
            pitch: 0.35,
            up: if dimension == 2 {
                [0.0, 1.0, 0.0]
            } else {
                opposite_axis(gravity)
            },
            half_angle: wanted.field_of_view.map_or(HALF_ANGLE, |degrees| {
                (0.5 * degrees.to_radians()).clamp(0.01, WIDEST)
            }),
            reach,
        };
        if let Some(direction) = wanted.direction {
            camera.look_from(direction);
        }
        camera.half_height = if dimension == 2 {
            0.5 * MARGIN * size[1].max(size[0] / aspect)
        } else {
            // Every corner must be inside: the view widens by how far out the worst corner is.
            let mut half_height = 0.5 * reach;
            for _ in 0..8 {
                camera.half_height = half_height;
                let worst = corners(min, max)
                    .into_iter()
                    .filter_map(|corner| camera.project(corner, aspect))
                    .map(|[x, y]| x.abs().max(y.abs()))
                    .fold(0.0, f64::max);
                half_height *= (worst * MARGIN).clamp(0.25, 4.0);
            }
            half_height
        };
        if let Some(center) = wanted.center {
            camera.target = center;
        }
        if let Some(height) = wanted.height {
            camera.half_height = 0.5 * height;
        }
        camera
    }

    /// Moves the camera to this direction from the target; 3D only.
    pub fn look_from(&mut self, direction: V3) {
        let back = normalize(direction);
        let [side, front] = self.level_axes();
        if self.dimension == 3 && length(direction) > 0.0 {
            self.pitch = dot(back, self.up).clamp(-1.0, 1.0).asin();
            self.pitch = self.pitch.clamp(-STEEPEST, STEEPEST);
            self.yaw = dot(back, side).atan2(dot(back, front));
        }
    }

    /// Two axes on the horizon. At yaw 0 the eye is in the direction of the second.
    fn level_axes(&self) -> [V3; 2] {
        let side = if self.up[0] == 0.0 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        [side, cross(side, self.up)]
    }

    /// The camera's axes: right, up, and back toward the eye.
    pub fn axes(&self) -> [V3; 3] {
        if self.dimension == 2 {
            return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        }
        let [side, front] = self.level_axes();
        let level = add(scale(side, self.yaw.sin()), scale(front, self.yaw.cos()));
        let back = add(
            scale(level, self.pitch.cos()),
            scale(self.up, self.pitch.sin()),
        );
        let right = normalize(cross(self.up, back));
        [right, cross(back, right), back]
    }

    /// Distance from the eye to the target \[m\].
    fn distance(&self) -> f64 {
        self.half_height / self.half_angle.tan()
    }

    fn eye(&self) -> V3 {
        add(self.target, scale(self.axes()[2], self.distance()))
    }

    /// The matrix from the scene, relative to `origin` \[m\], to the camera's axes.
    pub fn view(&self, origin: V3) -> M4 {
        let axes = self.axes();
        let eye = sub(
            if self.dimension == 2 {
                self.target
            } else {
                self.eye()
            },
            origin,
        );
        core::array::from_fn(|column| {
            core::array::from_fn(|row| match (row, column) {
                (3, 3) => 1.0,
                (3, _) => 0.0,
                (_, 3) => -dot(axes[row], eye) as f32,
                _ => axes[row][column] as f32,
            })
        })
    }

    /// The matrix from the camera's axes to −1..1, with depth in 0..1.
    pub fn projection(&self, aspect: f64) -> M4 {
        let mut m = [[0.0; 4]; 4];
        if self.dimension == 2 {
            m[0][0] = (1.0 / (self.half_height * aspect)) as f32;
            m[1][1] = (1.0 / self.half_height) as f32;
            m[3][2] = 0.5;
            m[3][3] = 1.0;
        } else {
            let (near, far) = self.depths();
            m[0][0] = (1.0 / (self.half_angle.tan() * aspect)) as f32;
            m[1][1] = (1.0 / self.half_angle.tan()) as f32;
            m[2][2] = (far / (near - far)) as f32;
            m[2][3] = -1.0;
            m[3][2] = (near * far / (near - far)) as f32;
        }
        m
    }

    fn depths(&self) -> (f64, f64) {
        let far = self.distance() + 8.0 * self.reach;
        ((self.distance() * 0.02).min(0.1 * self.reach), far)
    }

    /// Projects a point to −1..1 of the window, x to the right and y up. Returns `None` behind the eye.
    pub fn project(&self, point: V3, aspect: f64) -> Option<[f64; 2]> {
        let axes = self.axes();
        let d = sub(point, self.target);
        let (x, y) = (dot(axes[0], d), dot(axes[1], d));
        let half_height = if self.dimension == 2 {
            self.half_height
        } else {
            let depth = self.distance() - dot(axes[2], d);
            if depth <= 0.0 {
                return None;
            }
            depth * self.half_angle.tan()
        };
        Some([x / (half_height * aspect), y / half_height])
    }

    /// The point that is seen at `at` (−1..1), in the plane through `through` that faces the camera \[m\].
    pub fn unproject(&self, at: [f64; 2], aspect: f64, through: V3) -> V3 {
        let [right, up, back] = self.axes();
        let forward = dot(back, sub(through, self.target));
        let half_height = self.half_height_at(through);
        let center = add(self.target, scale(back, forward));
        add(
            center,
            add(
                scale(right, at[0] * half_height * aspect),
                scale(up, at[1] * half_height),
            ),
        )
    }

    /// Half of the height that the window shows in the plane through a point \[m\].
    pub fn half_height_at(&self, point: V3) -> f64 {
        if self.dimension == 2 {
            return self.half_height;
        }
        let depth = self.distance() - dot(self.axes()[2], sub(point, self.target));
        depth.max(1e-9) * self.half_angle.tan()
    }

    /// Orbits the target by parts of the window's height.
    pub fn orbit(&mut self, right: f64, up: f64) {
        self.yaw -= right * 4.0;
        self.pitch = (self.pitch + up * -4.0).clamp(-STEEPEST, STEEPEST);
    }

    /// Moves the target against a drag by parts of the window's height.
    pub fn pan(&mut self, right: f64, up: f64) {
        let [x, y, _] = self.axes();
        let by = add(scale(x, right), scale(y, up));
        self.target = sub(self.target, scale(by, 2.0 * self.half_height));
    }

    /// Enlarges by `factor`, and keeps the point that is seen at `at` where it is.
    pub fn zoom(&mut self, factor: f64, at: [f64; 2], aspect: f64) {
        let before = self.unproject(at, aspect, self.target);
        self.half_height = (self.half_height / factor).clamp(1e-4 * self.reach, 20.0 * self.reach);
        let after = self.unproject(at, aspect, self.target);
        self.target = add(self.target, sub(before, after));
    }

    /// The axis of the scene, with its sign, that is nearest to the right of the window.
    pub fn rightward_axis(&self) -> V3 {
        opposite_axis(scale(self.axes()[0], -1.0))
    }
}

/// The axis, with its sign, that is most nearly opposite to `v`; +y if `v` is zero.
pub fn opposite_axis(v: V3) -> V3 {
    let mut axis = 1;
    for i in [0, 2] {
        if v[i].abs() > v[axis].abs() {
            axis = i;
        }
    }
    let mut up = [0.0; 3];
    up[axis] = if v[axis] > 0.0 { -1.0 } else { 1.0 };
    up
}

/// The eight corners of a box. In 2D, pairs of them coincide.
pub fn corners(min: V3, max: V3) -> [V3; 8] {
    core::array::from_fn(|i| {
        core::array::from_fn(|axis| {
            if i >> axis & 1 == 0 {
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

    const DOWN: V3 = [0.0, -9.81, 0.0];

    fn cameras() -> [Camera; 3] {
        [
            Camera::fit(
                2,
                ([0.0; 3], [4.0, 2.0, 0.0]),
                DOWN,
                scene::Camera::default(),
                1.5,
            ),
            Camera::fit(
                3,
                ([0.0; 3], [4.0, 2.0, 1.0]),
                DOWN,
                scene::Camera::default(),
                1.5,
            ),
            Camera::fit(
                3,
                ([-1.0; 3], [4.0, 2.0, 1.0]),
                [0.0, 0.0, -9.81],
                scene::Camera::default(),
                0.7,
            ),
        ]
    }

    #[test]
    fn the_whole_box_is_seen_and_fills_the_window() {
        for (camera, aspect, min, max) in [
            (&cameras()[0], 1.5, [0.0; 3], [4.0, 2.0, 0.0]),
            (&cameras()[1], 1.5, [0.0; 3], [4.0, 2.0, 1.0]),
            (&cameras()[2], 0.7, [-1.0; 3], [4.0, 2.0, 1.0]),
        ] {
            let seen: Vec<_> = corners(min, max)
                .into_iter()
                .map(|corner| camera.project(corner, aspect).unwrap())
                .collect();
            let outermost = seen.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
            assert!(outermost < 1.0 && outermost > 0.85, "{outermost}");
        }
    }

    #[test]
    fn unproject_undoes_project() {
        for camera in cameras() {
            let point = if camera.dimension == 2 {
                [1.2, 0.3, 0.0]
            } else {
                [1.2, 0.3, 0.8]
            };
            let at = camera.project(point, 1.3).unwrap();
            let back = camera.unproject(at, 1.3, point);
            assert!(length(sub(back, point)) < 1e-12, "{back:?}");
        }
    }

    #[test]
    fn matrices_agree_with_project() {
        for camera in cameras() {
            let (origin, point) = ([0.5, 0.25, 0.0], [1.2, 0.3, 0.0]);
            let times = |m: M4, v: [f32; 4]| -> [f32; 4] {
                core::array::from_fn(|row| (0..4).map(|c| m[c][row] * v[c]).sum())
            };
            let p = sub(point, origin).map(|c| c as f32);
            let seen = times(camera.view(origin), [p[0], p[1], p[2], 1.0]);
            let clip = times(camera.projection(1.3), seen);
            let expected = camera.project(point, 1.3).unwrap();
            for i in 0..2 {
                assert!((f64::from(clip[i] / clip[3]) - expected[i]).abs() < 1e-5);
            }
            assert!((0.0..1.0).contains(&(clip[2] / clip[3])));
        }
    }

    #[test]
    fn the_camera_looks_from_the_direction_given() {
        for mut camera in cameras().into_iter().skip(1) {
            let from = normalize([0.3, 0.4, 0.8]);
            camera.look_from(from);
            assert!(length(sub(camera.axes()[2], from)) < 1e-12);
        }
    }

    #[test]
    fn center_height_and_field_of_view_are_those_asked_for() {
        let wanted = scene::Camera {
            center: Some([1.0, 0.5, 0.25]),
            height: Some(0.8),
            field_of_view: Some(60.0),
            ..scene::Camera::default()
        };
        for dimension in [2, 3] {
            let camera = Camera::fit(dimension, ([0.0; 3], [4.0, 2.0, 1.0]), DOWN, wanted, 1.5);
            assert_eq!(camera.project([1.0, 0.5, 0.25], 1.5), Some([0.0, 0.0]));
            assert!((camera.half_height_at(camera.target) - 0.4).abs() < 1e-12);
            let top = add(camera.target, scale(camera.axes()[1], 0.4));
            assert!((camera.project(top, 1.5).unwrap()[1] - 1.0).abs() < 1e-12);
            let away = (camera.project(add(top, camera.axes()[2]), 1.5)).map(|[_, y]| y);
            if dimension == 2 {
                assert!((away.unwrap() - 1.0).abs() < 1e-12);
            } else {
                // 0.4 m up at 0.4/tan 30° = 0.69 m from the eye: a meter nearer is behind it.
                assert_eq!(away, None);
            }
        }
    }

    #[test]
    fn zoom_keeps_the_point_under_the_pointer() {
        for mut camera in cameras() {
            let (at, through) = ([0.4, -0.2], camera.target);
            let before = camera.unproject(at, 1.3, through);
            camera.zoom(1.7, at, 1.3);
            let after = camera.project(before, 1.3).unwrap();
            assert!((after[0] - at[0]).abs() < 1e-9 && (after[1] - at[1]).abs() < 1e-9);
        }
    }

    #[test]
    fn up_is_against_gravity() {
        let [.., camera] = cameras();
        assert_eq!(camera.up, [0.0, 0.0, 1.0]);
        let [right, up, back] = camera.axes();
        assert!(up[2] > 0.0 && right[2] == 0.0);
        assert!((length(cross(right, up)) - 1.0).abs() < 1e-12 && dot(right, back).abs() < 1e-12);
    }
}
