//! Plots of curves as SVG.

use std::fmt;

use plotters::prelude::*;

/// A plot of lines over a common axis.
///
/// ```
/// use lahar_lab::plot::{Line, Plot};
///
/// let plot = Plot {
///     title: "Kinetic energy".into(),
///     x_label: "time [s]".into(),
///     y_label: "[J]".into(),
///     lines: vec![Line { name: "apic".into(), points: vec![(0.0, 1.0), (1.0, 0.5)] }],
/// };
/// assert!(plot.svg()?.starts_with("<svg"));
/// # Ok::<(), lahar_lab::plot::PlotError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Title above the plot.
    pub title: String,
    /// Quantity and unit of the horizontal axis.
    pub x_label: String,
    /// Quantity and unit of the vertical axis.
    pub y_label: String,
    /// Lines in the order in which they are drawn, each in its own color.
    pub lines: Vec<Line>,
}

/// A line of a plot. It is broken at numbers that are not finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Points as pairs of x and y.
    pub points: Vec<(f64, f64)>,
}

/// The reason why a plot cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlotError(String);

impl fmt::Display for PlotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot draw the plot: {}", self.0)
    }
}

impl std::error::Error for PlotError {}

/// Width and height of a plot \[pixels\].
const SIZE: (u32, u32) = (760, 420);

/// Color of the lines of the grid.
const GRID: RGBColor = RGBColor(0xE4, 0xE4, 0xE4);

/// Colors that color-blind people can tell apart (P. Tol's bright scheme, 2021, without yellow).
const COLORS: [RGBColor; 6] = [
    RGBColor(0x44, 0x77, 0xAA),
    RGBColor(0xEE, 0x66, 0x77),
    RGBColor(0x22, 0x88, 0x33),
    RGBColor(0xAA, 0x33, 0x77),
    RGBColor(0x66, 0xCC, 0xEE),
    RGBColor(0x55, 0x55, 0x55),
];

impl Plot {
    /// Draws the plot as an SVG document.
    ///
    /// # Errors
    /// If there is no finite point.
    pub fn svg(&self) -> Result<String, PlotError> {
        self.svg_with(None)
    }

    /// Draws the plot as [`Plot::svg`] does, with 0 on the vertical axis, so that heights are proportional to numbers.
    ///
    /// # Errors
    /// If there is no finite point.
    pub fn svg_from_zero(&self) -> Result<String, PlotError> {
        self.svg_with(Some(0.0))
    }

    /// Draws the plot with the value `shown` on the vertical axis.
    fn svg_with(&self, shown: Option<f64>) -> Result<String, PlotError> {
        let mut text = String::new();
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        self.draw(&root, shown)?;
        drop(root);
        Ok(text)
    }

    fn draw(
        &self,
        area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
        shown: Option<f64>,
    ) -> Result<(), PlotError> {
        let wrong = |error: DrawingAreaErrorKind<_>| PlotError(error.to_string());
        let points = || {
            self.lines
                .iter()
                .flat_map(|line| &line.points)
                .filter(finite)
        };
        let x = range(points().map(|p| p.0), 0.0);
        let y = range(points().map(|p| p.1), 0.05);
        let y = y.map(|y| match shown {
            Some(shown) => y.start.min(shown)..y.end.max(shown),
            None => y,
        });
        let (Some(x), Some(y)) = (x, y) else {
            return Err(PlotError(format!("\"{}\" has no finite point", self.title)));
        };
        area.fill(&WHITE).map_err(wrong)?;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 20))
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(78)
            .build_cartesian_2d(x, y)
            .map_err(wrong)?;
        chart
            .configure_mesh()
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .axis_desc_style(("sans-serif", 15))
            .label_style(("sans-serif", 13))
            .bold_line_style(GRID)
            .light_line_style(WHITE)
            .x_label_formatter(&|x| number(*x))
            .y_label_formatter(&|y| number(*y))
            .draw()
            .map_err(wrong)?;
        for (line, color) in self.lines.iter().zip(COLORS.iter().cycle()) {
            let style = color.stroke_width(2);
            for (index, piece) in line.points.split(|p| !finite(&p)).enumerate() {
                let drawn = chart
                    .draw_series(LineSeries::new(piece.iter().copied(), style))
                    .map_err(wrong)?;
                if index == 0 {
                    drawn
                        .label(&line.name)
                        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
                }
            }
        }
        if self.lines.len() > 1 {
            chart
                .configure_series_labels()
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(0xBB, 0xBB, 0xBB))
                .label_font(("sans-serif", 14))
                .draw()
                .map_err(wrong)?;
        }
        area.present().map_err(wrong)
    }
}

fn finite(point: &&(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Returns the range of values, enlarged at both ends by the share `margin`; never empty.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> Option<core::ops::Range<f64>> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    if low > high {
        return None;
    }
    // Values that differ by rounding only are drawn as a constant.
    let least = 1e-9 * low.abs().max(high.abs()).max(1e-30);
    let margin = (margin * (high - low)).max(least);
    Some(low - margin..high + margin)
}

/// Writes a number with few digits: 0.25, 1.2e-5.
fn number(value: f64) -> String {
    let size = value.abs();
    if size < 1e-12 {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = (3 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: &[(f64, f64)]) -> Plot {
        Plot {
            title: "Kinetic energy".into(),
            x_label: "time [s]".into(),
            y_label: "[J]".into(),
            lines: vec![
                Line {
                    name: "apic".into(),
                    points: points.to_vec(),
                },
                Line {
                    name: "pic <&>".into(),
                    points: vec![(0.0, 1.0), (1.0, 0.5)],
                },
            ],
        }
    }

    #[test]
    fn lines_titles_and_names_are_in_the_document() {
        let svg = plot(&[(0.0, 1.0), (0.5, f64::NAN), (1.0, 2.0)])
            .svg()
            .unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for text in ["Kinetic energy", "time [s]", "apic", "pic &lt;&amp;&gt;"] {
            assert!(svg.contains(text), "{text} is missing");
        }
    }

    #[test]
    fn one_point_and_a_constant_can_be_drawn_but_nothing_cannot() {
        let mut constant = plot(&[(0.0, 3.0), (1.0, 3.0)]);
        constant.lines.truncate(1);
        constant.svg().unwrap();
        constant.svg_from_zero().unwrap();
        constant.lines[0].points.truncate(1);
        constant.svg().unwrap();
        constant.lines[0].points[0].1 = f64::INFINITY;
        assert!(constant.svg().is_err());
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(0.25), "0.25");
        assert_eq!(number(-1200.0), "-1200");
        assert_eq!(number(1.23456e-5), "1.23e-5");
        assert_eq!(number(0.0), "0");
        assert_eq!(number(0.1 + 0.2), "0.3");
    }
}
