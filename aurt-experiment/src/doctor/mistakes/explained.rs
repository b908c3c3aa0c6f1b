//! How much of each joint's measurement a calibrated model explains.

use std::ops::Range;

use aurt::{RecordingResult, Role};
use aurt_report::rendering::number::significant;
use aurt_traits::RobotNames;

use super::setup::SLOW_SHARE;
use super::trial::FittedRows;

/// Below this share a joint counts as hardly explained.
pub(super) const LEAST_EXPLAINED: f64 = 0.5;
/// Rows that say enough of a joint, as a share of those of a recording.
const LEAST_ROWS: f64 = 0.1;
/// The same of a stretch, in which more than half of a usual measurement is missed.
const LEAST_STRETCH: f64 = 0.02;
/// A stretch is told if what it misses beyond half of its measurement is this share of all that the recording measures.
const LEAST_MISSED: f64 = 0.05;

/// A joint that a model hardly explains.
#[derive(Debug, Clone, PartialEq)]
pub struct Poor {
    pub joint: usize,
    /// What of it is explained: 1 − Σe²/Σy² over the rows at which it moves, 0 at least.
    pub explained: f64,
    pub file: usize,
    pub recording: String,
    /// From when to when, s from the first stamp; all of the recording without.
    pub span_s: Option<[f64; 2]>,
    /// Share of the recording's rows.
    pub rows: f64,
}

/// The joints that a model hardly explains in a recording or in a stretch of one, whatever it was used for: a mistake in a
/// recording that was fitted hardly shows in another. Joints that rest are left out: what holds them is friction that knows
/// no sign.
pub fn poorly_explained(recordings: &[RecordingResult]) -> Vec<Poor> {
    let of_recording = |(file, result): (usize, &RecordingResult)| {
        let moving = &result.validation.moving;
        let rows = rows_of(result);
        let joints = moving.nrmse.iter().zip(&moving.samples).enumerate();
        let of_joint = |(joint, (error, samples)): (usize, (&f64, &usize))| {
            // A few rows say little.
            let says_enough = *samples as f64 >= LEAST_ROWS * result.validation.samples as f64;
            let explained = 1.0 - error * error;
            let whole = (says_enough && explained < LEAST_EXPLAINED).then_some((explained, None, 1.0));
            let (explained, span_s, rows) = whole.or_else(|| rows.hardly_explained(joint))?;
            let recording = result.label.clone();
            Some(Poor { joint, explained: explained.max(0.0), file, recording, span_s, rows })
        };
        joints.filter_map(of_joint).collect::<Vec<_>>()
    };
    recordings.iter().enumerate().flat_map(of_recording).collect()
}

/// The rows that a calibrated model was judged on.
fn rows_of(result: &RecordingResult) -> FittedRows {
    let rows = &result.comparison;
    let speeds = || rows.joints.iter().flat_map(|j| &j.velocity_rad_s);
    let square = speeds().map(|v| v * v).sum::<f64>() / speeds().count().max(1) as f64;
    let slow_rad_s = SLOW_SHARE * square.sqrt();
    let joints = rows.joints.iter().map(|joint| {
        let all = joint.measured.iter().zip(&joint.predicted).zip(&joint.velocity_rad_s);
        all.map(|((y, predicted), v)| (v.abs() > slow_rad_s).then_some([y - predicted, *y])).collect()
    });
    FittedRows {
        time_s: rows.time_s.iter().map(|t| t - result.first_stamp_s).collect(),
        joints: joints.collect(),
    }
}

impl FittedRows {
    /// What is explained of a joint, with the stretch if it is not the recording, and its share of the rows, where that is less
    /// than half. A stretch in which little is measured has to be missed by as much as others.
    pub(super) fn hardly_explained(&self, joint: usize) -> Option<(f64, Option<[f64; 2]>, f64)> {
        let rows = self.joints.get(joint)?;
        let share = |range: Range<usize>| rows[range].iter().flatten().count() as f64 / rows.len() as f64;
        let explained = |range: Range<usize>| {
            let sum =
                |of: usize| rows[range.clone()].iter().flatten().map(|row| row[of].powi(2)).sum::<f64>();
            1.0 - sum(0) / sum(1)
        };
        let whole = explained(0..rows.len());
        if whole.is_nan() || share(0..rows.len()) < LEAST_ROWS {
            return None;
        }
        if whole < LEAST_EXPLAINED {
            return Some((whole.max(0.0), None, 1.0));
        }
        let measured = rows.iter().flatten();
        let all = measured.clone().map(|row| row[1].powi(2)).sum::<f64>();
        let usual = all / measured.count() as f64;
        let missed = |row: &Option<[f64; 2]>| {
            row.map_or(0.0, |[e, y]| e * e - (1.0 - LEAST_EXPLAINED) * usual.max(y * y))
        };
        let (range, most) = heaviest(rows.iter().map(missed))?;
        let rows = share(range.clone());
        if rows < LEAST_STRETCH || most < LEAST_MISSED * all {
            return None;
        }
        let span_s = [self.time_s[range.start], self.time_s[range.end - 1]];
        Some((explained(range).max(0.0), Some(span_s), rows))
    }
}

/// The neighbours with the largest sum, with that, if one is positive.
pub(super) fn heaviest(weights: impl IntoIterator<Item = f64>) -> Option<(Range<usize>, f64)> {
    let (mut first, mut sum) = (0, 0.0);
    let mut best: Option<(Range<usize>, f64)> = None;
    for (k, weight) in weights.into_iter().enumerate() {
        if sum <= 0.0 {
            (first, sum) = (k, 0.0);
        }
        sum += weight;
        if sum > 0.0 && best.as_ref().is_none_or(|(_, most)| sum > *most) {
            best = Some((first..k + 1, sum));
        }
    }
    best
}

/// The sentence that says so: `This model explains 4 % of joint 2 (point_to_point.csv)`, or nothing of it. Each joint is told where it
/// is explained least: on held-out recordings if it is poor there.
pub fn loudly(poor: &[Poor], recordings: &[RecordingResult], names: RobotNames<'_>) -> Option<String> {
    let is_fitted = |p: &Poor| recordings.get(p.file).is_some_and(|r| r.role == Role::Calibration);
    let mut worst: Vec<&Poor> = poor.iter().filter(|p| p.says_enough()).collect();
    worst.sort_by(|a, b| {
        (a.joint, is_fitted(a)).cmp(&(b.joint, is_fitted(b))).then(a.explained.total_cmp(&b.explained))
    });
    worst.dedup_by_key(|p| p.joint);
    let each: Vec<String> = worst.iter().map(|p| p.share(names)).collect();
    (!each.is_empty()).then(|| format!("This model explains {}.", each.join(", ")))
}

impl Poor {
    /// True if so many rows say enough by themselves. Shorter stretches are told with the mistake that they have.
    pub(super) fn says_enough(&self) -> bool {
        self.rows >= LEAST_ROWS
    }

    /// `4 % of joint 2 (point_to_point.csv, 3 s to 12 s)`.
    pub(super) fn share(&self, names: RobotNames<'_>) -> String {
        let name = self.recording.rsplit(['/', '\\']).next().unwrap_or(&self.recording);
        let share = if self.explained < 0.005 {
            "nothing".to_owned()
        } else {
            format!("{:.0} %", 100.0 * self.explained)
        };
        let span = self.span_s.map_or_else(String::new, |span_s| {
            let [from, to] = span_s.map(|t| significant(t, 3));
            format!(", {from} s to {to} s")
        });
        format!("{share} of {} ({name}{span})", names.joint(self.joint))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of 30 s that is measured with a sign of its own in a stretch.
    fn rows(turned: Range<usize>) -> FittedRows {
        let time_s: Vec<f64> = (0..600).map(|k| 0.05 * f64::from(k)).collect();
        let row = |(k, t): (usize, &f64)| {
            let predicted = t.sin();
            let measured = if turned.contains(&k) { -predicted } else { predicted };
            Some([measured - predicted, measured])
        };
        FittedRows { joints: vec![time_s.iter().enumerate().map(row).collect()], time_s }
    }

    #[test]
    fn the_heaviest_neighbours_are_found() {
        let found = heaviest([-1.0, 2.0, -0.5, 3.0, -4.0, 1.0]);
        assert_eq!(found, Some((1..4, 4.5)));
        assert_eq!(heaviest([-1.0, -2.0]), None);
    }

    #[test]
    fn a_recording_and_a_stretch_of_it_are_told_apart() {
        assert_eq!(rows(0..0).hardly_explained(0), None);
        assert_eq!(rows(0..600).hardly_explained(0), Some((0.0, None, 1.0)));
        let Some((explained, Some([from_s, to_s]), share)) = rows(520..575).hardly_explained(0) else {
            panic!("no stretch")
        };
        assert_eq!(explained, 0.0);
        assert!(share < LEAST_ROWS, "{share}");
        // Where the sine passes zero, little is missed.
        assert!((26.0..26.5).contains(&from_s) && (27.8..28.3).contains(&to_s), "{from_s} {to_s}");
        // A single row is a spike.
        assert_eq!(rows(300..301).hardly_explained(0), None);
    }
}
