//! What a diagnosis sees in its recordings, row by row, for programs that plot it.

use std::path::Path;

use aurt::predictions::PredictionNames;
use aurt_diagnosis::{JointSeriesRows, RecordingSeries, Verdict};
use aurt_traits::MeasurementUnit;

use super::series::{Series, SeriesFormat, difference};
use crate::workbench::failure::Failure;

/// A recording of a diagnosis: measurement, predictions and residuals before and after what was found, and where it was
/// found. Rows are those of the diagnosis, filtered and decimated.
#[derive(Debug, Clone)]
pub struct DiagnosedSeries {
    pub rows: RecordingSeries,
    /// The stamp from which they count, s after `origin_s`.
    pub first_s: f64,
    /// The whole second from which stamps count.
    pub origin_s: f64,
    pub joint_names: Vec<String>,
    pub unit: MeasurementUnit,
}

impl DiagnosedSeries {
    pub fn to_file(&self, format: SeriesFormat, verdict: &Verdict) -> Result<Vec<u8>, Failure> {
        let RecordingSeries { name, role, time_s, joints, .. } = &self.rows;
        let of = |values: fn(&JointSeriesRows) -> &Vec<f64>| -> Vec<Vec<f64>> {
            joints.iter().map(|joint| values(joint).clone()).collect()
        };
        let within = |windows: &[[f64; 2]]| -> Vec<f64> {
            let is_within = |t: &f64| windows.iter().any(|[from, to]| (*from..=*to).contains(t));
            time_s.iter().map(|t| f64::from(u8::from(is_within(t)))).collect()
        };
        let located: Vec<Vec<f64>> = (0..joints.len())
            .map(|joint| {
                let here = verdict
                    .effects
                    .iter()
                    .filter(|e| e.recording.as_ref() == Some(name) && e.joints.contains(&joint));
                within(&here.filter_map(|e| e.window_s).collect::<Vec<_>>())
            })
            .collect();
        let stands_out: Vec<Vec<f64>> = joints.iter().map(|joint| within(&joint.windows_s)).collect();
        let (before, after) = (of(|j| &j.before), of(|j| &j.after));
        let measured: Option<Vec<Vec<f64>>> = joints.iter().map(|j| j.measured.clone()).collect();
        let predicted = |residual: &Vec<Vec<f64>>| measured.as_ref().map(|m| difference(m, residual));
        let quantities = [
            ("predicted_before", predicted(&before)),
            ("predicted_after", predicted(&after)),
            ("residual_before", Some(before)),
            ("residual_after", Some(after)),
        ];
        let quantities = [("measured", measured)].into_iter().chain(quantities);
        Series {
            label: name.clone(),
            unit: self.unit,
            time_s: time_s.iter().map(|t| self.first_s + t).collect(),
            origin_s: self.origin_s,
            joint_names: self.joint_names.clone(),
            position_rad: of(|j| &j.position_rad),
            quantities: quantities.filter_map(|(name, series)| Some((name, series?))).collect(),
            flags: vec![("located", located), ("stands_out", stands_out)],
        }
        .to_file(format, Path::new(name), &[("part", role.name().to_owned())])
    }
}

/// The series of a diagnosis, each as the name and the contents of a file. Parts of one file have a file each.
pub fn files(
    series: &[DiagnosedSeries],
    verdict: &Verdict,
    format: SeriesFormat,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let mut names = PredictionNames::default();
    let named = series.iter().map(|one| {
        let name = names.stem(Path::new(&one.rows.name));
        Ok((format!("series_{name}.{}", format.ending()), one.to_file(format, verdict)?))
    });
    named.collect()
}
