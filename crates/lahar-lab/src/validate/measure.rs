//! Numbers computed from series: periods, slopes, means, distances from tables.

use std::collections::BTreeMap;

use super::running::Series;

/// Parses a table of reference numbers and returns its columns. Lines that start with # name the source; the first other
/// line names the columns.
pub(super) fn table(text: &str) -> Vec<Vec<f64>> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let columns = lines.next().map_or(0, |names| names.split(',').count());
    let mut table = vec![Vec::new(); columns];
    for line in lines {
        for (column, word) in table.iter_mut().zip(line.split(',')) {
            column.push(word.trim().parse().unwrap_or(f64::NAN));
        }
    }
    table
}

/// Parses the first two columns of a table as points.
pub(super) fn points(text: &str) -> Series {
    let table = table(text);
    match &table[..] {
        [x, y, ..] => x.iter().copied().zip(y.iter().copied()).collect(),
        _ => Series::new(),
    }
}

/// Returns the interpolated times at which a series crosses zero.
pub(super) fn zero_crossings(series: &[(f64, f64)]) -> Vec<f64> {
    let pairs = series.windows(2);
    pairs
        .filter(|pair| pair[0].1 != 0.0 && pair[0].1 * pair[1].1 <= 0.0)
        .map(|pair| {
            let [(t0, a), (t1, b)] = [pair[0], pair[1]];
            t0 + (t1 - t0) * a / (a - b)
        })
        .collect()
}

/// Returns slope and intercept of the least-squares line through the points.
pub(super) fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
    (slope, y - slope * x)
}

/// Returns the period of an oscillation about zero: twice the slope of its zero crossings over their number.
pub(super) fn period(series: &[(f64, f64)]) -> f64 {
    let crossings = zero_crossings(series);
    let numbered: Vec<(f64, f64)> = crossings
        .iter()
        .enumerate()
        .map(|(number, time)| (number as f64, *time))
        .collect();
    2.0 * line(&numbered).0
}

/// Returns the interpolated value of a series at `x`; outside, the value of the nearest end.
pub(super) fn at(series: &[(f64, f64)], x: f64) -> f64 {
    let after = series.partition_point(|point| point.0 < x);
    match (after.checked_sub(1).map(|i| series[i]), series.get(after)) {
        (Some((x0, y0)), Some(&(x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), None) => y,
        (None, Some(&(_, y))) => y,
        (None, None) => f64::NAN,
    }
}

/// Returns the mean of a series over `from .. to`, by trapezoids.
pub(super) fn mean(series: &[(f64, f64)], from: f64, to: f64) -> f64 {
    let inside = series.iter().copied().filter(|p| p.0 > from && p.0 < to);
    let ends = |x: f64| core::iter::once((x, at(series, x)));
    let points: Series = ends(from).chain(inside).chain(ends(to)).collect();
    let area: f64 = points
        .windows(2)
        .map(|p| 0.5 * (p[0].1 + p[1].1) * (p[1].0 - p[0].0))
        .sum();
    area / (to - from)
}

/// Returns the shift s within ± `range` at which `ours`, read at x + s, is closest to `reference`, and the remaining root
/// mean square difference.
pub(super) fn shifted(ours: &[(f64, f64)], reference: &[(f64, f64)], range: f64) -> (f64, f64) {
    const STEPS: i32 = 600;
    let left = |shift: f64| root_mean_square(ours, reference, shift);
    (-STEPS..=STEPS)
        .map(|step| range * f64::from(step) / f64::from(STEPS))
        .map(|shift| (shift, left(shift)))
        .fold((0.0, f64::INFINITY), |best, this| {
            if this.1 < best.1 { this } else { best }
        })
}

/// Returns the root mean square difference between `ours`, read at x + `shift`, and the points of `reference`.
pub(super) fn root_mean_square(ours: &[(f64, f64)], reference: &[(f64, f64)], shift: f64) -> f64 {
    let squares = reference
        .iter()
        .map(|(x, y)| (at(ours, x + shift) - y).powi(2));
    (squares.sum::<f64>() / reference.len() as f64).sqrt()
}

/// Returns the order of convergence from the errors of two resolutions that differ by `factor`.
pub(super) fn order(coarse: f64, fine: f64, factor: f64) -> f64 {
    (coarse / fine).abs().ln() / factor.ln()
}

/// Returns the distance of each point to its nearest neighbor; points have `d` coordinates each.
pub(super) fn to_nearest(x: &[f64], d: usize) -> Vec<f64> {
    let places: Vec<&[f64]> = x.chunks(d).collect();
    let mut cells = BTreeMap::<Vec<i64>, Vec<usize>>::new();
    let cell = |place: &[f64]| -> Vec<i64> { place.iter().map(|x| x.floor() as i64).collect() };
    for (index, place) in places.iter().enumerate() {
        cells.entry(cell(place)).or_default().push(index);
    }
    let distance = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let nearest = |(index, place): (usize, &&[f64])| {
        let around = (0..3_usize.pow(d as u32)).map(|number| {
            let mut number = number;
            let mut key = cell(place);
            for k in &mut key {
                *k += (number % 3) as i64 - 1;
                number /= 3;
            }
            key
        });
        let others = around.filter_map(|key| cells.get(&key)).flatten();
        let others = others.filter(|other| **other != index);
        others
            .map(|other| distance(place, places[*other]))
            .fold(f64::INFINITY, f64::min)
    };
    places.iter().enumerate().map(nearest).collect()
}

/// Returns the value below which the share `part` of the values lies.
pub(super) fn percentile(mut values: Vec<f64>, part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = (part * values.len() as f64) as usize;
    values.get(index).copied().unwrap_or(f64::NAN)
}

/// Returns the standard deviation of the number of points per cell of side 1, over the cells with any points that lie
/// below `below` on the second axis.
pub(super) fn spread_a_cell(x: &[f64], d: usize, below: f64) -> f64 {
    let mut counts = BTreeMap::<Vec<i64>, f64>::new();
    for place in x.chunks(d).filter(|place| place[1].floor() + 1.0 <= below) {
        let cell = place.iter().map(|x| x.floor() as i64).collect();
        *counts.entry(cell).or_default() += 1.0;
    }
    let n = counts.len() as f64;
    let mean = counts.values().sum::<f64>() / n;
    (counts
        .values()
        .map(|count| (count - mean).powi(2))
        .sum::<f64>()
        / n)
        .sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(period: f64) -> Series {
        (0..=500)
            .map(|i| 0.01 * f64::from(i))
            .map(|t| (t, (core::f64::consts::TAU * (t - 0.1) / period).sin()))
            .collect()
    }

    #[test]
    fn periods_and_means() {
        assert!((period(&wave(0.7)) - 0.7).abs() < 1e-4);
        assert!(mean(&wave(1.0), 0.5, 3.5).abs() < 1e-4);
        assert_eq!(mean(&[(0.0, 1.0), (2.0, 3.0)], 0.5, 1.5), 2.0);
        assert_eq!(at(&[(0.0, 1.0), (2.0, 3.0)], 5.0), 3.0);
    }

    #[test]
    fn neighbors_and_crowds() {
        let x = [0.25, 0.25, 0.75, 0.25, 1.25, 0.25, 1.25, 0.35];
        assert_eq!(to_nearest(&x, 2)[0], 0.5);
        assert!((percentile(to_nearest(&x, 2), 0.3) - 0.1).abs() < 1e-12);
        assert_eq!(spread_a_cell(&x, 2, 1.0), 0.0);
        assert_eq!(spread_a_cell(&x[..6], 2, 1.0), 0.5);
    }

    #[test]
    fn a_shift_is_found() {
        let late: Series = wave(2.0).iter().map(|(t, y)| (t + 0.15, *y)).collect();
        let some: Series = wave(2.0).into_iter().skip(50).step_by(40).take(9).collect();
        let (shift, left) = shifted(&late, &some, 0.3);
        assert!((shift - 0.15).abs() < 1e-3 && left < 1e-3, "{shift} {left}");
    }

    #[test]
    fn tables_have_sources_names_and_numbers() {
        let text = "# source\na,b\n1,2\n3,4\n";
        assert_eq!(table(text), [[1.0, 3.0], [2.0, 4.0]]);
        assert_eq!(points(text), [(1.0, 2.0), (3.0, 4.0)]);
    }
}
