//! Measurements as a table, beside a baseline, and as plots.

use serde::{Deserialize, Serialize};

use super::{Machine, Measurement};
use crate::plot::{Line, Plot};

/// The measurements of one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchReport {
    /// Version of the program.
    pub version: String,
    /// The machine that measured.
    pub machine: Machine,
    /// One measurement per case.
    pub results: Vec<Measurement>,
}

impl BenchReport {
    /// Returns the measurement of the same case, with the same precision, instruction set and threads, and a number of
    /// particles that differs by less than a tenth.
    fn same(&self, measured: &Measurement) -> Option<&Measurement> {
        let alike = |other: &&Measurement| {
            let key = |m: &Measurement| {
                (
                    m.case.clone(),
                    m.precision.clone(),
                    m.isa.clone(),
                    m.threads,
                )
            };
            let ratio = other.particles as f64 / measured.particles as f64;
            key(other) == key(measured) && (ratio - 1.0).abs() < 0.1
        };
        self.results.iter().find(alike)
    }

    /// Writes a table in Markdown, with the ratios of medians to those of `baseline`.
    pub fn text(&self, baseline: Option<&Self>) -> String {
        let mut head: Vec<String> = [
            "case",
            "numbers",
            "set",
            "threads",
            "particles",
            "median",
            "min",
            "max",
            "sort",
            "volume",
            "scatter",
            "grid",
            "gather",
            "other",
            "peak MB",
            "waited %",
        ]
        .map(String::from)
        .to_vec();
        if baseline.is_some() {
            head.push("to baseline".to_owned());
        }
        let rows = self.results.iter().map(|m| {
            let n = &m.nanoseconds;
            let mut row = vec![
                m.case.clone(),
                m.precision.clone(),
                m.isa.clone(),
                m.threads.to_string(),
                m.particles.to_string(),
            ];
            row.extend([m.median, m.min, m.max].map(|rate| format!("{:.2}", 1e-6 * rate)));
            let phases = [n.sort, n.volume, n.scatter, n.grid, n.gather, n.other];
            row.extend(phases.map(|phase| format!("{phase:.1}")));
            row.push(m.memory_peak.map_or_else(
                || "-".to_owned(),
                |bytes| format!("{:.0}", 1e-6 * bytes as f64),
            ));
            row.push(
                m.waited
                    .map_or_else(|| "-".to_owned(), |part| format!("{:.0}", 100.0 * part)),
            );
            if let Some(baseline) = baseline {
                let ratio = baseline.same(m).map(|other| m.median / other.median);
                row.push(ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.2}")));
            }
            row
        });
        let mut text = table(&head, &rows.collect::<Vec<_>>());
        let Machine {
            cpu,
            threads,
            system,
        } = &self.machine;
        text += &format!(
            "\nMedian, min and max in million particle-steps per second; phases in nanoseconds per particle and substep; waited: \
             the share of time in which a thread was ready but had no processor.\n\
             Version {} on {cpu}, {threads} threads, {system}.\n",
            self.version
        );
        if let Some(baseline) = baseline.filter(|baseline| baseline.machine != self.machine) {
            let Machine { cpu, threads, .. } = &baseline.machine;
            text += &format!("The baseline is of another machine: {cpu}, {threads} threads.\n");
        }
        text
    }
}

/// Writes a table with columns as wide as their widest word.
fn table(head: &[String], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let words = rows.iter().map(|row| row[column].len());
        words
            .chain([head[column].len(), 3])
            .max()
            .unwrap_or_default()
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let line = |row: &[String]| {
        let words = row
            .iter()
            .zip(&widths)
            .map(|(word, width)| format!(" {word:>width$} |"));
        format!("|{}\n", words.collect::<String>())
    };
    let rule: Vec<String> = widths
        .iter()
        .map(|width| format!("{}:", "-".repeat(width - 1)))
        .collect();
    let rows = rows.iter().map(|row| line(row));
    [line(head), line(&rule)].into_iter().chain(rows).collect()
}

/// Plots the growth of rate and memory: over particles, with one line per case and number of threads; and over threads,
/// with one line per case and number of particles. Returns file names without ending, and plots.
pub fn growth(results: &[Measurement]) -> Vec<(&'static str, Plot)> {
    let threads = |m: &Measurement| format!("{}, {} thread(s)", m.case, m.threads);
    let particles = |m: &Measurement| format!("{}, {:.0e} particles", m.case, m.particles as f64);
    let decades = |m: &Measurement| (m.particles as f64).log10();
    let rate = |m: &Measurement| Some(1e-6 * m.median);
    let memory = |m: &Measurement| Some(m.memory_peak? as f64 / m.particles as f64);
    let plot = |title: &str, x_label: &str, y_label: &str, lines| Plot {
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        y_label: y_label.to_owned(),
        lines,
    };
    let particle_axis = "particles, as a power of ten";
    let rate_axis = "million particle-steps per second";
    [
        (
            "particles",
            plot(
                "Speed over particles",
                particle_axis,
                rate_axis,
                lines(results, threads, decades, rate),
            ),
        ),
        (
            "memory",
            plot(
                "Peak memory over particles",
                particle_axis,
                "bytes per particle",
                lines(results, threads, decades, memory),
            ),
        ),
        (
            "threads",
            plot(
                "Speed over threads",
                "threads",
                rate_axis,
                lines(results, particles, |m| m.threads as f64, rate),
            ),
        ),
    ]
    .into_iter()
    .filter(|(_, plot)| plot.lines.iter().any(|line| line.points.len() > 1))
    .collect()
}

/// Returns one line per name, in the order of first use, with points by ascending x.
fn lines(
    results: &[Measurement],
    name: impl Fn(&Measurement) -> String,
    x: impl Fn(&Measurement) -> f64,
    y: impl Fn(&Measurement) -> Option<f64>,
) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for measured in results {
        let Some(y) = y(measured) else { continue };
        let name = name(measured);
        let index = lines
            .iter()
            .position(|line| line.name == name)
            .unwrap_or_else(|| {
                lines.push(Line {
                    name,
                    points: vec![],
                });
                lines.len() - 1
            });
        lines[index].points.push((x(measured), y));
    }
    for line in &mut lines {
        line.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::super::Nanoseconds;
    use super::*;

    fn measured(particles: u64, threads: usize, median: f64) -> Measurement {
        Measurement {
            case: "dam".into(),
            precision: "f32".into(),
            isa: "portable".into(),
            threads,
            particles,
            cells_per_meter: 10.0,
            build_seconds: 0.1,
            warm_up: 9,
            runs: vec![median],
            min: median,
            median,
            max: median,
            substeps: 10,
            sorts: 1,
            nanoseconds: Nanoseconds::default(),
            waited: None,
            memory_peak: Some(particles * 200),
        }
    }

    fn report(results: Vec<Measurement>) -> BenchReport {
        BenchReport {
            version: "1".into(),
            machine: Machine::default(),
            results,
        }
    }

    #[test]
    fn ratios_are_to_the_same_case() {
        let baseline = report(vec![measured(1000, 2, 4e6), measured(1000, 1, 2e6)]);
        let ours = report(vec![measured(1010, 1, 3e6), measured(5000, 1, 3e6)]);
        let text = ours.text(Some(&baseline));
        let rows: Vec<&str> = text.lines().filter(|line| line.contains("dam")).collect();
        assert!(rows[0].ends_with(" 1.50 |"), "{text}");
        assert!(rows[1].ends_with(" - |"), "{text}");
        let back: BenchReport =
            serde_json::from_str(&serde_json::to_string(&ours).unwrap()).unwrap();
        assert_eq!(back, ours);
    }

    #[test]
    fn growth_is_drawn_over_the_quantity_that_varies() {
        let names = |results: &[Measurement]| {
            growth(results)
                .iter()
                .map(|(name, _)| *name)
                .collect::<Vec<_>>()
        };
        let sizes = [measured(100_000, 1, 2e6), measured(10_000, 1, 1e6)];
        assert_eq!(names(&sizes), ["particles", "memory"]);
        assert_eq!(
            growth(&sizes)[0].1.lines[0].points,
            [(4.0, 1.0), (5.0, 2.0)]
        );
        assert_eq!(
            names(&[measured(1000, 1, 2e6), measured(1000, 2, 4e6)]),
            ["threads"]
        );
        assert!(names(&[measured(1000, 1, 2e6)]).is_empty());
    }
}
