//! Surfaces around particles, made by splashsurf: closed triangle meshes with the volume of the particles.
//!
//! splashsurf sums a kernel over particles, each weighted by the volume that its neighborhood gives it,
//!
//! ```text
//! c(x) = Σ_p W(x − x_p) / Σ_q W(x_p − x_q)
//! ```
//! and places the surface at one value of c. Deep inside c is 1. The value at the surface follows from the spacing of
//! particles: `level` computes it for a half-space of particles on a lattice, whose surface is half a spacing beyond the
//! outermost ones. So a mesh has the volume of its body, for any size and number of particles.

use std::fmt;

use splashsurf_lib::mesh::{Mesh3d, TriMesh3d};
use splashsurf_lib::nalgebra::Vector3;
use splashsurf_lib::postprocessing::par_laplacian_smoothing_inplace;
use splashsurf_lib::{Parameters, reconstruct_surface};

use crate::export::Triangles;

/// Radius of the kernel, in spacings of particles: smaller ones leave holes between scattered particles.
const REACH: f64 = 2.5;

/// Amounts by which two passes of smoothing move vertices towards the middle of their neighbors, and back. The second is
/// a little larger, so that no wave grows and long shapes keep their size (G. Taubin, "A signal processing approach to
/// fair surface design", SIGGRAPH 1995).
const SMOOTH: [f32; 2] = [0.5, -0.53];

/// Resolution and smoothing of surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Edge of the cubes in which the surface is built, in spacings of particles.
    pub cube: f64,
    /// Number of passes of smoothing, each there and back.
    pub smoothing: u32,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            cube: 0.5,
            smoothing: 5,
        }
    }
}

/// A surface: triangles over common vertices, with the front outside.
///
/// ```
/// use lahar_io::surface::{Style, Surface};
///
/// // A block of 4 × 4 × 4 particles, 0.1 m apart.
/// let positions: Vec<[f64; 3]> = (0..64)
///     .map(|i| [i % 4, i / 4 % 4, i / 16].map(|k| 0.1 * f64::from(k)))
///     .collect();
/// let surface = Surface::around(&positions, 1e-3, Style::default()).unwrap();
/// assert!((surface.volume() / 0.064 - 1.0).abs() < 0.1);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Positions \[m\], one per vertex.
    pub vertices: Vec<[f64; 3]>,
    /// Three indices of vertices per triangle, counterclockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// The reason why no surface can be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SurfaceError(String);

impl fmt::Display for SurfaceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no surface can be made: {}", self.0)
    }
}

impl std::error::Error for SurfaceError {}

impl Surface {
    /// Builds the surface around particles at `positions` \[m\], each with the volume `volume` \[m³\] on average. Without
    /// particles the surface is empty.
    ///
    /// # Errors
    /// If the volume or the edge of cubes is not a positive number, or there would be too many cubes.
    pub fn around(positions: &[[f64; 3]], volume: f64, style: Style) -> Result<Self, SurfaceError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(volume) || !positive(style.cube) {
            return Err(SurfaceError(format!(
                "the volume of a particle is {volume} m³ and the edge of cubes {} spacings; both must be above 0",
                style.cube
            )));
        }
        let Some(&origin) = positions.first() else {
            return Ok(Self::default());
        };
        let spacing = volume.cbrt();
        // In spacings, relative to one of the particles, so that single precision is enough anywhere.
        let places: Vec<Vector3<f32>> = positions
            .iter()
            .map(|x| Vector3::from_fn(|i, _| ((x[i] - origin[i]) / spacing) as f32))
            .collect();
        let parameters = Parameters {
            iso_surface_threshold: level(REACH) as f32,
            ..Parameters::new(0.5, REACH as f32, style.cube as f32)
        };
        let mut mesh = reconstruct_surface::<i64, f32>(&places, &parameters)
            .map_err(|error| SurfaceError(error.to_string()))?
            .mesh;
        smooth(&mut mesh, style.smoothing);
        let index = |i: usize| {
            u32::try_from(i).map_err(|_| SurfaceError("it would have over 2³² vertices".to_owned()))
        };
        Ok(Self {
            vertices: mesh
                .vertices
                .iter()
                .map(|v| core::array::from_fn(|i| origin[i] + spacing * f64::from(v[i])))
                .collect(),
            triangles: mesh
                .triangles
                .iter()
                .map(|&[a, b, c]| Ok([index(a)?, index(b)?, index(c)?]))
                .collect::<Result<_, _>>()?,
        })
    }

    /// Returns the triangles for [`MeshFormat::write`](crate::export::MeshFormat::write).
    pub fn as_triangles(&self) -> Triangles<'_> {
        Triangles {
            vertices: &self.vertices,
            triangles: &self.triangles,
        }
    }

    /// Returns the volume inside \[m³\]: the sum of tetrahedra from the first vertex to each triangle.
    pub fn volume(&self) -> f64 {
        let Some(origin) = self.vertices.first() else {
            return 0.0;
        };
        let edge = |i: u32| -> [f64; 3] {
            core::array::from_fn(|axis| self.vertices[i as usize][axis] - origin[axis])
        };
        let determinant = |[a, b, c]: [[f64; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        self.triangles
            .iter()
            .map(|triangle| determinant(triangle.map(edge)) / 6.0)
            .sum()
    }
}

fn smooth(mesh: &mut TriMesh3d<f32>, passes: u32) {
    if passes == 0 {
        return;
    }
    let neighbors = mesh.vertex_vertex_connectivity();
    let weights = vec![1.0; mesh.vertices.len()];
    for _ in 0..passes {
        for amount in SMOOTH {
            par_laplacian_smoothing_inplace(mesh, &neighbors, 1, amount, &weights);
        }
    }
}

/// The cubic spline kernel of reach 2 h, without its constant factor.
fn kernel(distance: f64, reach: f64) -> f64 {
    let q = 2.0 * distance / reach;
    match q {
        ..1.0 => 1.0 - 1.5 * q * q + 0.75 * q * q * q,
        1.0..2.0 => 0.25 * (2.0 - q).powi(3),
        _ => 0.0,
    }
}

/// Returns the mean of c over the plane half a spacing above a half-space of particles with spacing 1.
fn level(reach: f64) -> f64 {
    /// Points along an edge of the lattice over which the mean is taken.
    const POINTS: i32 = 8;
    let depth = reach.ceil() as i32 + 1;
    // The sum of the kernel over one layer of particles, at a height above it.
    let layer = |height: f64, y: f64, z: f64| -> f64 {
        let places = -depth..=depth;
        (places.clone())
            .flat_map(|j| places.clone().map(move |k| (f64::from(j), f64::from(k))))
            .map(|(j, k)| {
                kernel(
                    (height.powi(2) + (j - y).powi(2) + (k - z).powi(2)).sqrt(),
                    reach,
                )
            })
            .sum()
    };
    // Layers lie at the depths 1/2, 3/2, ...
    let sum_at = |i: i32| -> f64 {
        (0..=i + depth)
            .map(|j| layer(f64::from(i - j), 0.0, 0.0))
            .sum()
    };
    let sums: Vec<f64> = (0..depth).map(sum_at).collect();
    let mut mean = 0.0;
    for a in 0..POINTS {
        for b in 0..POINTS {
            let [y, z] = [a, b].map(|i| (f64::from(i) + 0.5) / f64::from(POINTS));
            for (i, sum) in (0..depth).zip(&sums) {
                mean += layer(f64::from(i) + 0.5, y, z) / sum;
            }
        }
    }
    mean / f64::from(POINTS * POINTS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// Particles inside the part of the unit cube that `inside` accepts, `edge` along its edge; `jitter` in spacings.
    fn particles(edge: u32, jitter: f64, inside: impl Fn([f64; 3]) -> bool) -> Vec<[f64; 3]> {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut places = Vec::new();
        for i in 0..edge.pow(3) {
            let cell = [i % edge, i / edge % edge, i / edge.pow(2)];
            let x = cell.map(|c| (f64::from(c) + 0.5 + jitter * random()) / f64::from(edge));
            if inside(x) {
                places.push(x);
            }
        }
        places
    }

    fn volume(edge: u32) -> f64 {
        f64::from(edge).powi(-3)
    }

    /// Every edge is shared by two triangles, which pass it in opposite directions.
    #[track_caller]
    fn assert_closed(surface: &Surface) {
        let mut edges = BTreeMap::<(u32, u32), i32>::new();
        for [a, b, c] in &surface.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((*from, *to)).or_default() += 1;
            }
        }
        assert!(!edges.is_empty());
        for ((from, to), count) in &edges {
            assert_eq!((*count, edges.get(&(*to, *from))), (1, Some(&1)));
        }
    }

    #[test]
    fn boxes_and_balls_keep_their_volume_at_any_number_of_particles() {
        let ball = |x: [f64; 3]| x.iter().map(|x| (x - 0.5).powi(2)).sum::<f64>() < 0.25;
        let flat = |x: [f64; 3]| x[1] < 0.5;
        for edge in [16, 24] {
            for jitter in [0.0, 1.0] {
                for (name, places) in [
                    ("box", particles(edge, jitter, |_| true)),
                    ("half", particles(edge, jitter, flat)),
                    ("ball", particles(edge, jitter, ball)),
                ] {
                    let surface = Surface::around(&places, volume(edge), Style::default()).unwrap();
                    assert_closed(&surface);
                    let expected = places.len() as f64 * volume(edge);
                    let off = surface.volume() / expected - 1.0;
                    assert!(off.abs() < 0.02, "{name}, {edge}, {jitter}: {off}");
                }
            }
        }
    }

    #[test]
    fn size_and_place_do_not_matter() {
        let places = particles(8, 1.0, |_| true);
        let surface = Surface::around(&places, volume(8), Style::default()).unwrap();
        let far = |x: f64| 1e4 + 1e-3 * x;
        let moved: Vec<_> = places.iter().map(|x| x.map(far)).collect();
        let small = Surface::around(&moved, 1e-9 * volume(8), Style::default()).unwrap();
        assert_closed(&small);
        assert!((small.volume() / (1e-9 * surface.volume()) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn nothing_has_no_surface_and_nonsense_is_refused() {
        assert_eq!(
            Surface::around(&[], 1.0, Style::default()),
            Ok(Surface::default())
        );
        assert_eq!(Surface::default().volume(), 0.0);
        for volume in [0.0, -1.0, f64::NAN] {
            assert!(Surface::around(&[[0.0; 3]], volume, Style::default()).is_err());
        }
    }
}
