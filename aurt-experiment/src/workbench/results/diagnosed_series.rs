//! What a diagnosis sees in its recordings, row by row, for programs that plot it.

use std::path::Path;

use aurt::predictions::PredictionNames;
use aurt_diagnosis::{JointSeriesRows, RecordingSeries, Verdict};
use aurt_traits::MeasurementUnit;

use super::series::{SeriesFormat, Written};
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
    /// Names of the joints; empty where they have none.
    pub joint_names: Vec<String>,
    pub unit: MeasurementUnit,
}

type Series = Vec<Vec<f64>>;

impl DiagnosedSeries {
    pub fn to_file(&self, format: SeriesFormat, verdict: &Verdict) -> Result<Vec<u8>, Failure> {
        let RecordingSeries { name, role, time_s, joints, .. } = &self.rows;
        let of = |values: fn(&JointSeriesRows) -> &Vec<f64>| -> Series {
            joints.iter().map(|joint| values(joint).clone()).collect()
        };
        let within = |windows: &[[f64; 2]]| -> Vec<f64> {
            let is_within = |t: &f64| windows.iter().any(|[from, to]| (*from..=*to).contains(t));
            time_s.iter().map(|t| f64::from(u8::from(is_within(t)))).collect()
        };
        let located: Series = (0..joints.len())
            .map(|joint| {
                let here = verdict
                    .effects
                    .iter()
                    .filter(|e| e.recording.as_ref() == Some(name) && e.joints.contains(&joint));
                within(&here.filter_map(|e| e.window_s).collect::<Vec<_>>())
            })
            .collect();
        let stands_out: Series = joints.iter().map(|joint| within(&joint.windows_s)).collect();
        let (before, after) = (of(|j| &j.before), of(|j| &j.after));
        let measured: Option<Series> = joints.iter().map(|j| j.measured.clone()).collect();
        let predicted = |residual: &Series| -> Option<Series> {
            let difference = |(m, r): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                m.iter().zip(r).map(|(m, r)| m - r).collect()
            };
            Some(measured.as_ref()?.iter().zip(residual).map(difference).collect())
        };
        let (predicted_before, predicted_after) = (predicted(&before), predicted(&after));
        let quantities = [
            ("measured", measured.as_ref()),
            ("predicted_before", predicted_before.as_ref()),
            ("predicted_after", predicted_after.as_ref()),
            ("residual_before", Some(&before)),
            ("residual_after", Some(&after)),
        ];
        let stamps: Vec<f64> = time_s.iter().map(|t| self.first_s + t).collect();
        Written {
            label: name,
            unit: self.unit,
            time_s: &stamps,
            origin_s: self.origin_s,
            joint_names: &self.joint_names,
            position_rad: &of(|j| &j.position_rad),
            quantities: quantities.into_iter().filter_map(|(name, s)| Some((name, s?.as_slice()))).collect(),
            flags: vec![("located", located.as_slice()), ("stands_out", stands_out.as_slice())],
        }
        .to_file(format, Path::new(name), &[("part", format!("{role:?}").to_lowercase())])
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
