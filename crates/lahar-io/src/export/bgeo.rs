//! `.bgeo`: Houdini's classic binary geometry, version 5. Houdini up to 11 wrote it; later versions and Partio read it.
//! All numbers are big-endian and have 32 bits.
//!
//! ```text
//! "Bgeo" 'V' 5 | points primitives point-groups primitive-groups | attributes of points, vertices, primitives, the whole
//! attribute*: length name  size  type  default*size     point*: x y z 1  attribute*     attribute of the whole, its value
//! ```

use std::io::{self, Write};

use lahar::particles::{FIELDS, Shape};
use lahar::{Data, Field, Snapshot};

use super::FormatInfo;
use super::rows::{AsBytes, Column, Component, in_space, write_rows};

const BIG_ENDIAN: AsBytes = AsBytes {
    f32: |x, out| out.extend(x.to_be_bytes()),
    f64: |x, out| out.extend((x as f32).to_be_bytes()),
    // Houdini's whole numbers have a sign; the bits stay the same.
    u32: |x, out| out.extend(x.to_be_bytes()),
};

const FLOAT: i32 = 0;
const INTEGER: i32 = 1;
const VECTOR: i32 = 5;

/// End of a file: no further blocks.
const END: [u8; 2] = [0x00, 0xff];

pub(super) const INFO: FormatInfo = FormatInfo {
    name: "bgeo",
    ending: "bgeo",
    needs_positions: true,
};

pub(super) fn write<W: Write>(mut writer: W, snapshot: &Snapshot) -> io::Result<W> {
    let positions = super::positions(snapshot)?;
    let d = snapshot.dimension;
    let points = i32::try_from(snapshot.count).map_err(|_| {
        io::Error::new(
            io::ErrorKind::InvalidInput,
            "bgeo files hold no more than 2147483647 points",
        )
    })?;
    let mut place = in_space(Field::Position, d);
    place.push(Component::One);
    let mut columns = vec![Column {
        data: positions,
        width: d,
        components: place,
    }];
    let mut names = Vec::new();
    for info in FIELDS.iter().filter(|info| info.field != Field::Position) {
        let Some(data) = snapshot.get(info.field) else {
            continue;
        };
        let components = in_space(info.field, d);
        let kind = match (data, info.shape) {
            (Data::U32(_), _) => INTEGER,
            (_, Shape::Vector) => VECTOR,
            _ => FLOAT,
        };
        attribute(&mut names, name(info.field), components.len(), kind);
        columns.push(Column {
            data,
            width: info.shape.len(d),
            components,
        });
    }
    let mut header = b"BgeoV".to_vec();
    let attributes = i32::try_from(columns.len() - 1).expect("there are few fields");
    for number in [5, points, 0, 0, 0, attributes, 0, 0, 1] {
        header.extend(number.to_be_bytes());
    }
    writer.write_all(&header)?;
    writer.write_all(&names)?;
    write_rows(&mut writer, snapshot.count, &columns, &BIG_ENDIAN)?;
    let mut whole = Vec::new();
    attribute(&mut whole, "time", 1, FLOAT);
    (BIG_ENDIAN.f64)(snapshot.time, &mut whole);
    whole.extend(END);
    writer.write_all(&whole)?;
    writer.flush()?;
    Ok(writer)
}

/// Returns Houdini's name of a field. Houdini moves and blurs points by `v`.
fn name(field: Field) -> &'static str {
    match field {
        Field::Velocity => "v",
        _ => field.info().name,
    }
}

/// Appends the definition of an attribute, with all defaults 0.
fn attribute(out: &mut Vec<u8>, name: &str, size: usize, kind: i32) {
    let short = |number: usize| u16::try_from(number).expect("names and sizes are short");
    out.extend(short(name.len()).to_be_bytes());
    out.extend(name.as_bytes());
    out.extend(short(size).to_be_bytes());
    out.extend(kind.to_be_bytes());
    out.extend([0; size_of::<u32>()].repeat(size));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_as_the_format_says() {
        let snapshot = Snapshot {
            time: 0.5,
            dimension: 2,
            count: 1,
            columns: vec![
                (Field::Position, Data::F64(vec![1.0, -2.0])),
                (Field::Velocity, Data::F32(vec![3.0, 4.0])),
                (Field::Id, Data::U32(vec![258])),
            ],
        };
        let mut wanted = b"BgeoV\0\0\0\x05".to_vec();
        for number in [1_i32, 0, 0, 0, 2, 0, 0, 1] {
            wanted.extend(number.to_be_bytes());
        }
        wanted.extend(b"\0\x01v\0\x03\0\0\0\x05");
        wanted.extend([0; 12]);
        wanted.extend(b"\0\x02id\0\x01\0\0\0\x01");
        wanted.extend([0; 4]);
        for number in [1.0_f32, -2.0, 0.0, 1.0, 3.0, 4.0, 0.0] {
            wanted.extend(number.to_be_bytes());
        }
        wanted.extend([0, 0, 1, 2]);
        wanted.extend(b"\0\x04time\0\x01\0\0\0\0");
        wanted.extend([0; 4]);
        wanted.extend(0.5_f32.to_be_bytes());
        wanted.extend([0x00, 0xff]);
        assert_eq!(write(Vec::new(), &snapshot).unwrap(), wanted);
    }
}
