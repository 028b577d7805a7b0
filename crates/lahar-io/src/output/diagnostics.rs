//! `diagnostics.csv`: totals, one row per frame. Nothing in it depends on the clock, so that a resumed run writes the
//! same bytes.

use std::fmt::Write as _;
use std::path::Path;

use lahar::Diagnostics;

use crate::files::{GrowingFile, Length, OutputError};

const AXES: [&str; 3] = ["x", "y", "z"];

/// The growing file `diagnostics.csv`. Every row is handed to the system at once.
///
/// ```
/// use lahar::Diagnostics;
/// use lahar_io::output::{DiagnosticsFile, Table};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("diagnostics.csv");
/// let mut file = DiagnosticsFile::create(&path, 2)?;
/// file.push(&Diagnostics { time: 0.5, mass: 2.0, ..Diagnostics::default() })?;
/// assert_eq!(Table::read(&path)?.column("mass"), Some(&[2.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct DiagnosticsFile {
    file: GrowingFile,
    dimension: usize,
}

impl DiagnosticsFile {
    /// Creates the file with its header. Vectors have `dimension` (2 or 3) components.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn create(path: &Path, dimension: usize) -> Result<Self, OutputError> {
        Self::open(path, dimension, None)
    }

    /// Creates the file, or cuts it back to an earlier length.
    pub(super) fn open(
        path: &Path,
        dimension: usize,
        was: Option<&Length>,
    ) -> Result<Self, OutputError> {
        let mut file = GrowingFile::open(path, was)?;
        if was.is_none() {
            file.add(header(dimension).as_bytes())?;
        }
        Ok(Self { file, dimension })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn push(&mut self, diagnostics: &Diagnostics) -> Result<(), OutputError> {
        self.file.add(row(diagnostics, self.dimension).as_bytes())
    }

    pub(super) fn file(&self) -> &GrowingFile {
        &self.file
    }
}

/// Returns the components of angular momentum: z in 2D, all in 3D.
fn turns(dimension: usize) -> core::ops::Range<usize> {
    if dimension == 2 { 2..3 } else { 0..3 }
}

fn header(dimension: usize) -> String {
    let mut line = "time,substeps,dt_min,dt_limit,particles,mass".to_owned();
    for axis in &AXES[..dimension] {
        line += ",momentum_";
        line += axis;
    }
    for axis in &AXES[turns(dimension)] {
        line += ",angular_momentum_";
        line += axis;
    }
    line += ",kinetic_energy,elastic_energy,potential_energy,max_speed,volume,particle_volume,escaped,escaped_mass\n";
    line
}

fn row(d: &Diagnostics, dimension: usize) -> String {
    // `{:?}` writes the fewest digits that read back to the same bits, with an exponent where that is shorter.
    let mut line = format!(
        "{:?},{},{:?},{},{},",
        d.time, d.substeps, d.dt_min, d.dt_limit, d.particles
    );
    let mut add = |values: &[f64]| {
        for value in values {
            write!(line, "{value:?},").expect("writing to a String");
        }
    };
    add(&[d.mass]);
    add(&d.momentum[..dimension]);
    add(&d.angular_momentum[turns(dimension)]);
    add(&[
        d.kinetic_energy,
        d.elastic_energy,
        d.potential_energy,
        d.max_speed,
        d.volume,
        d.particle_volume,
    ]);
    writeln!(line, "{},{:?}", d.escaped, d.escaped_mass).expect("writing to a String");
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_fit_the_header_and_read_back_to_the_bit() {
        let diagnostics = Diagnostics {
            time: 0.1 + 0.2,
            dt_min: 1.234_567_890_123_456_7e-7,
            dt_limit: "sound",
            mass: 1e300,
            momentum: [-0.0, f64::MIN_POSITIVE, 1.0 / 3.0],
            ..Diagnostics::default()
        };
        for dimension in [2, 3] {
            let (names, values) = (header(dimension), row(&diagnostics, dimension));
            let names: Vec<_> = names.trim_end().split(',').collect();
            let values: Vec<_> = values.trim_end().split(',').collect();
            assert_eq!(names.len(), values.len());
            let value = |name: &str| {
                values[names.iter().position(|n| *n == name).unwrap()]
                    .parse::<f64>()
                    .unwrap()
                    .to_bits()
            };
            assert_eq!(value("time"), diagnostics.time.to_bits());
            assert_eq!(value("dt_min"), diagnostics.dt_min.to_bits());
            assert_eq!(value("mass"), 1e300_f64.to_bits());
            assert_eq!(value("momentum_x"), (-0.0_f64).to_bits());
            assert_eq!(value("momentum_y"), f64::MIN_POSITIVE.to_bits());
            assert_eq!(names.contains(&"momentum_z"), dimension == 3);
            assert_eq!(names.contains(&"angular_momentum_x"), dimension == 3);
            assert!(names.contains(&"angular_momentum_z"));
        }
    }
}
