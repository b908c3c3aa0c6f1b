//! Rows that may fit, and rows that only confirm: two types, so that neither is taken for the other.

use std::ops::{Deref, DerefMut, Range};

use crate::recordings::partition::Partition;
use crate::recordings::rows::{JointRows, RecordingRows};

/// The rows that fit, search, mask and set floors, recording by recording; a validation recording has none.
#[derive(Debug, Clone)]
pub struct FitRows(Vec<RecordingRows>);

/// The rows that confirm: validation recordings, or the ends of those in question. They judge what was found, a delay first;
/// nothing is masked with them, and nothing fitted but the model beside which they judge.
#[derive(Debug, Clone)]
pub struct ConfirmRows(Vec<RecordingRows>);

impl FitRows {
    /// Divides recordings. Confirming rows next to fitting ones, within the filters' memory, do not count.
    pub fn divide(rows: Vec<RecordingRows>, partition: &Partition) -> (Self, ConfirmRows) {
        let (mut fit, mut confirm) = (Vec::new(), Vec::new());
        for (r, recording) in rows.into_iter().enumerate() {
            let (end_of_fit, rows) = (partition.end_of_fit[r], recording.rows());
            let mut rest = recording.part(end_of_fit..rows);
            let first = partition.held_out.iter().find(|part| part.0 == r).map_or(rows, |part| part.1);
            for joint in &mut rest.joints {
                joint.counts[..first - end_of_fit].fill(false);
                joint.silence();
            }
            confirm.push(rest);
            fit.push(if end_of_fit == rows { recording } else { recording.part(0..end_of_fit) });
        }
        (Self(fit), ConfirmRows(confirm))
    }
}

impl Deref for FitRows {
    type Target = [RecordingRows];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for FitRows {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl ConfirmRows {
    /// The rows, to judge what was found, or to be drawn.
    pub fn to_judge(&self) -> &[RecordingRows] {
        &self.0
    }

    /// Replaces the measurement of a joint's rows; rows that do not count stay zero.
    pub(crate) fn set_measurement(&mut self, recording: usize, joint: usize, values: &[f64]) {
        let rows = &mut self.0[recording].joints[joint];
        for ((o, value), counts) in rows.measurement.iter_mut().zip(values).zip(&rows.counts) {
            *o = if *counts { *value } else { 0.0 };
        }
    }

    /// Replaces a column of a joint's rows by that of a law as it was estimated on the rows that fit; rows that do not count
    /// stay zero.
    pub(crate) fn set_column(&mut self, recording: usize, joint: usize, column: usize, values: &[f64]) {
        self.0[recording].joints[joint].set_column(column, values);
    }
}

impl JointRows {
    /// Replaces a column; rows that do not count stay zero.
    pub(crate) fn set_column(&mut self, column: usize, values: &[f64]) {
        let length = self.measurement.len();
        let place = self.data[column * length..(column + 1) * length].iter_mut();
        for ((o, value), counts) in place.zip(values).zip(&self.counts) {
            *o = if *counts { *value } else { 0.0 };
        }
    }
}

impl RecordingRows {
    /// Some of the rows.
    pub fn part(&self, span: Range<usize>) -> Self {
        let rows = self.rows();
        let mut starts: Vec<usize> =
            self.segment_starts.iter().filter(|s| span.contains(s)).map(|s| s - span.start).collect();
        if starts.first() != Some(&0) {
            starts.insert(0, 0);
        }
        if span.start < span.end {
            starts.push(span.len());
        }
        let joint = |joint: &JointRows| JointRows {
            data: joint.data.chunks(rows.max(1)).flat_map(|c| &c[span.clone()]).copied().collect(),
            measurement: joint.measurement[span.clone()].to_vec(),
            position_rad: joint.position_rad[span.clone()].to_vec(),
            velocity_rad_s: joint.velocity_rad_s[span.clone()].to_vec(),
            acceleration_rad_s2: joint.acceleration_rad_s2[span.clone()].to_vec(),
            counts: joint.counts[span.clone()].to_vec(),
            rest_velocity: joint.rest_velocity,
        };
        Self {
            name: self.name.clone(),
            role: self.role,
            rate_hz: self.rate_hz,
            time_s: self.time_s[span.clone()].to_vec(),
            segment_starts: starts,
            joints: self.joints.iter().map(joint).collect(),
        }
    }

    /// The motion of the rows, without what models make of it.
    pub(crate) fn without_columns(&self) -> Self {
        let joint = |joint: &JointRows| JointRows {
            data: Vec::new(),
            measurement: joint.measurement.clone(),
            position_rad: joint.position_rad.clone(),
            velocity_rad_s: joint.velocity_rad_s.clone(),
            acceleration_rad_s2: joint.acceleration_rad_s2.clone(),
            counts: joint.counts.clone(),
            rest_velocity: joint.rest_velocity,
        };
        Self {
            name: self.name.clone(),
            role: self.role,
            rate_hz: self.rate_hz,
            time_s: self.time_s.clone(),
            segment_starts: self.segment_starts.clone(),
            joints: self.joints.iter().map(joint).collect(),
        }
    }

    /// These rows and those that follow, to be drawn.
    pub(crate) fn followed_by(&self, rest: &Self) -> Self {
        if self.rows() == 0 || rest.rows() == 0 {
            return if self.rows() == 0 { rest.clone() } else { self.clone() };
        }
        let mut whole = self.clone();
        whole.time_s.extend(&rest.time_s);
        whole.segment_starts.pop();
        // What starts anew where the rows were divided goes on.
        whole.segment_starts.extend(rest.segment_starts.iter().skip(1).map(|s| s + self.rows()));
        for (joint, rest) in whole.joints.iter_mut().zip(&rest.joints) {
            let (own, further) = (joint.measurement.len().max(1), rest.measurement.len().max(1));
            let (own, further) = (joint.data.chunks(own), rest.data.chunks(further));
            joint.data = own.zip(further).flat_map(|(a, b)| a.iter().chain(b)).copied().collect();
            joint.measurement.extend(&rest.measurement);
            joint.position_rad.extend(&rest.position_rad);
            joint.velocity_rad_s.extend(&rest.velocity_rad_s);
            joint.acceleration_rad_s2.extend(&rest.acceleration_rad_s2);
            joint.counts.extend(&rest.counts);
        }
        whole
    }

    /// Leaves out the rows of a window, s as in the recording's stamps.
    pub(crate) fn leave_out(&mut self, window_s: [f64; 2]) {
        let within: Vec<bool> = self.time_s.iter().map(|t| (window_s[0]..=window_s[1]).contains(t)).collect();
        for joint in &mut self.joints {
            for (counts, within) in joint.counts.iter_mut().zip(&within) {
                *counts &= !within;
            }
            joint.silence();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recordings::rows::Role;

    fn rows(count: usize) -> RecordingRows {
        let series: Vec<f64> = (0..count).map(|k| k as f64).collect();
        let data = series.iter().copied().chain(series.iter().map(|v| 100.0 + v)).collect();
        let joint = JointRows {
            data,
            measurement: series.clone(),
            position_rad: series.clone(),
            velocity_rad_s: series.clone(),
            acceleration_rad_s2: series.clone(),
            counts: vec![true; count],
            rest_velocity: 0.0,
        };
        RecordingRows {
            name: "r.csv".into(),
            role: Role::Calibration,
            rate_hz: 10.0,
            time_s: series,
            segment_starts: vec![0, count / 2, count],
            joints: vec![joint],
        }
    }

    #[test]
    fn no_row_is_on_both_sides_and_those_between_count_on_neither() {
        let whole = vec![rows(400)];
        let partition = Partition::new(&whole, 6, 0.8, false);
        let (fit, confirm) = FitRows::divide(whole, &partition);
        assert_eq!((fit[0].rows(), confirm.to_judge()[0].rows()), (300, 100));
        assert_eq!(fit[0].joints[0].column(1)[299], 399.0);
        assert_eq!(fit[0].segment_starts, [0, 200, 300]);
        let judged = &confirm.to_judge()[0].joints[0];
        assert_eq!(
            (judged.counted(0, 100), judged.measurement[3], judged.measurement[4]),
            (96.0, 0.0, 304.0)
        );
        assert_eq!(judged.column(1)[99], 499.0);
        let again = fit[0].followed_by(&confirm.to_judge()[0]);
        assert_eq!((again.rows(), again.segment_starts.as_slice()), (400, [0, 200, 400].as_slice()));
        assert_eq!(again.joints[0].column(1)[299..305], [399.0, 0.0, 0.0, 0.0, 0.0, 404.0]);
    }
}
