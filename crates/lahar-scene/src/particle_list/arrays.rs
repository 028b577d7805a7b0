//! Particle lists from NumPy's `.npz` archives.

use super::{ParticleList, known_variables};
use crate::error::SceneError;
use crate::npz::{NpzArray, read_from};
use lahar::StartingValues;
use lahar::math::Shape;
use std::io::{BufReader, Read, Seek};

/// Reads an `.npz` archive with the arrays of a run's frames: `position`, and optionally `velocity`,
/// `volume0` or `volume`, `mass`, `J`, `deformation_gradient` (which replaces `J`), `affine`, and variables of
/// models such as `plastic_J`; other arrays are skipped. The arrays may take `limit` bytes together. `name` is the file's, for messages.
///
/// # Errors
/// The array that is missing, has another shape, or has a value that particles cannot have.
pub(crate) fn read_npz<const D: usize>(
    name: &str,
    content: impl Read + Seek,
    limit: u64,
) -> Result<ParticleList<D>, SceneError> {
    let fail = |message: String| SceneError::of_file(name, message);
    let arrays =
        read_from(BufReader::new(content), limit).map_err(|(array, what)| match array {
            Some(array) => fail(format!("array \"{array}\": {what}")),
            None => fail(what),
        })?;
    from_arrays(&arrays).map_err(fail)
}

/// Makes a list of the arrays of a frame.
///
/// # Errors
/// The array that is missing, has another shape, or has a value that particles cannot have.
pub(crate) fn from_arrays<const D: usize>(arrays: &[NpzArray]) -> Result<ParticleList<D>, String> {
    let Some(position) = arrays.iter().find(|array| array.name == "position") else {
        let names: Vec<&str> = arrays.iter().map(|array| array.name.as_str()).collect();
        return Err(format!(
            "there is no array \"position\", only: {}",
            names.join(", ")
        ));
    };
    let count = position.shape.first().copied().unwrap_or(0);
    let numbers = |name: &str, shape: &[usize], positive: bool| {
        numbers_of(arrays, name, (count, shape), positive)
    };
    let vectors = |name: &str| -> Result<Vec<[f64; D]>, String> {
        let values = numbers(name, &[D], false)?.unwrap_or_default();
        Ok(values
            .chunks_exact(D)
            .map(|row| core::array::from_fn(|i| row[i]))
            .collect())
    };
    let matrices = |name: &str| -> Result<Vec<[[f64; D]; D]>, String> {
        let values = numbers(name, &[D, D], false)?.unwrap_or_default();
        Ok(values
            .chunks_exact(D * D)
            .map(|row| core::array::from_fn(|i| core::array::from_fn(|j| row[i * D + j])))
            .collect())
    };
    let deformation_gradient = matrices("deformation_gradient")?;
    Ok(ParticleList {
        position: vectors("position")?,
        velocity: vectors("velocity")?,
        volume: match numbers("volume0", &[], true)? {
            Some(volume) => volume,
            None => numbers("volume", &[], true)?.unwrap_or_default(),
        },
        mass: numbers("mass", &[], true)?.unwrap_or_default(),
        jacobian: if deformation_gradient.is_empty() {
            numbers("J", &[], true)?.unwrap_or_default()
        } else {
            Vec::new()
        },
        affine: matrices("affine")?,
        deformation_gradient,
        variables: known_variables()
            .filter_map(|variable| {
                let shape: &[usize] = match variable.shape {
                    Shape::Scalar => &[],
                    Shape::Vector => &[D],
                    Shape::Matrix => &[D, D],
                };
                let values = numbers(variable.name, shape, variable.is_positive()).transpose()?;
                let name = variable.name.to_owned();
                Some(values.map(|values| StartingValues { name, values }))
            })
            .collect::<Result<_, _>>()?,
        warnings: Vec::new(),
    })
}

/// Returns the numbers of the array `name`, which must have this shape per particle; `None` if there is no such array.
fn numbers_of(
    arrays: &[NpzArray],
    name: &str,
    (count, shape): (usize, &[usize]),
    positive: bool,
) -> Result<Option<Vec<f64>>, String> {
    let Some(array) = arrays.iter().find(|array| array.name == name) else {
        return Ok(None);
    };
    let wanted: Vec<usize> = core::iter::once(count)
        .chain(shape.iter().copied())
        .collect();
    if array.shape != wanted {
        return Err(format!(
            "array \"{name}\" has shape {:?}; {wanted:?} is needed",
            array.shape
        ));
    }
    let values = array.data.to_f64();
    let width = shape.iter().product::<usize>().max(1);
    match values
        .iter()
        .position(|value| !value.is_finite() || (positive && *value <= 0.0))
    {
        Some(at) => Err(format!(
            "array \"{name}\": {} is no value for a particle (row {})",
            values[at],
            at / width
        )),
        None => Ok(Some(values)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_become_a_list() {
        let array = |name: &str, shape: &[usize], data: Vec<f64>| NpzArray {
            name: name.to_owned(),
            shape: shape.to_vec(),
            data: lahar::Data::F64(data),
        };
        let arrays = [
            array("position", &[2, 2], vec![1.0, 2.0, 3.0, 4.0]),
            array("volume0", &[2], vec![0.1, 0.2]),
            array("affine", &[2, 2, 2], (0..8).map(f64::from).collect()),
            array("plastic_J", &[2], vec![0.8, 1.0]),
            array("time", &[], vec![0.5]),
        ];
        let list = from_arrays::<2>(&arrays).unwrap();
        assert_eq!(list.position, [[1.0, 2.0], [3.0, 4.0]]);
        assert_eq!(list.volume, [0.1, 0.2]);
        assert_eq!(list.affine[1], [[4.0, 5.0], [6.0, 7.0]]);
        assert!(list.velocity.is_empty() && list.jacobian.is_empty());
        assert_eq!(list.variables.len(), 1);
        assert_eq!(list.variables[0].name, "plastic_J");
        assert_eq!(list.variables[0].values, [0.8, 1.0]);
        assert!(
            from_arrays::<3>(&arrays)
                .unwrap_err()
                .contains("[2, 3] is needed")
        );
        assert!(
            from_arrays::<2>(&arrays[1..])
                .unwrap_err()
                .contains("no array \"position\"")
        );
        let bad = [array("position", &[1, 2], vec![0.0, f64::NAN])];
        assert!(from_arrays::<2>(&bad).unwrap_err().contains("NaN"));
    }
}
