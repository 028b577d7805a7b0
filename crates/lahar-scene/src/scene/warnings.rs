//! Warnings about scenes that run, but are suspicious.

use super::plan::{Plan, Source};
use super::stiffness::Falls;
use lahar::{Model, TimeStep};

impl<const D: usize> Plan<D> {
    /// Adds the warnings about the plan to `warnings`.
    pub(super) fn warn(&mut self) {
        let mut warnings = core::mem::take(&mut self.warnings);
        let speed = Falls::of(self).speed(self.gravity);
        for (index, material) in self.materials.iter().enumerate() {
            if !self.bodies.iter().any(|body| body.material == index) {
                warnings.push(format!(
                    "material \"{}\" is not used by any body",
                    material.name
                ));
                continue;
            }
            let c = material.sound_speed();
            if matches!(material.model, Model::Fluid(_)) && speed > 0.2 * c * (1.0 + 1e-9) {
                warnings.push(format!("speeds up to {speed:.3} m/s are expected, more than a fifth of the speed of sound {c:.3} m/s of \"{}\": it will be visibly compressed", material.name));
            }
            if let TimeStep::Fixed(dt) = self.time_step
                && dt * c > self.dx
            {
                warnings.push(format!("dt = {dt} s is longer than sound in \"{}\" takes to cross a cell ({:.3e} s): expect it to blow up", material.name, self.dx / c));
            }
        }
        for body in &self.bodies {
            let Source::Shape {
                region,
                spacing,
                count,
                ..
            } = &body.source
            else {
                continue;
            };
            let per_cell = match count {
                Some(count) => *count as f64 / region.volume() * self.dx.powi(D as i32),
                None => (self.dx / spacing).powi(D as i32),
            };
            let few = if D == 2 { 2.0 } else { 4.0 };
            if per_cell < few {
                warnings.push(format!("body \"{}\" has {per_cell:.2} particles per cell: below {few} it may fall apart into grains", body.name));
            }
            let thin = (0..D)
                .map(|i| region.bounds().side(i))
                .fold(f64::INFINITY, f64::min);
            if thin < 2.0 * self.dx {
                warnings.push(format!(
                    "body \"{}\" is {thin:.4} m thin, less than two cells: the grid hardly sees it",
                    body.name
                ));
            }
            if region.is_cut() {
                warnings.push(format!(
                    "body \"{}\" reaches out of the domain and is cut off there",
                    body.name
                ));
            }
        }
        self.warnings = warnings;
    }
}
