//! `lahar plot`: what runs have measured, over time, as SVG.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lahar_io::files::{is_link, make_folder, write_file};
use lahar_io::output::{PROBE_PLOT, Table};
use lahar_lab::plot::{Line, Plot};

use crate::error::CliError;
use crate::{args, terminal};

/// A plot: its file's name, what stands over it, and its columns with what the legend calls them.
struct Figure {
    file: &'static str,
    title: &'static str,
    unit: &'static str,
    columns: &'static [(&'static [&'static str], &'static str)],
}

/// Checksums of columns, in joules, metres and so on; in 2D per metre of depth.
const FIGURES: &[Figure] = &[
    Figure {
        file: "energy",
        title: "Energy",
        unit: "[J]",
        columns: &[
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
        columns: &[
            (&["angular_momentum_x"], "about x"),
            (&["angular_momentum_y"], "about y"),
            (&["angular_momentum_z"], "about z"),
        ],
    },
    Figure {
        file: "momentum",
        title: "Momentum",
        unit: "[kg m/s]",
        columns: &[
            (&["momentum_x"], "x"),
            (&["momentum_y"], "y"),
            (&["momentum_z"], "z"),
        ],
    },
    Figure {
        file: "volume",
        title: "Volume",
        unit: "[m³; m² in 2D]",
        columns: &[
            (&["volume"], "that particles fill"),
            (&["particle_volume"], "that particles say"),
        ],
    },
    Figure {
        file: "speed",
        title: "Largest speed",
        unit: "[m/s]",
        columns: &[(&["max_speed"], "largest speed")],
    },
    Figure {
        file: "time-step",
        title: "Shortest substep of a frame",
        unit: "[s]",
        columns: &[(&["dt_min"], "shortest substep")],
    },
];

const TOTAL: [&str; 3] = ["kinetic_energy", "elastic_energy", "potential_energy"];

/// Plots `args.runs`.
pub(crate) fn plot(args: &args::Plot) -> Result<ExitCode, CliError> {
    let folder = match (&args.output, args.runs.as_slice()) {
        (Some(folder), _) => folder.clone(),
        (None, [run]) => run.join("plots"),
        (None, _) => {
            return Err(CliError::Usage(
                "several runs are plotted into a folder of their own: name it with -o DIR".into(),
            ));
        }
    };
    let named = |run: &PathBuf| {
        let name = run.file_name().unwrap_or(run.as_os_str());
        (name.to_string_lossy().into_owned(), run.clone())
    };
    let runs: Vec<_> = args.runs.iter().map(named).collect();
    for path in draw(&runs, &folder)? {
        terminal::print(&format!("  {}\n", path.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// Draws all figures of `runs`, each with its name, into `folder`; returns the files.
pub(crate) fn draw(runs: &[(String, PathBuf)], folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let figures = figures(runs)?;
    make_folder(folder)?;
    let mut files = Vec::new();
    for (name, svg) in figures {
        let path = folder.join(format!("{name}.svg"));
        write_file(&path, svg)?;
        files.push(path);
    }
    Ok(files)
}

/// All figures of `runs`, each with its name, as SVG with a name.
pub(crate) fn figures(runs: &[(String, PathBuf)]) -> Result<Vec<(String, String)>, CliError> {
    let mut tables = Vec::new();
    for (name, run) in runs {
        tables.push((name.as_str(), Table::read(&run.join("diagnostics.csv"))?));
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
        // A run that ended before its second frame may have nothing to draw.
        let Ok(svg) = plot.svg() else { continue };
        figures.push((figure.file.to_owned(), svg));
    }
    for (probe, plot) in probe_plots(runs)? {
        let Ok(svg) = plot.svg() else { continue };
        figures.push((format!("{PROBE_PLOT}{probe}"), svg));
    }
    Ok(figures)
}

/// A plot for each probe, by name: a line for each of its numbers and each run that has it.
fn probe_plots(runs: &[(String, PathBuf)]) -> Result<BTreeMap<String, Plot>, CliError> {
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

/// Unit of a column of probes.
fn probe_unit(column: &str) -> &'static str {
    match column {
        "pressure" => "[Pa]",
        "height" | "front" => "[m]",
        _ if column.starts_with("velocity") => "[m/s]",
        _ => "[N; N/m in 2D]",
    }
}

impl Figure {
    /// Its columns of one run; or of each of several, and then the energies' sum only.
    fn lines(&self, tables: &[(&str, Table)]) -> Vec<Line> {
        let several = tables.len() > 1;
        let wanted = |name: &str| !several || self.file != "energy" || name == "total";
        let mut lines = Vec::new();
        for (run, table) in tables {
            let Some(time) = table.column("time") else {
                continue;
            };
            // Components that this dimension does not have are left out.
            let columns: Vec<(&str, Vec<&[f64]>)> = self
                .columns
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
    fn plots_are_those_that_a_run_folder_knows() {
        assert_eq!(
            FIGURES.iter().map(|figure| figure.file).collect::<Vec<_>>(),
            PLOTS
        );
    }
}
