//! Closed surfaces of triangles, and the points inside them.
//!
//! A point is inside if a ray from it along +x crosses the surface an odd number of times. A grid of cells
//! on the y-z plane finds the triangles that the ray may meet. Each crossing is decided edge by edge, and
//! an edge decides the same for both of its triangles, so that no ray slips through a seam or counts a
//! corner twice.

use std::collections::BTreeMap;

/// A closed surface of triangles.
///
/// ```
/// use lahar::geometry::Mesh;
///
/// let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let tetrahedron = Mesh::new(vertices, faces)?;
/// assert!(tetrahedron.contains([0.2, 0.2, 0.2]) && !tetrahedron.contains([0.5, 0.5, 0.5]));
/// # Ok::<(), lahar::geometry::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    min: [f64; 3],
    max: [f64; 3],
    /// True if the faces pass every edge as often in one direction as in the other. Parts of such a mesh
    /// may overlap.
    oriented: bool,
    /// Numbers of cells of the grid along y and z.
    size: [usize; 2],
    /// The index in `in_cell` at which each cell's faces begin.
    starts: Vec<u32>,
    /// The faces over each cell, cell by cell.
    in_cell: Vec<u32>,
}

/// The reason why triangles do not enclose a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MeshError {
    /// There is no triangle.
    Empty,
    /// Some edges belong to an odd number of triangles, so the surface has a hole.
    Open {
        /// The number of such edges.
        edges: usize,
        /// The first face with such an edge, counted from 0.
        face: usize,
    },
}

/// If the volume by formula and the volume by counting differ by more than this part, the mesh overlaps
/// itself.
const OVERLAP: f64 = 0.03;

/// Faces per cell of the grid on average.
const FACES_PER_CELL: usize = 2;

impl Mesh {
    /// Makes a mesh of `vertices` \[m\] and triangles, each given by the numbers of its three corners.
    /// Vertices at the same place are joined.
    ///
    /// # Errors
    /// If there is no triangle, or the surface is not closed.
    ///
    /// # Panics
    /// If a face names a vertex that is not there.
    pub fn new(vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let (vertices, faces) = welded(vertices, faces);
        if faces.is_empty() {
            return Err(MeshError::Empty);
        }
        let oriented = check_closed(&faces)?;
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &corner in faces.as_flattened() {
            for i in 0..3 {
                min[i] = min[i].min(vertices[corner as usize][i]);
                max[i] = max[i].max(vertices[corner as usize][i]);
            }
        }
        let edge = ((faces.len() / FACES_PER_CELL) as f64).sqrt() as usize;
        let mut mesh = Self {
            vertices,
            faces,
            min,
            max,
            oriented,
            size: [edge.clamp(1, 2048); 2],
            starts: Vec::new(),
            in_cell: Vec::new(),
        };
        mesh.fill_grid();
        Ok(mesh)
    }

    /// Returns the lower and upper corner of the box around the mesh \[m\].
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        (self.min, self.max)
    }

    /// Iterates over the vertices \[m\].
    pub(super) fn vertices(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.vertices.iter().copied()
    }

    /// Returns the number of triangles.
    pub fn faces(&self) -> usize {
        self.faces.len()
    }

    /// Returns the corners of a face \[m\].
    fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.faces[face as usize].map(|corner| self.vertices[corner as usize])
    }

    /// Returns the cell of the grid that contains a point of the y-z plane.
    fn cell(&self, y: f64, z: f64) -> [usize; 2] {
        let along = |x: f64, axis: usize| {
            let part = (x - self.min[axis]) / (self.max[axis] - self.min[axis]);
            ((part * self.size[axis - 1] as f64) as usize).min(self.size[axis - 1] - 1)
        };
        [along(y, 1), along(z, 2)]
    }

    /// Lists the faces over each cell of the grid.
    fn fill_grid(&mut self) {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for face in 0..self.faces.len() as u32 {
            let corners = self.corners(face);
            let range = |axis: usize| {
                let low = corners
                    .iter()
                    .map(|c| c[axis])
                    .fold(f64::INFINITY, f64::min);
                let high = corners
                    .iter()
                    .map(|c| c[axis])
                    .fold(f64::NEG_INFINITY, f64::max);
                (low, high)
            };
            let ((y0, y1), (z0, z1)) = (range(1), range(2));
            let (low, high) = (self.cell(y0, z0), self.cell(y1, z1));
            for j in low[0]..=high[0] {
                for k in low[1]..=high[1] {
                    pairs.push(((j * self.size[1] + k) as u32, face));
                }
            }
        }
        pairs.sort_unstable();
        self.starts = vec![0; self.size[0] * self.size[1] + 1];
        for (cell, _) in &pairs {
            self.starts[*cell as usize + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        self.in_cell = pairs.into_iter().map(|(_, face)| face).collect();
    }

    /// Returns true if `p` \[m\] is inside.
    pub fn contains(&self, p: [f64; 3]) -> bool {
        if !(0..3).all(|i| self.min[i] <= p[i] && p[i] <= self.max[i]) {
            return false;
        }
        let [j, k] = self.cell(p[1], p[2]);
        let cell = j * self.size[1] + k;
        let (mut winding, mut crossings) = (0_i32, 0_u32);
        for &face in &self.in_cell[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
            if let Some(sign) = crossing(self.corners(face), p) {
                winding += sign;
                crossings += 1;
            }
        }
        if self.oriented {
            winding != 0
        } else {
            crossings % 2 == 1
        }
    }

    /// Returns the volume \[m³\]: the sum of the tetrahedra between the faces and a corner of the bounds.
    /// `None` if that sum is not the volume: if the faces are not oriented alike, or the mesh falls into
    /// several pieces or overlaps itself.
    pub(super) fn exact_volume(&self) -> Option<f64> {
        if !self.oriented {
            return None;
        }
        let sum: f64 = (0..self.faces.len() as u32)
            .map(|face| {
                let [a, b, c] = self
                    .corners(face)
                    .map(|v| -> [f64; 3] { core::array::from_fn(|i| v[i] - self.min[i]) });
                let cross = [
                    b[1] * c[2] - b[2] * c[1],
                    b[2] * c[0] - b[0] * c[2],
                    b[0] * c[1] - b[1] * c[0],
                ];
                (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
            })
            .sum();
        // The sum counts overlapping parts twice, `contains` counts them once.
        let exact = sum.abs();
        let agrees = (exact - self.counted_volume()).abs() < OVERLAP * exact;
        (self.is_one_piece() && agrees).then_some(exact)
    }

    /// Returns the volume counted on a lattice of points \[m³\], to about a percent.
    fn counted_volume(&self) -> f64 {
        const N: usize = 40;
        let side: [f64; 3] = core::array::from_fn(|i| self.max[i] - self.min[i]);
        let inside = (0..N * N * N)
            .filter(|number| {
                let steps = [number % N, number / N % N, number / (N * N)];
                self.contains(core::array::from_fn(|i| {
                    self.min[i] + side[i] * (steps[i] as f64 + 0.5) / N as f64
                }))
            })
            .count();
        side.iter().product::<f64>() * inside as f64 / (N * N * N) as f64
    }

    /// Returns true if all faces are connected by shared vertices.
    fn is_one_piece(&self) -> bool {
        let mut root: Vec<u32> = (0..self.vertices.len() as u32).collect();
        fn find(root: &mut [u32], mut at: u32) -> u32 {
            while root[at as usize] != at {
                root[at as usize] = root[root[at as usize] as usize];
                at = root[at as usize];
            }
            at
        }
        for [a, b, c] in &self.faces {
            for other in [b, c] {
                let (x, y) = (find(&mut root, *a), find(&mut root, *other));
                root[x as usize] = y;
            }
        }
        let first = find(&mut root, self.faces[0][0]);
        let corners = self.faces.as_flattened();
        corners
            .iter()
            .all(|&corner| find(&mut root, corner) == first)
    }
}

/// Joins vertices at the same place and leaves out faces of which two corners are the same.
fn welded(vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut numbers: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut kept = Vec::new();
    let new: Vec<u32> = vertices
        .into_iter()
        .map(|v| {
            // Adding 0.0 turns −0.0 into 0.0.
            *numbers
                .entry(v.map(|x| (x + 0.0).to_bits()))
                .or_insert_with(|| {
                    kept.push(v);
                    kept.len() as u32 - 1
                })
        })
        .collect();
    let faces = faces
        .into_iter()
        .map(|face| face.map(|corner| new[corner as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    (kept, faces)
}

/// Returns true if the faces are oriented alike; an error if an edge has an odd number of faces.
fn check_closed(faces: &[[u32; 3]]) -> Result<bool, MeshError> {
    // (lower corner, higher corner, whether the face passes from low to high, face).
    let mut edges: Vec<(u32, u32, bool, u32)> = Vec::with_capacity(3 * faces.len());
    for (index, face) in faces.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (face[i], face[(i + 1) % 3]);
            edges.push((a.min(b), a.max(b), a < b, index as u32));
        }
    }
    edges.sort_unstable();
    let (mut open, mut first, mut oriented) = (0, u32::MAX, true);
    for same in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if same.len() % 2 == 1 {
            open += 1;
            first = same.iter().map(|edge| edge.3).fold(first, u32::min);
        }
        oriented &= 2 * same.iter().filter(|edge| edge.2).count() == same.len();
    }
    if open > 0 {
        return Err(MeshError::Open {
            edges: open,
            face: first as usize,
        });
    }
    Ok(oriented)
}

/// Returns ±1, by the side that it comes from, if the ray from `p` along +x crosses the triangle.
fn crossing(corners: [[f64; 3]; 3], p: [f64; 3]) -> Option<i32> {
    let mut inside = false;
    for i in 0..3 {
        // The edge starts at its lower end, whichever of its triangles asks.
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let (a, b) = if (a[2], a[1]) < (b[2], b[1]) {
            (a, b)
        } else {
            (b, a)
        };
        if (a[2] > p[2]) != (b[2] > p[2]) {
            let y = a[1] + (b[1] - a[1]) * ((p[2] - a[2]) / (b[2] - a[2]));
            inside ^= p[1] < y;
        }
    }
    if !inside {
        return None;
    }
    let [a, b, c] = corners;
    let (u, v) = ([b[1] - a[1], b[2] - a[2]], [c[1] - a[1], c[2] - a[2]]);
    let area = u[0] * v[1] - u[1] * v[0];
    if area == 0.0 {
        return None;
    }
    let r = [p[1] - a[1], p[2] - a[2]];
    let s = (r[0] * v[1] - r[1] * v[0]) / area;
    let t = (u[0] * r[1] - u[1] * r[0]) / area;
    let x = a[0] + s * (b[0] - a[0]) + t * (c[0] - a[0]);
    (x > p[0]).then_some(if area > 0.0 { 1 } else { -1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vertices and outward faces of a cube.
    fn cube(low: [f64; 3], side: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let vertices = (0..8_u32)
            .map(|n| core::array::from_fn(|i| low[i] + side * f64::from(n >> i & 1)))
            .collect();
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let faces = quads
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .collect();
        (vertices, faces)
    }

    #[test]
    fn a_cube_contains_its_inside() {
        let (vertices, faces) = cube([0.0; 3], 1.0);
        let mesh = Mesh::new(vertices, faces).unwrap();
        assert!(mesh.oriented);
        assert!((mesh.exact_volume().unwrap() - 1.0).abs() < 1e-15);
        // Rays pass through edges, corners and diagonals of faces too.
        for i in 0..9 {
            for j in 0..9 {
                for k in 0..9 {
                    let p = [i, j, k].map(|n| f64::from(n) * 0.25 - 0.5);
                    let inside = p.iter().all(|x| *x > 0.0 && *x < 1.0);
                    let outside = p.iter().any(|x| *x < 0.0 || *x > 1.0);
                    assert!(mesh.contains(p) || !inside, "{p:?}");
                    assert!(!mesh.contains(p) || !outside, "{p:?}");
                }
            }
        }
    }

    #[test]
    fn overlapping_parts_are_one_body() {
        let (mut vertices, mut faces) = cube([0.0; 3], 1.0);
        let (more, others) = cube([0.5; 3], 1.0);
        faces.extend(others.into_iter().map(|face| face.map(|corner| corner + 8)));
        vertices.extend(more);
        let mesh = Mesh::new(vertices, faces).unwrap();
        assert!(mesh.contains([0.75; 3]) && mesh.contains([0.25; 3]) && mesh.contains([1.25; 3]));
        assert!(!mesh.contains([0.25, 0.25, 1.25]));
        assert_eq!(mesh.exact_volume(), None);
    }

    #[test]
    fn faces_may_have_any_orientation() {
        let (vertices, mut faces) = cube([0.0; 3], 1.0);
        for face in faces.iter_mut().step_by(3) {
            face.swap(0, 1);
        }
        let mesh = Mesh::new(vertices.clone(), faces).unwrap();
        assert!(
            !mesh.oriented && mesh.contains([0.3, 0.4, 0.6]) && !mesh.contains([0.3, 0.4, 1.1])
        );
        let (_, mut faces) = cube([0.0; 3], 1.0);
        faces.iter_mut().for_each(|face| face.swap(0, 1));
        let mesh = Mesh::new(vertices, faces).unwrap();
        assert!(mesh.oriented && mesh.contains([0.3, 0.4, 0.6]));
    }

    #[test]
    fn holes_are_found() {
        let (vertices, mut faces) = cube([0.0; 3], 1.0);
        faces.remove(5);
        let error = Mesh::new(vertices, faces).unwrap_err();
        assert!(
            matches!(error, MeshError::Open { edges: 3, .. }),
            "{error:?}"
        );
        assert_eq!(Mesh::new(Vec::new(), Vec::new()), Err(MeshError::Empty));
    }

    /// The part of random points that are inside a ball of many thin triangles is its volume.
    #[test]
    fn the_volume_of_a_round_mesh_is_counted() {
        let (rings, sectors) = (60_u32, 90_u32);
        let mut vertices = Vec::new();
        for ring in 0..=rings {
            let polar = core::f64::consts::PI * f64::from(ring) / f64::from(rings);
            for sector in 0..sectors {
                let angle = core::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
                let flat = if ring == 0 || ring == rings {
                    0.0
                } else {
                    polar.sin()
                };
                vertices.push([flat * angle.cos(), polar.cos(), flat * angle.sin()]);
            }
        }
        let mut faces = Vec::new();
        for ring in 0..rings {
            for sector in 0..sectors {
                let at = |r: u32, s: u32| r * sectors + s % sectors;
                let (a, b) = (at(ring, sector), at(ring, sector + 1));
                let (c, d) = (at(ring + 1, sector), at(ring + 1, sector + 1));
                faces.extend([[a, b, c], [b, d, c]]);
            }
        }
        let mesh = Mesh::new(vertices, faces).unwrap();
        let exact = mesh.exact_volume().unwrap();
        let mut random = crate::geometry::sampling::Random::new(1, 2);
        let inside = (0..200_000)
            .filter(|_| mesh.contains(core::array::from_fn(|_| 2.0 * random.unit() - 1.0)))
            .count();
        let found = 8.0 * inside as f64 / 2e5;
        assert!((found - exact).abs() < 0.02, "{found} {exact}");
        assert!(
            (exact - 4.0 / 3.0 * core::f64::consts::PI).abs() < 0.02,
            "{exact}"
        );
    }
}
