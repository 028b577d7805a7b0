//! Plots of runs over time: energies, momenta, volume, speed, time step, and the readings of probes.
//!
//! One run gives one line per column of `diagnostics.csv`; several runs share the plots, so that they can be compared.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use lahar_io::files::{OutputError, confined, is_link, output_folder, write_file};
use lahar_io::output::{PROBE_PLOT, Table};

use crate::plot::{Line, Plot};

/// A plot of columns of `diagnostics.csv`.
struct Figure {
    /// File name without its ending.
    file: &'static str,
    title: &'static str,
    unit: &'static str,
    /// One line each: the columns that are summed, and the name in the legend.
    lines: &'static [(&'static [&'static str], &'static str)],
}

/// All plots of `diagnostics.csv`; in 2D their quantities are per meter of depth.
const FIGURES: &[Figure] = &[
    Figure {
        file: "energy",
        title: "Energy",
        unit: "[J]",
        lines: &[
            (&["kinetic_energy"], "kinetic"),
            (&["elastic_energy"], "elastic"),
            (&["potential_energy"], "potential"),
            (&TOTAL, "total"),
        ],
    },
    Figure {
        file: "angular-momentum",
        title: "Angular momentum",
        unit: "[kg m²/s]",
        lines: &[
            (&["angular_momentum_x"], "about x"),
            (&["angular_momentum_y"], "about y"),
            (&["angular_momentum_z"], "about z"),
        ],
    },
    Figure {
        file: "momentum",
        title: "Momentum",
        unit: "[kg m/s]",
        lines: &[
            (&["momentum_x"], "x"),
            (&["momentum_y"], "y"),
            (&["momentum_z"], "z"),
        ],
    },
    Figure {
        file: "volume",
        title: "Volume",
        unit: "[m³; m² in 2D]",
        lines: &[
            (&["volume"], "filled by particles"),
            (&["particle_volume"], "sum of J V0"),
        ],
    },
    Figure {
        file: "speed",
        title: "Largest speed",
        unit: "[m/s]",
        lines: &[(&["max_speed"], "largest speed")],
    },
    Figure {
        file: "time-step",
        title: "Shortest substep of a frame",
        unit: "[s]",
        lines: &[(&["dt_min"], "shortest substep")],
    },
];

const TOTAL: [&str; 3] = ["kinetic_energy", "elastic_energy", "potential_energy"];

/// Writes all plots of `runs` (name in the legend, folder) into `folder` as SVG; returns the paths of the files.
///
/// # Errors
/// If a run has no `diagnostics.csv`, or a file cannot be written.
pub fn save_plots(runs: &[(String, PathBuf)], folder: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let figures = svg_plots(runs)?;
    let folder = output_folder(Some(folder), PathBuf::new())?;
    let mut files = Vec::new();
    for (name, svg) in figures {
        let path = folder.join(format!("{name}.svg"));
        write_file(&path, svg)?;
        files.push(path);
    }
    Ok(files)
}

/// Draws all plots of `runs` (name in the legend, folder); returns file names without ending, and SVG documents.
///
/// # Errors
/// If a run has no `diagnostics.csv`, or a table of its is damaged.
pub fn svg_plots(runs: &[(String, PathBuf)]) -> Result<Vec<(String, String)>, OutputError> {
    let mut tables = Vec::new();
    for (name, run) in runs {
        tables.push((name.as_str(), Table::read(&table_path(run)?)?));
    }
    let mut figures = Vec::new();
    for figure in FIGURES {
        let lines = figure.lines(&tables);
        if lines.is_empty() {
            continue;
        }
        let plot = Plot {
            title: figure.title.to_owned(),
            x_label: "time [s]".to_owned(),
            y_label: figure.unit.to_owned(),
            lines,
        };
        // A run that ended before its second frame has no line to draw.
        let Ok(svg) = plot.svg() else { continue };
        figures.push((figure.file.to_owned(), svg));
    }
    for (probe, plot) in probe_plots(runs)? {
        let Ok(svg) = plot.svg() else { continue };
        figures.push((format!("{PROBE_PLOT}{probe}"), svg));
    }
    Ok(figures)
}

/// Returns the path of a run's `diagnostics.csv`, which must not be a link.
pub(crate) fn table_path(run: &Path) -> Result<PathBuf, OutputError> {
    confined(run, "diagnostics.csv").map_err(|what| OutputError {
        path: run.to_owned(),
        what,
        usage: true,
    })
}

/// Returns one plot per probe name, with one line per column and run.
fn probe_plots(runs: &[(String, PathBuf)]) -> Result<BTreeMap<String, Plot>, OutputError> {
    let mut plots = BTreeMap::<String, Plot>::new();
    for (run, folder) in runs {
        // Runs without probes have no such folder.
        let probes = folder.join("probes");
        if is_link(&probes) {
            continue;
        }
        let Ok(entries) = fs::read_dir(probes) else {
            continue;
        };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        let is_csv = |path: &Path| path.extension().is_some_and(|ending| ending == "csv");
        paths.retain(|path| is_csv(path) && !is_link(path));
        paths.sort();
        for path in paths {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let table = Table::read(&path)?;
            let Some(time) = table.column("time") else {
                continue;
            };
            for column in table.names().iter().filter(|column| *column != "time") {
                let Some(values) = table.column(column) else {
                    continue;
                };
                let plot = plots
                    .entry(name.clone().into_owned())
                    .or_insert_with(|| Plot {
                        title: name.clone().into_owned(),
                        x_label: "time [s]".to_owned(),
                        y_label: format!("{column} {}", probe_unit(column)),
                        lines: Vec::new(),
                    });
                plot.lines.push(Line {
                    name: match runs.len() {
                        1 => column.clone(),
                        _ => format!("{run}, {column}"),
                    },
                    points: time.iter().copied().zip(values.iter().copied()).collect(),
                });
            }
        }
    }
    Ok(plots)
}

/// The unit of a probe's column.
fn probe_unit(column: &str) -> &'static str {
    match column {
        "pressure" => "[Pa]",
        "height" | "front" => "[m]",
        _ if column.starts_with("velocity") => "[m/s]",
        _ => "[N; N/m in 2D]",
    }
}

impl Figure {
    /// Returns the lines of all runs. Of the energies, several runs show the total only.
    fn lines(&self, tables: &[(&str, Table)]) -> Vec<Line> {
        let several = tables.len() > 1;
        let wanted = |name: &str| !several || self.file != "energy" || name == "total";
        let mut lines = Vec::new();
        for (run, table) in tables {
            let Some(time) = table.column("time") else {
                continue;
            };
            // 2D runs lack some components.
            let columns: Vec<(&str, Vec<&[f64]>)> = self
                .lines
                .iter()
                .filter(|(_, name)| wanted(name))
                .filter_map(|(columns, name)| {
                    let columns = columns.iter().map(|column| table.column(column));
                    Some((*name, columns.collect::<Option<_>>()?))
                })
                .collect();
            for (name, parts) in &columns {
                let sum = |row: usize| parts.iter().map(|part| part[row]).sum();
                lines.push(Line {
                    name: match (several, columns.len()) {
                        (false, _) => (*name).to_owned(),
                        (true, 1) => (*run).to_owned(),
                        (true, _) => format!("{run}, {name}"),
                    },
                    points: time
                        .iter()
                        .enumerate()
                        .map(|(row, t)| (*t, sum(row)))
                        .collect(),
                });
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lahar_io::output::PLOTS;

    /// `--overwrite` removes plots by their names.
    #[test]
    fn the_names_of_plots_are_those_that_a_run_folder_knows() {
        assert_eq!(
            FIGURES.iter().map(|figure| figure.file).collect::<Vec<_>>(),
            PLOTS
        );
    }
}
