//! Scenes that follow other programs number by number, compared with those programs on the same particles.
//!
//! tests/peers/make_tables.py ran the programs and wrote lineage.csv.

use lahar::{Data, Field, Isa};
use lahar_scene::scene::Scene;

/// Returns the rows of the table: scene, substep, figures.
fn table() -> Vec<(&'static str, u64, Vec<f64>)> {
    let text = include_str!("lineage.csv");
    let rows = text.lines().filter(|line| !line.starts_with(['#', 's']));
    rows.map(|line| {
        let mut words = line.split(',');
        let scene = words.next().unwrap();
        let step = words.next().unwrap().parse().unwrap();
        let figures = words.map(|word| word.parse().unwrap()).collect();
        (scene, step, figures)
    })
    .collect()
}

/// Returns the figures of a state in the order of the table.
fn figures(simulation: &dyn lahar::Simulate) -> Vec<f64> {
    let snapshot = simulation.snapshot(&[Field::Position, Field::Velocity, Field::Jacobian]);
    let column = |field| snapshot.get(field).map(Data::to_f64).unwrap();
    let (x, v, j) = (
        column(Field::Position),
        column(Field::Velocity),
        column(Field::Jacobian),
    );
    let d = simulation.dimension();
    let mut found: Vec<f64> = (1..=4)
        .map(|power| x.iter().map(|x| x.powi(power)).sum::<f64>() / x.len() as f64)
        .collect();
    for axis in 0..3 {
        let along = x.iter().skip(axis).step_by(d);
        let count = (x.len() / d) as f64;
        found.push(if axis < d {
            along.sum::<f64>() / count
        } else {
            0.0
        });
    }
    found.push((v.iter().map(|v| v * v).sum::<f64>() / (x.len() / d) as f64).sqrt());
    found.push(j.iter().copied().fold(f64::INFINITY, f64::min));
    found.push(j.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    found
}

/// Runs each scene of the table and compares moments, center, speed and J, each relative to its size.
fn compare(precision: &str, limits: [f64; 4]) {
    let table = table();
    let mut scenes: Vec<&str> = table.iter().map(|(scene, ..)| *scene).collect();
    scenes.dedup();
    for scene in scenes {
        let own = [("precision".to_owned(), precision.to_owned())];
        let plan = Scene::load(scene, &own).unwrap_or_else(|error| panic!("{error}"));
        let mut simulation = plan.build(Isa::Portable).unwrap().simulation;
        for (_, step, wanted) in table.iter().filter(|row| row.0 == scene) {
            // When these grains of snow hit the floor, a rounding error grows by 10⁵ in 20 substeps.
            if scene == "mls-mpm88" && precision == "f32" && *step > 560 {
                continue;
            }
            while simulation.substeps() < *step {
                simulation.substep().unwrap();
            }
            let found = figures(&*simulation);
            assert_eq!(found.len(), wanted.len());
            for (place, (found, wanted)) in found.iter().zip(wanted).enumerate() {
                let kind = [0, 0, 0, 0, 1, 1, 1, 2, 3, 3][place];
                // The programs store no J for dust.
                let apart = (found - wanted).abs() / wanted.abs().max(1e-3);
                assert!(
                    wanted.is_nan() || apart < limits[kind],
                    "{scene} in {precision}, substep {step}, figure {place}: {found}, {wanted} wanted"
                );
            }
        }
    }
}

#[test]
fn scenes_follow_the_programs_in_f64() {
    compare("f64", [1e-8, 1e-8, 1e-8, 1e-7]);
}

#[test]
fn scenes_follow_the_programs_in_f32() {
    compare("f32", [1e-5, 1e-5, 1e-4, 5e-3]);
}
