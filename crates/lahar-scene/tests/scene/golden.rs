//! A few frames of every built-in scene have the recorded bits on the portable instruction set, on every machine and any
//! number of threads.
//!
//! A change of the physics changes the bits. Look at pictures of the scenes, then record the new bits with
//! `LAHAR_UPDATE=1 cargo test -p lahar-scene --test scene golden`.

use std::fmt::Write as _;
use std::path::Path;

use lahar::particles::{Data, Field};
use lahar::{Isa, Simulate};
use lahar_scene::builtin;
use lahar_scene::scene::Scene;

/// Returns the number of frames to run: fewer for the largest scenes.
fn frames(scene: &Scene) -> u32 {
    if scene.expected_particles() > 2e5 {
        1
    } else {
        3
    }
}

/// Returns the FNV-1a hash of the bits of positions, velocities and J.
fn hash(simulation: &dyn Simulate) -> u64 {
    let snapshot = simulation.snapshot(&[Field::Position, Field::Velocity, Field::Jacobian]);
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bits: u64| {
        for byte in bits.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for (_, data) in &snapshot.columns {
        match data {
            Data::F32(values) => values.iter().for_each(|x| add(u64::from(x.to_bits()))),
            Data::F64(values) => values.iter().for_each(|x| add(x.to_bits())),
            Data::U32(values) => values.iter().for_each(|&x| add(u64::from(x))),
        }
    }
    hash
}

#[test]
fn built_in_scenes_keep_their_bits() {
    let mut found = String::new();
    for scene in builtin::list() {
        let plan = Scene::load(scene.name, &[]).expect("a built-in scene is sound");
        let mut simulation = plan.build(Isa::Portable).expect("it builds").simulation;
        for frame in 1..=frames(&plan) {
            simulation
                .advance_to(f64::from(frame) / plan.frame_rate)
                .expect("it runs");
        }
        writeln!(found, "{} {:016x}", scene.name, hash(&*simulation)).expect("writing to a string");
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scene/golden.txt");
    if std::env::var_os("LAHAR_UPDATE").is_some() {
        std::fs::write(&path, &found).expect("the table can be written");
    }
    let expected = std::fs::read_to_string(&path).expect("the table is there");
    assert_eq!(found, expected, "the bits of a scene have changed");
}
