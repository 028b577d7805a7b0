//! Numbers of particles as bytes, row by row or column by column.

use std::io::{self, Write};

use lahar::particles::Shape;
use lahar::{Data, Field};

/// Bytes are handed on in pieces of about this size.
const PIECE: usize = 1 << 18;

/// One number of a particle in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    /// This one of the field's.
    Of(usize),
    /// 0, which 2D lacks.
    Zero,
    /// 1, which 2D lacks.
    One,
}

/// The numbers of a field in three dimensions.
pub(super) fn in_space(field: Field, dimension: usize) -> Vec<Component> {
    let inside = |axis: usize| axis < dimension;
    match field.info().shape {
        Shape::Scalar => vec![Component::Of(0)],
        Shape::Vector => (0..3)
            .map(|i| match inside(i) {
                true => Component::Of(i),
                false => Component::Zero,
            })
            .collect(),
        Shape::Matrix => (0..9)
            .map(|k| match (k / 3, k % 3) {
                (i, j) if inside(i) && inside(j) => Component::Of(i * dimension + j),
                (i, j) if i == j && field == Field::DeformationGradient => Component::One,
                _ => Component::Zero,
            })
            .collect(),
    }
}

/// The numbers of a field as they are.
pub(super) fn as_is(field: Field, dimension: usize) -> Vec<Component> {
    (0..field.info().shape.len(dimension))
        .map(Component::Of)
        .collect()
}

/// A field in a file: its numbers, how many a particle has of them in memory, and which are written.
pub(super) struct Column<'a> {
    pub(super) data: &'a Data,
    pub(super) width: usize,
    pub(super) components: Vec<Component>,
}

impl Column<'_> {
    /// Its numbers of one particle, each by the function for its type.
    fn push(&self, row: usize, as_bytes: &AsBytes, out: &mut Vec<u8>) {
        for component in &self.components {
            let at = |k: &usize| row * self.width + k;
            match (self.data, component) {
                (Data::F32(v), Component::Of(k)) => (as_bytes.f32)(v[at(k)], out),
                (Data::F64(v), Component::Of(k)) => (as_bytes.f64)(v[at(k)], out),
                (Data::U32(v), Component::Of(k)) => (as_bytes.u32)(v[at(k)], out),
                (Data::F32(_), filled) => (as_bytes.f32)(f32::from(*filled == Component::One), out),
                (Data::F64(_), filled) => (as_bytes.f64)(f64::from(*filled == Component::One), out),
                (Data::U32(_), filled) => (as_bytes.u32)(u32::from(*filled == Component::One), out),
            }
        }
    }
}

/// How numbers become bytes.
pub(super) struct AsBytes {
    pub(super) f32: fn(f32, &mut Vec<u8>),
    pub(super) f64: fn(f64, &mut Vec<u8>),
    pub(super) u32: fn(u32, &mut Vec<u8>),
}

/// As they are in the memory of most machines.
pub(super) const LITTLE_ENDIAN: AsBytes = AsBytes {
    f32: |x, out| out.extend(x.to_le_bytes()),
    f64: |x, out| out.extend(x.to_le_bytes()),
    u32: |x, out| out.extend(x.to_le_bytes()),
};

/// Writes `count` particles, one after the other, each with all `columns`.
pub(super) fn write_rows(
    writer: &mut impl Write,
    count: usize,
    columns: &[Column<'_>],
    as_bytes: &AsBytes,
) -> io::Result<()> {
    let mut piece = Vec::with_capacity(PIECE + (1 << 10));
    for row in 0..count {
        for column in columns {
            column.push(row, as_bytes, &mut piece);
        }
        if piece.len() >= PIECE {
            writer.write_all(&piece)?;
            piece.clear();
        }
    }
    writer.write_all(&piece)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Component::{Of, One, Zero};

    #[test]
    fn what_2d_lacks_is_filled_up() {
        assert_eq!(in_space(Field::Velocity, 2), [Of(0), Of(1), Zero]);
        let corner = |last| [Of(0), Of(1), Zero, Of(2), Of(3), Zero, Zero, Zero, last];
        assert_eq!(in_space(Field::Affine, 2), corner(Zero));
        assert_eq!(in_space(Field::DeformationGradient, 2), corner(One));
        for field in [Field::Velocity, Field::Affine, Field::Mass] {
            assert_eq!(in_space(field, 3), as_is(field, 3));
        }
    }
}
