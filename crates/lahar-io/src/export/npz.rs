//! `.npz`: NumPy's archive of arrays, one per field, and `time`. It holds everything as it is in memory.

use std::io::{self, Seek, Write};

use lahar::particles::{FIELDS, Shape};
use lahar::{Data, Snapshot};
use lahar_scene::npz::{Compression, NpzWriter};

use super::FormatInfo;

pub(super) const INFO: FormatInfo = FormatInfo {
    name: "npz",
    ending: "npz",
    needs_positions: false,
};

pub(super) fn write<W: Write + Seek>(writer: W, snapshot: &Snapshot) -> io::Result<W> {
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
