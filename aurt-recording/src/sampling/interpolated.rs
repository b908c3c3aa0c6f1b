//! Rows that lie on straight lines between others: a recording that was put on a finer grid.

use crate::noise::lattice_step;
use crate::recording::Recording;

/// Rows from each that was recorded to the next, at most.
const WIDEST: usize = 16;
const FEWEST_ROWS: usize = 200;
/// Share of a series' range by which numbers that are not rounded further may lie off the line.
const EXACT: f64 = 1e-9;

/// A series with the distance from a line that rounding explains.
struct Rounded<'a> {
    series: &'a [f64],
    tolerance: f64,
}

impl Rounded<'_> {
    /// Whether a row lies on the line between two others.
    fn is_between(&self, from: usize, row: usize, to: usize) -> bool {
        let share = (row - from) as f64 / (to - from) as f64;
        let line = self.series[from] + share * (self.series[to] - self.series[from]);
        (self.series[row] - line).abs() <= self.tolerance
    }
}

impl Recording {
    /// Every how many rows one was recorded, if all between lie on straight lines in stamps, positions and measurements:
    /// such rows say nothing of their own, but their noise is less than a sensor's, and so would be all deviations. `None` of
    /// rows as sensors give them.
    pub fn interpolation_stride(&self) -> Option<usize> {
        let measured = self.measurement.as_ref()?;
        if self.samples() < FEWEST_ROWS {
            return None;
        }
        let rounded = |series: &'_ Vec<f64>| {
            let (low, high) =
                series.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
            let step = lattice_step(series).map_or(0.0, |step| 0.51 * step);
            step.max(EXACT * (high - low))
        };
        let families = [std::slice::from_ref(&self.time_s), &self.position_rad, measured];
        let all: Vec<Rounded<'_>> = families
            .into_iter()
            .flatten()
            .map(|series| Rounded { series, tolerance: rounded(series) })
            .collect();
        let last = self.samples() - 1;
        let on_lines = |stride: usize| {
            (0..last).step_by(stride).filter(|from| from + stride <= last).all(|from| {
                let to = from + stride;
                (from + 1..to).all(|row| all.iter().all(|series| series.is_between(from, row, to)))
            })
        };
        // A measurement that bends nowhere would lie on any lines.
        let bends = |stride: usize| {
            let rows = (stride..last.saturating_sub(stride)).step_by(stride);
            let bent = |row: &usize| {
                all[1 + self.joints()..].iter().any(|s| !s.is_between(row - stride, *row, row + stride))
            };
            2 * rows.clone().filter(bent).count() > rows.count()
        };
        (2..=WIDEST).rev().find(|stride| on_lines(*stride) && bends(*stride))
    }

    /// The first row and every `stride`-th after it.
    pub fn every(&self, stride: usize) -> Self {
        self.with_series(|series| series.iter().step_by(stride.max(1)).copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use aurt_traits::MeasurementUnit;

    use super::*;
    use crate::noise::Normal;

    /// A joint that moves smoothly, with noise in what is measured, interpolated by a factor and rounded to some decimals.
    fn recording(factor: usize, decimals: i32) -> Recording {
        let mut normal = Normal::new(1);
        let coarse: Vec<[f64; 2]> = (0..400)
            .map(|k| f64::from(k) * 0.01)
            .map(|t| [t.sin(), t.cos() + 0.015 * normal.next()])
            .collect();
        let unit = 10.0_f64.powi(decimals);
        let coarse: Vec<[f64; 2]> = coarse.iter().map(|row| row.map(|v| (v * unit).round() / unit)).collect();
        let at = |k: usize, of: usize| {
            let (row, share) = (k / factor, (k % factor) as f64 / factor as f64);
            let next = coarse[(row + 1).min(399)][of];
            ((coarse[row][of] + share * (next - coarse[row][of])) * unit).round() / unit
        };
        let rows = 399 * factor + 1;
        let series = |of: usize| vec![(0..rows).map(|k| at(k, of)).collect::<Vec<_>>()];
        let time = (0..rows).map(|k| k as f64 * 0.01 / factor as f64).collect();
        Recording::from_arrays(time, series(0))
            .unwrap()
            .with_measurement(series(1), MeasurementUnit::Ampere)
            .unwrap()
    }

    #[test]
    fn interpolated_rows_are_known_and_sensors_believed() {
        for decimals in [4, 6, 12] {
            let own = recording(1, decimals);
            assert_eq!(own.interpolation_stride(), None, "{decimals}");
            for factor in [2, 4] {
                let finer = recording(factor, decimals);
                assert_eq!(finer.interpolation_stride(), Some(factor), "{decimals}");
                assert_eq!(finer.every(factor).measurement, own.measurement);
            }
        }
    }
}
