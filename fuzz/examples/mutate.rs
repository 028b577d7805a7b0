//! Runs a reader on changed files of its corpus, on any toolchain. No coverage guides it, but it reads a million files soon.
//!
//!     cargo run --release --manifest-path fuzz/Cargo.toml --example mutate -- csv 1000000
//!
//! Prints the number of files, the time of the slowest, and the largest memory.

use std::time::{Duration, Instant};

struct Random(u64);

impl Random {
    /// Returns a number from 0, included, to `below`, excluded (splitmix64).
    fn below(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as usize % below.max(1)
    }
}

const WORDS: [&[u8]; 16] = [
    b"-1",
    b"0",
    b"1e999",
    b"nan",
    b"99999999999999999999",
    b"\n",
    b",",
    b" ",
    b"\"",
    b"[[",
    b"]]",
    b"=",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"\x7f\xff\xff\xff",
    b"((((",
];

/// Makes one to eight changes to a file: bits, words, parts cut, doubled, or taken from another file.
fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len() + 1);
        let end = at + random.below((bytes.len() - at).min(64) + 1);
        match random.below(6) {
            0 | 1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.splice(at..end, WORDS[random.below(WORDS.len())].iter().copied())),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let part = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, part));
            }
            _ => {
                let from = random.below(other.len() + 1);
                let to = from + random.below((other.len() - from).min(200) + 1);
                drop(bytes.splice(at..end, other[from..to].iter().copied()));
            }
        }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [target, count] = words.as_slice() else {
        panic!("mutate TARGET COUNT")
    };
    let count: u64 = count.parse().expect("a count");
    let folder = format!("{}/corpus/{target}", env!("CARGO_MANIFEST_DIR"));
    let mut paths: Vec<_> = std::fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{folder}: {error}"))
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    let corpus: Vec<Vec<u8>> = paths
        .iter()
        .map(|path| std::fs::read(path).expect("a file"))
        .collect();
    let read: fn(&[u8]) = match target.as_str() {
        "scene" => lahar_scene::fuzzing::scene,
        "expression" => lahar_scene::fuzzing::expression,
        "csv" => lahar_scene::fuzzing::csv,
        "ply" => lahar_scene::fuzzing::ply,
        "npz" => lahar_scene::fuzzing::npz,
        "checkpoint" => lahar_io::fuzzing::checkpoint,
        "state" => lahar_io::fuzzing::state,
        "mesh_stl" => |bytes| lahar_scene::fuzzing::mesh(bytes, "stl"),
        "mesh_obj" => |bytes| lahar_scene::fuzzing::mesh(bytes, "obj"),
        _ => panic!("there is no target {target}"),
    };
    let (mut random, mut slowest) = (Random(1), Duration::ZERO);
    for number in 0..count {
        let mut bytes = corpus[random.below(corpus.len())].clone();
        change(&mut bytes, &corpus[random.below(corpus.len())], &mut random);
        // Every few thousand files, show how far the run has come.
        if number % 4096 == 0 {
            eprint!("\r{target} {number}");
        }
        let start = Instant::now();
        if std::panic::catch_unwind(|| read(&bytes)).is_err() {
            let path = format!("{target}-{number}.crash");
            std::fs::write(&path, &bytes).expect("the file that crashes is kept");
            eprintln!("\n{path}");
            std::process::exit(1);
        }
        slowest = slowest.max(start.elapsed());
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let memory = status
        .lines()
        .find(|line| line.starts_with("VmHWM"))
        .unwrap_or("");
    println!("\n{target}: {count} files, no panic, the slowest {slowest:?}, {memory}");
}
