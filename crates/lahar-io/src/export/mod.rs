//! Particles of a moment as files that other programs open: one table of formats, a file each.
//!
//! ```text
//! Snapshot ──▶ .npz   NumPy's arrays: everything, as it is in memory
//!              .vtp   VTK's PolyData: 3D vectors and tensors, a .pvd lists them by time
//!              .ply   vertices with a property a number
//!              .bgeo  Houdini's classic geometry: single precision
//! ```
//! What 2D lacks is filled up where a format knows 3D only: coordinates and velocities by 0, the deformation gradient
//! by 1 on the diagonal.

mod bgeo;
mod mesh;
mod ply;
mod rows;
mod series;
mod vtp;

use serde::{Deserialize, Serialize};
use std::io::{self, Seek, Write};

use lahar::particles::{FIELDS, Shape};
use lahar::{Data, Field, Snapshot};

use lahar_scene::npz::{Compression, NpzWriter};

pub use mesh::{MeshFormat, Triangles};
pub(crate) use series::TimeSeries;

/// A format of particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// NumPy's archive of arrays.
    Npz,
    /// VTK's XML PolyData.
    Vtk,
    /// Stanford's polygon format.
    Ply,
    /// Houdini's classic geometry.
    Bgeo,
}

/// One line of the table of formats.
#[derive(Clone, Copy, Debug)]
pub struct FormatInfo {
    /// Which format.
    pub format: Format,
    /// Its name in `--format` and `output.formats`.
    pub name: &'static str,
    /// How its files end, without the dot.
    pub ending: &'static str,
}

/// Every format of particles.
pub const FORMATS: &[FormatInfo] = &[
    line(Format::Npz, "npz", "npz"),
    line(Format::Vtk, "vtk", "vtp"),
    line(Format::Ply, "ply", "ply"),
    line(Format::Bgeo, "bgeo", "bgeo"),
];

const fn line(format: Format, name: &'static str, ending: &'static str) -> FormatInfo {
    FormatInfo {
        format,
        name,
        ending,
    }
}

impl Format {
    /// Its line in [`FORMATS`].
    pub fn info(self) -> &'static FormatInfo {
        FORMATS
            .iter()
            .find(|info| info.format == self)
            .expect("every format is in the table")
    }

    /// The format of that name, or of files that end so.
    pub fn named(name: &str) -> Option<Self> {
        FORMATS
            .iter()
            .find(|info| info.name == name || info.ending == name)
            .map(|info| info.format)
    }

    /// Whether its files are of points, and so cannot do without [`Field::Position`].
    pub fn needs_positions(self) -> bool {
        self != Self::Npz
    }

    /// Writes what fields `snapshot` has, in the order of [`FIELDS`], and `time` \[s\]; gives the writer back, flushed.
    ///
    /// # Errors
    /// If writing fails, or the format needs positions and there are none.
    pub fn write<W: Write + Seek>(self, writer: W, snapshot: &Snapshot) -> io::Result<W> {
        match self {
            Self::Npz => npz(writer, snapshot),
            Self::Vtk => vtp::write(writer, snapshot),
            Self::Ply => ply::write(writer, snapshot),
            Self::Bgeo => bgeo::write(writer, snapshot),
        }
    }
}

fn npz<W: Write + Seek>(writer: W, snapshot: &Snapshot) -> io::Result<W> {
    let (n, d) = (snapshot.count, snapshot.dimension);
    let mut npz = NpzWriter::new(writer, Compression::Stored);
    for info in FIELDS {
        if let Some(data) = snapshot.get(info.field) {
            let shape: &[usize] = match info.shape {
                Shape::Scalar => &[n],
                Shape::Vector => &[n, d],
                Shape::Matrix => &[n, d, d],
            };
            npz.add(info.name, shape, data)?;
        }
    }
    npz.add("time", &[], &Data::F64(vec![snapshot.time]))?;
    npz.finish()
}

/// The positions, which formats of points cannot do without.
fn positions(snapshot: &Snapshot) -> io::Result<&Data> {
    snapshot.get(Field::Position).ok_or_else(|| {
        io::Error::new(
            io::ErrorKind::InvalidInput,
            "there are no positions to write as points",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_found_by_name_and_by_ending() {
        for info in FORMATS {
            assert_eq!(Format::named(info.name), Some(info.format));
            assert_eq!(Format::named(info.ending), Some(info.format));
            assert_eq!(info.format.info().name, info.name);
        }
        assert_eq!(Format::named("gif"), None);
    }

    #[test]
    fn points_need_positions() {
        let snapshot = Snapshot {
            time: 0.0,
            dimension: 2,
            count: 1,
            columns: vec![(Field::Mass, Data::F32(vec![1.0]))],
        };
        for info in FORMATS {
            let written = info
                .format
                .write(io::Cursor::new(Vec::new()), &snapshot)
                .map(drop);
            assert_eq!(written.is_err(), info.format.needs_positions());
        }
    }
}
