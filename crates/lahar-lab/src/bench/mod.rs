//! The speed of simulations in particle-steps per second, measured by a fixed protocol.
//!
//! ```text
//! case ─► its scene, with dx for the number of particles ─► build ─► warm up: past the second sort
//!                                                                    └─► timed runs: from one sort to the next
//! ```
//! Scenes start in motion, so that particles soon pass from block to block and meet walls. The time covers everything
//! that `lahar run` does but output: sorting, corrections, time steps, and the copy from which a failed frame is retried.
//! A run ends with a sort, so that it has its fair share of them.

mod machine;
mod table;

use lahar::{Isa, PhaseTimes};
use lahar_scene::driver::{Driver, Event, FrameEnd, Schedule};
use serde::{Deserialize, Serialize};

use lahar_scene::error::SceneError;
use lahar_scene::scene::{Precision, Scene};
pub use machine::{Machine, seconds};
pub use table::{BenchReport, growth};

/// A benchmark case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// Name on the command line.
    pub name: &'static str,
    /// Description in a few words.
    pub what: &'static str,
    /// Name of the built-in scene that it runs.
    pub scene: &'static str,
    /// Keys and values laid over the scene.
    set: &'static [(&'static str, &'static str)],
    /// Instruction set, if the case fixes it.
    isa: Option<Isa>,
}

impl Case {
    const fn of(name: &'static str, what: &'static str, scene: &'static str) -> Self {
        Self {
            name,
            what,
            scene,
            set: &[],
            isa: None,
        }
    }
}

/// All cases, in the order of the report.
pub const CASES: &[Case] = &[
    Case::of(
        "dam-3d",
        "default fluid, 8 particles per cell",
        "bench-dam-3d",
    ),
    Case::of(
        "dam-2d",
        "default fluid, 4 particles per cell",
        "bench-dam-2d",
    ),
    Case::of(
        "jelly-3d",
        "corotated: polar decomposition",
        "bench-jelly-3d",
    ),
    Case::of(
        "snow-3d",
        "singular values, return mapping",
        "bench-snow-3d",
    ),
    Case {
        set: &[("precision", "\"f64\"")],
        ..Case::of("dam-3d-f64", "dam-3d in f64", "bench-dam-3d")
    },
    Case {
        isa: Some(Isa::Portable),
        ..Case::of(
            "dam-3d-portable",
            "dam-3d by the portable instruction set",
            "bench-dam-3d",
        )
    },
];

/// Returns the case called `name`.
///
/// ```
/// use lahar_lab::bench;
///
/// assert_eq!(bench::find("dam-3d").unwrap().scene, "bench-dam-3d");
/// ```
pub fn find(name: &str) -> Option<&'static Case> {
    CASES.iter().find(|case| case.name == name)
}

/// Options of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Approximate number of particles; `None` for that of the scene.
    pub particles: Option<f64>,
    /// Instruction set, unless the case fixes it.
    pub isa: Isa,
    /// Number of timed runs.
    pub runs: usize,
}

/// The reason why a case could not be measured.
#[derive(Clone, Debug)]
pub enum BenchError {
    /// The scene cannot be built.
    Scene(Box<SceneError>),
    /// The simulation failed.
    Failure(String),
}

impl From<SceneError> for BenchError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

/// Wall time per particle and substep \[ns\], by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Nanoseconds {
    /// Sorting particles into blocks.
    pub sort: f64,
    /// Correcting volumes by the density on the grid.
    pub volume: f64,
    /// Particles to grid (P2G).
    pub scatter: f64,
    /// Grid update and boundaries.
    pub grid: f64,
    /// Grid to particles (G2P).
    pub gather: f64,
    /// All other work.
    pub other: f64,
}

/// The measurement of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Name of the case.
    pub case: String,
    /// Precision: "f32" or "f64".
    pub precision: String,
    /// Name of the instruction set in use.
    pub isa: String,
    /// Number of threads that computed.
    pub threads: usize,
    /// Number of particles.
    pub particles: u64,
    /// Number of cells along 1 m.
    #[serde(default)]
    pub cells_per_meter: f64,
    /// Seconds in which the scene was built.
    pub build_seconds: f64,
    /// Number of substeps before the runs.
    pub warm_up: u64,
    /// Particle-steps per second of each run.
    pub runs: Vec<f64>,
    /// Smallest rate of the runs.
    pub min: f64,
    /// Median rate of the runs.
    pub median: f64,
    /// Largest rate of the runs.
    pub max: f64,
    /// Number of substeps in all runs.
    pub substeps: u64,
    /// Number of sorts in all runs.
    pub sorts: u64,
    /// Wall time by phase, over all runs.
    pub nanoseconds: Nanoseconds,
    /// Share of time in which a thread was ready to compute but had no processor. Above some percent, other programs used
    /// the machine, and rates are too low. `None` if the system does not tell.
    #[serde(default)]
    pub waited: Option<f64>,
    /// Largest memory of the process since the case began, with building \[bytes\]. `None` if the system does not tell.
    pub memory_peak: Option<u64>,
}

/// Number of sorts before the first run.
const WARM_SORTS: u64 = 2;

/// Fewest substeps of a run, which ends with the next sort.
const LEAST_SUBSTEPS: u64 = 20;

/// Number of substeps after which a run or the warm-up ends without a sort, because nothing moves.
const MOST_SUBSTEPS: u64 = 1000;

/// Loads the scene of a case, with about `particles` particles.
///
/// # Errors
/// If the scene cannot have this number of particles.
pub fn scene(case: &Case, particles: Option<f64>) -> Result<Scene, SceneError> {
    let mut set: Vec<(String, String)> = case
        .set
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let scene = Scene::load(case.scene, &set)?;
    let Some(particles) = particles else {
        return Ok(scene);
    };
    // The sides of domains are whole meters, so a whole number of cells per meter fits them.
    let finer = (particles / scene.expected_particles()).powf(1.0 / scene.dimension as f64);
    let cells = (cells_per_meter(&scene) * finer).round().max(1.0);
    set.push(("dx".to_owned(), format!("{:?}", 1.0 / cells)));
    Scene::load(case.scene, &set)
}

fn cells_per_meter(scene: &Scene) -> f64 {
    (1.0 / scene.dx()).round()
}

/// Measures a case on the threads of the pool in which it is called.
///
/// # Errors
/// If the scene cannot be built or its simulation fails.
pub fn measure(case: &Case, options: &Options) -> Result<Measurement, BenchError> {
    machine::forget_peak();
    let began = seconds();
    let scene = scene(case, options.particles)?;
    let isa = case.isa.unwrap_or(options.isa);
    let simulation = scene.build(isa)?.simulation;
    let build_seconds = seconds() - began;
    // Runs end with a sort, not with a frame of the scene.
    let schedule = Schedule::new(FrameEnd::Open);
    let mut driver = Driver::new(simulation, schedule).with_clock(seconds);
    let warm_up = until_sorted(&mut driver, WARM_SORTS, 0)?;
    let particles = driver.simulation().particle_count() as u64;
    let start = driver.simulation().phase_times();
    let waited = machine::waited();
    let (mut rates, mut substeps, mut time) = (Vec::new(), 0, 0.0);
    for _ in 0..options.runs.max(1) {
        let began = seconds();
        let count = until_sorted(&mut driver, 1, LEAST_SUBSTEPS)?;
        let elapsed = seconds() - began;
        rates.push((particles * count) as f64 / elapsed);
        substeps += count;
        time += elapsed;
    }
    let end = driver.simulation().phase_times();
    let waited = machine::waited().zip(waited).map(|(end, start)| {
        ((end - start) / (time * rayon::current_num_threads() as f64)).min(1.0)
    });
    let steps = (particles * substeps) as f64;
    let mut sorted = rates.clone();
    sorted.sort_by(f64::total_cmp);
    Ok(Measurement {
        case: case.name.to_owned(),
        precision: match scene.precision {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        }
        .to_owned(),
        isa: isa.name().to_owned(),
        threads: rayon::current_num_threads(),
        particles,
        cells_per_meter: cells_per_meter(&scene),
        build_seconds,
        warm_up,
        min: sorted[0],
        median: median(&sorted),
        max: sorted[sorted.len() - 1],
        runs: rates,
        substeps,
        sorts: end.sorts - start.sorts,
        nanoseconds: Nanoseconds::between(&start, &end, time, steps),
        waited,
        memory_peak: machine::peak(),
    })
}

/// Takes at least `least` substeps as one frame, until particles have been sorted `sorts` times. Returns their number.
fn until_sorted(driver: &mut Driver, sorts: u64, least: u64) -> Result<u64, BenchError> {
    let before = driver.simulation().phase_times().sorts;
    let mut substeps = 0;
    let mut sorted = 0;
    while substeps < MOST_SUBSTEPS {
        match driver.pump_substeps(1) {
            Event::Unfinished | Event::Frame(_) => {}
            Event::Retry(retry) => return Err(BenchError::Failure(retry.failure.to_string())),
            Event::Failed(failure) => return Err(BenchError::Failure(failure.to_string())),
        }
        substeps += driver.last_advance().substeps;
        let now = driver.simulation().phase_times().sorts - before;
        if now > sorted && now >= sorts && substeps >= least {
            break;
        }
        sorted = now;
    }
    driver.end_frame();
    Ok(substeps)
}

/// Returns the median of sorted numbers, of which there must be at least one.
fn median(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    if sorted.len().is_multiple_of(2) {
        0.5 * (sorted[half - 1] + sorted[half])
    } else {
        sorted[half]
    }
}

impl Nanoseconds {
    /// Returns the times of phases between two readings, `time` seconds and `steps` particle-steps apart.
    fn between(start: &PhaseTimes, end: &PhaseTimes, time: f64, steps: f64) -> Self {
        let each = |phase: fn(&PhaseTimes) -> f64| 1e9 * (phase(end) - phase(start)) / steps;
        let mut phases = Self {
            sort: each(|times| times.sort),
            volume: each(|times| times.volume),
            scatter: each(|times| times.scatter),
            grid: each(|times| times.grid),
            gather: each(|times| times.gather),
            other: 0.0,
        };
        phases.other = (1e9 * time / steps - phases.sum()).max(0.0);
        phases
    }

    /// Returns the sum over all phases.
    pub fn sum(&self) -> f64 {
        self.sort + self.volume + self.scatter + self.grid + self.gather + self.other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_numbers() {
        assert_eq!(median(&[1.0, 2.0, 9.0]), 2.0);
        assert_eq!(median(&[1.0, 2.0, 4.0, 9.0]), 3.0);
    }

    #[test]
    fn names_are_one_each() {
        for case in CASES {
            assert_eq!(find(case.name), Some(case));
        }
        assert_eq!(find("dam"), None);
    }

    #[test]
    fn a_scene_has_about_the_particles_asked_for() {
        for case in CASES {
            for wanted in [3e4, 1e6] {
                let count = scene(case, Some(wanted)).unwrap().expected_particles();
                assert!(
                    (count / wanted - 1.0).abs() < 0.1,
                    "{}: {count} of {wanted}",
                    case.name
                );
            }
            let own = scene(case, None).unwrap().expected_particles();
            assert!((9e5..1.1e6).contains(&own), "{}: {own}", case.name);
        }
    }

    #[test]
    fn a_case_is_measured_past_its_sorts() {
        let options = Options {
            particles: Some(4000.0),
            isa: Isa::Portable,
            runs: 3,
        };
        for case in CASES {
            let measured = measure(case, &options).unwrap();
            assert_eq!(measured.runs.len(), 3, "{}", case.name);
            assert!(measured.sorts >= 3, "{}: {}", case.name, measured.sorts);
            assert!(measured.warm_up < MOST_SUBSTEPS, "{}", case.name);
            assert!(measured.min <= measured.median && measured.median <= measured.max);
            // Phases cover the time: particle-steps over it is the mean rate.
            let mean = 1e9 / measured.nanoseconds.sum();
            assert!(
                measured.min * 0.999 <= mean && mean <= measured.max * 1.001,
                "{}",
                case.name
            );
        }
    }
}
