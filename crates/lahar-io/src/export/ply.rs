//! `.ply`: little-endian vertices with one property per number. Scenes read particles by the same names (x, vx, C11,
//! F11, ..), so that a frame can be the start of another run.

use std::io::{self, Write};

use lahar::particles::{FIELDS, Shape};
use lahar::{Data, Field, Snapshot};

use super::FormatInfo;
use super::rows::{Column, LITTLE_ENDIAN, as_is, in_space, write_rows};

pub(super) const INFO: FormatInfo = FormatInfo {
    name: "ply",
    ending: "ply",
    needs_positions: true,
};

pub(super) fn write<W: Write>(mut writer: W, snapshot: &Snapshot) -> io::Result<W> {
    super::positions(snapshot)?;
    let d = snapshot.dimension;
    let mut header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment lahar, time {:?} s\nelement vertex {}\n",
        snapshot.time, snapshot.count
    );
    let mut columns = Vec::new();
    for info in FIELDS {
        let Some(data) = snapshot.get(info.field) else {
            continue;
        };
        let kind = match data {
            Data::F32(_) => "float",
            Data::F64(_) => "double",
            Data::U32(_) => "uint",
        };
        // Points need three coordinates; other fields keep the dimension of the simulation.
        let components = match info.field {
            Field::Position => in_space(info.field, d),
            _ => as_is(info.field, d),
        };
        for k in 0..components.len() {
            header += &format!("property {kind} {}\n", property(info.field, k, d));
        }
        columns.push(Column {
            data,
            width: info.shape.len(d),
            components,
        });
    }
    header += "end_header\n";
    writer.write_all(header.as_bytes())?;
    write_rows(&mut writer, snapshot.count, &columns, &LITTLE_ENDIAN)?;
    writer.flush()?;
    Ok(writer)
}

/// Returns the name of number `k` of a field.
fn property(field: Field, k: usize, dimension: usize) -> String {
    const AXES: [&str; 3] = ["x", "y", "z"];
    let letter = match field {
        Field::Position => "",
        Field::Velocity => "v",
        Field::Affine => "C",
        Field::DeformationGradient => "F",
        _ => field.info().name,
    };
    match field.info().shape {
        Shape::Scalar => letter.to_owned(),
        Shape::Vector => format!("{letter}{}", AXES[k]),
        Shape::Matrix => format!("{letter}{}{}", k / dimension + 1, k % dimension + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lahar_scene::ply::parse_ply;

    #[test]
    fn a_frame_is_a_particle_list() {
        let snapshot = Snapshot {
            time: 0.25,
            dimension: 2,
            count: 2,
            columns: vec![
                (Field::Position, Data::F64(vec![0.1, 0.2, 0.3, 0.4])),
                (Field::Velocity, Data::F32(vec![1.0, 2.0, 3.0, 4.0])),
                (Field::Affine, Data::F32((0..8_u8).map(f32::from).collect())),
                (Field::Jacobian, Data::F32(vec![0.5, 0.75])),
                (Field::Volume0, Data::F32(vec![8.0, 9.0])),
                (Field::Id, Data::U32(vec![7, u32::MAX])),
            ],
        };
        let bytes = write(Vec::new(), &snapshot).unwrap();
        let list = parse_ply::<2>(&bytes, "frame.ply").unwrap();
        assert_eq!(list.position, [[0.1, 0.2], [0.3, 0.4]]);
        assert_eq!(list.velocity, [[1.0, 2.0], [3.0, 4.0]]);
        assert_eq!(
            list.affine,
            [[[0.0, 1.0], [2.0, 3.0]], [[4.0, 5.0], [6.0, 7.0]]]
        );
        assert_eq!(list.volume, [8.0, 9.0]);
        assert!(bytes.ends_with(&u32::MAX.to_le_bytes()));
    }
}
