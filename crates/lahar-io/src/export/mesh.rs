//! Files of triangle meshes, in single precision: programs that draw use no more.

use std::io::{self, Write};

use super::vtp;

/// Triangles over common vertices, counterclockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a> {
    /// Positions \[m\], one per vertex.
    pub vertices: &'a [[f64; 3]],
    /// Three indices of vertices per triangle.
    pub triangles: &'a [[u32; 3]],
}

/// A format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Stanford's polygon format, little-endian.
    Ply,
    /// Wavefront's text format.
    Obj,
    /// VTK's XML PolyData.
    Vtk,
}

impl MeshFormat {
    /// Every format of meshes.
    pub const ALL: [Self; 3] = [Self::Ply, Self::Obj, Self::Vtk];

    /// Returns the name of this format in `--format`, and the ending of its files.
    const fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Ply => ("ply", "ply"),
            Self::Obj => ("obj", "obj"),
            Self::Vtk => ("vtk", "vtp"),
        }
    }

    /// Returns the name of this format in `--format`.
    pub fn name(self) -> &'static str {
        self.words().0
    }

    /// Returns the ending of its files, without the dot.
    pub fn ending(self) -> &'static str {
        self.words().1
    }

    /// Returns the format with this name or with this ending of files.
    pub fn named(name: &str) -> Option<Self> {
        (Self::ALL.into_iter()).find(|format| [format.name(), format.ending()].contains(&name))
    }

    /// Writes a mesh of the time `time` \[s\]. Returns the writer, flushed.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write<W: Write>(self, mut writer: W, mesh: Triangles<'_>, time: f64) -> io::Result<W> {
        match self {
            Self::Ply => ply(&mut writer, mesh, time)?,
            Self::Obj => obj(&mut writer, mesh, time)?,
            Self::Vtk => vtp::write_triangles(&mut writer, mesh, time)?,
        }
        writer.flush()?;
        Ok(writer)
    }
}

fn ply(writer: &mut impl Write, mesh: Triangles<'_>, time: f64) -> io::Result<()> {
    write!(
        writer,
        "ply\nformat binary_little_endian 1.0\ncomment lahar, time {time:?} s\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices.len(),
        mesh.triangles.len()
    )?;
    for x in mesh.vertices.iter().flatten() {
        writer.write_all(&(*x as f32).to_le_bytes())?;
    }
    for triangle in mesh.triangles {
        writer.write_all(&[3])?;
        for index in triangle {
            writer.write_all(&index.to_le_bytes())?;
        }
    }
    Ok(())
}

fn obj(writer: &mut impl Write, mesh: Triangles<'_>, time: f64) -> io::Result<()> {
    writeln!(writer, "# lahar, time {time:?} s")?;
    for [x, y, z] in mesh.vertices {
        writeln!(writer, "v {} {} {}", *x as f32, *y as f32, *z as f32)?;
    }
    for [a, b, c] in mesh.triangles {
        // Indices count from 1; in u64, so that the last u32 has a successor.
        let [a, b, c] = [a, b, c].map(|i| u64::from(*i) + 1);
        writeln!(writer, "f {a} {b} {c}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: Triangles<'_> = Triangles {
        vertices: &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 0.5, 0.0],
            [0.0, 0.0, 0.1],
        ],
        triangles: &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    };

    #[test]
    fn an_obj_is_lines_of_vertices_and_faces() {
        let text = MeshFormat::Obj.write(Vec::new(), TETRAHEDRON, 0.5).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "# lahar, time 0.5 s\nv 0 0 0\nv 1 0 0\nv 0 0.5 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        );
    }

    #[test]
    fn a_ply_holds_every_number() {
        let bytes = MeshFormat::Ply.write(Vec::new(), TETRAHEDRON, 0.5).unwrap();
        let marker = b"end_header\n";
        let start = bytes
            .windows(marker.len())
            .position(|window| window == marker)
            .unwrap();
        let body = &bytes[start + marker.len()..];
        assert_eq!(body.len(), 4 * 12 + 4 * 13);
        assert_eq!(body[4 * 11..4 * 12], 0.1_f32.to_le_bytes());
        assert_eq!(
            body[4 * 12..][..13],
            [3, 0, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0]
        );
    }
}
