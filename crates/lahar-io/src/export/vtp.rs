//! `.vtp`: VTK's XML PolyData, with raw numbers appended. Vectors and tensors have 3 and 9 components.
//!
//! ```text
//! <VTKFile ..> ..  <DataArray .. offset="o"/> .. <AppendedData encoding="raw">_ bytes, n bytes | bytes, n bytes | ..
//! ```

use std::io::{self, Write};

use lahar::particles::FIELDS;
use lahar::{Data, Field, Snapshot};

use super::FormatInfo;
use super::mesh::Triangles;
use super::rows::{Column, LITTLE_ENDIAN, in_space, write_rows};

pub(super) const INFO: FormatInfo = FormatInfo {
    name: "vtk",
    ending: "vtp",
    needs_positions: true,
};

pub(super) fn write<W: Write>(mut writer: W, snapshot: &Snapshot) -> io::Result<W> {
    let positions = super::positions(snapshot)?;
    let (n, d) = (snapshot.count, snapshot.dimension);
    let column = |field: Field, data| Column {
        data,
        width: field.info().shape.len(d),
        components: in_space(field, d),
    };
    let mut arrays = Arrays {
        offset: 0,
        count: n as u64,
    };
    let mut columns = vec![column(Field::Position, positions)];
    let points = arrays.of_column("position", &columns[0]);
    let vertices = arrays.whole_numbers("connectivity") + &arrays.whole_numbers("offsets");
    let mut data = String::new();
    for info in FIELDS.iter().filter(|info| info.field != Field::Position) {
        if let Some(numbers) = snapshot.get(info.field) {
            let column = column(info.field, numbers);
            data += &arrays.of_column(info.name, &column);
            columns.push(column);
        }
    }
    let piece = format!(
        r#"<Piece NumberOfPoints="{n}" NumberOfVerts="{n}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
<PointData>
{data}</PointData>
<Points>
{points}</Points>
<Verts>
{vertices}</Verts>
"#
    );
    begin(&mut writer, snapshot.time, &piece)?;
    // The blocks follow in the order of their offsets.
    let mut columns = columns.into_iter();
    let block = |writer: &mut W, column: Column<'_>| {
        writer.write_all(&(n as u64 * row_bytes(&column)).to_le_bytes())?;
        write_rows(writer, n, &[column], &LITTLE_ENDIAN)
    };
    block(&mut writer, columns.next().expect("there are positions"))?;
    // One cell per point: its point 0, 1, .. and its end 1, 2, ..
    for first in [0, 1] {
        writer.write_all(&(n as u64 * WHOLE_NUMBER).to_le_bytes())?;
        for cell in 0..n as u64 {
            writer.write_all(&(first + cell).to_le_bytes())?;
        }
    }
    for column in columns {
        block(&mut writer, column)?;
    }
    writer.write_all(END)?;
    writer.flush()?;
    Ok(writer)
}

/// Writes a mesh with positions in single precision.
pub(super) fn write_triangles(
    writer: &mut impl Write,
    mesh: Triangles<'_>,
    time: f64,
) -> io::Result<()> {
    let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
    let mut arrays = Arrays {
        offset: 0,
        count: vertices as u64,
    };
    let points = arrays.tag("Float32", "position", 3, 3 * SINGLE);
    arrays.count = triangles as u64;
    let polygons = arrays.tag("Int64", "connectivity", 1, 3 * WHOLE_NUMBER)
        + &arrays.tag("Int64", "offsets", 1, WHOLE_NUMBER);
    let piece = format!(
        r#"<Piece NumberOfPoints="{vertices}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{triangles}">
<Points>
{points}</Points>
<Polys>
{polygons}</Polys>
"#
    );
    begin(writer, time, &piece)?;
    writer.write_all(&(vertices as u64 * 3 * SINGLE).to_le_bytes())?;
    for x in mesh.vertices.iter().flatten() {
        writer.write_all(&(*x as f32).to_le_bytes())?;
    }
    writer.write_all(&(triangles as u64 * 3 * WHOLE_NUMBER).to_le_bytes())?;
    for index in mesh.triangles.iter().flatten() {
        writer.write_all(&u64::from(*index).to_le_bytes())?;
    }
    writer.write_all(&(triangles as u64 * WHOLE_NUMBER).to_le_bytes())?;
    for triangle in 1..=triangles as u64 {
        writer.write_all(&(3 * triangle).to_le_bytes())?;
    }
    writer.write_all(END)
}

/// Writes the text before the numbers; `piece` declares the arrays.
fn begin(writer: &mut impl Write, time: f64, piece: &str) -> io::Result<()> {
    write!(
        writer,
        r#"<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<FieldData>
<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time:?}</DataArray>
</FieldData>
{piece}</Piece>
</PolyData>
<AppendedData encoding="raw">
_"#
    )
}

const END: &[u8] = b"\n</AppendedData>\n</VTKFile>\n";

/// Bytes of a `Float32`.
const SINGLE: u64 = 4;

/// Bytes of an `Int64`.
const WHOLE_NUMBER: u64 = 8;

fn number(data: &Data) -> (&'static str, u64) {
    match data {
        Data::F32(_) => ("Float32", 4),
        Data::F64(_) => ("Float64", 8),
        Data::U32(_) => ("UInt32", 4),
    }
}

fn row_bytes(column: &Column<'_>) -> u64 {
    column.components.len() as u64 * number(column.data).1
}

/// Declares arrays and assigns their offsets, one after the other.
struct Arrays {
    offset: u64,
    count: u64,
}

impl Arrays {
    /// Returns the tag of an array with `row_bytes` bytes per particle.
    fn tag(&mut self, kind: &str, name: &str, components: usize, row_bytes: u64) -> String {
        let offset = self.offset;
        self.offset += size_of::<u64>() as u64 + self.count * row_bytes;
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>\n"
        )
    }

    fn of_column(&mut self, name: &str, column: &Column<'_>) -> String {
        let kind = number(column.data).0;
        self.tag(kind, name, column.components.len(), row_bytes(column))
    }

    fn whole_numbers(&mut self, name: &str) -> String {
        self.tag("Int64", name, 1, WHOLE_NUMBER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the bytes of an array by the offset in its tag.
    fn array<'a>(file: &'a [u8], name: &str) -> &'a [u8] {
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let start = file
            .windows(marker.len())
            .position(|window| window == marker)
            .unwrap();
        let text = std::str::from_utf8(&file[..start]).unwrap();
        let tag = text
            .lines()
            .find(|line| line.contains(&format!("Name=\"{name}\"")))
            .unwrap();
        let (_, offset) = tag.split_once("offset=\"").unwrap();
        let offset: usize = offset.split('"').next().unwrap().parse().unwrap();
        let block = &file[start + marker.len() + offset..];
        let length = u64::from_le_bytes(block[..8].try_into().unwrap()) as usize;
        &block[8..8 + length]
    }

    #[test]
    fn arrays_are_where_their_tags_say() {
        let snapshot = Snapshot {
            time: 0.5,
            dimension: 2,
            count: 2,
            columns: vec![
                (Field::Id, Data::U32(vec![3, 9])),
                (Field::Position, Data::F64(vec![1.0, 2.0, 3.0, 4.0])),
                (
                    Field::DeformationGradient,
                    Data::F32((0..8_u8).map(f32::from).collect()),
                ),
            ],
        };
        let file = write(Vec::new(), &snapshot).unwrap();
        let doubles: Vec<f64> = array(&file, "position")
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(doubles, [1.0, 2.0, 0.0, 3.0, 4.0, 0.0]);
        let singles: Vec<f32> = array(&file, "deformation_gradient")
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(singles[..9], [0.0, 1.0, 0.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(array(&file, "id"), [3, 0, 0, 0, 9, 0, 0, 0]);
        let cells = |name| -> Vec<u64> {
            let bytes = array(&file, name).chunks_exact(8);
            bytes
                .map(|b| u64::from_le_bytes(b.try_into().unwrap()))
                .collect()
        };
        assert_eq!(
            (cells("connectivity"), cells("offsets")),
            (vec![0, 1], vec![1, 2])
        );
        assert!(file.ends_with(b"\n</AppendedData>\n</VTKFile>\n"));
    }
}
