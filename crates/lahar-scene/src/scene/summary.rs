//! A scene in a few lines of text.

use super::checked::Scene;
use lahar::TimeStep;

impl Scene {
    /// Describes the scene in a few lines: size, resolution, duration, bodies.
    pub fn summary(&self) -> String {
        let (time_step, dx) = (time_step_words(self.time_step()), self.dx());
        let (min, max) = self.bounds();
        let sides: Vec<String> = (0..self.dimension)
            .map(|i| format!("{:.4}", max[i] - min[i]))
            .collect();
        let cells: Vec<String> = (0..self.dimension)
            .map(|i| format!("{:.0}", (max[i] - min[i]) / dx))
            .collect();
        let mut lines = vec![
            if self.title.is_empty() {
                self.name.clone()
            } else {
                format!("{}: {}", self.name, self.title)
            },
            format!(
                "{}D, {} m, {} cells of {dx} m",
                self.dimension,
                sides.join(" x "),
                cells.join(" x ")
            ),
            format!(
                "{} s in {} frames, time step {time_step}",
                self.duration,
                self.frames()
            ),
        ];
        for body in &self.bodies {
            let material = &self.materials[body.material];
            lines.push(format!(
                "{}: about {:.0} particles of {} ({}, {} kg/m3, wave speed {:.2} m/s)",
                body.name,
                body.expected_particles,
                material.name,
                material.model,
                material.density,
                material.wave_speed
            ));
        }
        lines.join("\n") + "\n"
    }
}

fn time_step_words(time_step: TimeStep) -> String {
    match time_step {
        TimeStep::Fixed(dt) => format!("fixed at {dt} s"),
        TimeStep::Automatic { cfl, longest } if longest.is_finite() => {
            format!("automatic, cfl {cfl}, at most {longest} s")
        }
        TimeStep::Automatic { cfl, .. } => format!("automatic, cfl {cfl}"),
    }
}
