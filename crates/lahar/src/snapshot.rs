//! Copies of particles for everything outside: rows by ascending id, whatever the order of storage.

use crate::math::Lanes;
use crate::parallel;
use crate::particles::{Data, Field, Snapshot};
use crate::simulation::Simulation;
use crate::store::Layout;

/// Where a particle lies.
#[derive(Clone, Copy)]
struct Place<const D: usize> {
    id: u32,
    group: u32,
    row: u32,
    block: [i32; D],
}

/// Rows that are worth a piece of parallel work of their own.
const SMALLEST_PIECE: usize = 1 << 13;

pub(crate) fn snapshot<T: Lanes, const D: usize>(
    simulation: &Simulation<T, D>,
    fields: &[Field],
) -> Snapshot {
    let mut places: Vec<Place<D>> =
        Vec::with_capacity(simulation.groups.iter().map(|g| g.len()).sum());
    for (index, group) in simulation.groups.iter().enumerate() {
        for run in &group.runs {
            places.extend(run.rows().map(|row| Place {
                id: group.id[row],
                group: index as u32,
                row: row as u32,
                block: run.block,
            }));
        }
    }
    places.sort_unstable_by_key(|place| place.id);
    let columns = fields
        .iter()
        .map(|&field| (field, column(simulation, field, &places)))
        .collect();
    Snapshot {
        time: simulation.control.time(),
        dimension: D,
        count: places.len(),
        columns,
    }
}

fn column<T: Lanes, const D: usize>(
    simulation: &Simulation<T, D>,
    field: Field,
    places: &[Place<D>],
) -> Data {
    let width = field.info().shape.len(D);
    let group = |place: &Place<D>| &simulation.groups[place.group as usize];
    match field {
        Field::Id => Data::U32(places.iter().map(|place| place.id).collect()),
        Field::Material => Data::U32(places.iter().map(|place| place.group).collect()),
        Field::Body => Data::U32(
            places
                .iter()
                .map(|place| group(place).body.get(place.row as usize))
                .collect(),
        ),
        Field::Position => Data::F64(fill(places, width, |place, out| {
            out.copy_from_slice(&simulation.position(
                group(place),
                place.block,
                place.row as usize,
            ));
        })),
        _ => {
            let values = fill(places, width, |place, out: &mut [T]| {
                let (group, row) = (group(place), place.row as usize);
                let at = |column: usize| group.columns[column][row];
                match field {
                    Field::Velocity => {
                        (0..D).for_each(|axis| out[axis] = at(Layout::velocity(D) + axis))
                    }
                    Field::Affine => {
                        (0..D * D).for_each(|k| out[k] = at(Layout::affine(D) + k % D * D + k / D));
                    }
                    Field::Mass => out[0] = group.mass.get(row),
                    Field::Volume0 => out[0] = group.volume0.get(row),
                    _ => {
                        let mut strain = [0.0; 16];
                        let strain = &mut strain[..group.law.strain_columns()];
                        for (column, value) in strain.iter_mut().enumerate() {
                            *value = at(Layout::strain(D) + column).to_f64();
                        }
                        let gradient = core::array::from_fn(|i| {
                            core::array::from_fn(|j| at(Layout::affine(D) + j * D + i).to_f64())
                        });
                        let state = group.law.describe(strain, gradient);
                        match field {
                            Field::Jacobian => out[0] = T::from_f64(state.jacobian),
                            Field::PlasticJacobian => out[0] = T::from_f64(state.plastic_jacobian),
                            Field::Pressure => out[0] = T::from_f64(state.pressure),
                            _ => (0..D * D).for_each(|k| {
                                out[k] = T::from_f64(state.deformation_gradient[k / D][k % D])
                            }),
                        }
                    }
                }
            });
            T::data(values)
        }
    }
}

/// `width` numbers a place, side by side.
fn fill<U: Copy + Default + Send, const D: usize>(
    places: &[Place<D>],
    width: usize,
    write: impl Fn(&Place<D>, &mut [U]) + Sync,
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
