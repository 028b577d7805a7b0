//! K7: the regression test of Taichi's mpm88 (taichi-dev/taichi, tests/python/test_mpm88.py, Apache-2.0).

use super::conservation::norm;
use super::engine::ParticleState;
use super::table::Table;

/// Returns the table of a run of Taichi's own kernels in f64: totals of the particles after each number of substeps.
pub fn reference() -> Table<'static> {
    Table::parse(include_str!("../../data/peer_taichi_mpm88_regression.csv"))
}

/// Returns the moments that the Taichi project publishes for substep 500.
pub fn published_moments() -> [f64; 4] {
    let table = reference();
    let row = table.rows.iter().find(|row| row[0] == 500.0);
    ["m1", "m2", "m3", "m4"].map(|name| row.map_or(f64::NAN, |row| table.get(row, name)))
}

/// Returns the means of the powers 1 to 4 of x and 2y.
pub fn moments(particles: &[ParticleState<2>]) -> [f64; 4] {
    [1, 2, 3, 4].map(|power| {
        mean(particles, |p| {
            0.5 * (p.position[0].powi(power) + (2.0 * p.position[1]).powi(power))
        })
    })
}

/// Returns the row of the table for these particles, without its first two columns: means of position and velocity,
/// kinetic energy, largest coordinates, smallest and largest J, and the moments.
pub fn row(particles: &[ParticleState<2>]) -> Vec<f64> {
    let count = particles.len() as f64;
    let largest =
        |f: &dyn Fn(&ParticleState<2>) -> f64| particles.iter().map(f).fold(f64::MIN, f64::max);
    let mut row = vec![
        mean(particles, |p| p.position[0]),
        mean(particles, |p| p.position[1]),
        mean(particles, |p| p.velocity[0]),
        mean(particles, |p| p.velocity[1]),
        count * mean(particles, |p| 0.5 * p.mass * norm(&p.velocity).powi(2)),
        largest(&|p| p.position[0]),
        largest(&|p| p.position[1]),
        1.0 - largest(&|p| -p.jacobian_minus_one),
        1.0 + largest(&|p| p.jacobian_minus_one),
    ];
    row.extend(moments(particles));
    row
}

/// Returns the mean of a number of the particles.
fn mean(particles: &[ParticleState<2>], of: impl Fn(&ParticleState<2>) -> f64) -> f64 {
    particles.iter().map(of).sum::<f64>() / particles.len() as f64
}
