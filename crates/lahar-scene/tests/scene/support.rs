//! Helpers that make scenes and read what they build.

use lahar::{Data, Field, Isa, Simulate};
use lahar_scene::scene::Scene;

/// Returns overrides as the command line passes them.
pub(crate) fn overrides(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    let own = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    pairs.iter().map(own).collect()
}

/// Parses a scene that must be good.
#[track_caller]
pub(crate) fn parse(text: &str, pairs: &[(&str, &str)]) -> Scene {
    Scene::parse(text, "a.toml", &overrides(pairs)).unwrap_or_else(|error| panic!("{error}"))
}

/// Builds a scene that must be good, on the portable instruction set.
#[track_caller]
pub(crate) fn build(scene: &Scene) -> Box<dyn Simulate> {
    let built = scene.build(Isa::Portable);
    built.unwrap_or_else(|error| panic!("{error}")).simulation
}

/// Returns the numbers of a field, particle after particle by ascending id.
pub(crate) fn column(simulation: &dyn Simulate, field: Field) -> Vec<f64> {
    let snapshot = simulation.snapshot(&[field]);
    snapshot.get(field).map(Data::to_f64).unwrap_or_default()
}
