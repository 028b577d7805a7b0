//! Measured limits of the time step: speeds of waves, of new particles and of colliders.

use super::State;
use crate::grid::Grid;
use crate::instance::Instance;
use crate::math::{Lanes, Vector};
use crate::particles::{Group, Layout};
use crate::setup::check::CheckedSetup;

/// Returns the square of the fastest wave speed in `group` \[m²/s²\].
fn wave_speed_squared<T: Lanes, const D: usize>(group: &Group<T, D>) -> f64 {
    let strain = &group.columns[Layout::strain(D)..];
    group.law.wave_modulus(strain, group.len()) / group.density
}

impl<T: Lanes, const D: usize> State<T, D> {
    /// Sets the wave speed that limits the next substep to the fastest among the particles.
    pub(crate) fn measure_waves(&mut self) {
        let squared = self.groups.iter().map(wave_speed_squared);
        self.control.wave_speed = squared.fold(0.0, f64::max).sqrt();
    }
}

impl<T: Instance<D>, const D: usize> State<T, D> {
    /// Raises the limits of the next substep to what the particles of `new`, of all materials, ask for.
    pub(crate) fn limit_by_new_particles(&mut self, scene: &CheckedSetup<D>, new: &[Group<T, D>]) {
        let control = &self.control;
        let mut speed_squared = 0.0_f64;
        for group in new {
            for row in 0..group.len() {
                let v = Vector::<f64, D>::from_fn(|axis| {
                    group.columns[Layout::velocity(D) + axis][row].to_f64()
                });
                speed_squared = speed_squared.max(v.dot(v));
            }
        }
        let waves_squared = new.iter().map(wave_speed_squared).fold(0.0, f64::max);
        let is_there = |group: &&Group<T, D>| group.len() > 0;
        let viscosity = new
            .iter()
            .filter(is_there)
            .map(|group| group.law.viscosity() / group.density);
        let acceleration = self.largest_acceleration(scene, new);
        let (speed, wave_speed, viscosity, field) = (
            control.speed.max(speed_squared.sqrt()),
            control.wave_speed.max(waves_squared.sqrt()),
            viscosity.fold(control.viscosity, f64::max),
            control.field.max(acceleration),
        );
        let control = &mut self.control;
        control.speed = speed;
        control.wave_speed = wave_speed;
        control.viscosity = viscosity;
        control.field = field;
    }

    /// Sets the speed of colliders that limits the next substep to a bound on their speeds in it, near the
    /// particles on `grid`.
    pub(crate) fn limit_by_colliders(&mut self, scene: &CheckedSetup<D>, grid: &Grid<T, D>) {
        self.control.boundary_speed = 0.0;
        if scene.colliders.is_empty() {
            return;
        }
        let (dt, _) = self.control.next();
        let (time, occupied) = (self.control.time(), grid.occupied());
        self.control.boundary_speed = scene
            .colliders
            .iter()
            .map(|collider| scene.lattice.dx * collider.largest_speed(time, dt, occupied))
            .fold(0.0, f64::max);
    }
}
