//! Probes: what is measured on the way, and what was read, as plain data.

/// Something that is measured while the simulation runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe<const D: usize> {
    /// Its name, for files.
    pub name: String,
    /// How often \[1/s\]; it is read at the start too.
    pub rate: f64,
    /// What it measures.
    pub gauge: Gauge<D>,
}

/// What a probe measures. Only [`Gauge::Pressure`] and [`Gauge::Velocity`], which weighs by volume, look at
/// the material law.
#[derive(Clone, Debug, PartialEq)]
pub enum Gauge<const D: usize> {
    /// Cauchy pressure \[Pa\] by (16), 0 where there is no particle. On a wall on its plane, what a sensor
    /// in it feels: the normal impulse on its face since the reading before, over area and time.
    Pressure {
        /// Where \[m\].
        at: [f64; D],
        /// How far it looks \[m\].
        radius: f64,
        /// The plate it is averaged over, with `at` in its middle; `None`: the point alone.
        plate: Option<Plate<D>>,
    },
    /// Velocity \[m/s\] by (16), a number an axis; 0 where there is no particle.
    Velocity {
        /// Where \[m\].
        at: [f64; D],
        /// How far it looks \[m\].
        radius: f64,
    },
    /// Where on an axis the surface of the material is \[m\].
    Height {
        /// The axis that points up.
        up: usize,
        /// A point of the column; `None`: the mean over the domain, by the volume that is filled.
        column: Option<[f64; D]>,
    },
    /// Where on an axis the last column of one cell is that holds material deeper than `depth`
    /// \[m\], interpolated between the columns' middles; the domain's near end if none does.
    Front {
        /// The axis it runs along.
        along: usize,
        /// Whether it runs towards higher coordinates.
        rising: bool,
        /// The axis that points up.
        up: usize,
        /// The depth \[m\] that still counts.
        depth: f64,
    },
    /// The mean force of the material on a boundary since the reading before \[N; N/m in 2D\], a
    /// number an axis; 0 at the start.
    Force {
        /// Its name in [`Simulate::boundary_impulses`](crate::Simulate::boundary_impulses).
        on: String,
    },
}

/// The face of a gauge: a line across the normal in 2D, a disc in 3D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate<const D: usize> {
    /// Across the face, of any length.
    pub normal: [f64; D],
    /// Length of the line, diameter of the disc \[m\].
    pub width: f64,
}

impl<const D: usize> Gauge<D> {
    /// What its numbers are called: "pressure", "height", "front"; "velocity_x", "velocity_y",
    /// "velocity_z"; "force_x", "force_y", "force_z".
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

/// A reading.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeSample {
    /// When \[s\].
    pub time: f64,
    /// The numbers of [`ProbeSamples::columns`].
    pub values: Vec<f64>,
}

/// The readings of one probe.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeSamples {
    /// The probe's name.
    pub name: String,
    /// What the numbers are.
    pub columns: Vec<&'static str>,
    /// In the order of time.
    pub samples: Vec<ProbeSample>,
}
