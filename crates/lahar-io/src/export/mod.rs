//! Files of particles that other programs open. A format is one file of this folder and one line in the table below.
//!
//! ```text
//! Snapshot ──▶ .npz   NumPy's arrays: everything, as it is in memory
//!              .vtp   VTK's PolyData: 3D vectors and tensors; a .pvd lists the files by time
//!              .ply   vertices with one property per number
//!              .bgeo  Houdini's classic geometry, in single precision
//! ```
//! Formats that know 3D only get 2D snapshots filled up: coordinates and velocities with 0, the deformation gradient
//! with 1 on the diagonal.
//!
//! ```
//! use std::io::Cursor;
//!
//! use lahar::{Data, Field, Snapshot};
//! use lahar_io::export::Format;
//!
//! let snapshot = Snapshot {
//!     time: 0.5,
//!     dimension: 2,
//!     count: 1,
//!     columns: vec![(Field::Position, Data::F64(vec![0.1, 0.2]))],
//! };
//! let file = Format::named("ply").unwrap().write(Cursor::new(Vec::new()), &snapshot)?;
//! assert!(file.into_inner().starts_with(b"ply\n"));
//! # Ok::<(), std::io::Error>(())
//! ```

mod bgeo;
mod mesh;
mod npz;
mod ply;
mod rows;
mod series;
mod vtp;

use serde::{Deserialize, Serialize};
use std::io::{self, Seek, Write};

use lahar::{Data, Field, Snapshot};

pub use mesh::{MeshFormat, Triangles};
pub(crate) use series::TimeSeries;

/// The words and needs of a format of particles; each file of this folder declares its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormatInfo {
    /// Name in `--format` and `output.formats`.
    pub name: &'static str,
    /// Ending of its files, without the dot.
    pub ending: &'static str,
    /// True if its files consist of points, and so need [`Field::Position`].
    pub needs_positions: bool,
}

/// Declares the formats: variant, documentation, and the file of this folder that writes it.
macro_rules! formats {
    ($($(#[$documentation:meta])* $variant:ident = $file:ident,)*) => {
        /// A format of particles.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "&'static str")]
        pub enum Format {
            $($(#[$documentation])* $variant,)*
        }

        impl Format {
            /// Every format, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Returns the words and needs of this format.
            pub fn info(self) -> FormatInfo {
                match self {
                    $(Self::$variant => $file::INFO,)*
                }
            }

            /// Writes the fields that `snapshot` has, in the order of [`FIELDS`](lahar::particles::FIELDS), and its time
            /// \[s\]. Returns the writer, flushed.
            ///
            /// # Errors
            /// If writing fails, or the format needs positions and the snapshot has none.
            pub fn write<W: Write + Seek>(self, writer: W, snapshot: &Snapshot) -> io::Result<W> {
                match self {
                    $(Self::$variant => $file::write(writer, snapshot),)*
                }
            }
        }
    };
}

formats! {
    /// NumPy's archive of arrays.
    Npz = npz,
    /// VTK's XML PolyData.
    Vtk = vtp,
    /// Stanford's polygon format.
    Ply = ply,
    /// Houdini's classic geometry.
    Bgeo = bgeo,
}

impl Format {
    /// Returns the format with this name or with this ending of files.
    pub fn named(name: &str) -> Option<Self> {
        let is_named = |format: &Self| [format.info().name, format.info().ending].contains(&name);
        Self::ALL.iter().copied().find(is_named)
    }
}

impl TryFrom<String> for Format {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::named(&name).ok_or_else(|| format!("there is no format \"{name}\""))
    }
}

impl From<Format> for &'static str {
    fn from(format: Format) -> Self {
        format.info().name
    }
}

/// Returns the positions, which formats of points need.
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
        for &format in Format::ALL {
            let info = format.info();
            assert_eq!(Format::named(info.name), Some(format));
            assert_eq!(Format::named(info.ending), Some(format));
            let word = serde_json::to_string(&format).unwrap();
            assert_eq!(word, format!("\"{}\"", info.name));
            assert_eq!(serde_json::from_str::<Format>(&word).unwrap(), format);
        }
        assert_eq!(Format::named("gif"), None);
        assert!(serde_json::from_str::<Format>("\"gif\"").is_err());
    }

    #[test]
    fn points_need_positions() {
        let snapshot = Snapshot {
            time: 0.0,
            dimension: 2,
            count: 1,
            columns: vec![(Field::Mass, Data::F32(vec![1.0]))],
        };
        for format in Format::ALL {
            let written = format
                .write(io::Cursor::new(Vec::new()), &snapshot)
                .map(drop);
            assert_eq!(written.is_err(), format.info().needs_positions);
        }
    }
}
