//! Snapshots: copies of particles by ascending id, whatever the order of storage.

use super::State;
use crate::instance::Instance;
use crate::material;
use crate::parallel;
use crate::particles::{Data, Field, Snapshot};
use crate::particles::{Group, Layout, MOST_COLUMNS};
use crate::setup::check::CheckedSetup;

/// The place of a particle in storage.
#[derive(Clone, Copy)]
struct Place {
    group: u32,
    row: u32,
}

/// The place of an id whose particle has left.
const LEFT: Place = Place {
    group: u32::MAX,
    row: u32::MAX,
};

/// The smallest number of particles that is worth a piece of work of its own.
const SMALLEST_PIECE: usize = 1 << 13;

/// Copies `fields` of all particles.
pub(crate) fn snapshot<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    fields: &[Field],
) -> Snapshot {
    let places = places(state);
    let blocks = match fields.contains(&Field::Position) {
        true => state.groups.iter().map(blocks).collect(),
        false => Vec::new(),
    };
    let mut described = described(state, fields, &places).into_iter();
    let columns = fields
        .iter()
        .map(|&field| {
            let data = match is_described(field) {
                true => T::data(described.next().expect("one for each of these fields")),
                false => column(scene, state, field, &places, &blocks),
            };
            (field, data)
        })
        .collect();
    Snapshot {
        time: state.control.time(),
        dimension: D,
        count: places.len(),
        columns,
    }
}

/// Lists the places of all particles by ascending id. Each id has its slot, so nothing need be sorted.
fn places<T: Instance<D>, const D: usize>(state: &State<T, D>) -> Vec<Place> {
    let mut slots = vec![LEFT; state.next_id as usize];
    let mut count = 0;
    for (index, group) in state.groups.iter().enumerate() {
        count += group.id.len();
        for (row, &id) in group.id.iter().enumerate() {
            slots[id as usize] = Place {
                group: index as u32,
                row: row as u32,
            };
        }
    }
    if count < slots.len() {
        slots.retain(|place| place.group != LEFT.group);
    }
    slots
}

/// Lists the block of each row of a group.
fn blocks<T: Instance<D>, const D: usize>(group: &Group<T, D>) -> Vec<[i32; D]> {
    let mut blocks = Vec::with_capacity(group.id.len());
    for run in &group.runs {
        blocks.resize(run.end as usize, run.block);
    }
    blocks
}

/// Copies a field that is stored as it is.
fn column<T: Instance<D>, const D: usize>(
    scene: &CheckedSetup<D>,
    state: &State<T, D>,
    field: Field,
    places: &[Place],
    blocks: &[Vec<[i32; D]>],
) -> Data {
    let width = field.info().shape.len(D);
    let group = |place: &Place| &state.groups[place.group as usize];
    match field {
        Field::Id => Data::U32(fill(places, width, |place, out| {
            out[0] = group(place).id[place.row as usize];
        })),
        Field::Material => Data::U32(fill(places, width, |place, out| out[0] = place.group)),
        Field::Body => Data::U32(fill(places, width, |place, out| {
            out[0] = group(place).body.get(place.row as usize);
        })),
        Field::Position => Data::F64(fill(places, width, |place, out| {
            let row = place.row as usize;
            let block = blocks[place.group as usize][row];
            out.copy_from_slice(&group(place).position(&scene.lattice, block, row));
        })),
        Field::Velocity => T::data(fill(places, width, |place, out: &mut [T]| {
            let (columns, row) = (&group(place).columns, place.row as usize);
            (0..D).for_each(|axis| out[axis] = columns[Layout::velocity(D) + axis][row]);
        })),
        Field::Affine => T::data(fill(places, width, |place, out: &mut [T]| {
            let (columns, row) = (&group(place).columns, place.row as usize);
            (0..D * D).for_each(|k| out[k] = columns[Layout::affine(D) + k % D * D + k / D][row]);
        })),
        Field::Mass => T::data(fill(places, width, |place, out: &mut [T]| {
            out[0] = group(place).mass.get(place.row as usize);
        })),
        Field::Volume0 => T::data(fill(places, width, |place, out: &mut [T]| {
            out[0] = group(place).volume0.get(place.row as usize);
        })),
        Field::Jacobian | Field::DeformationGradient | Field::Variable(_) | Field::Pressure => {
            unreachable!("these follow from the strain")
        }
    }
}

/// Returns true for a field that follows from the strain by the law of the material.
fn is_described(field: Field) -> bool {
    match field {
        Field::Jacobian | Field::DeformationGradient | Field::Variable(_) | Field::Pressure => true,
        Field::Id
        | Field::Body
        | Field::Material
        | Field::Position
        | Field::Velocity
        | Field::Affine
        | Field::Mass
        | Field::Volume0 => false,
    }
}

/// Computes those of `fields` that follow from the strain, in that order. The law is called once per particle.
fn described<T: Instance<D>, const D: usize>(
    state: &State<T, D>,
    fields: &[Field],
    places: &[Place],
) -> Vec<Vec<T>> {
    let fields: Vec<Field> = fields
        .iter()
        .copied()
        .filter(|f| is_described(*f))
        .collect();
    let width = |field: &Field| field.info().shape.len(D);
    let mut values: Vec<Vec<T>> = (fields.iter())
        .map(|field| vec![T::default(); places.len() * width(field)])
        .collect();
    if fields.is_empty() {
        return values;
    }
    let columns = (fields.iter().zip(&mut values))
        .map(|(field, values)| (*field, values.as_mut_slice()))
        .collect();
    let grain = parallel::grain(places.len(), SMALLEST_PIECE);
    describe_pieces(state, places, columns, grain);
    values
}

/// Computes the fields of all `places`, in halves on all threads down to pieces of `grain` particles.
fn describe_pieces<T: Instance<D>, const D: usize>(
    state: &State<T, D>,
    places: &[Place],
    mut columns: Vec<(Field, &mut [T])>,
    grain: usize,
) {
    if places.len() > grain {
        let half = places.len() / 2;
        let (low, high) = places.split_at(half);
        let (low_columns, high_columns) = (columns.into_iter())
            .map(|(field, values)| {
                let (low, high) = values.split_at_mut(half * field.info().shape.len(D));
                ((field, low), (field, high))
            })
            .unzip();
        parallel::join(
            || describe_pieces(state, low, low_columns, grain),
            || describe_pieces(state, high, high_columns, grain),
        );
        return;
    }
    for (index, place) in places.iter().enumerate() {
        let (group, row) = (&state.groups[place.group as usize], place.row as usize);
        let at = |column: usize| group.columns[column][row].to_f64();
        let mut strain = [0.0; MOST_COLUMNS];
        let strain = &mut strain[..group.law.strain_columns()];
        for (column, value) in strain.iter_mut().enumerate() {
            *value = at(Layout::strain(D) + column);
        }
        let gradient =
            core::array::from_fn(|i| core::array::from_fn(|j| at(Layout::affine(D) + j * D + i)));
        let found = group.law.describe(strain, gradient);
        for (field, values) in &mut columns {
            let width = field.info().shape.len(D);
            let out = &mut values[index * width..][..width];
            match *field {
                Field::Jacobian => out[0] = T::from_f64(found.jacobian),
                Field::Pressure => out[0] = T::from_f64(found.pressure),
                Field::DeformationGradient => (0..D * D).for_each(|k| {
                    out[k] = T::from_f64(found.deformation_gradient[k / D][k % D]);
                }),
                Field::Variable(variable) => {
                    let shown = material::values(variable, group.law.variables(), strain, D);
                    out.iter_mut()
                        .zip(shown)
                        .for_each(|(out, value)| *out = T::from_f64(value));
                }
                Field::Id
                | Field::Body
                | Field::Material
                | Field::Position
                | Field::Velocity
                | Field::Affine
                | Field::Mass
                | Field::Volume0 => unreachable!("these are stored as they are"),
            }
        }
    }
}

/// Fills an array with `width` numbers per place.
fn fill<U: Copy + Default + Send>(
    places: &[Place],
    width: usize,
    write: impl Fn(&Place, &mut [U]) + Sync,
) -> Vec<U> {
    let mut values = vec![U::default(); places.len() * width];
    let grain = parallel::grain(places.len(), SMALLEST_PIECE);
    parallel::for_chunks(&mut values, width, 0, grain, &|first, piece| {
        for (place, out) in places[first..].iter().zip(piece.chunks_exact_mut(width)) {
            write(place, out);
        }
    });
    values
}
