//! Numbers of particles as bytes, one particle after the other.

use std::io::{self, Write};

use lahar::particles::Shape;
use lahar::{Data, Field};

/// Number of bytes that are collected before they are written.
const CHUNK: usize = 1 << 18;

/// One number of a particle in a file, and its source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    /// The number of the field with this index.
    Of(usize),
    /// The number 0, which fills up 2D fields.
    Zero,
    /// The number 1, which fills up 2D fields.
    One,
}

/// Returns the numbers of a field filled up to three dimensions.
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

/// Returns the numbers of a field in its own dimension.
pub(super) fn as_is(field: Field, dimension: usize) -> Vec<Component> {
    (0..field.info().shape.len(dimension))
        .map(Component::Of)
        .collect()
}

/// A field in a file: its numbers, their count per particle, and the ones that are written.
pub(super) struct Column<'a> {
    pub(super) data: &'a Data,
    pub(super) width: usize,
    pub(super) components: Vec<Component>,
}

impl Column<'_> {
    /// Appends the numbers of one particle, each by the function for its type.
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

/// Functions that append a number as bytes.
pub(super) struct AsBytes {
    pub(super) f32: fn(f32, &mut Vec<u8>),
    pub(super) f64: fn(f64, &mut Vec<u8>),
    pub(super) u32: fn(u32, &mut Vec<u8>),
}

/// Little-endian bytes, as in the memory of most machines.
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
    let mut chunk = Vec::with_capacity(CHUNK + (1 << 10));
    for row in 0..count {
        for column in columns {
            column.push(row, as_bytes, &mut chunk);
        }
        if chunk.len() >= CHUNK {
            writer.write_all(&chunk)?;
            chunk.clear();
        }
    }
    writer.write_all(&chunk)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Component::{Of, One, Zero};

    #[test]
    fn two_dimensions_are_filled_up_to_three() {
        assert_eq!(in_space(Field::Velocity, 2), [Of(0), Of(1), Zero]);
        let corner = |last| [Of(0), Of(1), Zero, Of(2), Of(3), Zero, Zero, Zero, last];
        assert_eq!(in_space(Field::Affine, 2), corner(Zero));
        assert_eq!(in_space(Field::DeformationGradient, 2), corner(One));
        for field in [Field::Velocity, Field::Affine, Field::Mass] {
            assert_eq!(in_space(field, 3), as_is(field, 3));
        }
    }
}
