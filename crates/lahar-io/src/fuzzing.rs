//! The readers of checkpoints as the targets in fuzz/ call them. A target fails by a panic, a hang or too much memory.

use std::cell::RefCell;

use lahar::checkpoint::Values;
use lahar::particles::FIELDS;
use lahar::{Checkpoint, Isa, Simulate};
use lahar_scene::scene::Scene;

use crate::checkpoint::{self, Checksums};

/// Reads `bytes` as the file of a checkpoint, and resumes a simulation from it. The length and the checksums are taken as
/// right, since nearly all altered files would stop there.
pub fn checkpoint(bytes: &[u8]) {
    drop(checkpoint::read(bytes, bytes.len() as u64));
    let mut bytes = bytes.to_vec();
    let length = (bytes.len() as u64).to_le_bytes();
    if let Some(stated) = bytes.get_mut(checkpoint::LENGTH_AT) {
        stated.copy_from_slice(&length);
    }
    let read = checkpoint::read_with(&*bytes, bytes.len() as u64, Checksums::Ignored);
    if let Ok((_, checkpoint)) = read {
        resume_from(checkpoint);
    }
}

/// A scene with few particles, walls, a force that depends on starting positions, and a gauge.
const SMALL: &str = r#"
dx = 0.1
gravity = [0.0, -9.81]
[domain]
min = [0.0, 0.0]
max = [1.0, 1.0]
[materials.water]
preset = "water"
sound_speed = 10.0
[materials.snow]
preset = "snow"
[[bodies]]
material = "water"
shape = { box = { min = [0.0, 0.0], max = [0.4, 0.3] } }
[[bodies]]
material = "snow"
shape = { ball = { center = [0.7, 0.5], radius = 0.1 } }
[[forces]]
acceleration = ["X - x", "0"]
[[probes]]
name = "wall"
pressure = { at = [1.0, 0.1] }
"#;

thread_local! {
    /// The small scene after some substeps, and a checkpoint of it.
    static GOOD: (RefCell<Box<dyn Simulate>>, Checkpoint) = {
        let scene = Scene::parse(SMALL, "small.toml", &[]).expect("the small scene is sound");
        let mut simulation = (scene.build(Isa::Portable)).expect("it can be built").simulation;
        simulation.advance_to(0.05).expect("it runs");
        let checkpoint = simulation.checkpoint();
        (RefCell::new(simulation), checkpoint)
    };
}

/// Resumes the small scene. If it accepts the checkpoint, it must give snapshots and diagnostics and take substeps.
fn resume_from(checkpoint: Checkpoint) {
    GOOD.with(|(simulation, _)| {
        let mut simulation = simulation.borrow_mut();
        if simulation.resume(checkpoint).is_ok() {
            let fields = FIELDS.iter().map(|info| info.field);
            drop(simulation.snapshot(&fields.collect::<Vec<_>>()));
            simulation.diagnostics();
            for _ in 0..3 {
                if simulation.substep().is_err() {
                    break;
                }
            }
        }
    });
}

/// Alters arrays of a good checkpoint and resumes from it. `bytes` are the changes: array, number, new value.
pub fn state(bytes: &[u8]) {
    let mut checkpoint = GOOD.with(|(_, checkpoint)| checkpoint.clone());
    for change in bytes.as_chunks::<12>().0.iter().take(8) {
        let [array, number, shift, kind, value @ ..] = *change;
        let arrays = checkpoint.arrays.len();
        let array = &mut checkpoint.arrays[usize::from(array) % arrays];
        let length = array.values.len().max(1);
        let at = (usize::from(number) << (shift % 4)) % length;
        let bits = u64::from_le_bytes(value);
        match kind % 4 {
            0 => array.shape = vec![usize::from(number), bits as usize],
            1 => truncate(&mut array.values, at),
            _ => set(&mut array.values, at, bits),
        }
    }
    resume_from(checkpoint);
}

fn truncate(values: &mut Values, length: usize) {
    match values {
        Values::F32(values) => values.truncate(length),
        Values::F64(values) => values.truncate(length),
        Values::U32(values) => values.truncate(length),
        Values::I32(values) => values.truncate(length),
        Values::U64(values) => values.truncate(length),
    }
}

fn set(values: &mut Values, at: usize, bits: u64) {
    fn put<T>(values: &mut [T], at: usize, value: T) {
        if let Some(old) = values.get_mut(at) {
            *old = value;
        }
    }
    match values {
        Values::F32(values) => put(values, at, f32::from_bits(bits as u32)),
        Values::F64(values) => put(values, at, f64::from_bits(bits)),
        Values::U32(values) => put(values, at, bits as u32),
        Values::I32(values) => put(values, at, bits as i32),
        Values::U64(values) => put(values, at, bits),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An unchanged checkpoint, and random changes.
    #[test]
    fn no_state_makes_a_simulation_panic() {
        state(&[]);
        proptest!(ProptestConfig::with_cases(300), |(
            bytes in proptest::collection::vec(any::<u8>(), 0..96)
        )| state(&bytes));
    }

    #[test]
    fn no_bytes_make_the_reader_panic() {
        proptest!(ProptestConfig::with_cases(200), |(
            bytes in proptest::collection::vec(any::<u8>(), 0..200)
        )| checkpoint(&bytes));
    }
}
