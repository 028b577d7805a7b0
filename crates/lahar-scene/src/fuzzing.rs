//! The readers of files from users, as the targets in fuzz/ call them: bytes in, nothing out. A target fails by a
//! panic, a hang or too much memory.

use lahar::Isa;

use crate::expression::Expression;
use crate::scene::{Limits, Scene};
use crate::{mesh_file, particle_list, ply};

/// Memory that a scene may ask for \[bytes\]: enough for some thousand particles, which take under a second.
const MEMORY: u64 = 1 << 20;

/// Reads a scene file, and builds it if it is sound and small.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else {
        return;
    };
    if let Ok(scene) = Scene::parse_within(text, "fuzz.toml", &[], &Limits { memory: MEMORY }) {
        drop(scene.resolved());
        drop(scene.summary());
        drop(scene.build(Isa::Portable));
    }
}

/// Reads a formula, and evaluates it.
pub fn expression(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else {
        return;
    };
    if let Ok(formula) = Expression::parse(text, &["x", "y", "z", "t"]) {
        let mut out = [0.0; 100];
        formula.evaluate(&mut out, |variable, start, values| {
            for (index, value) in values.iter_mut().enumerate() {
                *value = (start + index) as f64 - 10.0 * variable as f64;
            }
        });
    }
}

/// Reads a particle list from text.
pub fn csv(bytes: &[u8]) {
    if let Ok(text) = core::str::from_utf8(bytes) {
        drop(particle_list::parse_csv::<2>(text, "fuzz.csv"));
        drop(particle_list::parse_csv::<3>(text, "fuzz.csv"));
    }
}

/// Reads a particle list from PLY.
pub fn ply(bytes: &[u8]) {
    drop(ply::parse_ply::<2>(bytes, "fuzz.ply"));
    drop(ply::parse_ply::<3>(bytes, "fuzz.ply"));
}

/// Reads NumPy's archives and single arrays, and makes particle lists of them.
#[cfg(feature = "npz")]
pub fn npz(bytes: &[u8]) {
    use crate::npz;
    use std::io::Cursor;

    drop(npz::read_array_from(bytes));
    if let Ok(arrays) = npz::read_from(Cursor::new(bytes), MEMORY) {
        drop(particle_list::from_arrays::<2>(&arrays));
        drop(particle_list::from_arrays::<3>(&arrays));
    }
}

/// Reads a mesh, and tests points against it if it is closed.
pub fn mesh(bytes: &[u8], ending: &str) {
    if let Ok(mesh) = mesh_file::parse_mesh(bytes, &format!("fuzz.{ending}")) {
        let (low, high) = mesh.bounds();
        for part in [0.1, 0.5, 0.77] {
            mesh.contains(core::array::from_fn(|axis| {
                low[axis] + part * (high[axis] - low[axis])
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn no_bytes_make_a_reader_panic() {
        proptest!(ProptestConfig::with_cases(200), |(
            bytes in proptest::collection::vec(any::<u8>(), 0..200)
        )| {
            for reader in [scene, expression, csv, ply] {
                reader(&bytes);
            }
            #[cfg(feature = "npz")]
            npz(&bytes);
            mesh(&bytes, "stl");
            mesh(&bytes, "obj");
        });
    }
}
