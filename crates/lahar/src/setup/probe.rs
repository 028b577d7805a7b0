//! Probes: measurements while a simulation runs, as plain data.

/// A measurement that is repeated while the simulation runs. Readings are collected by
/// [`Simulate::take_probe_samples`](crate::Simulate::take_probe_samples). A probe changes nothing: a run has the
/// same bits with and without it.
///
/// ```
/// use lahar::{Gauge, ParticleBatch, Probe, Setup, Simulate, Simulation};
///
/// let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// let mut setup = Setup::<2>::new(0.02, vec![jelly]);
/// setup.probes.push(Probe {
///     name: "speed".into(),
///     rate: 100.0,
///     gauge: Gauge::Velocity { at: [0.5, 0.5], radius: 0.05 },
/// });
/// let drop = ParticleBatch {
///     position: vec![[0.5, 0.5]],
///     velocity: vec![[0.1, 0.0]],
///     volume: vec![1e-4],
///     ..Default::default()
/// };
/// let mut simulation = Simulation::<f64, 2>::new(setup, &[drop])?;
/// simulation.advance_to(0.05)?;
///
/// let readings = simulation.take_probe_samples();
/// assert_eq!(readings[0].columns, ["velocity_x", "velocity_y"]);
/// let samples = &readings[0].samples;
/// assert_eq!((samples.len(), samples[0].time), (6, 0.0), "one at the start, then 100 per second");
/// assert!((samples[5].values[0] - 0.1).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Probe<const D: usize> {
    /// The name of the probe's file and in messages.
    pub name: String,
    /// Readings per second \[1/s\]. The first is at the start, each other one at the end of the first substep at or
    /// after it is due.
    pub rate: f64,
    /// The quantity to measure.
    pub gauge: Gauge<D>,
}

/// The quantity that a [`Probe`] measures. Only [`Gauge::Pressure`] and [`Gauge::Velocity`], which weigh by volume,
/// use the material's law.
#[derive(Clone, Debug, PartialEq)]
pub enum Gauge<const D: usize> {
    /// Cauchy pressure \[Pa\] by (16), 0 where there is no particle. In a wall on its plane, it is the pressure that
    /// a sensor there feels: the normal impulse on its face since the last reading, over area and time.
    Pressure {
        /// The point to measure at \[m\].
        at: [f64; D],
        /// Distance within which particles count \[m\].
        radius: f64,
        /// The plate to average over, with `at` in its middle; `None` for the point alone.
        plate: Option<Plate<D>>,
    },
    /// Velocity \[m/s\] by (16), one number per axis; 0 where there is no particle.
    Velocity {
        /// The point to measure at \[m\].
        at: [f64; D],
        /// Distance within which particles count \[m\].
        radius: f64,
    },
    /// Coordinate of the material's surface on an axis \[m\].
    Height {
        /// The axis that points up.
        up: usize,
        /// A point of the column to measure \[m\]; `None` for the mean over the domain, by the volume that is filled.
        column: Option<[f64; D]>,
    },
    /// Coordinate \[m\] of a front on an axis: the last column of one cell with more than `depth` of material,
    /// interpolated between the middles of columns. If no column has that, the domain's end where the front starts.
    Front {
        /// The axis that the front runs along.
        along: usize,
        /// True if it runs toward higher coordinates.
        rising: bool,
        /// The axis that points up.
        up: usize,
        /// The least depth \[m\] that counts.
        depth: f64,
    },
    /// Mean force of the material on a boundary since the last reading \[N; N/m in 2D\], one number per axis; 0 at the
    /// start.
    Force {
        /// The boundary's name in [`Simulate::boundary_impulses`](crate::Simulate::boundary_impulses).
        on: String,
    },
}

/// The face of a pressure gauge: a line in 2D, a disc in 3D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate<const D: usize> {
    /// A vector of any length perpendicular to the face.
    pub normal: [f64; D],
    /// Length of the line, or diameter of the disc \[m\].
    pub width: f64,
}

impl<const D: usize> Gauge<D> {
    /// Names of the numbers of a reading: "pressure", "height", "front"; "velocity_x", "velocity_y", "velocity_z";
    /// "force_x", "force_y", "force_z".
    ///
    /// ```
    /// let gauge = lahar::Gauge::<2>::Force { on: "bottom".into() };
    /// assert_eq!(gauge.columns(), ["force_x", "force_y"]);
    /// ```
    pub fn columns(&self) -> Vec<&'static str> {
        match self {
            Self::Pressure { .. } => vec!["pressure"],
            Self::Velocity { .. } => ["velocity_x", "velocity_y", "velocity_z"][..D].to_vec(),
            Self::Height { .. } => vec!["height"],
            Self::Front { .. } => vec!["front"],
            Self::Force { .. } => ["force_x", "force_y", "force_z"][..D].to_vec(),
        }
    }
}

/// One reading of a probe.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeSample {
    /// Simulated time \[s\].
    pub time: f64,
    /// The numbers that [`ProbeSamples::columns`] names.
    pub values: Vec<f64>,
}

/// Readings of one probe.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeSamples {
    /// The probe's name.
    pub name: String,
    /// Names of the numbers of a reading, as [`Gauge::columns`] gives them.
    pub columns: Vec<&'static str>,
    /// The readings, by ascending time.
    pub samples: Vec<ProbeSample>,
}
