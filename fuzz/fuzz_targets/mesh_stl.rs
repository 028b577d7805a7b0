#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| lahar_scene::fuzzing::mesh(bytes, "stl"));
